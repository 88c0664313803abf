// What a hand does one after the other: files opened, undone, read again, played.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "io/io.h"
#include "view/workbench.h"

namespace sfumato::view {
namespace {

using ::testing::Contains;
using Clock = std::chrono::steady_clock;

class WorkbenchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("sfumato_workbench_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    bench_.reset();
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
    start.wishes.files = {file};
    start.wishes.technique = "points";
    start.wake = [] {};
    return start;
  }

  /// What `start` names, in a small window, whole.
  Workbench& show(const Start& start) {
    bench_ = std::make_unique<Workbench>(start);
    bench_->set_size(320, 200);
    EXPECT_TRUE(settle(*bench_));
    return *bench_;
  }
  void tick(Workbench& bench) {
    bench.tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
    for (const Message& message : bench.take_messages()) mistakes_ += message.is_error;
  }
  /// Ticks until the bench has what it wants; false when that takes a minute.
  bool wait(Workbench& bench, const std::function<bool()>& done) {
    for (const auto from = Clock::now(); Clock::now() - from < std::chrono::minutes(1);) {
      tick(bench);
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  bool settle(Workbench& bench) {
    return wait(bench, [&] { return bench.settled(); });
  }
  /// What was just wished for is read, or refused.
  bool load(Workbench& bench) {
    return wait(bench, [&] { return bench.scene.loading(); }) && settle(bench);
  }
  /// The pictures that were asked for, once all of them are there.
  std::vector<Shot> shots(Workbench& bench) {
    EXPECT_TRUE(wait(bench, [&] { return !bench.shots.pending(); }));
    return bench.shots.take();
  }
  static void reset(Workbench& bench) {
    bench.move("reset", [&](Navigator& hand) { hand.set_camera(bench.wishes().home); });
  }
  static void turn(Workbench& bench) {
    bench.move("turn", [](Navigator& hand) { hand.rotate(40, 10, 200, hand.camera().target); });
  }
  static void hide_class(Workbench& bench, int id) {
    bench.change("classes", [&](Wishes& wishes) { wishes.hide_classes = {id}; });
  }

  std::filesystem::path folder_;
  std::unique_ptr<Workbench> bench_;
  Clock::time_point began_ = Clock::now();
  int mistakes_ = 0;
};

TEST_F(WorkbenchTest, UndoGoesBackToViewsThatWereSeen) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  Workbench& bench = show(start(here));
  turn(bench);
  const ViewCamera of_here = bench.wishes().camera;
  bench.open({there}, false);
  ASSERT_TRUE(load(bench));
  const ViewCamera of_there = bench.wishes().camera;
  EXPECT_GT(of_there.target.x, 5000);
  turn(bench);
  bench.undo();
  EXPECT_EQ(bench.wishes().files, std::vector{there});
  EXPECT_EQ(bench.wishes().camera, of_there);
  bench.undo();
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().files, std::vector{here});
  EXPECT_EQ(bench.wishes().camera, of_here);
  bench.redo();
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().camera, of_there);
  EXPECT_EQ(mistakes_, 0);
}

// What is undone before it was seen is framed when it comes back.
TEST_F(WorkbenchTest, RedoFramesWhatWasNeverSeen) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  Workbench& bench = show(start(here));
  turn(bench);
  const ViewCamera of_here = bench.wishes().camera;
  bench.open({there}, false);
  bench.undo();
  hide_class(bench, 6);
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().camera, of_here);
  bench.undo();
  bench.open({there}, false);
  bench.undo();
  bench.redo();
  ASSERT_TRUE(load(bench));
  EXPECT_GT(bench.wishes().camera.target.x, 5000);
}

TEST_F(WorkbenchTest, UndoKeepsTheTechniqueThatWasChosen) {
  Start unsettled = start(write("here.las", 0));
  unsettled.wishes.technique.clear();
  unsettled.settle = [](const TechniqueChoice&) { return TechniqueChoice{"splats", "for a test"}; };
  Workbench bench(unsettled);
  bench.set_size(320, 200);
  ASSERT_TRUE(wait(bench, [&] { return bench.scene.loaded() != nullptr; }));
  ASSERT_TRUE(bench.wishes().technique.empty());
  turn(bench);
  ASSERT_TRUE(wait(bench, [&] { return !bench.wishes().technique.empty(); }));
  EXPECT_EQ(bench.wishes().technique, "splats");
  bench.undo();
  EXPECT_EQ(bench.wishes().technique, "splats");
  EXPECT_EQ(bench.scene.reason(), "for a test");
}

// A file that is open is read again where it stands, and arms nothing for later.
TEST_F(WorkbenchTest, OpeningWhatIsOpenReadsItAgain) {
  const std::string file = write("here.las", 0, 50);
  Workbench& bench = show(start(file));
  turn(bench);
  const ViewCamera turned = bench.wishes().camera;
  write("here.las", 0, 60);
  bench.open({file}, false);
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.scene.loaded()->points_read, 3600u);
  EXPECT_EQ(bench.wishes().camera, turned);
  hide_class(bench, 6);
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().camera, turned);
}

// The painter that is done with the last points does not end the reading of the next ones.
TEST_F(WorkbenchTest, IsLoadingUntilTheNewestFilesAreThere) {
  const std::string file = write("here.las", 0), larger = write("larger.las", 0, 700);
  Workbench& bench = show(start(file));
  hide_class(bench, 6);
  ASSERT_TRUE(wait(bench, [&] { return bench.scene.loaded()->points_shown == 1250; }));
  std::filesystem::rename(larger, file);
  bench.open({file}, false);
  ASSERT_TRUE(wait(bench, [&] { return bench.scene.loading(); }));
  ASSERT_TRUE(wait(bench, [&] { return !bench.scene.loading(); }));
  EXPECT_EQ(bench.scene.loaded()->points_read, 490000u);
  EXPECT_EQ(mistakes_, 0);
}

// What the painter refuses of the last points is nothing against the next ones.
TEST_F(WorkbenchTest, SavesAPictureOfTheNewestFilesAlthoughTheLastWereRefused) {
  const std::string file = write("here.las", 0), larger = write("larger.las", 0, 700);
  Workbench& bench = show(start(file));
  bench.change("rules", [](Wishes& wishes) {
    wishes.hide_classes = {6};
    wishes.items = {{"*", "points", {}, false}};
  });
  ASSERT_TRUE(wait(bench, [&] { return bench.scene.loaded()->points_shown == 1250; }));
  bench.open({larger}, false);
  bench.change("rules", [](Wishes& wishes) { wishes.items.clear(); });
  ASSERT_TRUE(wait(bench, [&] { return bench.scene.loading(); }));
  bench.shoot(64, 40);
  EXPECT_EQ(shots(bench).size(), 1u);
  ASSERT_TRUE(settle(bench));
  EXPECT_EQ(bench.scene.loaded()->points_read, 490000u);
}

TEST_F(WorkbenchTest, UndoOfWhatCannotBeOpenedLosesNothing) {
  Start sequence = start(write("f1.las", 0));
  sequence.frames = scene::files_of({sequence.wishes.files.front(), write("f2.las", 1)});
  Workbench& bench = show(sequence);
  turn(bench);
  const ViewCamera turned = bench.wishes().camera;
  bench.open({(folder_ / "missing.las").string()}, false);
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(mistakes_, 1);
  EXPECT_TRUE(bench.sequence.frames().empty());
  bench.undo();
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().camera, turned);
  EXPECT_EQ(bench.sequence.frames().size(), 2u);
}

// The old scene stays on the screen, but there is no command that draws it.
TEST_F(WorkbenchTest, SavesNoPictureOfWhatCannotBeOpened) {
  const std::string here = write("here.las", 0);
  Workbench& bench = show(start(here));
  bench.open({(folder_ / "missing.las").string()}, false);
  ASSERT_TRUE(load(bench));
  ASSERT_EQ(mistakes_, 1);
  bench.shoot(64, 40);
  EXPECT_TRUE(shots(bench).empty());
  EXPECT_EQ(mistakes_, 2);
  bench.undo();
  ASSERT_TRUE(load(bench));
  bench.shoot(64, 40);
  const std::vector<Shot> saved = shots(bench);
  ASSERT_EQ(saved.size(), 1u);
  EXPECT_THAT(saved[0].words, Contains(here));
}

TEST_F(WorkbenchTest, SavesEveryPictureThatWasAskedForWhileFilesWereRead) {
  Workbench bench(start(write("here.las", 0)));
  bench.set_size(320, 200);
  bench.shoot(64, 40);
  bench.shoot(80, 50);
  std::vector<Shot> saved = shots(bench);
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_EQ(saved[0].picture.image.width(), 64);
  EXPECT_EQ(saved[1].picture.image.width(), 80);
  ASSERT_TRUE(settle(bench));
  EXPECT_EQ(saved[0].words, bench.wishes().words(64, 40));
  // Each of them from where it was asked for.
  hide_class(bench, 6);
  const Wishes first = bench.wishes();
  bench.shoot(64, 40);
  turn(bench);
  bench.shoot(64, 40);
  saved = shots(bench);
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_EQ(saved[0].words, first.words(64, 40));
  EXPECT_EQ(ViewCamera::from(saved[0].picture.camera), first.camera);
  EXPECT_EQ(saved[1].words, bench.wishes().words(64, 40));
  EXPECT_EQ(mistakes_, 0);
}

// What R goes back to belongs to the files that are shown.
TEST_F(WorkbenchTest, ResetGoesToTheFirstViewOfTheFilesThatAreShown) {
  const std::string here = write("here.las", 0), there = write("there.las", 5000);
  Workbench& bench = show(start(here));
  const ViewCamera of_here = bench.wishes().camera;
  bench.open({there}, false);
  ASSERT_TRUE(load(bench));
  const ViewCamera of_there = bench.wishes().camera;
  bench.undo();
  ASSERT_TRUE(load(bench));
  turn(bench);
  reset(bench);
  EXPECT_EQ(bench.wishes().camera, of_here);
  // A scene that says from where it is seen.
  ViewCamera above = of_there;
  above.position.z += 500;
  bench.change("preset", [&](Wishes& next) { next.files = {there}, next.place(above); });
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.wishes().camera, above);
  turn(bench);
  reset(bench);
  EXPECT_EQ(bench.wishes().camera, above);
  bench.undo(), bench.undo(), bench.undo();
  ASSERT_TRUE(load(bench));
  turn(bench);
  reset(bench);
  EXPECT_EQ(bench.wishes().camera, of_here);
}

// Undo goes back to where the path was left, and then to where it was begun.
TEST_F(WorkbenchTest, APathThatWasPlayedIsAStep) {
  Workbench& bench = show(start(write("here.las", 0)));
  bench.path.seconds_per_key = 0.2;
  bench.path.add(bench.wishes().camera);
  turn(bench);
  const ViewCamera last = bench.wishes().camera;
  bench.path.add(last);
  turn(bench);
  const ViewCamera before = bench.wishes().camera;
  bench.play(true);
  ASSERT_TRUE(wait(bench, [&] { return !bench.playing(); }));
  EXPECT_EQ(bench.wishes().camera, last);
  turn(bench);
  bench.undo();
  EXPECT_EQ(bench.wishes().camera, last);
  bench.undo();
  EXPECT_EQ(bench.wishes().camera, before);
  // A hand that goes on takes over.
  bench.path.seconds_per_key = 20;
  bench.play(true);
  ASSERT_TRUE(wait(bench, [&] { return bench.wishes().camera != before; }));
  const ViewCamera left = bench.wishes().camera;
  turn(bench);
  EXPECT_FALSE(bench.playing());
  bench.undo();
  EXPECT_EQ(bench.wishes().camera, left);
  bench.undo();
  EXPECT_EQ(bench.wishes().camera, before);
  bench.play(true);
  ASSERT_TRUE(wait(bench, [&] { return bench.wishes().camera != before; }));
  bench.undo();
  EXPECT_FALSE(bench.playing());
  EXPECT_EQ(bench.wishes().camera, before);
  // Nor is there anything to play without keys.
  bench.play(true);
  bench.path.clear();
  tick(bench);
  EXPECT_FALSE(bench.playing());
  EXPECT_EQ(bench.wishes().camera, before);
}

TEST_F(WorkbenchTest, ASequenceMayShowAFileTwice) {
  const std::string one = write("f1.las", 0), two = write("f2.las", 1);
  Start sequence = start(one);
  sequence.frames = scene::files_of({one, one, two, one});
  Workbench& bench = show(sequence);
  bench.sequence.frames_per_second = 20;
  bench.sequence.play(true);
  for (const std::size_t frame : {1u, 2u, 3u, 0u, 1u})
    ASSERT_TRUE(wait(bench, [&] { return bench.sequence.frame() == frame; })) << frame;
  bench.sequence.play(false);
  bench.show_frame(3);
  EXPECT_EQ(bench.sequence.frame(), 3u);
  EXPECT_EQ(bench.wishes().files, std::vector{one});
}

// Each frame stands where its transform puts it, and undo leaves the one that is shown.
TEST_F(WorkbenchTest, FramesHaveTheirTransformsAndNoSteps) {
  Start sequence = start(write("f1.las", 0));
  sequence.frames = scene::files_of({sequence.wishes.files.front(), write("f2.las", 0)});
  dmat4 moved(1);
  moved[3] = {1000, 0, 0, 1};
  sequence.frames[1].transform = moved;
  Workbench& bench = show(sequence);
  bench.show_frame(1);
  ASSERT_TRUE(load(bench));
  EXPECT_NEAR(bench.scene.loaded()->pose.subject.box.center().x, 1024.5, 1);
  EXPECT_THAT(bench.wishes().words(1, 1), Contains("--transform=1: 1,0,0,1000,0,1,0,0,0,0,1,0,0,0,0,1"));
  bench.change("shadows", [](Wishes& wishes) { wishes.set("shadows", "hard"); });
  bench.undo();
  EXPECT_EQ(bench.sequence.frame(), 1u);
  bench.redo();
  EXPECT_EQ(bench.sequence.frame(), 1u);
  bench.show_frame(0);
  ASSERT_TRUE(load(bench));
  EXPECT_NEAR(bench.scene.loaded()->pose.subject.box.center().x, 24.5, 1);
}

TEST_F(WorkbenchTest, WaitsForItsFirstFiles) {
  const std::string here = write("here.las", 0);
  Start start = WorkbenchTest::start(here);
  start.wishes.files.clear();
  Workbench bench(std::move(start));
  bench.set_size(320, 200);
  for (int i = 0; i < 20; ++i) tick(bench);
  EXPECT_FALSE(bench.scene.loading());
  EXPECT_FALSE(bench.wait_ms(1e4));
  bench.shoot(64, 64);
  tick(bench);
  EXPECT_EQ(mistakes_, 1) << "there is no picture to save";
  bench.open({here}, false);
  ASSERT_TRUE(load(bench));
  EXPECT_EQ(bench.scene.loaded()->points_shown, 2500u);
  EXPECT_FALSE(bench.fatal());
  EXPECT_FALSE(bench.can_undo());
}

TEST_F(WorkbenchTest, SaysWhatIsNoColour) {
  Workbench bench(start(write("here.las", 0)));
  bench.change("one colour", [](Wishes& wishes) { set(wishes, "color", "blu"); });
  EXPECT_FALSE(bench.wishes().color.solid);
  ASSERT_EQ(bench.take_messages().size(), 1u);
}

}  // namespace
}  // namespace sfumato::view
