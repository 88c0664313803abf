#include "analysis/prepare.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/morton.h"
#include "analysis/spacing.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

PreparedCloud prepared(const std::vector<vec3>& positions) { return prepare(cloud_of(positions), {}, {}); }

TEST(Spacing, SquareGrid) {
  // Inside the grid the 8th neighbour is a diagonal one at sqrt(2) h: sqrt(2 pi / 8) h = 0.8862 h. The border
  // is less than half of the points, so the median does not see it.
  const float h = 0.37f;
  EXPECT_NEAR(prepared(square_grid(60, h)).median_spacing, 0.886227f * h, 1e-5f * h);
}

TEST(Spacing, RandomUniformPlane) {
  // With density D, D pi R_8^2 is Gamma(8) distributed: its median 7.669 makes sqrt(7.669 / 8) = 0.979 of the
  // side of the square per point, D^-1/2. Each of 20,000 samples scatters by 1 / (2 sqrt(8)) = 18 %, the
  // median of dependent samples by under 0.5 %; 2 % is room for the border too.
  const std::size_t n = 40'000;
  EXPECT_NEAR(prepared(uniform_square(n)).median_spacing * std::sqrt(float(n)), 0.979f, 0.02f);
}

TEST(Spacing, ScalesWithTheCloud) {
  const std::vector<vec3> positions = uniform_square(5000);
  const float spacing = prepared(positions).median_spacing;
  for (float scale : {1e-6f, 0.125f, 1000.0f, 1e6f}) {
    std::vector<vec3> scaled = positions;
    for (vec3& p : scaled) p *= scale;
    EXPECT_NEAR(prepared(scaled).median_spacing / (scale * spacing), 1, 1e-5) << scale;  // float rounding
  }
}

TEST(Spacing, CoincidentPointsCountOnce) {
  const std::vector<vec3> grid = square_grid(40, 1);
  std::vector<vec3> tripled = grid;
  tripled.insert(tripled.end(), grid.begin(), grid.end());
  tripled.insert(tripled.end(), grid.begin(), grid.end());
  tripled.insert(tripled.end(), 500, vec3(7, 7, 0));
  EXPECT_FLOAT_EQ(prepared(tripled).median_spacing, prepared(grid).median_spacing);
}

TEST(Spacing, CloudsOfManyDoublePointsAreMeasured) {
  for (const int copies : {2, 20, 64}) {
    std::vector<vec3> positions;
    for (const vec3& p : square_grid(120, 1))
      for (int i = 0; i < copies; ++i) positions.push_back(p);
    EXPECT_NEAR(prepared(positions).median_spacing, 0.886227f, 1e-4f) << copies;  // as without the copies
  }
}

TEST(Spacing, ManyCoincidentPointsAreQuick) {
  // Without merging boxes, each of 10,000 queries would walk through 200,000 points: minutes.
  std::vector<vec3> positions = uniform_cube(20'000);
  positions.insert(positions.end(), 200'000, vec3(0.5f));
  const float spacing = prepared(positions).median_spacing;
  EXPECT_GT(spacing, 0.01f);  // 20,000 points in a cube: the 8th neighbour is 0.046 away, spacing 0.029
  EXPECT_LT(spacing, 0.05f);
}

TEST(Spacing, TinyCloudsHaveOneToo) {
  // m places: R_(m-1) sqrt(pi / (m - 1)); a single place: 1.
  EXPECT_EQ(prepared({}).median_spacing, 1);
  EXPECT_EQ(prepared({vec3(5)}).median_spacing, 1);
  EXPECT_EQ(prepared(std::vector<vec3>(100, vec3(5))).median_spacing, 1);
  EXPECT_NEAR(prepared({vec3(0), vec3(2, 0, 0)}).median_spacing, 2 * 1.7724539f, 1e-5);
  EXPECT_NEAR(prepared({vec3(0), vec3(2, 0, 0), vec3(2, 0, 0)}).median_spacing, 2 * 1.7724539f, 1e-5);
}

TEST(Prepare, BatchesCoverAllPointsOnce) {
  const PreparedCloud cloud = prepared(uniform_cube(50'001));
  ASSERT_EQ(cloud.batches.size(), 98u);  // 512 points each
  std::uint32_t next = 0;
  for (const Batch& batch : cloud.batches) {
    EXPECT_EQ(batch.first, next);
    EXPECT_NEAR(batch.count, 510, 1);
    next += batch.count;
    vec3 low = cloud.cloud.positions[batch.first], high = low;
    for (std::uint32_t i = batch.first; i < next; ++i) {
      low = glm::min(low, cloud.cloud.positions[i]);
      high = glm::max(high, cloud.cloud.positions[i]);
    }
    EXPECT_EQ(batch.box_min, low);
    EXPECT_EQ(batch.box_max, high);
  }
  EXPECT_EQ(next, 50'001u);
}

TEST(Prepare, BatchesKnowTheirOwnSpacing) {
  // Two grids of 160 x 160, one ten times finer, far apart: most batches lie within one of them.
  std::vector<vec3> positions = square_grid(160, 1);
  for (const vec3& p : square_grid(160, 0.1f)) positions.push_back(p + vec3(1000, 0, 0));
  const PreparedCloud cloud = prepared(positions);
  std::size_t pure = 0;
  for (const Batch& batch : cloud.batches) {
    EXPECT_GT(batch.spacing, 0);
    const bool coarse = batch.box_max.x<500, fine = batch.box_min.x> 500;
    if (!coarse && !fine) continue;
    const float h = coarse ? 1 : 0.1f;
    EXPECT_NEAR(batch.spacing, 0.886227f * h, 1e-3f * h);  // coordinates of 1000 are rounded to 6e-5
    ++pure;
  }
  EXPECT_GE(pure, 4u);
}

/// A plane as scanned from one place: the density falls with 1 / distance^2, and the spacing is `h` times the
/// distance.
std::vector<vec3> plane_around_a_scanner(double h) {
  std::vector<vec3> positions;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  // Equal numbers at each ln(distance): in a ring there are 2 pi d dd / (h d)^2 points.
  const double nearest = 2, farthest = 40;
  const auto count = std::size_t(2 * std::numbers::pi * std::log(farthest / nearest) / (h * h));
  for (std::size_t i = 0; i < count; ++i) {
    const double d = nearest * std::pow(farthest / nearest, unit(random)),
                 angle = 2 * std::numbers::pi * unit(random);
    positions.emplace_back(float(d * std::cos(angle)), float(d * std::sin(angle)), 0.0f);
  }
  return positions;
}

// One spacing for each batch is wrong by as much as the density changes over half of its width.
TEST(Prepare, SpacingFollowsTheDensityWithinABatch) {
  const double h = 0.02;
  const PreparedCloud cloud = prepared(plane_around_a_scanner(h));
  double worst_of_one = 0;
  std::vector<double> errors;  // of the logarithm to base 2
  for (const Batch& batch : cloud.batches)
    for (std::uint32_t i = batch.first; i < batch.first + batch.count; i += 16) {
      const vec3& at = cloud.cloud.positions[i];
      const double truth = std::log2(h * glm::length(glm::dvec3(at)));
      errors.push_back(std::abs(std::log2(batch.spacing_at(at)) - truth));
      worst_of_one = std::max(worst_of_one, std::abs(std::log2(double(batch.spacing)) - truth));
    }
  std::sort(errors.begin(), errors.end());
  // 16 samples of a deviation of 0.26 leave 0.26 / 4 at the middle of a batch and twice that at its corners,
  // and the logarithm's mean is (psi(8) - ln 8) / (2 ln 2) = -0.05: 99 % are within a third, where one number
  // is off by more than a half somewhere.
  EXPECT_GT(worst_of_one, 0.5);
  EXPECT_LT(errors[errors.size() / 2], 0.13);
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.35);
}

// Sizes on the screen follow the spacing, so that a step of it where batches meet is an edge in the picture.
TEST(Prepare, SpacingHardlyJumpsWhereBatchesMeet) {
  const PreparedCloud cloud = prepared(plane_around_a_scanner(0.02));
  const std::vector<vec3>& at = cloud.cloud.positions;
  std::vector<double> steps, steps_of_one;
  for (const Batch& batch : cloud.batches)
    for (std::uint32_t i = batch.first; i < batch.first + batch.count; i += 16)
      for (const Batch& other : cloud.batches) {
        if (&other == &batch) continue;
        const float near = batch.spacing_at(at[i]);
        const vec3 low = other.box_min - near, high = other.box_max + near;
        if (glm::any(glm::lessThan(at[i], low)) || glm::any(glm::greaterThan(at[i], high))) continue;
        for (std::uint32_t j = other.first; j < other.first + other.count; ++j)
          if (glm::distance(at[i], at[j]) < near) {
            steps.push_back(std::abs(std::log2(near / other.spacing_at(at[j]))));
            steps_of_one.push_back(std::abs(std::log2(batch.spacing / other.spacing)));
            break;
          }
      }
  ASSERT_GT(steps.size(), 300u);
  std::sort(steps.begin(), steps.end());
  std::sort(steps_of_one.begin(), steps_of_one.end());
  // Two planes of a deviation of 0.13 each at their rims differ by 0.12 in the middle of all cases and by 0.3
  // in one of ten, a fifth in size; medians differ by what the density does from batch to batch.
  EXPECT_LT(steps[steps.size() / 2], 0.12);
  EXPECT_LT(steps[steps.size() * 9 / 10], 0.3);
  EXPECT_GT(steps_of_one[steps_of_one.size() * 9 / 10], 0.5);
}

TEST(Prepare, EmptyAndOnePoint) {
  const PreparedCloud nothing = prepared({});
  EXPECT_TRUE(nothing.batches.empty());
  const PreparedCloud one = prepared({vec3(1, 2, 3)});
  ASSERT_EQ(one.batches.size(), 1u);
  EXPECT_EQ(one.batches[0].count, 1u);
  EXPECT_EQ(one.batches[0].box_min, vec3(1, 2, 3));
  EXPECT_EQ(one.batches[0].spacing, 1);
  EXPECT_EQ(one.cloud.source_index, std::vector<std::uint32_t>{0});
}

TEST(Prepare, SameForOneAndTwoThreads) {
  PreparedCloud alone;
  {
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    alone = prepared(difficult_cloud());
  }
  tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  const PreparedCloud both = prepared(difficult_cloud());
  EXPECT_EQ(both.cloud.source_index, alone.cloud.source_index);
  EXPECT_EQ(both.median_spacing, alone.median_spacing);
  ASSERT_EQ(both.batches.size(), alone.batches.size());
  for (std::size_t i = 0; i < alone.batches.size(); ++i)
    EXPECT_EQ(both.batches[i].spacing, alone.batches[i].spacing);
}

}  // namespace
