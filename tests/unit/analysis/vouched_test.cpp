// Cells among neighbours, in the plane.
#include "analysis/vouched.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

VoronoiCell cell_of_first(const std::vector<vec3>& points) {
  std::vector<std::uint32_t> others(points.size() - 1);
  std::iota(others.begin(), others.end(), 1u);
  const auto frame = local_frame(points, 0, others);
  return cell_of(points, 0, others, *frame, vec3(0, 0, 1));
}

/// 1.7 spacings: of all, or of the nearest eight.
float limit_of(const std::vector<vec3>& points) {
  dvec3 mean(0);
  double xx = 0, xy = 0, yy = 0;
  for (const vec3& p : points) mean += dvec3(p) / double(points.size());
  for (const vec3& p : points) {
    const dvec3 d = dvec3(p) - mean;
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
  }
  const double deviations = std::sqrt(xx * yy - xy * xy) / double(points.size());
  std::vector<float> distances;
  for (std::size_t i = 1; i < points.size(); ++i) distances.push_back(glm::length(points[i]));
  std::nth_element(distances.begin(), distances.begin() + 7, distances.end());
  return 1.7f * std::min(distances[7] * std::sqrt(float(M_PI) / 8),
                         float(std::sqrt(4 * M_PI * deviations / double(points.size()))));
}

/// Directions in which no place of the circle is nearer to another point, as a share.
double open_share(const std::vector<vec3>& points, float radius) {
  constexpr int turns = 3600;
  int open = 0;
  for (int turn = 0; turn < turns; ++turn) {
    const double angle = 2 * M_PI * turn / turns;
    const vec3 at(radius * std::cos(angle), radius * std::sin(angle), 0);
    bool is_own = true;
    for (const vec3& other : points) is_own = is_own && glm::distance(at, other) >= radius * 0.9999f;
    open += is_own;
  }
  return double(open) / turns;
}

}  // namespace

TEST(Cells, AreClosedWhereAllPlacesAroundAreNearerToOthers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-1, 1);
  int closed = 0, open = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<vec3> points{vec3(0)};
    const bool at_border = round % 2 == 0;
    while (points.size() < 25) {
      const vec3 p(at_border ? std::abs(place(random)) : place(random), place(random), 0);
      points.push_back(p);
    }
    const VoronoiCell cell = cell_of_first(points);
    const double share = open_share(points, limit_of(points));
    if (cell.closed == 1) {
      ++closed;
      EXPECT_LT(share, 0.002) << round;
      EXPECT_EQ(cell.widest_angle, 0);
    } else {
      ++open;
      EXPECT_NEAR(1 - cell.closed, share, 0.15) << round;  // a polygon around the circle
    }
    EXPECT_TRUE(cell.is_measured());
  }
  EXPECT_GT(closed, 500);
  EXPECT_GT(open, 500);
}
