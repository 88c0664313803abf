// Facts of parts merge to the facts of the whole, whatever the parts and the order.
#include "analysis/cloud_facts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "analysis/quantiles.h"
#include "analysis/spacing.h"
#include "analysis/survey.h"
#include "clouds.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t few = 500;  // so that samples leave points out
constexpr std::size_t around = 65;

void add_values(PointCloud& cloud, std::mt19937& random) {
  std::normal_distribution<float> gauss(0, 1);
  ScalarField height{"height", 1e6, {}}, kind{"classification", 0, {}};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    height.values.push_back(i % 17 == 0 ? NAN : gauss(random));
    kind.values.push_back(float(random() % 5));
  }
  cloud.set_scalar(std::move(height)), cloud.set_scalar(std::move(kind));
}

/// A cube far from the origin with colours and numbers; a sphere with normals; a grid, where distances are
/// alike; and few places with many points.
std::vector<PointCloud> clouds() {
  std::mt19937 random(5);
  std::vector<PointCloud> all(4);
  all[0].origin = {5e5, 4e6, 100};
  all[0].positions = test::uniform_cube(6000);
  for (std::size_t i = 0; i < all[0].size(); ++i)
    all[0].colors.push_back(i % 9 == 0 ? no_color : Rgba8{std::uint8_t(i), 7, 9});
  add_values(all[0], random);
  all[1].positions = test::noisy_sphere(5000, 2, 0.02f);
  for (const vec3& p : all[1].positions) all[1].normals.push_back(glm::normalize(p));
  all[2].positions = test::square_grid(60, 0.25f);
  all[2].radii.assign(all[2].size(), 0.1f);
  const std::vector<vec3> places = test::uniform_cube(40);
  for (int i = 0; i < 3000; ++i) all[3].positions.push_back(places[random() % (i < 1500 ? 1 : 40)]);
  add_values(all[3], random);
  return all;
}

std::vector<PointCloud> split(const PointCloud& cloud, std::size_t parts, std::mt19937& random) {
  std::vector<std::vector<std::uint32_t>> members(parts);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) members[random() % parts].push_back(i);
  std::vector<PointCloud> out;
  for (std::vector<std::uint32_t>& each : members) {
    std::shuffle(each.begin(), each.end(), random);
    out.push_back(select(cloud, each));
  }
  return out;
}

/// Merges two of them until one is left.
template <class T, class Merge>
T merged(std::vector<T> parts, std::mt19937& random, const Merge& merge_two) {
  while (parts.size() > 1) {
    std::shuffle(parts.begin(), parts.end(), random);
    const T last = std::move(parts.back());
    parts.pop_back();
    merge_two(parts[random() % parts.size()], last);
  }
  return std::move(parts.front());
}

TEST(CloudFacts, AreThoseOfTheWholeHoweverItIsSplit) {
  std::mt19937 random(1);
  for (const PointCloud& cloud : clouds()) {
    const CloudFacts whole = facts_of(cloud, few);
    const PointCloud sample = sample_of(whole);
    ASSERT_LE(sample.size(), few);
    for (int round = 0; round < 50; ++round) {
      std::vector<CloudFacts> parts;
      for (const PointCloud& part : split(cloud, 1 + random() % 8, random))
        parts.push_back(facts_of(part, few));
      const CloudFacts facts = merged(std::move(parts), random,
                                      [](CloudFacts& into, const CloudFacts& of) { merge(into, of, few); });
      ASSERT_EQ(facts, whole);
      const PointCloud same = sample_of(facts);
      ASSERT_EQ(same.positions, sample.positions);
      ASSERT_EQ(same.colors, sample.colors);
      for (std::size_t k = 0; k < sample.scalars.size(); ++k)
        ASSERT_EQ(quantiles(same.scalars[k].values).q98, quantiles(sample.scalars[k].values).q98);
    }
  }
}

TEST(CloudFacts, CountWhatThereIs) {
  const PointCloud cloud = clouds()[0];
  const CloudFacts facts = facts_of(cloud, few);
  EXPECT_EQ(facts.points, 6000u);
  EXPECT_EQ(facts.with_color, 6000u - 667u);
  EXPECT_EQ(facts.scalars.at("height").count, 6000u - 353u);
  EXPECT_EQ(facts.classes.size(), 5u);
  EXPECT_EQ((Bounds{facts.least, facts.most}), bounds(cloud));
  EXPECT_EQ(facts.sample.size(), few);
  EXPECT_EQ(facts_of(clouds()[3], few).sample.size(), few);
}

// One part knows scalars and colours that the other lacks.
TEST(CloudFacts, OfPartsThatDiffer) {
  std::vector<PointCloud> all = clouds();
  all[1].positions.resize(200), all[1].normals.resize(200);
  const CloudFacts a = facts_of(all[0], few), b = facts_of(all[1], few);
  CloudFacts ab = a, ba = b;
  merge(ab, b, few), merge(ba, a, few);
  EXPECT_EQ(ab, ba);
  const PointCloud sample = sample_of(ab);
  EXPECT_EQ(sample.colors.size(), few);
  EXPECT_EQ(sample.scalar("height")->values.size(), few);
}

// A share read off the sample is off by no more than the bound: 500 points by 8.6 % but for one time in 1000.
TEST(CloudFacts, TheSampleHasTheSharesOfTheWhole) {
  const double most = std::sqrt(std::log(2000.0) / (2 * few));
  for (unsigned seed = 0; seed < 20; ++seed) {
    PointCloud cloud;
    cloud.positions = test::uniform_cube(20'000, 100 + seed);
    std::vector<float> of_all, of_sample;
    for (const vec3& p : cloud.positions) of_all.push_back(p.x);
    const PointCloud sample = sample_of(facts_of(cloud, few));
    for (const vec3& p : sample.positions) of_sample.push_back(p.x);
    for (const double share : {0.02, 0.25, 0.5, 0.98}) {
      const float value = quantile(of_sample, share);
      const auto below = std::count_if(of_all.begin(), of_all.end(), [&](float x) { return x < value; });
      EXPECT_NEAR(double(below) / double(of_all.size()), share, most);
    }
  }
}

TEST(Neighborhoods, AreThoseOfTheWholeHoweverItIsSplit) {
  std::mt19937 random(2);
  for (const PointCloud& cloud : clouds()) {
    const std::vector<dvec3> places = first_places(places_in(cloud), 60);
    const Neighborhoods whole = neighborhoods_of(NeighborTree(cloud.positions), cloud.origin, places, around);
    for (int round = 0; round < 10; ++round) {
      std::vector<Neighborhoods> parts;
      for (const PointCloud& part : split(cloud, 1 + random() % 8, random))
        parts.push_back(neighborhoods_of(NeighborTree(part.positions), part.origin, places, around));
      const Neighborhoods all =
          merged(std::move(parts), random,
                 [](Neighborhoods& into, const Neighborhoods& of) { merge(into, of, around); });
      ASSERT_EQ(all, whole);
      ASSERT_EQ(spacing_of(all), spacing_of(whole));
      ASSERT_EQ(residual_of(all), residual_of(whole));
    }
  }
}

// Around 500 places: what is measured of the whole otherwise, within three standard errors of a median.
TEST(Neighborhoods, TellSpacingAndNoise) {
  PointCloud cloud;
  cloud.positions = test::noisy_sphere(40'000, 2, 0.02f);
  const NeighborTree tree(cloud.positions);
  const Neighborhoods near =
      neighborhoods_of(tree, cloud.origin, first_places(places_in(cloud), few), around);
  std::vector<Batch> batches(1);
  batches[0].count = std::uint32_t(cloud.size());
  EXPECT_NEAR(spacing_of(near) / measure_spacing(batches, tree), 1, 0.03);
  EXPECT_NEAR(residual_of(near) / plane_residual(cloud.positions), 1, 0.03);
}

}  // namespace
}  // namespace sfumato::analysis
