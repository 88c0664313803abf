// What counts as a surface, and what shrinks because it is none.
#include "analysis/support.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/attributes.h"
#include "clouds.h"
#include "reference/forest.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

/// Radii over what they are where nothing shrinks: 0.4 in clutter, 1 on surfaces.
std::vector<float> shrunk(const std::vector<vec3>& points) {
  PrepareOptions never;
  never.clutter_radius = 1;
  const PreparedCloud some = prepare(cloud_of(points), Attribute::radius, {});
  const PreparedCloud none = prepare(cloud_of(points), Attribute::radius, never);
  EXPECT_EQ(some.median_radius, none.median_radius)
      << "the limit of large radii must not follow the shrunken";
  std::vector<float> ratio(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    ratio[some.cloud.source_index[i]] = some.cloud.radii[i] / none.cloud.radii[i];
  return ratio;
}

double share_below(const std::vector<float>& values, float limit) {
  return double(std::count_if(values.begin(), values.end(), [&](float v) { return v < limit; })) /
         double(values.size());
}

/// Share of the places that no disc reaches: `owner` says which of them one may close, by where it came from.
/// Discs are drawn with 1.5 radii.
template <class May>
double open_share(const std::vector<vec3>& points, const std::vector<vec3>& places, const May& may) {
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  double open = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    bool closed = false;
    for (std::size_t i = 0; i < points.size() && !closed; ++i)
      closed = glm::distance(prepared.cloud.positions[i], places[k]) < 1.5f * prepared.cloud.radii[i] &&
               may(prepared.cloud.source_index[i], k);
    open += !closed;
  }
  return open / double(places.size());
}

/// Six faces of a box, spacing 1, with noise across them.
std::vector<vec3> noisy_box(float side, float noise) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> gauss(0, 1);
  std::vector<vec3> points;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < int(side * side); ++i) {
      vec3 p;
      p[face % 3] = noise * gauss(random) + (face > 2 ? side : 0);
      p[(face + 1) % 3] = side * unit(random), p[(face + 2) % 3] = side * unit(random);
      points.push_back(p);
    }
  return points;
}

TEST(Support, EdgesAndCornersKeepTheirSize) {
  // The smallest box has edges within reach of half its neighbourhoods. Discs beside an edge may end there,
  // but none may leave it open; with noise of 0.3 spacings, which is more than scanners have at usual
  // densities, 5 % may shrink, where faces are 20 spacings wide.
  const auto any = [](std::size_t, std::size_t) { return true; };
  const std::vector<vec3> box = noisy_box(20, 0);
  EXPECT_EQ(open_share(box, noisy_box(20, 0), any), 0) << "a point reaches itself";
  std::vector<vec3> places = box;  // others of the same faces
  for (vec3& p : places) std::swap(p.x, p.y);
  EXPECT_LT(open_share(box, places, any), 1e-3);
  EXPECT_LT(share_below(shrunk(box), 0.5f), 0.01);
  EXPECT_LT(share_below(shrunk(noisy_box(60, 0)), 0.5f), 0.003);
  EXPECT_LT(share_below(shrunk(noisy_box(20, 0.3f)), 0.9f), 0.05);
  EXPECT_LT(share_below(shrunk(noisy_box(60, 0.3f)), 0.9f), 0.01);
}

// How far discs reach beyond the last row, drawn 1.5 times as large (splats): of Eq. 20 by two spacings.
TEST(Support, DiscsEndAtTheBorderOfASheet) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const float shaken : {0.0f, 0.5f}) {
    std::vector<vec3> points;
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 80; ++x)
        points.push_back({float(x) + shaken * unit(random), float(y) + shaken * unit(random), 0});
    const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
    std::vector<float> beyond(60, 0.0f);  // along the border, from 10 on
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec3 p = prepared.cloud.positions[i] + vec3(prepared.cloud.origin);
      for (std::size_t k = 0; k < beyond.size(); ++k) {
        const float aside = p.x - float(10 + k), radius = 1.5f * prepared.cloud.radii[i];
        if (std::abs(aside) < radius)
          beyond[k] = std::max(beyond[k], std::sqrt(radius * radius - aside * aside) - p.y);
      }
    }
    std::sort(beyond.begin(), beyond.end());
    EXPECT_LT(beyond[30], 1) << shaken;
    EXPECT_LT(beyond[54], 1.8f) << shaken;
    EXPECT_GT(beyond[0], 0) << shaken << ": the last row is closed";
  }
}

TEST(Support, BesideAnEdgeTheNearestTellTheDirection) {
  // The plane of 24 neighbours turns 21 % of the points of a box 20 spacings wide by more than 20 degrees; 17
  // % where the nearest 8 are asked as well.
  const std::vector<vec3> points = noisy_box(20, 0);
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal, {});
  double turned = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t face = prepared.cloud.source_index[i] / 400;
    turned += std::abs(prepared.cloud.normals[i][int(face) % 3]) < std::cos(glm::radians(20.0f));
  }
  EXPECT_LT(turned / double(points.size()), 0.19);
}

TEST(Support, NoiseAboveTheSpacingIsStillASurface) {
  // 24 neighbours of such a point fill a ball; 192 of them lie in a layer a quarter as thick as wide, 1536 in
  // one of a tenth. Edges closer than those reach may shrink, as what is less than 20 spacings wide may, and
  // the 1.2 % beyond 2.5 deviations, which stand alone before all others.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> gauss(0, 1);
  for (float noise : {1.0f, 2.0f}) {
    std::vector<vec3> points(40'000);
    for (vec3& p : points) p = {200 * unit(random), 200 * unit(random), noise * gauss(random)};
    const std::vector<float> ratio = shrunk(points);
    std::vector<float> within;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(points[i].z) < 2.5f * noise) within.push_back(ratio[i]);
    EXPECT_LT(share_below(within, 0.8f), 0.02) << noise;
  }
}

TEST(Support, ThinSheetsKeepTheirSize) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0, 1);
  for (float gap : {1.0f, 1.5f, 2.0f, 2.5f, 3.0f, 5.0f, 10.0f})
    for (float side : {8.0f, 60.0f}) {
      std::vector<vec3> points;
      const std::size_t on_sheets = std::size_t(2 * side * side);
      for (std::size_t i = 0; i < on_sheets; ++i)
        points.push_back({side * unit(random), side * unit(random), float(i % 2) * gap});
      // Nearby, so that the sheets are not all there is.
      for (int i = 0; i < 4000; ++i) points.push_back({100 + 63 * unit(random), 63 * unit(random), 0});
      // None is perforated: discs of the same side close it, up to a spacing from its border.
      std::vector<vec3> places;
      for (int i = 0; i < 2000; ++i)
        places.push_back({1 + (side - 2) * unit(random), 1 + (side - 2) * unit(random), float(i % 2) * gap});
      EXPECT_LT(open_share(points, places,
                           [&](std::size_t point, std::size_t place) {
                             return point < on_sheets && point % 2 == place % 2;
                           }),
                4e-3)
          << "sheets " << gap << " spacings apart, " << side << " wide";
    }
}

/// `lines` rings of points `spacing` apart, `gap` from ring to ring.
std::vector<vec3> rings(int lines, float spacing, float gap) {
  std::vector<vec3> points;
  for (int ring = 0; ring < lines; ++ring) {
    const float r = 50 + gap * float(ring);
    for (int i = 0; i < int(2 * 3.14159f * r / spacing); ++i) {
      const float angle = float(i) * spacing / r;
      points.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
  }
  return points;
}

TEST(Support, LonelyLinesAreThinAndUnbroken) {
  // 24 neighbours on a line reach 12 spacings to either side: Eq. 20 makes that 4.9 spacings of plank. Half
  // of one touches, and discs are drawn 1.5 times as large.
  const std::vector<vec3> points = rings(10, 0.05f, 3);
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  const auto [least, most] = std::minmax_element(prepared.cloud.radii.begin(), prepared.cloud.radii.end());
  EXPECT_GT(*least, 0.95f * 0.05f);
  EXPECT_LT(*most, 1.1f * 0.05f);
  for (const float surface : prepared.on_surface)
    ASSERT_LT(surface, 0.1f) << "a dot, whatever its neighbours";
  const float smallest = *std::min_element(prepared.shrunk.begin(), prepared.shrunk.end());
  EXPECT_GE(smallest, 0.2f);
  EXPECT_LT(smallest, PrepareOptions().clutter_radius) << "a line is thinner than clutter";
}

TEST(Support, LinesOfASurfaceStillClose) {
  // Two or more lines within reach of 24 neighbours: discs 1.5 times as large must close the gap of up to 8
  // spacings.
  for (float gap : {0.1f, 0.2f, 0.4f}) {
    const std::vector<vec3> points = rings(20, 0.05f, gap);
    const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
    std::vector<float> radii = prepared.cloud.radii;
    std::sort(radii.begin(), radii.end());
    EXPECT_GT(1.5f * radii[radii.size() / 20], 0.5f * gap) << gap;
  }
}

TEST(Support, WiresAboveAFieldAreDotsAndASparseRoofIsClosed) {
  // Six wires, three field spacings apart, with a point every three: flat, sparse, and much too few to be a
  // surface beside the field. A roof of thousands of points is one, six times as sparse as what lies below
  // it.
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<vec3> field(40'000);
  for (vec3& p : field) p = {200 * unit(random), 200 * unit(random), 0};
  const auto radii_of = [&](int lines, int along, float spacing) {
    std::vector<vec3> points = field;
    for (int line = 0; line < lines; ++line)
      for (int i = 0; i < along; ++i)
        points.push_back({20 + spacing * (float(i) + 0.6f * unit(random)),
                          20 + spacing * float(line) + 0.6f * unit(random), 15});
    const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
    std::vector<float> above;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (prepared.cloud.source_index[i] >= field.size())
        above.push_back(prepared.on_surface[i] * prepared.cloud.radii[i] / prepared.median_radius);
    std::sort(above.begin(), above.end());
    return std::array{above[above.size() / 10], above.back()};
  };
  EXPECT_LE(radii_of(6, 25, 3)[1], 0.6f);
  // 1.13 spacings of 2.5, with noise: one in fifteen ends at its border.
  EXPECT_GT(radii_of(60, 60, 2.5f)[0], 2.2f);
}

TEST(Support, FoliageShrinksAndTheGroundDoesNot) {
  for (double density : {8.0, 30.0}) {
    const sfumato::testing::Forest forest(density);
    const std::vector<float> ratio = shrunk(forest.cloud.positions);
    double ground = 0, ground_small = 0, leaves = 0, leaves_sum = 0, leaves_large = 0;
    vec3 low(1e9f), high(-1e9f);
    for (const vec3& p : forest.cloud.positions) low = glm::min(low, p), high = glm::max(high, p);
    const float margin = 0.02f * (high.x - low.x);  // where the ground ends its discs do
    for (std::size_t i = 0; i < ratio.size(); ++i) {
      if (forest.on_leaf[i])
        ++leaves, leaves_sum += ratio[i], leaves_large += ratio[i] > 0.6f;
      else if (const vec3 p = forest.cloud.positions[i];
               std::min({p.x - low.x, p.y - low.y, high.x - p.x, high.y - p.y}) > margin)
        ++ground, ground_small += ratio[i] < 0.9f;
    }
    EXPECT_LT(leaves_sum / leaves, 0.55) << density;  // 0.4 if all were recognised
    // One in five is flat by chance; each that stays large is a boulder of 25 leaves.
    EXPECT_LT(leaves_large / leaves, 0.07) << density;
    EXPECT_LT(ground_small / ground, 0.01) << density;
  }
}

TEST(Support, FewFlatPointsWithinACrownAreABranch) {
  // A hollow crown over land. What a scanner saw in the hollow are 400 points that happen to lie in a plane,
  // farther apart than leaves. The land has points as far apart, and discs that close it.
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<vec3> points;
  while (points.size() < 60'000) {
    const vec3 p = 10.0f * vec3(unit(random), unit(random), unit(random));
    if (glm::length(p) > 5.7f && glm::length(p) < 10) points.push_back(p);
  }
  const std::size_t leaves = points.size();
  for (int i = 0; i < 400; ++i) points.push_back({4 * unit(random), 4 * unit(random), 0});
  const std::size_t branches = points.size();
  for (int i = 0; i < 8000; ++i) points.push_back({16 * unit(random), 16 * unit(random), -20});
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  std::vector<float> land, branch;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t source = prepared.cloud.source_index[i];
    const float radius = prepared.cloud.radii[i] / prepared.median_radius;
    if (source >= branches)
      land.push_back(radius);
    else if (source >= leaves)
      branch.push_back(prepared.on_surface[i] * radius);
  }
  std::sort(branch.begin(), branch.end());
  EXPECT_LT(branch[branch.size() * 9 / 10], 0.6f);  // two medians and more by Eq. 20
  std::sort(land.begin(), land.end());
  // Of 8000 points on 32 x 32: 2 / sqrt(24) sqrt(24 / (7.8 pi)) = 0.4 scene units, less at the border.
  EXPECT_GT(land[land.size() / 20] * prepared.median_radius, 0.3f);
}

TEST(Support, StraysAreNoDiscs) {
  // 200 stray points over a plane of 40,000: each is many spacings from anything.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<vec3> points(40'200);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {200 * unit(random), 200 * unit(random), i < 200 ? 20 + 100 * unit(random) : 0};
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  std::size_t large = 0, small_on_plane = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool stray = prepared.cloud.source_index[i] < 200;
    large += stray && prepared.on_surface[i] * prepared.cloud.radii[i] > prepared.median_radius;
    small_on_plane += !stray && prepared.cloud.radii[i] < 0.4f * prepared.median_radius;
  }
  EXPECT_LT(large, 30u) << "of 200";
  EXPECT_LT(small_on_plane, 80u) << "of 40,000, of which 800 are at its border";
}

// Photogrammetry's strays: 100 points and 40 groups of three, 3 spacings before a wall of 10,000, which does
// not vouch for what is no part of it: told by their region alone, 45 and 46 points are discs. Of the wall
// 9,614 are without strays; the others are at its border.
TEST(Support, WhatIsAloneBeforeAWallIsNoPartOfIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<vec3> points(10'220);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {100 * unit(random), 100 * unit(random), 0};
  for (std::size_t i = 0; i < 100; ++i) points[i].z = 3;
  for (std::size_t i = 100; i < 220; ++i)
    points[i] = i % 3 == 1 ? vec3(points[i].x, points[i].y, 3) : points[i - 1] + vec3(0.5f, 0.2f, 0);
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::radius, {});
  double alone = 0, grouped = 0, on_wall = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t own = prepared.cloud.source_index[i];
    const bool is_disc =
        prepared.on_surface[i] > 0.5f && prepared.cloud.radii[i] > 0.7f * prepared.median_radius;
    (own < 100 ? alone : own < 220 ? grouped : on_wall) += is_disc;
  }
  EXPECT_LT(alone, 10) << "of 100";
  EXPECT_LT(grouped, 20) << "of 120";
  EXPECT_GT(on_wall, 9'590) << "of 10,000";
}

TEST(Support, WhatFileBroughtIsKept) {
  PointCloud cloud = cloud_of(uniform_cube(5000));
  cloud.radii.assign(cloud.size(), 0.01f);
  for (float r : prepare(cloud, Attribute::radius, {}).cloud.radii) EXPECT_EQ(r, 0.01f);
}

// A viewer asks for one technique after the other, the command for one: both must show the same.
TEST(Support, UncertaintyIsTheSameWhoeverAsksFirst) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<vec3> points;
  for (int i = 0; i < 6000; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  constexpr Attributes shape = Attribute::normal | Attribute::radius;
  const PreparedCloud at_once = prepare(cloud_of(points), shape | Attribute::uncertainty, {});
  PreparedCloud later = prepare(cloud_of(points), shape, {});
  ASSERT_FALSE(later.shrunk.empty());
  complete(later, Attribute::uncertainty, {});
  EXPECT_EQ(later.cloud.radii, at_once.cloud.radii);
  EXPECT_EQ(later.cloud.scalar("uncertainty")->values, at_once.cloud.scalar("uncertainty")->values);
}

// Radii that were there before others were found have other sizes than those of their neighbours' distances.
TEST(Support, UncertaintyOfRadiiThatWereThereIsTheSameWhoeverAsksFirst) {
  PointCloud cloud = cloud_of(uniform_cube(6000));
  cloud.radii.assign(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.radii[i] = 0.2f + 1e-5f * float(i);
  constexpr Attributes shape = Attribute::normal | Attribute::radius;
  const PreparedCloud at_once = prepare(cloud, shape | Attribute::uncertainty, {});
  PreparedCloud later = prepare(cloud, shape, {});
  ASSERT_FALSE(later.shrunk.empty());
  complete(later, Attribute::uncertainty, {});
  EXPECT_EQ(later.cloud.radii, at_once.cloud.radii);
  EXPECT_EQ(later.cloud.scalar("uncertainty")->values, at_once.cloud.scalar("uncertainty")->values);
}

TEST(Support, OnlyFlatPlacesHaveLargeDiscs) {
  // Dense ground, and above it a box with a tenth of its points per area, whose discs are three times as
  // large: within a face they close it, across an edge they would stand out.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<vec3> points;
  for (int i = 0; i < 40'000; ++i) points.push_back({20 * uniform(random), 20 * uniform(random), 0});
  for (int i = 0; i < 2'160; ++i) {
    vec3 p(6 * uniform(random), 6 * uniform(random), 6 * uniform(random));
    p[i % 3] = i % 2 ? 6.0f : 0.0f;
    points.push_back(p + vec3(7, 7, 3));
  }
  const PreparedCloud prepared = prepare(cloud_of(points), Attribute::normal | Attribute::radius, {});
  int edge = 0, edge_large = 0, face = 0, face_large = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (prepared.cloud.source_index[i] < 40'000) continue;
    vec3 to_side;  // the second smallest is the way to an edge
    for (int k = 0; k < 3; ++k) {
      const float at =
          prepared.cloud.positions[i][k] + float(prepared.cloud.origin[k]) - (k == 2 ? 3.0f : 7.0f);
      to_side[k] = std::min(std::abs(at), std::abs(6 - at));
    }
    std::sort(&to_side.x, &to_side.x + 3);
    const float medians = prepared.cloud.radii[i] / prepared.median_radius;
    if (to_side.y < 0.15f) ++edge, edge_large += medians > 1.51f;
    if (to_side.y > 1.5f) ++face, face_large += medians > 2;
  }
  ASSERT_GT(edge, 100);
  ASSERT_GT(face, 300);
  EXPECT_LT(edge_large, 0.1 * edge);
  EXPECT_GT(face_large, 0.9 * face);
}

TEST(Support, TooFewPointsAreNoClutter) {
  EXPECT_EQ(share_below(shrunk(uniform_cube(150)), 0.999f), 0);
  EXPECT_GT(share_below(shrunk(uniform_cube(5000)), 0.51f), 0.95);
}

}  // namespace
