#include "analysis/attributes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "analysis/quantiles.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

constexpr Attributes everything = Attribute::normal | Attribute::radius | Attribute::uncertainty;

std::vector<vec3> noisy_square(std::size_t n, float noise) {
  std::mt19937 random(7);
  std::normal_distribution<float> gauss(0, noise);
  std::vector<vec3> points = uniform_square(n);
  for (vec3& p : points) p.z = gauss(random);
  return points;
}

float degrees_between(const vec3& a, const vec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

TEST(Normals, ExactPlaneInAnyDirection) {
  std::vector<vec3> points = uniform_square(5000);
  const vec3 normal = glm::normalize(vec3(1, 2, 3));
  const vec3 u = glm::normalize(glm::cross(normal, vec3(0, 0, 1))), v = glm::cross(normal, u);
  for (vec3& p : points) p = p.x * u + p.y * v;
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal, {});
  ASSERT_EQ(prepared.cloud.normals.size(), points.size());
  // Coordinates below 2 are rounded to 1e-7, a neighbourhood is 0.04 wide: about 1e-5 rad = 6e-4 degrees,
  // more where its points are nearly in line.
  for (const vec3& n : prepared.cloud.normals) EXPECT_LT(degrees_between(n, normal), 0.05f);
}

TEST(Normals, NoisyPlane) {
  // Least squares over a disc of radius R: a tilt has deviation noise / (R/2 sqrt(K)) about each axis. With
  // 10,000 points a unit square, R = sqrt(25 / (10,000 pi)) = 0.028; noise 0.001 makes 0.001 / (0.0141 * 5) =
  // 0.0142 rad = 0.81 degrees an axis, 1.15 rms in all.
  const PreparedCloud prepared = prepare(cloud_of(noisy_square(10'000, 0.001f)), Attribute::normal, {});
  double sum2 = 0;
  float worst = 0;
  for (const vec3& n : prepared.cloud.normals) {
    EXPECT_NEAR(glm::length(n), 1, 1e-5);
    const float angle = degrees_between(n, vec3(0, 0, 1));
    sum2 += angle * angle, worst = std::max(worst, angle);
  }
  const double rms = std::sqrt(sum2 / double(prepared.cloud.size()));
  EXPECT_GT(rms, 0.8);   // noise is there: an answer of z everywhere would be invented
  EXPECT_LT(rms, 1.5);   // 1.15, and half-discs at the border are worse
  EXPECT_LT(worst, 10);  // seven deviations and the corners
}

TEST(Normals, NoisySphereSeenFromOutsideAndInside) {
  // 20,000 points on a unit sphere: R = 2 sqrt(25 / 20,000) = 0.0707; noise 0.002 gives as above
  // 0.002 / (0.0354 * 5) = 0.0113 rad, 0.92 degrees rms in all. Curvature does not tilt, the shift of the
  // neighbourhood's centre does by its scatter R / 2 / 5 = 0.007 rad = 0.4 degrees an axis. Together 1.1.
  const std::vector<vec3> points = noisy_sphere(20'000, 1, 0.002f);
  for (bool inside : {false, true}) {
    PointCloud cloud = cloud_of(points);
    cloud.origin = {1000, 2000, 3000};
    ScalarField scanner{"scanner", 0, {}};
    if (inside) {
      cloud.scanners = {cloud.origin};
    } else {  // each half seen by its own scanner
      cloud.scanners = {cloud.origin - dvec3(0, 0, 1e4), cloud.origin + dvec3(0, 0, 1e4)};
      for (const vec3& p : points) scanner.values.push_back(p.z > 0);
      cloud.set_scalar(std::move(scanner));
    }
    const PreparedCloud prepared = prepare(std::move(cloud), Attribute::normal, {});
    double sum2 = 0;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec3 outward = glm::normalize(prepared.cloud.positions[i]);
      const vec3 n = inside ? -prepared.cloud.normals[i] : prepared.cloud.normals[i];
      if (!inside && std::abs(outward.z) < 0.1f)
        continue;  // grazing: noise decides which side the scanner sees
      turned += glm::dot(n, outward) < 0;
      const float angle = degrees_between(n, outward);
      sum2 += angle * angle;
    }
    EXPECT_EQ(turned, 0u);
    EXPECT_LT(std::sqrt(sum2 / double(points.size())), 1.5);
  }
}

TEST(Normals, FaceTheViewpointOfTheirGrid) {
  // Two organised halves of one plane, seen from above and from below, and points of no grid.
  PointCloud cloud = cloud_of(square_grid(30, 1));
  const std::size_t half = 450;
  cloud.grids = {{0, 300, 30, 10, dvec3(15, 0, 20)}, {half, half, 30, 15, dvec3(15, 30, -20)}};
  for (std::uint32_t i = 0; i < cloud.size(); ++i) cloud.grid_index.push_back(i);
  const PreparedCloud prepared = prepare(std::move(cloud), Attribute::normal, {});
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i)
    EXPECT_EQ(prepared.cloud.normals[i].z > 0, prepared.cloud.source_index[i] < half)
        << "by the fixed rule: up";
}

TEST(Normals, UpWhereNobodyLookedAndSteadyOnUprightWalls) {
  PointCloud cloud = cloud_of(noisy_square(2000, 0.001f));
  cloud.up = UpAxis::neg_z;
  for (const vec3& n : prepare(cloud, Attribute::normal, {}).cloud.normals) EXPECT_LT(n.z, 0);
  for (vec3& p : cloud.positions) p = {p.z, p.x, p.y};  // a wall: its normals are +-x with noise
  const PreparedCloud wall = prepare(cloud, Attribute::normal, {});
  std::size_t one_side = 0;
  for (const vec3& n : wall.cloud.normals) one_side += n.x > 0;
  EXPECT_TRUE(one_side == 0 || one_side == cloud.size()) << one_side;
}

TEST(Normals, LinesCoincidentAndSinglePointsGetUnitNormals) {
  std::vector<vec3> line;
  for (int i = 0; i < 100; ++i) line.push_back(vec3(float(i), 0, 0));
  for (const vec3& n : prepare(cloud_of(line), Attribute::normal, {}).cloud.normals) {
    EXPECT_NEAR(glm::length(n), 1, 1e-5);
    EXPECT_NEAR(n.x, 0, 1e-5);  // across the line
  }
  for (std::size_t count : {1u, 2u, 100u})
    for (const vec3& n : prepare(cloud_of(std::vector<vec3>(count, vec3(3))), everything, {}).cloud.normals)
      EXPECT_EQ(n, vec3(0, 0, 1));
}

TEST(Radii, UniformGrid) {
  // K = 24 on a square grid: the 24th neighbour is at 2 sqrt(2) h, 2 * 2.828 / sqrt(24) h = 1.1547 h.
  const float h = 0.01f;
  const PreparedCloud prepared = prepare(cloud_of(square_grid(50, h)), Attribute::radius, {});
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const vec3 p = prepared.cloud.positions[i] / h;
    if (std::min(p.x, p.y) < 1.5f || std::max(p.x, p.y) > 47.5f) continue;  // the border has to reach farther
    EXPECT_NEAR(prepared.cloud.radii[i], 1.1547f * h, 1e-4f * h);
  }
  EXPECT_NEAR(prepared.median_radius, 1.1547f * h, 1e-4f * h);
}

TEST(Radii, ASparsePartHasItsOwnAndPointsThatStandAloneDoNot) {
  const auto shifted = [](std::vector<vec3> points, float x) {
    for (vec3& p : points) p.x += x;
    return points;
  };
  std::vector<vec3> points = square_grid(200, 0.5f);  // most of all, so the median is theirs
  for (const vec3& p : shifted(square_grid(160, 10), 200)) points.push_back(p);
  const std::size_t alone = points.size();
  for (const vec3& p : shifted(square_grid(5, 40), -400)) points.push_back(p);
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  ASSERT_NEAR(prepared.median_radius, 1.1547f * 0.5f, 1e-3f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const vec3 p = prepared.cloud.positions[i];
    const float radius = prepared.cloud.radii[i];
    if (prepared.cloud.source_index[i] >= alone)
      EXPECT_LT(radius, 1.2f * largest_disc * prepared.median_radius);  // next on the curve: a border
    else if (p.x > 220 && p.x < 1670 && p.y > 20 && p.y < 1470)
      EXPECT_NEAR(radius, 1.1547f * 10, 1e-3f);
    EXPECT_LE(radius, prepared.radius_limit);
  }
}

TEST(Radii, ScaleWithTheCloudAndLeaveTheNormalizedUncertainty) {
  const std::vector<vec3> points = noisy_sphere(4000, 1, 0.02f);
  const PreparedCloud one = prepare(cloud_of(points), everything, {});
  for (float scale : {0.001f, 512.0f}) {
    std::vector<vec3> scaled = points;
    for (vec3& p : scaled) p *= scale;
    const PreparedCloud other = prepare(cloud_of(scaled), everything, {});
    ASSERT_EQ(other.cloud.source_index, one.cloud.source_index);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(other.cloud.radii[i] / scale, one.cloud.radii[i], 1e-5f * one.cloud.radii[i]);
      // Rounding of the scaled coordinates turns normals by about 1e-7 / 0.1 rad, more where they are
      // ill-defined.
      EXPECT_NEAR(normalized(other.cloud.scalar("uncertainty")->values[i], other.uncertainty_range),
                  normalized(one.cloud.scalar("uncertainty")->values[i], one.uncertainty_range), 1e-3);
    }
  }
}

TEST(Radii, CoincidentAndSinglePointsGetTheRadiusOfTheSpacing) {
  for (std::size_t count : {1u, 100u})
    for (float r : prepare(cloud_of(std::vector<vec3>(count, vec3(3))), Attribute::radius, {}).cloud.radii)
      EXPECT_NEAR(r, 1.128379f, 1e-5);  // 2 / sqrt(pi) times the spacing of 1 that a single place has
}

TEST(Uncertainty, IsTheRadiusOnAPlaneAndLargerAtAnEdge) {
  std::vector<vec3> corner = square_grid(40, 1);
  for (const vec3& p : square_grid(40, 1)) corner.push_back(vec3(0, p.x, p.y + 1));
  const PreparedCloud prepared = prepare(cloud_of(corner), everything, {});
  const ScalarField& uncertainty = *prepared.cloud.scalar("uncertainty");
  float worst_flat = 0, least_edge = 9;
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const vec3 p = prepared.cloud.positions[i];
    const float ratio = uncertainty.values[i] / prepared.cloud.radii[i];
    EXPECT_GE(ratio, 1 - 1e-5f);  // the factor is in [1, 4] for normals without sign
    EXPECT_LE(ratio, 4 + 1e-5f);
    // Discs at the border are smaller than the equation's, from which uncertainty is.
    if (std::max(p.x, p.z) > 12 && std::max({p.x, p.y, p.z}) < 30 && p.y > 8)
      worst_flat = std::max(worst_flat, ratio);
    if (std::max(p.x, p.z) < 1.5f && p.y > 8 && p.y < 30) least_edge = std::min(least_edge, ratio);
  }
  EXPECT_LT(worst_flat, 1.001f);
  EXPECT_GT(least_edge, 1.05f);
}

TEST(Uncertainty, MatchesTheEquationTypedAgain) {
  PointCloud sphere = cloud_of(noisy_sphere(600, 1, 0.05f));
  sphere.normals = noisy_sphere(600, 1, 0);  // any will do
  // Radii as the equation has them. Where discs shrink in clutter, uncertainty still comes from whole ones.
  const PreparedCloud prepared = prepare(sphere, everything, {.neighbors = 10, .clutter_radius = 1});
  const PreparedCloud shrunk = prepare(sphere, everything, {.neighbors = 10});
  EXPECT_FALSE(shrunk.shrunk.empty()) << "or this compares nothing";
  const PointCloud& cloud = prepared.cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> by_distance;
    for (std::size_t j = 0; j < cloud.size(); ++j)
      if (j != i)
        by_distance.push_back({glm::distance(dvec3(cloud.positions[i]), dvec3(cloud.positions[j])), j});
    std::sort(by_distance.begin(), by_distance.end());
    const double radius = 2 * by_distance[9].first / std::sqrt(10.0);
    double sum = 0;
    for (int j = 0; j < 10; ++j) {
      const dvec3 a(cloud.normals[i]), b(cloud.normals[by_distance[std::size_t(j)].second]);
      sum += std::pow(2 - std::abs(glm::dot(a, b)), 2);
    }
    EXPECT_NEAR(cloud.radii[i], radius, 1e-6);  // float
    EXPECT_NEAR(cloud.scalar("uncertainty")->values[i], radius * sum / 10, 1e-5);
    EXPECT_NEAR(shrunk.cloud.scalar("uncertainty")->values[i], radius * sum / 10, 1e-5);
  }
}

TEST(Complete, WhatTheFileBroughtWins) {
  PointCloud cloud = cloud_of(square_grid(20, 1));
  cloud.normals.assign(cloud.size(), vec3(1, 0, 0));
  cloud.radii.assign(cloud.size(), 7);
  cloud.normals[5] = vec3(0);  // unknown: is computed
  cloud.radii[6] = 0;
  cloud.set_scalar({"uncertainty", 10, std::vector<float>(cloud.size(), 3)});
  const PreparedCloud prepared = prepare(cloud, everything, {});
  EXPECT_EQ(prepared.available, everything);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool fifth = prepared.cloud.source_index[i] == 5, sixth = prepared.cloud.source_index[i] == 6;
    EXPECT_EQ(prepared.cloud.normals[i], fifth ? vec3(0, 0, 1) : vec3(1, 0, 0));
    if (sixth)
      EXPECT_LT(prepared.cloud.radii[i], 2);
    else
      EXPECT_EQ(prepared.cloud.radii[i], 7);
    EXPECT_EQ(prepared.cloud.scalar("uncertainty")->value(i), 13);
  }
}

TEST(Complete, ComputesOnlyWhatIsAskedForAndTheRestLater) {
  const std::vector<vec3> points = noisy_sphere(2000, 1, 0.01f);
  PreparedCloud prepared = prepare(cloud_of(points), {}, {});
  EXPECT_TRUE(prepared.available.empty());
  EXPECT_TRUE(prepared.cloud.normals.empty());
  EXPECT_TRUE(prepared.cloud.radii.empty());
  complete(prepared, Attribute::radius, {});
  EXPECT_EQ(prepared.available, Attributes(Attribute::radius));
  EXPECT_TRUE(prepared.cloud.normals.empty());
  complete(prepared, Attribute::uncertainty, {});  // brings the normals it is made of
  EXPECT_EQ(prepared.available, everything);
  const PreparedCloud at_once = prepare(cloud_of(points), everything, {});
  EXPECT_EQ(prepared.cloud.normals, at_once.cloud.normals);
  EXPECT_EQ(prepared.cloud.radii, at_once.cloud.radii);
  EXPECT_EQ(prepared.cloud.scalar("uncertainty")->values, at_once.cloud.scalar("uncertainty")->values);
  EXPECT_EQ(prepared.uncertainty_range.q98, at_once.uncertainty_range.q98);
}

TEST(Complete, EmptyCloudHasEverything) { EXPECT_EQ(prepare({}, everything, {}).available, everything); }

TEST(Complete, SameForOneAndTwoThreads) {
  PreparedCloud alone;
  {
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    alone = prepare(cloud_of(difficult_cloud()), everything, {});
  }
  tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  const PreparedCloud both = prepare(cloud_of(difficult_cloud()), everything, {});
  EXPECT_EQ(both.cloud.normals, alone.cloud.normals);
  EXPECT_EQ(both.cloud.radii, alone.cloud.radii);
  EXPECT_EQ(both.cloud.scalar("uncertainty")->values, alone.cloud.scalar("uncertainty")->values);
}

TEST(Complete, CancelledCallChangesNothing) {
  struct StopAfterAWhile final : Progress {  // in the middle of the neighbours
    void update(double fraction, std::string_view) override { stop = stop || fraction > 0.1; }
    bool cancelled() const override { return stop; }
    std::atomic<bool> stop = false;
  } progress;
  PreparedCloud prepared = prepare(cloud_of(uniform_cube(100'000)), {}, {});
  EXPECT_THROW(complete(prepared, everything, {}, progress), Cancelled);
  EXPECT_TRUE(prepared.cloud.normals.empty());
  EXPECT_TRUE(prepared.cloud.radii.empty());
  EXPECT_TRUE(prepared.available.empty());
}

TEST(Quantiles, InterpolateAndLeaveOutNan) {
  std::vector<float> values;
  for (int i = 100; i >= 0; --i) values.push_back(float(i));
  values.push_back(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(quantile(values, 0), 0);
  EXPECT_EQ(quantile(values, 1), 100);
  EXPECT_FLOAT_EQ(quantile(values, 0.855), 85.5f);
  EXPECT_FLOAT_EQ(quantiles(values).q02, 2);
  EXPECT_FLOAT_EQ(quantiles(values).q98, 98);
  EXPECT_EQ(quantile({}, 0.5), 0);
}

TEST(Quantiles, NormalizedValuesIgnoreOutliersAndRounding) {
  const Quantiles range{2, 6};
  EXPECT_EQ(normalized(1e9f, range), 1);
  EXPECT_EQ(normalized(0, range), 0);
  EXPECT_EQ(normalized(3, range), 0.25f);
  EXPECT_EQ(normalized(std::numeric_limits<float>::quiet_NaN(), range), 0);
  // The radii of a regular grid differ by rounding only: nothing is uncertain there.
  EXPECT_EQ(normalized(1.0000002f, {1.0f, 1.0000001f}), 0);
}

}  // namespace
