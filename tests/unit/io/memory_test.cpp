// Clouds of arrays that lie in memory.
#include "io/memory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sfumato::io {
namespace {

MemoryResult read(std::vector<float>& xyz) {
  const auto* data = reinterpret_cast<const std::byte*>(xyz.data());
  std::vector<MemoryColumn> columns;
  for (std::size_t k = 0; k < 3; ++k)
    columns.push_back(
        {std::string(1, "xyz"[k]), StoredType::float32, data + k * sizeof(float), 3 * sizeof(float), false});
  return read_memory(columns, xyz.size() / 3);
}

TEST(Memory, ACloudHoldsNothingButItsPoints) {
  std::vector<float> xyz(3000, 1.5f);
  const MemoryResult result = read(xyz);
  ASSERT_EQ(result.cloud.size(), 1000u);
  // Where each row went is built on the way: four bytes a point that nobody asks for when all rows stay.
  EXPECT_EQ(result.cloud.grid_index.capacity(), 0u);
  EXPECT_EQ(result.cloud.source_index.capacity(), 0u);
  EXPECT_TRUE(result.kept.empty());
}

TEST(Memory, RowsThatStayAreTold) {
  std::vector<float> xyz(30, 1.5f);
  xyz[13] = std::nanf("");
  const MemoryResult result = read(xyz);
  EXPECT_EQ(result.kept, (std::vector<std::uint32_t>{0, 1, 2, 3, 5, 6, 7, 8, 9}));
}

}  // namespace
}  // namespace sfumato::io
