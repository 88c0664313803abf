// Which nodes a view needs: against what the points themselves say, with budgets, and read back.
#include "copc/select.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>
#include <set>

#include "copc/build.h"
#include "io/io.h"
#include "unit/copc/scan.h"
#include "unit/io/las_bytes.h"

using namespace sfumato;
using copc::NodeSelection;
using copc::Tree;
using copc::View;

namespace {

class CopcSelect : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::path(testing::TempDir()) / ("sfumato_copc_select_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    io::write(folder_ / "in.las", test::scan(600'000));
    copc::build({folder_ / "in.las"}, folder_ / "scan.copc.laz");
    trees_ = {copc::read_tree(folder_ / "scan.copc.laz")};
  }
  static void TearDownTestSuite() {
    std::filesystem::remove_all(folder_);
    trees_.clear();
  }

  static const Tree& tree() { return trees_[0]; }
  static Camera camera(const dvec3& position, const dvec3& target, double fov_y_deg = 45) {
    Camera camera;
    camera.position = dvec3(500000, 4100000, 100) + position;
    camera.target = dvec3(500000, 4100000, 100) + target;
    camera.fov_y = glm::radians(fov_y_deg);
    camera.width = 320, camera.height = 200;
    return camera;
  }
  static std::set<copc::Key> keys(const NodeSelection& selection) {
    std::set<copc::Key> all;
    for (std::size_t i : selection.nodes[0]) all.insert(tree().nodes[i].key);
    return all;
  }

  static inline std::filesystem::path folder_;
  static inline std::vector<Tree> trees_;
};

TEST_F(CopcSelect, TheTreeIsKnownWithoutItsPoints) {
  EXPECT_EQ(tree().points, 600'000u);
  EXPECT_NEAR(tree().bounds.min.x, 500000, 0.01);
  EXPECT_NEAR(tree().bounds.max.y, 4100100, 0.01);
  EXPECT_NEAR(tree().spacing, 100.0 / 128, 0.01);
  EXPECT_THAT(tree().crs, testing::HasSubstr("somewhere"));
  EXPECT_THAT(tree().attributes, testing::IsSupersetOf({"red", "intensity", "gps_time", "echo_width"}));
  std::uint64_t points = 0;
  for (const copc::LevelFacts& level : levels_of(tree())) points += level.points;
  EXPECT_EQ(points, tree().points);
  EXPECT_TRUE(copc::is_tree(tree().file));
  EXPECT_FALSE(copc::is_tree(folder_ / "in.las"));
  EXPECT_FALSE(copc::is_tree(folder_ / "absent"));
}

TEST_F(CopcSelect, EveryPointInViewIsOfASpacingBelowTheLimit) {
  // From afar, near, inside, down on it, and through a long lens.
  const std::vector<Camera> cameras{camera({50, -400, 150}, {50, 50, 0}), camera({10, 10, 5}, {60, 60, 0}),
                                    camera({50, 50, 1}, {50, 51, 1}), camera({50, 50, 80}, {50, 50.001, 0}),
                                    camera({50, -900, 300}, {80, 80, 0}, 2)};
  std::size_t nodes_left_out = 0;
  for (const Camera& from : cameras) {
    const NodeSelection selection = copc::select_nodes(trees_, std::vector{View{from}}, {});
    ASSERT_TRUE(selection.is_complete());
    EXPECT_EQ(selection.widest_px, 0);
    const std::set<copc::Key> chosen = keys(selection);
    EXPECT_TRUE(chosen.contains(copc::Key{}));
    for (const copc::Key& key : chosen)
      if (key.level > 0) EXPECT_TRUE(chosen.contains(key.parent())) << key.level;
    const dmat4 to_eye = from.view();
    const Intrinsics lens = from.intrinsics();
    for (std::size_t i = 0; i < tree().nodes.size(); ++i) {
      const copc::Key key = tree().nodes[i].key;
      if (chosen.contains(key)) continue;
      ++nodes_left_out;
      const io::ReadResult node = copc::read_nodes(tree(), {i});
      for (std::size_t k = 0; k < node.cloud.size(); ++k) {
        const dvec3 eye(to_eye * glm::dvec4(node.cloud.world(k), 1));
        const double x = lens.fx * eye.x / -eye.z + lens.cx, y = -lens.fy * eye.y / -eye.z + lens.cy;
        if (eye.z >= 0 || x < 0 || y < 0 || x > from.width || y > from.height) continue;
        // Without this node its parent's points stand for it.
        ASSERT_LT(tree().spacing_of(key.level - 1) * lens.fy / -eye.z, 0.7) << key.level;
      }
    }
  }
  EXPECT_GT(nodes_left_out, 10u);  // most of these views do not need everything
}

TEST_F(CopcSelect, NodesBesideThePictureAreLeftOut) {
  // Through a long lens, and turned so that the boxes stand on their corners; beyond a side or a corner of
  // the picture with its margin there is nothing of them.
  std::size_t beside = 0;
  for (const double turn : {0.2, 0.7, 1.1, 2.5}) {
    const Camera from = camera({50 - 200 * std::cos(turn), 50 - 200 * std::sin(turn), 160}, {48, 53, 0}, 4);
    const NodeSelection selection = copc::select_nodes(trees_, std::vector{View{from}}, {});
    const std::set<copc::Key> chosen = keys(selection);
    const dmat4 to_eye = from.view();
    const Intrinsics lens = from.intrinsics();
    const double margin = 64.0 * from.height / 720 + 1;
    for (const copc::Key& key : chosen) {
      if (key.level == 0) continue;
      const Bounds box = tree().box(key);
      bool is_seen = false;
      constexpr int steps = 40;
      for (int k = 0; k <= steps * (steps + 1) * (steps + 1) && !is_seen; ++k) {
        const dvec3 share(k % (steps + 1), k / (steps + 1) % (steps + 1), k / (steps + 1) / (steps + 1));
        const dvec3 eye(to_eye * glm::dvec4(box.min + share / double(steps) * box.size(), 1));
        const double x = lens.fx * eye.x / -eye.z + lens.cx, y = -lens.fy * eye.y / -eye.z + lens.cy;
        const double near = 20 + margin;  // the samples are that coarse
        is_seen = x > -near && y > -near && x < from.width + near && y < from.height + near;
      }
      EXPECT_TRUE(is_seen) << key.level << ' ' << key.x << ' ' << key.y << ' ' << key.z;
    }
    beside += tree().nodes.size() - chosen.size();
  }
  EXPECT_GT(beside, 20u);
}

TEST_F(CopcSelect, ABudgetLeavesOutTheFinestAndFarthest) {
  const std::vector<View> view{{camera({10, 10, 5}, {60, 60, 0})}};
  const NodeSelection whole = copc::select_nodes(trees_, view, {});
  copc::SelectOptions options;
  options.budget = whole.points / 3;
  const NodeSelection part = copc::select_nodes(trees_, view, options);
  EXPECT_LE(part.points, options.budget);
  EXPECT_GT(part.points, options.budget / 3);
  EXPECT_FALSE(part.is_complete());
  EXPECT_EQ(part.points_needed, whole.points);
  EXPECT_GT(part.widest_px, 0.7);
  const std::set<copc::Key> some = keys(part), all = keys(whole);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
  // The camera stands near the corner at 0, 0: its nodes come before those of the far corner.
  int near_level = 0, far_level = 0;
  for (const copc::Key& key : some) {
    const Bounds box = tree().box(key);
    if (box.min.x < 500025 && box.min.y < 4100025) near_level = std::max(near_level, key.level);
    if (box.max.x > 500075 && box.max.y > 4100075) far_level = std::max(far_level, key.level);
  }
  EXPECT_GT(near_level, far_level);
  options.budget = 1;
  EXPECT_EQ(copc::select_nodes(trees_, view, options).nodes_read, 1u);
}

/// Tiles of 100 m in a row to the north, each with 60,000 points in its root and as many in a child.
std::vector<Tree> tiles(int count) {
  std::vector<Tree> trees;
  for (int i = 0; i < count; ++i) {
    Tree tree;
    tree.cube = {{0, 100.0 * i, 0}, 100};
    tree.spacing = 100.0 / 128;
    tree.bounds = {tree.cube.min, tree.cube.min + 100.0};
    tree.nodes = {{{}, {}}, {copc::Key{}.child(0), {}}};
    for (copc::TreeNode& node : tree.nodes) node.points = 60'000;
    tree.points = 120'000;
    trees.push_back(tree);
  }
  return trees;
}

TEST(CopcTiles, OfManyThoseInViewAreReadAndDistantOnesThinned) {
  const std::vector<Tree> trees = tiles(1000);
  Camera camera;
  camera.position = {50, 30'000, 150};  // over the middle, to the north
  camera.target = {50, 100'000, 0};
  camera.fov_y = glm::radians(45.0);
  camera.width = 1280, camera.height = 720;
  const NodeSelection selection = copc::select_nodes(trees, std::vector{View{camera}}, {});
  ASSERT_TRUE(selection.is_complete());
  const double scale = camera.intrinsics().fy;
  std::size_t unseen = 0, thinned = 0;
  std::uint64_t points = 0;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (selection.nodes[t].empty()) {
      ++unseen;
      EXPECT_LT(trees[t].bounds.max.y, 30'200) << t;  // beside and behind the camera
      continue;
    }
    EXPECT_EQ(selection.nodes[t].front(), 0u);
    const double distance =
        glm::length(glm::clamp(camera.position, trees[t].bounds.min, trees[t].bounds.max) - camera.position);
    const double px = 2 * trees[t].spacing * scale / distance;  // the spacing that a tree over the tiles had
    const std::uint64_t count = 60'000 * selection.nodes[t].size();
    if (px >= 0.7) {
      EXPECT_GT(selection.wanted[t], count) << t;  // all
    } else {
      ++thinned;
      EXPECT_EQ(selection.nodes[t].size(), 1u);
      EXPECT_NEAR(double(selection.wanted[t]), 60'000 * (px / 0.7) * (px / 0.7), 1) << t;
    }
    points += std::min(selection.wanted[t], count);
  }
  EXPECT_EQ(points, selection.points);
  EXPECT_GT(unseen, 250u);
  EXPECT_GT(thinned, 300u);
  // As few as one file of the same points would give, or so: not 60,000 of each.
  EXPECT_LT(selection.points, 5'000'000u);
}

TEST(CopcTiles, AnOverviewOfManyKeepsTheBudget) {
  const NodeSelection selection = copc::select_overview(tiles(1000), 300'000);
  EXPECT_LE(selection.points, 300'000u);
  EXPECT_GT(selection.points, 290'000u);
  for (std::size_t t = 0; t < 1000; ++t) {
    EXPECT_EQ(selection.nodes[t].size(), 1u);
    EXPECT_EQ(selection.wanted[t], 300u);
  }
}

TEST_F(CopcSelect, NodesThatAreKeptAreTheNodesOfTheFile) {
  std::vector<std::size_t> all(tree().nodes.size()), even, odd;
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (std::size_t i : all) (i % 2 ? odd : even).push_back(i);
  // Room for everything, for a few nodes, for none.
  for (const std::uint64_t room : {std::uint64_t{1} << 30, std::uint64_t{8} << 20, std::uint64_t{1000}}) {
    io::ChunkCache cache(room);
    for (const auto& nodes : {even, all, odd, all, even}) {
      const io::ReadResult from_file = copc::read_nodes(tree(), nodes);
      const io::ReadResult kept = copc::read_nodes(tree(), nodes, no_progress(), {&cache, 3});
      EXPECT_EQ(kept.cloud.origin, from_file.cloud.origin);
      EXPECT_TRUE(kept.cloud.positions == from_file.cloud.positions);
      EXPECT_TRUE(kept.cloud.colors == from_file.cloud.colors);
      ASSERT_EQ(kept.cloud.scalars.size(), from_file.cloud.scalars.size());
      for (std::size_t k = 0; k < kept.cloud.scalars.size(); ++k)
        EXPECT_TRUE(kept.cloud.scalars[k].values == from_file.cloud.scalars[k].values);
      EXPECT_LE(cache.bytes(), room);
    }
    if (room > 1 << 29) EXPECT_EQ(cache.bytes() % 600'000, 0u);  // every record once
    for (const copc::TreeNode& node : tree().nodes)
      EXPECT_EQ(cache.find({4, node.chunk.byte}), nullptr);  // of another file
  }
}

TEST_F(CopcSelect, WhatIsOutOfViewCountsWhenShadowsAreCast) {
  const std::vector<View> view{{camera({50, 20, 2}, {50, 0, 2})}};  // most of the scan is behind the camera
  copc::SelectOptions options;
  const NodeSelection seen = copc::select_nodes(trees_, view, options);
  options.outside = 0.25;
  const NodeSelection lit = copc::select_nodes(trees_, view, options);
  EXPECT_GT(lit.points, seen.points);
  EXPECT_LT(lit.points, tree().points);
  // All around is more than one side.
  EXPECT_GT(copc::select_nodes(trees_, std::vector{View{view[0].camera, true}}, {}).points, seen.points);
  // Two views need what each of them does.
  const std::vector<View> both{view[0], {camera({50, 80, 2}, {50, 100, 2})}};
  EXPECT_GT(copc::select_nodes(trees_, both, {}).points, seen.points);
  // A box.
  options.box = Bounds{{500000, 4100000, 0}, {500010, 4100010, 200}};
  for (const copc::Key& key : keys(copc::select_nodes(trees_, view, options))) {
    EXPECT_LE(tree().box(key).min.x, 500010);
    EXPECT_LE(tree().box(key).min.y, 4100010);
  }
}

TEST_F(CopcSelect, AnOverviewIsTheCoarseLevels) {
  const NodeSelection overview = copc::select_overview(trees_, 100'000);
  EXPECT_LE(overview.points, 100'000u);
  EXPECT_GT(overview.points, 0u);
  for (const copc::Key& key : keys(overview)) EXPECT_LE(key.level, 2);
  EXPECT_EQ(copc::select_overview(trees_, 1'000'000).points, tree().points);
  EXPECT_EQ(copc::select_overview(trees_, 1).nodes_read, 1u);
}

TEST_F(CopcSelect, DamagedNodesAreLeftOutAndTold) {
  test::Bytes bytes = test::load(tree().file);
  const auto& node = tree().nodes[tree().nodes.size() / 2];
  // A layer larger than its chunk: what the sizes behind the first point say.
  test::put<std::uint32_t>(bytes, node.chunk.byte + 36 + 4 + 4, 0x7FFFFFFF);
  std::ofstream(folder_ / "damaged.copc.laz", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  const Tree damaged = copc::read_tree(folder_ / "damaged.copc.laz");
  std::vector<std::size_t> all(damaged.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const io::ReadResult result = copc::read_nodes(damaged, all);
  ASSERT_EQ(result.report.damage.size(), 1u);
  EXPECT_THAT(result.report.damage[0], testing::HasSubstr("damaged.copc.laz: byte"));
  EXPECT_THAT(result.report.damage[0], testing::HasSubstr("node " + std::to_string(node.key.level) + "-"));
  EXPECT_EQ(result.report.points_missing, node.chunk.count);
  EXPECT_EQ(result.cloud.size(), 600'000u - node.chunk.count);
  // The others are those of the file.
  std::vector<std::size_t> whole = all;
  whole.erase(whole.begin() + std::ptrdiff_t(all.size() / 2));
  EXPECT_TRUE(copc::read_nodes(tree(), whole).cloud.positions == result.cloud.positions);
}

// Kept records of another file, which stood there before, are not taken for this one's.
TEST_F(CopcSelect, DecodesWhereKeptRecordsHaveAnotherLength) {
  io::ChunkCache kept(1 << 20);
  kept.keep({0, tree().nodes[0].chunk.byte}, std::vector<std::uint8_t>(7));
  const io::ReadResult with = copc::read_nodes(tree(), {0}, no_progress(), io::KeptChunks{&kept, 0});
  const io::ReadResult without = copc::read_nodes(tree(), {0});
  EXPECT_EQ(with.cloud.positions, without.cloud.positions);
}

}  // namespace
