// LAS and LAZ of more points than memory holds: refused in one line, or thinned while they are read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/subsample.h"
#include "io/io.h"
#include "unit/io/las_bytes.h"

using namespace sfumato;

namespace {

PointCloud cloud_of(int points, int format) {
  PointCloud cloud;
  cloud.las.emplace();
  cloud.las->scale = dvec3(0.01);
  cloud.las->point_format = format;
  ScalarField time{"gps_time", 1000, {}, StoredType::float64};
  for (int i = 0; i < points; ++i) {
    cloud.positions.push_back({float(i % 1000), float(i / 1000), float(i % 7)});
    cloud.colors.push_back({std::uint8_t(i), std::uint8_t(i >> 8), 9, 255});
    time.values.push_back(float(i) * 0.125f);
  }
  cloud.scalars = {time};
  return cloud;
}

class LasMemory : public testing::TestWithParam<std::pair<const char*, int>> {
 protected:
  void TearDown() override { unsetenv("SFUMATO_MEMORY"); }
};

TEST_P(LasMemory, IsNotExceeded) {
  const auto [extension, format] = GetParam();
  const auto file = test::temporary(std::string("many") + extension);
  io::write(file, cloud_of(200'000, format));
  const PointCloud whole = io::read(file).cloud;
  setenv("SFUMATO_MEMORY", "4000000", 1);
  try {
    io::read(file);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::out_of_memory);
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("200000 points take about"),
                               testing::HasSubstr("sfumato build"), testing::HasSubstr("--max-points")));
  }
  io::ReadOptions options;
  options.max_points = 7'001;
  const io::ReadResult thinned = io::read(file, options);
  unsetenv("SFUMATO_MEMORY");
  // The points that a subsample of the whole cloud takes.
  const PointCloud expected = subsample(whole, 7'001);
  EXPECT_EQ(thinned.report.points, 200'000u);
  EXPECT_THAT(thinned.report.notes, testing::Contains(testing::HasSubstr("7001 are kept while reading")));
  ASSERT_EQ(thinned.cloud.size(), expected.size());
  EXPECT_TRUE(thinned.cloud.source_index == expected.source_index);
  EXPECT_TRUE(thinned.cloud.colors == expected.colors);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_NEAR(glm::distance(thinned.cloud.world(i), expected.world(i)), 0, 1e-4) << i;  // a float of 1000
    ASSERT_EQ(thinned.cloud.scalar("gps_time")->value(i), expected.scalar("gps_time")->value(i)) << i;
  }
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Las, LasMemory,
                         testing::Values(std::pair(".las", 3), std::pair(".las", 7), std::pair(".laz", 3),
                                         std::pair(".laz", 7)),
                         [](const auto& p) {
                           return std::string(p.param.first).substr(1) + std::to_string(p.param.second);
                         });

TEST(Subsample, TakesOnePointOfEachRun) {
  for (const auto& [total, wanted] : {std::pair(10, 3), {7, 7}, {1000, 1}, {1001, 999}, {5'000'000, 4321}}) {
    const Subsample some{std::uint64_t(total), std::uint64_t(wanted)};
    std::uint64_t taken = 0;
    for (std::uint64_t i = 0; i < std::uint64_t(total); ++i) {
      ASSERT_EQ(some.before(i), taken) << i << " of " << total;
      if (some.takes(i)) ASSERT_EQ(some.place(taken++), i);
    }
    EXPECT_EQ(taken, std::uint64_t(wanted));
    EXPECT_EQ(some.before(std::uint64_t(total)), taken);
  }
}

}  // namespace
