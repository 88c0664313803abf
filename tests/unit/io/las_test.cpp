// LAS, LAZ and COPC: the real scans against truth.json, every point format from hand-made bytes, damage,
// round trips.
#include <gtest/gtest.h>

#include "io/io.h"
#include "unit/io/truth.h"

using namespace sfumato;

namespace {

// Coordinates are origin + float: half a float step of the larger scans (5 km) stays below a millimetre, and
// scans are in steps of 0.01.
constexpr double position_tolerance = 5e-4;

std::string test_name(const testing::TestParamInfo<const char*>& scan) {
  std::string name = scan.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '.' || c == '-'; }, '_');
  return name;
}

class LasRealScan : public testing::TestWithParam<const char*> {};

TEST_P(LasRealScan, EqualsTheTruth) {
  SFUMATO_NEEDS_REAL_SCAN(GetParam());
  const io::ReadResult result = io::read(test::data_folder() / GetParam());
  test::expect_truth(GetParam(), result, position_tolerance);
}

INSTANTIATE_TEST_SUITE_P(Las, LasRealScan,
                         testing::Values("autzen_trim.las", "lion_takanawa.copc.laz", "bcts_3.laz",
                                         "indoor.laz", "las_with_several_extra_byte_bloc.laz",
                                         "autzen_full.laz"),
                         test_name);

// Reading, writing and reading again gives the same cloud, bit for bit.
void expect_same(const io::ReadResult& a, const io::ReadResult& b) {
  ASSERT_EQ(a.cloud.size(), b.cloud.size());
  EXPECT_EQ(a.cloud.origin, b.cloud.origin);
  EXPECT_TRUE(a.cloud.positions == b.cloud.positions);
  EXPECT_TRUE(a.cloud.colors == b.cloud.colors);
  EXPECT_TRUE(a.cloud.normals == b.cloud.normals);
  EXPECT_TRUE(a.cloud.radii == b.cloud.radii);
  EXPECT_EQ(a.report.crs, b.report.crs);
  EXPECT_EQ(a.report.bounds_min, b.report.bounds_min);
  EXPECT_EQ(a.report.bounds_max, b.report.bounds_max);
  EXPECT_EQ(a.cloud.las->scale, b.cloud.las->scale);
  EXPECT_EQ(a.cloud.las->offset, b.cloud.las->offset);
  EXPECT_EQ(a.cloud.las->point_format, b.cloud.las->point_format);
  ASSERT_EQ(a.cloud.scalars.size(), b.cloud.scalars.size());
  for (std::size_t i = 0; i < a.cloud.scalars.size(); ++i) {
    EXPECT_EQ(a.cloud.scalars[i].name, b.cloud.scalars[i].name);
    EXPECT_EQ(a.cloud.scalars[i].offset, b.cloud.scalars[i].offset) << a.cloud.scalars[i].name;
    EXPECT_TRUE(a.cloud.scalars[i].values == b.cloud.scalars[i].values) << a.cloud.scalars[i].name;
  }
  ASSERT_EQ(a.report.attributes.size(), b.report.attributes.size());
  for (std::size_t i = 0; i < a.report.attributes.size(); ++i) {
    EXPECT_EQ(a.report.attributes[i].name, b.report.attributes[i].name);
    EXPECT_EQ(a.report.attributes[i].min, b.report.attributes[i].min) << a.report.attributes[i].name;
    EXPECT_EQ(a.report.attributes[i].max, b.report.attributes[i].max) << a.report.attributes[i].name;
  }
}

class LasRoundTrip : public testing::TestWithParam<const char*> {};

TEST_P(LasRoundTrip, KeepsEveryBit) {
  SFUMATO_NEEDS_REAL_SCAN(GetParam());
  const io::ReadResult original = io::read(test::data_folder() / GetParam());
  for (const char* extension : {".las", ".laz"}) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / (std::string("sfumato_round_") + GetParam() + extension);
    io::write(file, original.cloud);
    expect_same(original, io::read(file));
    // Nothing that the cloud does not hold was lost either: the attributes' means are still the truth's.
    test::expect_truth(GetParam(), io::read(file), position_tolerance);
    std::filesystem::remove(file);
  }
}

INSTANTIATE_TEST_SUITE_P(Las, LasRoundTrip,
                         testing::Values("autzen_trim.las", "lion_takanawa.copc.laz",
                                         "las_with_several_extra_byte_bloc.laz"),
                         test_name);

}  // namespace
