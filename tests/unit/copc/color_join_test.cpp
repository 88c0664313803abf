// Files of other bits of colour, or none, side by side in one COPC.
#include <gtest/gtest.h>

#include <filesystem>

#include "copc/build.h"
#include "io/io.h"

namespace sfumato {
namespace {

/// Points in a row, whose red rises; `bits` 0: no colours.
std::filesystem::path part(const std::string& name, int bits, float east) {
  PointCloud cloud;
  for (int i = 0; i < 400; ++i) {
    cloud.positions.emplace_back(east + 0.1f * float(i), 0.01f * float(i * i % 97), 0);
    if (bits) cloud.colors.push_back({std::uint8_t(i * 255 / 399), 128, 255, 255});
  }
  cloud.las.emplace();
  cloud.las->color_bits = bits ? bits : 16;
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / name;
  io::write(file, cloud);
  return file;
}

TEST(ColorJoins, BuildBringsAllTo16Bits) {
  for (const auto& [first, second] :
       {std::pair{8, 16}, {16, 8}, {12, 16}, {16, 12}, {8, 12}, {0, 16}, {8, 0}}) {
    const std::vector files{part("first.las", first, 0), part("second.las", second, 100)};
    const std::filesystem::path out = std::filesystem::path(::testing::TempDir()) / "joined.copc.laz";
    const copc::BuildReport report = copc::build(files, out);
    EXPECT_FALSE(report.notes.empty());
    const io::ReadResult read = io::read(out);
    ASSERT_EQ(read.cloud.size(), 800u);
    for (std::size_t i = 0; i < 800; ++i) {
      const double x = read.cloud.world(i).x;
      const int bits = x < 90 ? first : second;
      const double expected = bits ? (x < 90 ? x : x - 100) / 39.9 * 255 : 255;
      ASSERT_NEAR(read.cloud.colors.at(i).r, expected, 1.5) << first << " and " << second << " at " << x;
    }
  }
}

}  // namespace
}  // namespace sfumato
