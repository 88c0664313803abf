#include "analysis/neighbors.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <set>

#include "analysis/morton.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

std::vector<vec3> sorted(const std::vector<vec3>& positions) {
  PointCloud cloud = cloud_of(positions);
  reorder(cloud, morton_order(cloud));
  return cloud.positions;
}

struct Found {
  std::vector<std::vector<std::uint32_t>> ids;
  std::vector<std::vector<float>> distances2;
};

Found find(const std::vector<vec3>& positions, int k) {
  Found found;
  found.ids.resize(positions.size());
  found.distances2.resize(positions.size());
  const NeighborTree tree(positions);
  for_each_neighborhood(tree, k, [&](std::uint32_t i, auto ids, auto distances2) {
    EXPECT_TRUE(found.ids[i].empty()) << "visited twice: " << i;
    found.ids[i].assign(ids.begin(), ids.end());
    found.distances2[i].assign(distances2.begin(), distances2.end());
  });
  return found;
}

/// Compares with all distances, sorted. Ties may be broken either way, so distances are compared, not
/// indices; both sides compute them by the same float expression, so that they must agree to the last bit.
void expect_brute_force(const std::vector<vec3>& positions, int k, std::size_t stride = 1) {
  const Found found = find(positions, k);
  const std::size_t n = positions.size(), expected = std::min(std::size_t(k), n - 1);
  for (std::size_t i = 0; i < n; i += stride) {
    std::vector<float> all;
    for (std::size_t j = 0; j < n; ++j) {
      const vec3 d = positions[j] - positions[i];
      if (j != i) all.push_back(d.x * d.x + d.y * d.y + d.z * d.z);
    }
    std::sort(all.begin(), all.end());
    all.resize(expected);
    ASSERT_EQ(found.ids[i].size(), expected);
    EXPECT_EQ(std::set<std::uint32_t>(found.ids[i].begin(), found.ids[i].end()).size(), expected)
        << "a point twice";
    for (std::size_t j = 0; j < expected; ++j) {
      ASSERT_NE(found.ids[i][j], i) << "a point is no neighbour of itself";
      const vec3 d = positions[found.ids[i][j]] - positions[i];
      ASSERT_EQ(found.distances2[i][j], d.x * d.x + d.y * d.y + d.z * d.z);
    }
    EXPECT_EQ(found.distances2[i].back(), all.back()) << "the last is the farthest";
    std::vector<float> mine = found.distances2[i];
    std::sort(mine.begin(), mine.end());
    ASSERT_EQ(mine, all) << "point " << i;
  }
}

TEST(Neighbors, RandomPointsOfACube) { expect_brute_force(sorted(uniform_cube(3000)), 24); }
TEST(Neighbors, RandomPointsOfASphere) { expect_brute_force(sorted(noisy_sphere(3000, 1, 0.01f)), 8); }
TEST(Neighbors, OneNeighbor) { expect_brute_force(sorted(uniform_cube(2000)), 1); }
TEST(Neighbors, SquareGridWithTies) { expect_brute_force(sorted(square_grid(50, 0.1f)), 24); }
TEST(Neighbors, DensityContrastsLinesCoincidentPointsAndOutliers) {
  expect_brute_force(sorted(difficult_cloud()), 24);
}
TEST(Neighbors, MoreNeighborsThanCandidatesFit) { expect_brute_force(sorted(uniform_cube(4000)), 2500, 200); }
TEST(Neighbors, MoreNeighborsThanPoints) { expect_brute_force(sorted(uniform_cube(10)), 24); }
TEST(Neighbors, AllPointsCoincide) { expect_brute_force(std::vector<vec3>(3000, vec3(1, 2, 3)), 24, 100); }
TEST(Neighbors, AnyOrderOfThePoints) { expect_brute_force(uniform_cube(2000), 16); }

/// Holds the search to its contract: nothing at or beyond the limit is ever offered, however it shrank
/// meanwhile.
struct EightPlaces {
  static constexpr bool merges_coincident = true;
  std::vector<float> kept;
  int beyond = 0;
  float limit() const { return kept.size() < 8 ? std::numeric_limits<float>::infinity() : kept.back(); }
  void add(std::uint32_t, float distance2) {
    if (!(distance2 < limit())) ++beyond;
    kept.insert(std::upper_bound(kept.begin(), kept.end(), distance2), distance2);
    if (kept.size() > 8) kept.pop_back();
  }
};

TEST(Neighbors, CoincidentPointsAreNeverOfferedBeyondTheLimit) {
  // Leaves of one place each, as scans with double points and integer lattices have them.
  for (const std::size_t copies : {2, 5, 20, 64}) {
    std::vector<vec3> positions;
    for (const vec3& p : uniform_cube(4000, 7))
      for (std::size_t i = 0; i < copies; ++i) positions.push_back(glm::round(p * 40.0f));
    positions = sorted(positions);
    const NeighborTree tree(positions);
    for (std::size_t i = 0; i < positions.size(); i += 97) {
      EightPlaces nearest;
      tree.search(positions[i] + vec3(0.3f, 0.1f, 0.2f), nearest);
      ASSERT_EQ(nearest.beyond, 0) << copies << " copies, point " << i;
    }
  }
}

TEST(Neighbors, NoPointAndOnePoint) {
  EXPECT_TRUE(find({}, 24).ids.empty());
  EXPECT_TRUE(find({vec3(1)}, 24).ids[0].empty());
}

TEST(Neighbors, SameForOneAndTwoThreads) {
  // The grid has ties everywhere: which of them is taken must not depend on the threads either.
  for (const auto& positions : {sorted(square_grid(150, 1)), sorted(difficult_cloud())}) {
    Found alone;
    {
      tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      alone = find(positions, 24);
    }
    tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
    EXPECT_EQ(find(positions, 24).ids, alone.ids);
  }
}

TEST(Neighbors, StopsWhenTheUserWantsTo) {
  struct Stop final : Progress {
    void update(double, std::string_view) override {}
    bool cancelled() const override { return true; }
  } stop;
  const std::vector<vec3> positions = uniform_cube(1000);
  const NeighborTree tree(positions);
  EXPECT_THROW(for_each_neighborhood(
                   tree, 8, [](auto, auto, auto) {}, "neighbors", stop),
               Cancelled);
}

}  // namespace
