// Parts of COPC files (ReadOptions::part): by nodes.
#include <gtest/gtest.h>

#include "copc/build.h"
#include "unit/copc/scan.h"
#include "unit/io/files.h"
#include "unit/io/parts.h"

namespace sfumato::test {
namespace {

TEST(CopcPart, NodesTogetherAreTheWhole) {
  io::write(temp_file("in.laz"), scan(300'000));
  copc::build({temp_file("in.laz")}, temp_file("out.copc.laz"));
  expect_parts_are_all(temp_file("out.copc.laz"), {1, 2, 3, 7});
  io::ReadOptions some;
  some.max_points = 7'000;
  expect_parts_are_all(temp_file("out.copc.laz"), {3}, some);
  std::size_t least = ~std::size_t{0};
  for (const io::ReadResult& part : parts_of(temp_file("out.copc.laz"), 3))
    least = std::min(least, part.cloud.size());
  EXPECT_GT(least, 60'000u);
}

}  // namespace
}  // namespace sfumato::test
