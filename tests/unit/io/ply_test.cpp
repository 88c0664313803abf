#include <gtest/gtest.h>

#include <fstream>

#include "io/io.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

TEST(PlyTest, RealBinaryFileMatchesItsTruth) {
  SFUMATO_NEEDS_REAL_SCAN("Guanyin.ply");
  const io::ReadResult result = io::read(test::data_folder() / "Guanyin.ply");
  test::expect_truth("Guanyin.ply", result, 0);
  const std::filesystem::path copy = std::filesystem::path(testing::TempDir()) / "guanyin_copy.ply";
  io::write(copy, result.cloud);
  const io::ReadResult again = io::read(copy);
  EXPECT_EQ(again.cloud.positions, result.cloud.positions);
  EXPECT_EQ(again.cloud.colors, result.cloud.colors);
  EXPECT_EQ(again.cloud.up, UpAxis::pos_y);
}

}  // namespace
}  // namespace sfumato
