// Ranges of colours of a file with levels follow from the sample that `build` stores: the same for every view
// and budget, and as in a picture of all points. The technique follows from the levels.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "copc/build.h"
#include "io/io.h"
#include "reference/gl_fixture.h"
#include "session/opening.h"
#include "session/session.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

constexpr int points = 600'000;

/// A wavy ground of 100 m: two thirds of the points lie in a hundredth of it, and have other values. They are
/// skewed everywhere.
PointCloud two_densities() {
  PointCloud cloud;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  ScalarField amplitude{"amplitude", 0, {}, StoredType::float32};
  for (int i = 0; i < points; ++i) {
    const bool is_dense = i % 3 > 0;
    const float side = is_dense ? 10 : 100, x = side * unit(random), y = side * unit(random);
    cloud.positions.push_back({x, y, std::sin(x / 9) * std::cos(y / 7)});
    amplitude.values.push_back(-(is_dense ? 1 : 20) * std::log(1 - unit(random)));
  }
  cloud.set_scalar(std::move(amplitude));
  return cloud;
}

/// What a session makes of a view.
struct Automatic {
  double low = 0, high = 0;
  TechniqueChoice choice;
};

class StoredSampleTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    std::filesystem::create_directories(folder_);
    const PointCloud cloud = two_densities();
    std::vector<std::uint32_t> halves[2];
    for (std::uint32_t i = 0; i < cloud.size(); ++i) halves[i % 2].push_back(i);
    for (int k : {0, 1}) io::write(half(k), select(cloud, halves[k]));
    values_ = cloud.scalar("amplitude")->values;
    std::sort(values_.begin(), values_.end());
    copc::BuildOptions options;
    options.memory = 8'000'000;  // in pieces
    copc::build({half(0), half(1)}, scan(), options);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    GlTest::TearDown();
  }
  std::filesystem::path half(int k) const { return folder_ / ("half" + std::to_string(k) + ".las"); }
  std::filesystem::path scan() const { return folder_ / "scan.copc.laz"; }

  static Camera above(double x, double height) {
    Camera camera;
    camera.position = {x, x, 50}, camera.target = {x, x, 0}, camera.up = {0, 1, 0};
    camera.projection = Projection::orthographic;
    camera.height_world = height;
    camera.width = 320, camera.height = 320;
    return camera;
  }
  static Automatic measured(scene::Scene scene, const Pose& pose) {
    Session session(context());
    SessionOptions options;
    options.color.color_by = "amplitude";
    session.set_scene(std::move(scene), pose, options);
    Automatic found;
    found.choice = session.suggest();
    session.measure({});
    found.low = session.coloring().low, found.high = session.coloring().high;
    return found;
  }
  Automatic of_view(const std::filesystem::path& file, std::uint64_t budget, const Camera& camera) const {
    Request request;
    request.points.read.max_points = budget;
    const Opening opening(request, scene::files_of({file.string()}));
    EXPECT_TRUE(opening.has_levels());
    scene::Scene scene = opening.read({&camera, 1}, false);
    EXPECT_LE(scene.cloud.size(), budget);
    return measured(std::move(scene), opening.pose());
  }
  /// Of all points, those below the value.
  double share_below(double value) const {
    const auto at = std::lower_bound(values_.begin(), values_.end(), float(value));
    return double(at - values_.begin()) / double(values_.size());
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("sfumato_stored_sample_" + std::to_string(::getpid()));
  std::vector<float> values_;
};

TEST_F(StoredSampleTest, EveryViewAndBudgetHasTheRangeOfTheWhole) {
  Opening all({}, scene::files_of({half(0).string(), half(1).string()}));
  ASSERT_FALSE(all.has_levels());
  const Automatic whole = measured(all.take(), all.pose());
  EXPECT_NEAR(share_below(whole.low), 0.02, 1e-4);
  EXPECT_NEAR(share_below(whole.high), 0.98, 1e-4);
  const Automatic first = of_view(scan(), 300'000, above(50, 100));
  // Five standard deviations of the share of a sample.
  const double off = 5 * std::sqrt(0.02 * 0.98 / double(copc::RecordSample::size_for(points)));
  EXPECT_NEAR(share_below(first.low), 0.02, off);
  EXPECT_NEAR(share_below(first.high), 0.98, off);
  EXPECT_EQ(first.choice.technique, "surface");  // `splats` of files with levels
  EXPECT_EQ(whole.choice.technique, "splats");
  EXPECT_NEAR(first.choice.surface_share, whole.choice.surface_share, 0.1);
  for (const std::uint64_t budget : {30'000u, 300'000u})
    for (const Camera& camera : {above(5, 8), above(80, 30)}) {
      const Automatic other = of_view(scan(), budget, camera);
      EXPECT_EQ(other.low, first.low);
      EXPECT_EQ(other.high, first.high);
      // The coarse levels tell the technique: as many as the budget allows.
      if (budget == 300'000u) EXPECT_EQ(other.choice.reason, first.choice.reason);
    }
}

std::shared_ptr<const scene::Overview> overview(const std::vector<std::filesystem::path>& files,
                                                const Selection& selection = {}) {
  scene::SceneOptions options;
  options.selection = selection;
  std::vector<std::string> names;
  for (const std::filesystem::path& file : files) names.push_back(file.string());
  auto leveled = scene::LeveledScene::open(scene::files_of(names), options, 10'000'000, true);
  return leveled->overview().overview;
}

TEST_F(StoredSampleTest, CoarseLevelsStandInForADamagedOne) {
  const copc::Tree tree = copc::read_tree(scan());
  const auto changed = [&](std::uint64_t from_head, std::size_t bytes) {
    const std::filesystem::path file = folder_ / "damaged.copc.laz";
    std::filesystem::copy_file(scan(), file, std::filesystem::copy_options::overwrite_existing);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(std::streamoff(tree.sample->byte - copc::sample_head + from_head))
        .write("\x99\x99\x99\x99\x99\x99\x99\x99", std::streamsize(bytes));
    return overview({file});
  };
  EXPECT_TRUE(overview({scan()})->levels);
  // The version, the number of its points, that of the file's, which another program wrote, and its points.
  for (const auto& [from_head, bytes] : {std::pair(0, 1), {7, 1}, {8, 1}, {int(copc::sample_head) + 40, 8}}) {
    EXPECT_FALSE(changed(std::uint64_t(from_head), std::size_t(bytes))->levels) << from_head;
    EXPECT_GT(changed(std::uint64_t(from_head), std::size_t(bytes))->size(), 0u);
  }
}

TEST_F(StoredSampleTest, FilesHaveSharesByTheirPoints) {
  // One without a sample, as it is small: of other values, and a thirtieth of all points.
  constexpr int few = 20'000;
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> side(100, 110);
  for (int i = 0; i < few; ++i) cloud.positions.push_back({side(random), side(random), 0});
  cloud.set_scalar({"amplitude", 0, std::vector<float>(few, -7.f), StoredType::float32});
  const std::filesystem::path small = folder_ / "small.las", built = folder_ / "small.copc.laz";
  io::write(small, cloud);
  copc::build({small}, built);
  ASSERT_FALSE(copc::read_tree(built).sample);
  const auto both = overview({scan(), built});
  ASSERT_TRUE(both->levels);
  const std::vector<float>& values = both->scalar("amplitude")->values;
  const double share = double(std::count(values.begin(), values.end(), -7.f)) / double(values.size());
  EXPECT_NEAR(share, double(few) / double(points + few), 1e-4);  // less than a point of each
}

TEST_F(StoredSampleTest, IsSelectedFrom) {
  // Of a box the levels know more, and of what is rare.
  Selection part;
  part.crop = Bounds{{0, 0, -2}, {50, 50, 2}};
  EXPECT_FALSE(overview({scan()}, part)->levels);
  part = {};
  part.filters = {{"amplitude", 0, 1}};
  const auto some = overview({scan()}, part);
  EXPECT_TRUE(some->levels);
  for (const float value : some->scalar("amplitude")->values) EXPECT_LE(value, 1);
  part.filters = {{"amplitude", 60, 1e6}};
  EXPECT_FALSE(overview({scan()}, part)->levels);
}

}  // namespace
