#include "analysis/wide_normals.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/prepare.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

/// 40,000 points of a unit square, 0.005 apart, off it by a Gaussian of `noise` spacings.
std::vector<vec3> noisy_square(float noise) {
  std::mt19937 random(7);
  std::normal_distribution<float> gauss(0, noise * 0.005f);
  std::vector<vec3> points = uniform_square(40'000);
  for (vec3& p : points) p.z = gauss(random);
  return points;
}

/// Degrees between normals and lines along `truth(position)`, sorted.
template <class Truth>
std::vector<float> errors_of(const PointCloud& cloud, const Truth& truth) {
  std::vector<float> errors;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const vec3 n = cloud.normals[i], t = truth(cloud.positions[i]);
    errors.push_back(glm::degrees(std::atan2(glm::length(glm::cross(n, t)), std::abs(glm::dot(n, t)))));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

// A disc of 1600 points has a radius of 22.6 spacings, so tilts by noise / (22.6 / 2 * 40) about each axis:
// one spacing of noise by 0.13 degrees, two by 0.25; those of 200 points, which count as much as their error
// is small, are nine times worse. The nearest 24 are off by 13 and 27 degrees.
TEST(WideNormals, NoiseAsThickAsTheNeighbourhoodTiltsNothing) {
  for (float noise : {0.3f, 1.0f, 2.0f}) {
    const PreparedCloud prepared = prepare(cloud_of(noisy_square(noise)), Attribute::normal, {});
    const std::vector<float> errors = errors_of(prepared.cloud, [](const vec3&) { return vec3(0, 0, 1); });
    EXPECT_LT(errors[errors.size() / 2], 1) << noise;
    EXPECT_LT(errors[errors.size() * 99 / 100], 6) << noise;  // at the border discs are half as large
    EXPECT_NEAR(prepared.noise, noise * 0.005f, 0.1f * noise * 0.005f) << noise;
  }
}

// Two scans that do not quite meet: of 24 points some lie on either sheet.
TEST(WideNormals, TwoSheetsAreOneSurface) {
  std::vector<vec3> points = noisy_square(0.05f);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].z += 0.01f;  // two spacings
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal, {});
  const std::vector<float> errors = errors_of(prepared.cloud, [](const vec3&) { return vec3(0, 0, 1); });
  EXPECT_LT(errors[errors.size() / 2], 1);
  EXPECT_LT(errors[errors.size() * 99 / 100], 4);
  EXPECT_NEAR(prepared.noise, 0.005f, 0.0005f);  // each sheet is half as far off the middle
}

// 40,000 points of a unit sphere, 0.018 apart. Bends count as errors, so less is gained than in a plane: from
// 13 degrees in the median.
TEST(WideNormals, ANoisySphereStaysRound) {
  const PreparedCloud prepared = prepare(cloud_of(noisy_sphere(40'000, 1, 0.018f)), Attribute::normal, {});
  const std::vector<float> errors =
      errors_of(prepared.cloud, [](const vec3& p) { return glm::normalize(p); });
  EXPECT_LT(errors[errors.size() / 2], 6);
  EXPECT_LT(errors[errors.size() * 9 / 10], 15);
}

// Edges of what is clean keep what the nearest points tell: 24 of them reach 2.8 spacings, wide planes 8
// and 23.
TEST(WideNormals, EdgesStaySharp) {
  std::vector<vec3> points = uniform_square(20'000);
  for (const vec3& p : uniform_square(20'000, 5)) points.push_back({0, p.y, p.x});
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal, {});
  EXPECT_EQ(prepared.noise, 0);
  const float spacing = 1 / std::sqrt(20'000.0f);
  int beyond = 0, near = 0, dull = 0;
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const vec3 p = prepared.cloud.positions[i], n = prepared.cloud.normals[i];
    const bool flat = p.z == 0;
    const float away = flat ? p.x : p.z, along = std::abs(flat ? n.z : n.x);
    if (away > 5 * spacing) {
      ++beyond;
      EXPECT_GT(along, 0.99999f) << away / spacing;
    } else if (away > 2 * spacing) {
      ++near, dull += along < 0.98f;  // 11 degrees
    }
  }
  EXPECT_GT(beyond, 30'000);
  EXPECT_LT(dull, 0.15 * near);  // what 24 neighbours leave: 8 % of them reach round the edge
}

TEST(WideNormals, FoliageIsNoNoisySurface) {
  const std::vector<vec3> points = uniform_cube(40'000);
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal, {});
  EXPECT_EQ(prepared.noise, 0);
}

// Whatever was computed before, uncertainty is of the nearest neighbours, by which noise is uncertain.
TEST(WideNormals, UncertaintyKeepsTheNearest) {
  const std::vector<vec3> points = noisy_square(0.7f);
  PreparedCloud later = prepare(cloud_of(points), Attribute::normal | Attribute::radius, {});
  complete(later, Attribute::uncertainty, {});
  const PreparedCloud at_once =
      prepare(cloud_of(points), Attribute::normal | Attribute::radius | Attribute::uncertainty, {});
  EXPECT_EQ(later.cloud.normals, at_once.cloud.normals);
  EXPECT_EQ(later.cloud.scalar("uncertainty")->values, at_once.cloud.scalar("uncertainty")->values);
  const std::vector<float>& values = at_once.cloud.scalar("uncertainty")->values;
  std::size_t unsure = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    unsure += values[i] > 1.02f * at_once.cloud.radii[i] / (at_once.shrunk.empty() ? 1 : at_once.shrunk[i]);
  EXPECT_GT(unsure, values.size() / 2) << "or the widened ones were asked, which agree";
}

TEST(WideNormals, GivenNormalsStay) {
  PointCloud cloud = cloud_of(noisy_square(1));
  cloud.normals.assign(cloud.size(), vec3(0));
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] = vec3(1, 0, 0);
  const PreparedCloud prepared = prepare(cloud, Attribute::normal, {});
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    if (prepared.cloud.source_index[i] % 2 == 0)
      EXPECT_EQ(prepared.cloud.normals[i], vec3(1, 0, 0));
    else
      EXPECT_GT(prepared.cloud.normals[i].z, 0.9f);
  }
}

// Those that came with a scan may be of too few of its noisy points.
TEST(WideNormals, GivenNormalsThatAreRougherThanComputedOnesAreComputed) {
  for (const float degrees : {1.0f, 12.0f}) {
    std::mt19937 random(3);
    std::normal_distribution<float> tilt(0, glm::radians(degrees));
    PointCloud cloud = cloud_of(noisy_square(0.2f));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud.normals.push_back(glm::normalize(vec3(tilt(random), tilt(random), i % 2 ? 1 : -1)));
    const PreparedCloud prepared = prepare(cloud, Attribute::normal, {});
    EXPECT_EQ(prepared.computed.has(Attribute::normal), degrees > 10) << degrees;
    const std::vector<float> errors = errors_of(prepared.cloud, [](const vec3&) { return vec3(0, 0, 1); });
    EXPECT_LT(errors[errors.size() / 2], 2) << degrees;
  }
}

// A noisy thing is flat in few places; thirty that agree are enough.
TEST(WideNormals, GivenNormalsAreAskedWhereFewPlacesAreFlat) {
  std::mt19937 random(4);
  std::normal_distribution<float> any;
  PointCloud cloud = cloud_of(noisy_square(0.2f));
  const std::size_t flat = cloud.size();
  for (std::size_t i = 0; i < 30 * flat; ++i)  // a filled ball beside it
    cloud.positions.push_back(vec3(1000) + 40.0f * std::cbrt(float(i + 1) / float(30 * flat)) *
                                               glm::normalize(vec3(any(random), any(random), any(random))));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.normals.push_back(glm::normalize(vec3(any(random), any(random), any(random))));
  EXPECT_TRUE(prepare(cloud, Attribute::normal, {}).computed.has(Attribute::normal));
}

TEST(WideNormals, GivenNormalsOfWhatBendsStay) {
  PointCloud cloud = cloud_of(noisy_sphere(2'000, 1, 0));  // 0.08 apart: neighbours turn by 13 degrees
  for (const vec3& p : cloud.positions) cloud.normals.push_back(glm::normalize(p));
  const PreparedCloud prepared = prepare(cloud, Attribute::normal, {});
  EXPECT_FALSE(prepared.computed.has(Attribute::normal));
}

}  // namespace
