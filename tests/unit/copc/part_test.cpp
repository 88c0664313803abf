// Parts of COPC files (ReadOptions::part): by nodes.
#include <gtest/gtest.h>

#include "copc/build.h"
#include "copc/tree.h"
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

TEST(CopcPart, NodesThatAreReadBySeveralAgree) {
  PointCloud cloud = scan(100'000);
  // What the half at larger x has, some nodes know nothing of.
  ScalarField user{"user_data", 0, {}, StoredType::uint8};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool is_dark = cloud.positions[i].x < 50;
    user.values.push_back(is_dark ? 0.0f : 3.0f);
    if (is_dark) cloud.colors[i] = {0, 0, 0, 255};
  }
  cloud.set_scalar(std::move(user));
  io::write(temp_file("in.laz"), cloud);
  copc::build({temp_file("in.laz")}, temp_file("out.copc.laz"));
  const copc::Tree tree = copc::read_tree(temp_file("out.copc.laz"));
  const copc::TreeChoices choices = copc::choices_of(tree);
  std::vector<std::size_t> nodes(tree.nodes.size());
  std::iota(nodes.begin(), nodes.end(), std::size_t{0});
  const PointCloud all = copc::read_nodes(tree, nodes, no_progress(), {}, &choices).cloud;
  ASSERT_TRUE(all.scalar("user_data"));
  std::size_t points = 0;
  for (std::uint64_t i = 0; i < 9; ++i) {
    const auto own = copc::part_of(tree, nodes, {i, 9});
    const PointCloud part = copc::read_nodes(tree, own, no_progress(), {}, &choices).cloud;
    EXPECT_EQ(names_of(part), names_of(all));
    EXPECT_EQ(part.origin, all.origin);
    EXPECT_EQ(part.las->color_bits, all.las->color_bits);
    points += part.size();
  }
  EXPECT_EQ(points, cloud.size());
  EXPECT_EQ(names_of(copc::read_nodes(tree, {}, no_progress(), {}, &choices).cloud), names_of(all));
}

}  // namespace
}  // namespace sfumato::test
