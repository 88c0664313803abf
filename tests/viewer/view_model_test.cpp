// What a hand does one after the other: files opened, undone, read again, played.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "io/io.h"
#include "view/view_model.h"

namespace sfumato::view {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

class ViewModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ("sfumato_view_model_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    model_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// A hilly square whose corner is at `x` to the east, of two classes.
  std::string write(const std::string& name, double x, int per_edge = 50) {
    PointCloud cloud;
    cloud.origin = {x, 0, 0};
    ScalarField classes{"classification", 0, {}, StoredType::uint8};
    for (int i = 0; i < per_edge * per_edge; ++i) {
      cloud.positions.push_back({float(i % per_edge), float(i / per_edge), float(i % 7)});
      classes.values.push_back(i % 2 ? 2.0f : 6.0f);
    }
    cloud.scalars = {classes};
    io::write(folder_ / name, cloud);
    return (folder_ / name).string();
  }
  static Start start(const std::string& file) {
    Start start;
    start.request.files = {file};
    start.request.technique = "points";
    start.wake = [] {};
    return start;
  }

  /// What `start` names, in a small window, whole.
  ViewModel& show(const Start& start) {
    model_ = std::make_unique<ViewModel>(start);
    model_->set_size(320, 200);
    EXPECT_TRUE(settle(*model_));
    return *model_;
  }
  void tick(ViewModel& model) {
    model.tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
    for (const Message& message : model.take_messages()) mistakes_ += message.is_error;
  }
  /// Ticks until the view model has what it wants; false when that takes a minute.
  bool wait(ViewModel& model, const std::function<bool()>& done) {
    for (const auto from = Clock::now(); Clock::now() - from < std::chrono::minutes(1);) {
      tick(model);
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  bool settle(ViewModel& model) {
    return wait(model, [&] { return model.settled(); });
  }
  /// What was just wished for is read, or refused.
  bool load(ViewModel& model) {
    return wait(model, [&] { return model.scene.loading(); }) && settle(model);
  }
  /// The pictures that were asked for, once all of them are there.
  std::vector<SavedPicture> shots(ViewModel& model) {
    EXPECT_TRUE(wait(model, [&] { return !model.saved_pictures.pending(); }));
    return model.saved_pictures.take();
  }
  static void reset(ViewModel& model) {
    model.move("reset", [&](Navigator& hand) { hand.set_camera(model.request().home); });
  }
  static void turn(ViewModel& model) {
    model.move("turn", [](Navigator& hand) { hand.rotate(40, 10, 200, hand.camera().target); });
  }
  static void hide_class(ViewModel& model, int id) {
    model.change("classes", [&](ViewRequest& request) { request.hide_classes = {id}; });
  }

  std::filesystem::path folder_;
  std::unique_ptr<ViewModel> model_;
  Clock::time_point began_ = Clock::now();
  int mistakes_ = 0;
};

TEST_F(ViewModelTest, UndoGoesBackToViewsThatWereSeen) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  ViewModel& model = show(start(here));
  turn(model);
  const ViewCamera of_here = model.request().camera;
  model.open({there}, false);
  ASSERT_TRUE(load(model));
  const ViewCamera of_there = model.request().camera;
  EXPECT_GT(of_there.target.x, 5000);
  turn(model);
  model.undo();
  EXPECT_EQ(model.request().files, std::vector{there});
  EXPECT_EQ(model.request().camera, of_there);
  model.undo();
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().files, std::vector{here});
  EXPECT_EQ(model.request().camera, of_here);
  model.redo();
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().camera, of_there);
  EXPECT_EQ(mistakes_, 0);
}

// What is undone before it was seen is framed when it comes back.
TEST_F(ViewModelTest, RedoFramesWhatWasNeverSeen) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  ViewModel& model = show(start(here));
  turn(model);
  const ViewCamera of_here = model.request().camera;
  model.open({there}, false);
  model.undo();
  hide_class(model, 6);
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().camera, of_here);
  model.undo();
  model.open({there}, false);
  model.undo();
  model.redo();
  ASSERT_TRUE(load(model));
  EXPECT_GT(model.request().camera.target.x, 5000);
}

TEST_F(ViewModelTest, UndoKeepsTheTechniqueThatWasChosen) {
  Start unsettled = start(write("here.las", 0));
  unsettled.request.technique.clear();
  unsettled.given = {{"size_mode", "pixels"}};  // which the first technique has not
  ViewModel model(unsettled);
  model.set_size(320, 200);
  ASSERT_TRUE(wait(model, [&] { return model.scene.loaded() != nullptr; }));
  ASSERT_TRUE(model.request().technique.empty());
  turn(model);
  ASSERT_TRUE(wait(model, [&] { return !model.request().technique.empty(); }));
  EXPECT_EQ(model.request().technique, "points");
  model.undo();
  EXPECT_EQ(model.request().technique, "points");
  EXPECT_THAT(model.scene.reason(), HasSubstr("has --size-mode"));
}

// What was named to be shown becomes what is left out, and noise stays so.
TEST_F(ViewModelTest, ShowsAndHidesOneClassAmongOthers) {
  Start only = start(write("here.las", 0));
  only.request.points.selection.show_classes = {2};
  ViewModel early(only);
  early.show_class(6, true);  // among others that nobody knows yet
  EXPECT_EQ(early.request().points.selection.show_classes, std::vector{2});
  ViewModel& model = show(only);
  EXPECT_FALSE(model.request().shows_class(6));
  model.show_class(6, true);
  EXPECT_TRUE(model.request().points.selection.show_classes.empty());
  EXPECT_EQ(model.request().hide_classes, (std::vector{7, 18}));
  model.show_class(2, false);
  EXPECT_EQ(model.request().hide_classes, (std::vector{2, 7, 18}));
  EXPECT_TRUE(model.request().shows_class(6) && !model.request().shows_class(2));
}

// A file that is open is read again where it stands, and arms nothing for later.
TEST_F(ViewModelTest, OpeningWhatIsOpenReadsItAgain) {
  const std::string file = write("here.las", 0, 50);
  ViewModel& model = show(start(file));
  turn(model);
  const ViewCamera turned = model.request().camera;
  write("here.las", 0, 60);
  model.open({file}, false);
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.scene.loaded()->points_read, 3600u);
  EXPECT_EQ(model.request().camera, turned);
  hide_class(model, 6);
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().camera, turned);
}

// The render client that is done with the last points does not end the reading of the next ones.
TEST_F(ViewModelTest, IsLoadingUntilTheNewestFilesAreThere) {
  const std::string file = write("here.las", 0), larger = write("larger.las", 0, 700);
  ViewModel& model = show(start(file));
  hide_class(model, 6);
  ASSERT_TRUE(wait(model, [&] { return model.scene.loaded()->points_shown == 1250; }));
  std::filesystem::rename(larger, file);
  model.open({file}, false);
  ASSERT_TRUE(wait(model, [&] { return model.scene.loading(); }));
  ASSERT_TRUE(wait(model, [&] { return !model.scene.loading(); }));
  EXPECT_EQ(model.scene.loaded()->points_read, 490000u);
  EXPECT_EQ(mistakes_, 0);
}

// What the render client refuses of the last points is nothing against the next ones.
TEST_F(ViewModelTest, SavesAPictureOfTheNewestFilesAlthoughTheLastWereRefused) {
  const std::string file = write("here.las", 0), larger = write("larger.las", 0, 700);
  ViewModel& model = show(start(file));
  model.change("rules", [](ViewRequest& request) {
    request.hide_classes = {6};
    request.items = {{"*", "points", {}, false}};
  });
  ASSERT_TRUE(wait(model, [&] { return model.scene.loaded()->points_shown == 1250; }));
  model.open({larger}, false);
  model.change("rules", [](ViewRequest& request) { request.items.clear(); });
  ASSERT_TRUE(wait(model, [&] { return model.scene.loading(); }));
  model.save_picture(64, 40);
  EXPECT_EQ(shots(model).size(), 1u);
  ASSERT_TRUE(settle(model));
  EXPECT_EQ(model.scene.loaded()->points_read, 490000u);
}

TEST_F(ViewModelTest, UndoOfWhatCannotBeOpenedLosesNothing) {
  Start sequence = start(write("f1.las", 0));
  sequence.frames = scene::files_of({sequence.request.files.front(), write("f2.las", 1)});
  ViewModel& model = show(sequence);
  turn(model);
  const ViewCamera turned = model.request().camera;
  model.open({(folder_ / "missing.las").string()}, false);
  ASSERT_TRUE(load(model));
  EXPECT_EQ(mistakes_, 1);
  EXPECT_TRUE(model.sequence.frames().empty());
  model.undo();
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().camera, turned);
  EXPECT_EQ(model.sequence.frames().size(), 2u);
}

// The old scene stays on the screen, but there is no command that draws it.
TEST_F(ViewModelTest, SavesNoPictureOfWhatCannotBeOpened) {
  const std::string here = write("here.las", 0);
  ViewModel& model = show(start(here));
  model.open({(folder_ / "missing.las").string()}, false);
  ASSERT_TRUE(load(model));
  ASSERT_EQ(mistakes_, 1);
  model.save_picture(64, 40);
  EXPECT_TRUE(shots(model).empty());
  EXPECT_EQ(mistakes_, 2);
  model.undo();
  ASSERT_TRUE(load(model));
  model.save_picture(64, 40);
  const std::vector<SavedPicture> saved = shots(model);
  ASSERT_EQ(saved.size(), 1u);
  EXPECT_THAT(saved[0].words, Contains(here));
}

TEST_F(ViewModelTest, SavesEveryPictureThatWasAskedForWhileFilesWereRead) {
  ViewModel model(start(write("here.las", 0)));
  model.set_size(320, 200);
  model.save_picture(64, 40);
  model.save_picture(80, 50);
  std::vector<SavedPicture> saved = shots(model);
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_EQ(saved[0].picture.image.width(), 64);
  EXPECT_EQ(saved[1].picture.image.width(), 80);
  ASSERT_TRUE(settle(model));
  EXPECT_EQ(saved[0].words, model.request().words(64, 40));
  // Each of them from where it was asked for.
  hide_class(model, 6);
  const ViewRequest first = model.request();
  model.save_picture(64, 40);
  turn(model);
  model.save_picture(64, 40);
  saved = shots(model);
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_EQ(saved[0].words, first.words(64, 40));
  EXPECT_EQ(ViewCamera::from(saved[0].picture.camera), first.camera);
  EXPECT_EQ(saved[1].words, model.request().words(64, 40));
  EXPECT_EQ(mistakes_, 0);
}

// What R goes back to belongs to the files that are shown.
TEST_F(ViewModelTest, ResetGoesToTheFirstViewOfTheFilesThatAreShown) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  ViewModel& model = show(start(here));
  const ViewCamera of_here = model.request().camera;
  model.open({there}, false);
  ASSERT_TRUE(load(model));
  const ViewCamera of_there = model.request().camera;
  model.undo();
  ASSERT_TRUE(load(model));
  turn(model);
  reset(model);
  EXPECT_EQ(model.request().camera, of_here);
  // A scene that says from where it is seen.
  ViewCamera above = of_there;
  above.position.z += 500;
  model.change("preset", [&](ViewRequest& next) { next.files = {there}, next.place(above); });
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.request().camera, above);
  turn(model);
  reset(model);
  EXPECT_EQ(model.request().camera, above);
  model.undo(), model.undo(), model.undo();
  ASSERT_TRUE(load(model));
  turn(model);
  reset(model);
  EXPECT_EQ(model.request().camera, of_here);
}

// Undo goes back to where the path was left, and then to where it was begun.
TEST_F(ViewModelTest, APathThatWasPlayedIsAStep) {
  ViewModel& model = show(start(write("here.las", 0)));
  model.path.seconds_per_key = 0.2;
  model.path.add(model.request().camera);
  turn(model);
  const ViewCamera last = model.request().camera;
  model.path.add(last);
  turn(model);
  const ViewCamera before = model.request().camera;
  model.play(true);
  ASSERT_TRUE(wait(model, [&] { return !model.playing(); }));
  EXPECT_EQ(model.request().camera, last);
  turn(model);
  model.undo();
  EXPECT_EQ(model.request().camera, last);
  model.undo();
  EXPECT_EQ(model.request().camera, before);
  // A hand that goes on takes over.
  model.path.seconds_per_key = 20;
  model.play(true);
  ASSERT_TRUE(wait(model, [&] { return model.request().camera != before; }));
  const ViewCamera left = model.request().camera;
  turn(model);
  EXPECT_FALSE(model.playing());
  model.undo();
  EXPECT_EQ(model.request().camera, left);
  model.undo();
  EXPECT_EQ(model.request().camera, before);
  model.play(true);
  ASSERT_TRUE(wait(model, [&] { return model.request().camera != before; }));
  model.undo();
  EXPECT_FALSE(model.playing());
  EXPECT_EQ(model.request().camera, before);
  // Nor is there anything to play without keys.
  model.play(true);
  model.path.clear();
  tick(model);
  EXPECT_FALSE(model.playing());
  EXPECT_EQ(model.request().camera, before);
}

TEST_F(ViewModelTest, ASequenceMayShowAFileTwice) {
  const std::string one = write("f1.las", 0), two = write("f2.las", 1);
  Start sequence = start(one);
  sequence.frames = scene::files_of({one, one, two, one});
  ViewModel& model = show(sequence);
  model.sequence.frames_per_second = 20;
  model.sequence.play(true);
  for (const std::size_t frame : {1u, 2u, 3u, 0u, 1u})
    ASSERT_TRUE(wait(model, [&] { return model.sequence.frame() == frame; })) << frame;
  model.sequence.play(false);
  model.show_frame(3);
  EXPECT_EQ(model.sequence.frame(), 3u);
  EXPECT_EQ(model.request().files, std::vector{one});
}

// Each frame stands where its transform puts it, and undo leaves the one that is shown.
TEST_F(ViewModelTest, FramesHaveTheirTransformsAndNoSteps) {
  Start sequence = start(write("f1.las", 0));
  sequence.frames = scene::files_of({sequence.request.files.front(), write("f2.las", 0)});
  dmat4 moved(1);
  moved[3] = {1000, 0, 0, 1};
  sequence.frames[1].transform = moved;
  ViewModel& model = show(sequence);
  model.show_frame(1);
  ASSERT_TRUE(load(model));
  EXPECT_NEAR(model.scene.loaded()->pose.subject.box.center().x, 1024.5, 1);
  EXPECT_THAT(model.request().words(1, 1), Contains("--transform=1: 1,0,0,1000,0,1,0,0,0,0,1,0,0,0,0,1"));
  model.change("shadows", [](ViewRequest& request) { request.set("shadows", "hard"); });
  model.undo();
  EXPECT_EQ(model.sequence.frame(), 1u);
  model.redo();
  EXPECT_EQ(model.sequence.frame(), 1u);
  model.show_frame(0);
  ASSERT_TRUE(load(model));
  EXPECT_NEAR(model.scene.loaded()->pose.subject.box.center().x, 24.5, 1);
}

TEST_F(ViewModelTest, WaitsForItsFirstFiles) {
  const std::string here = write("here.las", 0);
  Start start = ViewModelTest::start(here);
  start.request.files.clear();
  ViewModel model(std::move(start));
  model.set_size(320, 200);
  for (int i = 0; i < 20; ++i) tick(model);
  EXPECT_FALSE(model.scene.loading());
  EXPECT_FALSE(model.wait_ms(1e4));
  model.save_picture(64, 64);
  tick(model);
  EXPECT_EQ(mistakes_, 1) << "there is no picture to save";
  model.open({here}, false);
  ASSERT_TRUE(load(model));
  EXPECT_EQ(model.scene.loaded()->points_shown, 2500u);
  EXPECT_FALSE(model.fatal());
  EXPECT_FALSE(model.can_undo());
}

TEST_F(ViewModelTest, SaysWhatIsNoColour) {
  ViewModel model(start(write("here.las", 0)));
  model.change("one colour", [](ViewRequest& request) { set(request, "color", "blu"); });
  EXPECT_FALSE(model.request().color.solid);
  ASSERT_EQ(model.take_messages().size(), 1u);
}

}  // namespace
}  // namespace sfumato::view
