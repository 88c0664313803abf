#include "core/point_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace sfumato;

namespace {

PointCloud line(std::size_t n, dvec3 origin) {
  PointCloud cloud;
  cloud.origin = origin;
  ScalarField order{"order", 1e9, {}, StoredType::float64};
  for (std::size_t i = 0; i < n; ++i) {
    cloud.positions.push_back(vec3(float(i), 0, 0));
    order.values.push_back(float(i));
  }
  cloud.set_scalar(std::move(order));
  return cloud;
}

TEST(PointCloud, AppendMovesToOneOriginAndFillsWhatIsMissing) {
  PointCloud a = line(3, {1e6, 0, 0});
  PointCloud b = line(2, {1e6 + 10, 0, 0});
  b.colors.assign(2, Rgba8{1, 2, 3, 255});
  b.set_scalar({"extra", 0, {5, 6}});
  append(a, b);
  ASSERT_EQ(a.size(), 5u);
  EXPECT_EQ(a.world(4).x, 1e6 + 11);
  EXPECT_EQ(a.colors.size(), 5u);
  EXPECT_EQ(a.colors[0], no_color);
  EXPECT_EQ(a.scalar("order")->value(4), 1e9 + 1);
  EXPECT_TRUE(std::isnan(a.scalar("extra")->value(0)));
  EXPECT_EQ(a.scalar("extra")->value(4), 6);
}

TEST(PointCloud, AppendToNothingTakesItsOrigin) {
  PointCloud nothing = select(line(3, {0, 0, 0}), {});
  nothing.set_scalar({"extra", 0, {}, StoredType::float32});  // a tile of which no node is in view
  const PointCloud tile = line(3, {5e6, 5e6, 0});
  append(nothing, tile);
  EXPECT_EQ(nothing.origin, tile.origin);
  EXPECT_EQ(nothing.world(2), tile.world(2));
}

TEST(PointCloud, AppendTellsScannersApart) {
  PointCloud one = line(2, {0, 0, 0}), another = line(1, {0, 0, 0}), several = line(2, {0, 0, 0});
  one.scanners = {{1, 0, 0}};
  another.scanners = {{2, 0, 0}};
  several.scanners = {{3, 0, 0}, {4, 0, 0}};
  several.set_scalar({"scanner", 0, {1, 0}});
  append(one, another);
  append(one, several);
  append(one, line(1, {0, 0, 0}));
  ASSERT_EQ(one.scanners.size(), 4u);
  const ScalarField* scanner = one.scalar("scanner");
  ASSERT_TRUE(scanner);
  const double expected[] = {0, 0, 1, 3, 2};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(scanner->value(i), expected[i]) << i;
  EXPECT_TRUE(std::isnan(scanner->value(5))) << "seen by none of them";

  PointCloud unknown = line(1, {0, 0, 0});
  append(unknown, another);
  EXPECT_TRUE(std::isnan(unknown.scalar("scanner")->value(0)));
  EXPECT_EQ(unknown.scalar("scanner")->value(1), 0);
}

// A column `scanner` of a table says which scanner it was, and not where that stood: its numbers stay, and
// come to name none of the scanners of other files, in whatever order the files are put together.
TEST(PointCloud, AppendLeavesNumbersOfScannersWithoutPlaces) {
  PointCloud table = line(3, {0, 0, 0}), longer = line(2, {0, 0, 0}), one = line(1, {0, 0, 0}),
             two = line(2, {0, 0, 0}), lost = line(1, {0, 0, 0});
  lost.scanners = {dvec3(std::numeric_limits<double>::quiet_NaN())};
  table.set_scalar({"scanner", 0, {0, 2, 1e6f}});
  longer.set_scalar({"scanner", 3, {1, 0}});
  one.scanners = {{1, 0, 0}};
  two.scanners = {{2, 0, 0}, {3, 0, 0}};
  two.set_scalar({"scanner", 0, {1, 0}});
  // By file: its numbers, and where the scanners of its points stood; 0: unknown.
  struct File {
    const PointCloud* cloud;
    std::vector<double> numbers, places;
  };
  const File files[] = {{&table, {0, 2, 1e6}, {0, 0, 0}},
                        {&longer, {4, 3}, {0, 0}},
                        {&one, {}, {1}},
                        {&two, {}, {3, 2}},
                        {&lost, {}, {0}}};
  std::vector<int> order{0, 1, 2, 3, 4};
  do {
    PointCloud all;
    for (int i : order) append(all, *files[i].cloud);
    const ScalarField* scanner = all.scalar("scanner");
    ASSERT_TRUE(scanner);
    ASSERT_EQ(scanner->values.size(), 9u);
    std::size_t at = 0;
    for (int i : order)
      for (std::size_t k = 0; k < files[i].places.size(); ++k, ++at) {
        SCOPED_TRACE(::testing::PrintToString(order) + " file " + std::to_string(i));
        const double number = scanner->value(at);
        if (!files[i].numbers.empty()) EXPECT_EQ(number, files[i].numbers[k]);
        const bool is_known =
            number < double(all.scanners.size()) && !std::isnan(all.scanners[std::size_t(number)].x);
        EXPECT_EQ(is_known ? all.scanners[std::size_t(number)].x : 0, files[i].places[k]);
      }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(PointCloud, SubsampleIsDeterministicAndKeepsSourceIndex) {
  PointCloud cloud = line(1000, {0, 0, 0});
  cloud.provenance = Provenance::model;
  const PointCloud a = subsample(cloud, 100), b = subsample(cloud, 100);
  ASSERT_EQ(a.size(), 100u);
  EXPECT_EQ(a.source_index, b.source_index);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a.positions[i].x, float(a.source_index[i]));
  EXPECT_TRUE(std::is_sorted(a.source_index.begin(), a.source_index.end()));
  EXPECT_EQ(a.provenance, Provenance::model);
  EXPECT_EQ(subsample(cloud, 5000).size(), 1000u);
}

TEST(Bounds, CornersAreCountedByTheBitsOfTheirIndex) {
  const std::array<dvec3, 8> corners = Bounds{dvec3(0), {1, 2, 4}}.corners();
  for (unsigned i = 0; i < 8; ++i) EXPECT_EQ(corners[i], dvec3(i & 1, i & 2, i & 4));
}

TEST(PointCloud, RobustBoundsIgnoreAFewStrayPoints) {
  PointCloud cloud = line(1000, {0, 0, 0});
  cloud.positions[7] = vec3(1e6f, 1e6f, 1e6f);
  EXPECT_LT(robust_bounds(cloud).max.x, 1000);
  EXPECT_EQ(bounds(cloud).max.x, 1e6);
}

TEST(PointCloud, TransformTurnsWhatHasADirectionAndKeepsWhatHasNone) {
  PointCloud cloud = line(3, {6e6, 5e5, 10});
  cloud.normals.assign(3, vec3(0, 0, 1));
  cloud.radii.assign(3, 0.5f);
  cloud.las = LasScaling{dvec3(0.01), dvec3(6e6, 5e5, 0), false, false, 3, 1, {}};
  cloud.up = UpAxis::pos_y;
  // x to y to z to x, twice as large, and moved.
  transform(cloud, dmat4({0, 2, 0, 0}, {0, 0, 2, 0}, {2, 0, 0, 0}, {0.25, 0.5, 1e6, 1}));
  EXPECT_EQ(cloud.world(2), dvec3(20.25, 2 * (6e6 + 2) + 0.5, 2e6));
  EXPECT_EQ(cloud.normals[0], vec3(1, 0, 0));
  EXPECT_EQ(cloud.radii[0], 1);
  EXPECT_EQ(cloud.scalar("order")->value(2), 1e9 + 2);
  EXPECT_EQ(cloud.up, UpAxis::pos_z);
  ASSERT_TRUE(cloud.las);
  EXPECT_EQ(cloud.las->point_format, 3);
  EXPECT_EQ(cloud.las->time_and_returns, 1);
  EXPECT_EQ(cloud.las->scale, dvec3(0)) << "the old steps are not those of the new places";
}

}  // namespace
