// Files larger than memory in the window: what a view shows is read for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "copc/build.h"
#include "unit/copc/scan.h"
#include "view/view_model.h"

namespace sfumato::view {
namespace {

using ::testing::Contains;
using ::testing::Not;
using Clock = std::chrono::steady_clock;

/// Pixels that differ; all of them for pictures of different sizes.
std::size_t different(const Image<Rgba8>& a, const Image<Rgba8>& b) {
  if (a.width() != b.width() || a.height() != b.height()) return a.size();
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += !(a.data()[i] == b.data()[i]);
  return count;
}

/// Whether points of class 6 are among those that are shown.
bool has_walls(const Loaded& scene) {
  const ScalarField* kind = scene.near->scalar("classification");
  return std::count(kind->values.begin(), kind->values.end(), 6.0f) > 0;
}

class LevelsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::path(testing::TempDir()) / ("sfumato_view_levels_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    io::write(folder_ / "in.las", test::scan(points));
    copc::build({folder_ / "in.las"}, scan());
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }
  static std::filesystem::path scan() { return folder_ / "scan.copc.laz"; }

  static constexpr std::size_t points = 900'000;
  static constexpr std::uint64_t memory = 400'000 * scene::memory_of_point;  // fewer than there are
  static constexpr int width = 320, height = 200;

  static Start start() {
    Start start;
    start.request.files = {scan().string()};
    start.request.technique = "points";
    start.request.color.color_by = "elevation";
    start.memory = memory;
    start.wake = [] {};
    return start;
  }
  /// Ticks until the view model has what it wants; false when that takes a minute.
  bool wait(ViewModel& model, const std::function<bool()>& done) {
    for (const auto from = Clock::now(); Clock::now() - from < std::chrono::minutes(1);) {
      model.tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
      for (const Message& message : model.take_messages())
        if (message.is_error) mistakes_.push_back(message.text);
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  void TearDown() override { EXPECT_THAT(mistakes_, ::testing::IsEmpty()); }
  bool settle(ViewModel& model) {
    return wait(model, [&] { return model.settled(); });
  }
  /// What the command draws of the same view.
  static Image<Rgba8> picture_of(const Camera& camera) {
    scene::SceneOptions options;
    auto leveled = scene::LeveledScene::open(scene::files_of({scan().string()}), options, memory);
    EXPECT_TRUE(leveled);
    scene::Scene scene = leveled->overview();
    Pose pose = stand_upright(scene);
    scene = leveled->read(std::vector<copc::View>{{camera, false}}, false);
    scene.cloud.up = pose.upright.up;
    const auto context = gl::Context::create_headless();
    Session session(*context);
    SessionOptions wanted;
    wanted.color.color_by = "elevation";
    Look look("points");
    session.set_scene(std::move(scene), std::move(pose), wanted);
    session.measure(look.technique->needs());
    return session.render(look, camera).rgba8;
  }

  static inline std::filesystem::path folder_;
  Clock::time_point began_ = Clock::now();
  std::vector<std::string> mistakes_;
};

TEST_F(LevelsTest, EveryViewShowsWhatItsPixelsTellApart) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  ASSERT_TRUE(model.scene.loaded());
  EXPECT_TRUE(model.scene.loaded()->follows_view);
  EXPECT_FALSE(model.scene.loaded()->is_coarse);
  EXPECT_EQ(different(model.picture()->image, picture_of(model.camera())), 0u);
  const std::uint64_t first = model.scene.loaded()->points_shown;
  EXPECT_GT(first, 60'000u);
  const double low = model.picture()->coloring.low, high = model.picture()->coloring.high;
  EXPECT_LT(first, points);

  // The hand goes near: details come that the first view did not hold.
  const dvec3 home = model.camera().position;
  model.move("zoom", [](Navigator& navigator) {
    ViewCamera near = navigator.camera();
    const dvec3 away = near.position - near.target;
    near.target = {500050, 4100050, 100 + 3 * std::sin(50 / 9.) * std::cos(50 / 7.)};  // of the ground
    near.position = near.target + 0.05 * away;
    navigator.set_camera(near);
  });
  EXPECT_FALSE(model.settled());
  ASSERT_TRUE(settle(model));
  const auto near = model.scene.loaded()->nodes;
  const Image<Rgba8> expected = picture_of(model.camera());
  EXPECT_EQ(different(model.picture()->image, expected), 0u);
  // A height has the colour that it had from afar.
  EXPECT_EQ(model.picture()->coloring.low, low);
  EXPECT_EQ(model.picture()->coloring.high, high);
  ASSERT_TRUE(near);
  int deepest = 0;
  const copc::Tree tree = copc::read_tree(scan());
  for (std::size_t i : near->nodes[0]) deepest = std::max(deepest, tree.nodes[i].key.level);
  EXPECT_EQ(deepest, copc::levels_of(tree).back().level);

  // And back: the same bytes as before.
  model.move("back", [&](Navigator& navigator) {
    ViewCamera far = navigator.camera();
    far.position = home;
    navigator.set_camera(far);
  });
  ASSERT_TRUE(settle(model));
  EXPECT_EQ(model.scene.loaded()->points_shown, first);
}

TEST_F(LevelsTest, PicturesForKeepsAreReadForTheirSize) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  model.save_picture(4 * width, 4 * height);
  std::vector<SavedPicture> shots;
  ASSERT_TRUE(wait(model, [&] {
    for (SavedPicture& shot : model.saved_pictures.take()) shots.push_back(std::move(shot));
    return !shots.empty();
  }));
  Camera camera = model.camera();
  camera.width = 4 * width, camera.height = 4 * height;
  EXPECT_EQ(different(shots[0].picture.image, picture_of(camera)), 0u);
  // The window goes on with what it needs itself.
  ASSERT_TRUE(settle(model));
  EXPECT_EQ(different(model.picture()->image, picture_of(model.camera())), 0u);
}

// Whoever saves a picture and goes on at once gets it all the same, of what was shown then.
TEST_F(LevelsTest, PicturesForKeepsComeBeforeWhatIsWishedNext) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  const Camera first = model.camera();
  model.save_picture(width, height);
  model.move("zoom", [](Navigator& navigator) {
    ViewCamera near = navigator.camera();
    near.position = near.target + 0.2 * (near.position - near.target);
    navigator.set_camera(near);
  });
  const Camera second = model.camera();
  model.save_picture(width, height);
  model.change("hide", [](ViewRequest& request) {
    request.hide_classes = {6};
    request.color.color_by = "clay";
  });
  std::vector<SavedPicture> shots;
  ASSERT_TRUE(wait(model, [&] {
    for (SavedPicture& shot : model.saved_pictures.take()) shots.push_back(std::move(shot));
    return shots.size() == 2 && model.settled() && !has_walls(*model.scene.loaded());
  }));
  EXPECT_EQ(different(shots[0].picture.image, picture_of(first)), 0u);
  EXPECT_EQ(different(shots[1].picture.image, picture_of(second)), 0u);
  for (const SavedPicture& shot : shots) {
    EXPECT_THAT(shot.words, Contains("--color-by=elevation"));
    EXPECT_THAT(shot.words, Not(Contains("--hide-classes=6")));
  }
}

TEST_F(LevelsTest, PointsShowAViewUntilTheTechniqueHasMeasuredIt) {
  Start with_splats = start();
  with_splats.request.technique = "splats";
  ViewModel model(with_splats);
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  model.move("zoom", [](Navigator& navigator) {
    ViewCamera near = navigator.camera();
    near.position = near.target + 0.2 * (near.position - near.target);
    navigator.set_camera(near);
  });
  std::shared_ptr<const Picture> last = model.picture();
  std::vector<std::string> whole;  // techniques of the pictures in full size, one after the other
  ASSERT_TRUE(wait(model, [&] {
    if (model.picture() != last && model.shown_quality().whole_cloud &&
        model.picture()->image.width() == width)
      whole.push_back(model.picture()->technique);
    last = model.picture();
    return model.settled();
  }));
  ASSERT_GE(whole.size(), 2u);
  EXPECT_EQ(whole[whole.size() - 2], "points");
  EXPECT_EQ(whole.back(), "splats");
  EXPECT_EQ(last->camera.position, model.camera().position);
}

TEST_F(LevelsTest, ChosenPointsStayWhenTheViewChanges) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  model.pick(width / 2.0, height / 2.0);
  ASSERT_TRUE(wait(model, [&] { return !model.picks.points().empty(); }));
  const dvec3 picked = model.picks.points()[0].world;
  model.move("turn", [](Navigator& navigator) {
    ViewCamera near = navigator.camera();
    near.position = near.target + 0.2 * (near.position - near.target);
    navigator.set_camera(near);
  });
  ASSERT_TRUE(settle(model));
  ASSERT_EQ(model.picks.points().size(), 1u);
  EXPECT_EQ(model.picks.points()[0].world, picked);
}

TEST_F(LevelsTest, AClassThatIsHiddenStaysHiddenInEveryView) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  const ViewCamera seen = model.request().camera;
  model.change("hide", [](ViewRequest& request) { request.hide_classes = {6}; });
  ASSERT_TRUE(wait(model, [&] { return model.scene.loading(); }));
  ASSERT_TRUE(settle(model));
  EXPECT_EQ(model.request().camera, seen);
  EXPECT_FALSE(has_walls(*model.scene.loaded()));
  EXPECT_EQ(model.scene.loaded()->classes.size(), 2u) << "what is hidden can be shown again";
  model.move("zoom", [](Navigator& navigator) {
    ViewCamera near = navigator.camera();
    near.position = near.target + 0.2 * (near.position - near.target);
    navigator.set_camera(near);
  });
  ASSERT_TRUE(settle(model));
  EXPECT_FALSE(has_walls(*model.scene.loaded()));
  EXPECT_EQ(model.scene.loaded()->classes.size(), 2u);
}

// One reading of the coarse levels says which classes there are, whatever is selected of them.
TEST_F(LevelsTest, OneReadingTellsAllClassesAndWhatIsSelected) {
  struct Reads : Progress {
    void update(double, std::string_view) override { ++updates; }  // at every node
    bool cancelled() const override { return false; }
    std::atomic<int> updates = 0;
  };
  scene::SceneOptions options;
  options.selection.hide_classes = {6};
  const auto open = [&] {
    return *scene::LeveledScene::open(scene::files_of({scan().string()}), options, memory);
  };
  Reads alone, both;
  const scene::Scene expected = open().overview(alone);
  const scene::Scene all = open().unselected_overview(both);
  const scene::Scene scene = open().overview(both, all);
  EXPECT_EQ(both.updates, alone.updates);
  const std::vector<float>& seen = all.cloud.scalar("classification")->values;
  EXPECT_EQ(std::set(seen.begin(), seen.end()), (std::set{2.0f, 6.0f}));
  EXPECT_EQ(scene.cloud.positions, expected.cloud.positions);
  EXPECT_GT(scene.selected.hidden, 0u);
  const ScalarField* kind = scene.cloud.scalar("classification");
  EXPECT_EQ(std::count(kind->values.begin(), kind->values.end(), 6.0f), 0);
  EXPECT_EQ(all.cloud.size(), scene.cloud.size() + scene.selected.hidden);
}

// It is a picture of the technique that the whole has, not of the one that stood in.
TEST_F(LevelsTest, APictureIsSavedByTheTechniqueThatIsChosenLater) {
  Start unsettled = start();
  unsettled.request.technique.clear();
  unsettled.given = {{"epsilon", "0.1"}};  // which the stand-in has not
  ViewModel model(unsettled);
  model.set_size(width, height);
  ASSERT_TRUE(wait(model, [&] { return model.scene.loaded() && !model.scene.loading(); }));
  ASSERT_TRUE(model.scene.loaded()->is_coarse && model.request().technique.empty());
  model.save_picture(width, height);
  ASSERT_TRUE(wait(model, [&] { return !model.saved_pictures.pending(); }));
  const std::vector<SavedPicture> saved = model.saved_pictures.take();
  ASSERT_EQ(saved.size(), 1u);
  EXPECT_EQ(saved[0].picture.technique, "splats");
}

// What a box leaves out is seen as well, though nothing is read there for what is selected.
TEST_F(LevelsTest, ClassesBesideABoxAreKnown) {
  io::write(folder_ / "beside.las", test::scan(20'000, 7, 1000));
  copc::build({folder_ / "beside.las"}, folder_ / "beside.copc.laz");
  const auto files = scene::files_of({scan().string(), (folder_ / "beside.copc.laz").string()});
  scene::SceneOptions options;
  auto both = scene::LeveledScene::open(files, options, memory, true);
  options.selection.crop = both->trees()[1].bounds;
  auto boxed = scene::LeveledScene::open(files, options, memory, true);
  const scene::Scene all = boxed->unselected_overview();
  EXPECT_EQ(boxed->overview(no_progress(), all).levels->points, 20'000u);
  EXPECT_EQ(all.cloud.size(), both->overview().cloud.size());
}

// What cannot be opened is said once, and not again for every view of what is still on the screen.
TEST_F(LevelsTest, AFileThatCannotBeReadIsSaidOnce) {
  ViewModel model(start());
  model.set_size(width, height);
  ASSERT_TRUE(settle(model));
  model.open({(folder_ / "missing.copc.laz").string()}, false);
  ASSERT_TRUE(wait(model, [&] { return model.scene.loading(); }));
  ASSERT_TRUE(settle(model));
  for (int n = 0; n < 2; ++n) {
    model.move("turn", [](Navigator& hand) { hand.rotate(40, 10, 200, hand.camera().target); });
    ASSERT_TRUE(settle(model));
  }
  EXPECT_THAT(std::exchange(mistakes_, {}), ::testing::SizeIs(1));
  model.undo();  // the turn
  model.undo();
  ASSERT_TRUE(wait(model, [&] { return model.scene.loading(); }));
  ASSERT_TRUE(settle(model));
  EXPECT_TRUE(model.scene.loaded()->nodes);
}

}  // namespace
}  // namespace sfumato::view
