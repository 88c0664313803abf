// Which nodes a view needs: against what the points themselves say, with budgets, and read back.
#include "copc/select.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

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

}  // namespace
