// What the thread that reads gives, and in which order.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>
#include <thread>

#include "copc/build.h"
#include "io/io.h"
#include "unit/copc/scan.h"
#include "view/loader.h"

namespace sfumato::view {
namespace {

constexpr std::size_t many = 1'200'000;

std::filesystem::path place_of(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) /
         (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" + name);
}

/// Points 12 wide, 2 deep and `height` high, as a binary PLY.
std::string write_sheet(const std::string& name, std::size_t points, float height = 1) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < points; ++i)
    for (const float value : {float(i) * 1e-5f, float(i % 1000) * 1e-3f * height, float(i % 777) / 777 * 2})
      numbers.push_back(value);
  std::ofstream out(place_of(name), std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << points
      << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  out.write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size() * sizeof(float)));
  return place_of(name).string();
}

LoadJob job_of(const std::string& file, bool sample_first) {
  LoadJob job;
  job.id = 7;
  job.files = {{file, {}}};
  job.sample_first = sample_first;
  job.request.hide_classes.clear();  // nothing is left out
  return job;
}

/// All that comes until the whole, or what was wrong with it, is there.
std::vector<Loaded> all_of(LoadJob job) {
  Loader loader([] {});
  loader.load(std::move(job));
  std::vector<Loaded> all;
  for (int i = 0; i < 60'000; ++i) {
    while (auto loaded = loader.take()) all.push_back(std::move(*loaded));
    if (!all.empty() && !all.back().is_sample) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return all;
}

TEST(Loader, GivesASampleOfALargeFileAndThenTheWhole) {
  // Flat, so that there is no doubt which way is up.
  const std::vector<Loaded> all = all_of(job_of(write_sheet("a.ply", many, 0.05f), true));
  ASSERT_EQ(all.size(), 2u);
  const Loaded &sample = all[0], &whole = all[1];
  EXPECT_TRUE(sample.is_sample);
  EXPECT_EQ(sample.id, 7u);
  EXPECT_FALSE(sample.failure);
  EXPECT_TRUE(sample.whole.cloud.empty());
  EXPECT_LE(sample.sample.cloud.size(), Loader::most_sample);
  EXPECT_GT(sample.sample.cloud.size(), Loader::most_sample / 2);
  EXPECT_EQ(sample.points_read, many);
  ASSERT_TRUE(sample.near);
  EXPECT_EQ(sample.near->size(), sample.sample.cloud.size());
  EXPECT_EQ(whole.whole.cloud.size(), many);
  EXPECT_FALSE(whole.is_sample);
  // The first view of the sample is that of the whole, nearly.
  const double size = whole.box.diagonal();
  EXPECT_LT(glm::length(sample.box.min - whole.box.min), 0.01 * size);
  EXPECT_LT(glm::length(sample.box.max - whole.box.max), 0.01 * size);
  EXPECT_EQ(sample.pose.upright.up, whole.pose.upright.up);
}

TEST(Loader, GivesNoSampleWhereNoneIsWantedOrTheFileIsSmall) {
  EXPECT_EQ(all_of(job_of(write_sheet("a.ply", many), false)).size(), 1u);
  const std::vector<Loaded> small = all_of(job_of(write_sheet("b.ply", Loader::most_sample), true));
  ASSERT_EQ(small.size(), 1u);
  EXPECT_EQ(small[0].whole.cloud.size(), Loader::most_sample);
}

TEST(Loader, SaysBehindTheSampleWhatIsWrongWithTheRest) {
  const std::filesystem::path file = place_of("a.xyz");
  {
    std::ofstream out(file);
    for (std::size_t i = 0; i < many; ++i) out << i % 1000 << " " << i / 1000 << " 0\n";
    out << "1 nonsense 3\n";
    out << "1 2 3";
  }
  const std::vector<Loaded> all = all_of(job_of(file.string(), true));
  ASSERT_GE(all.size(), 1u);
  ASSERT_TRUE(all.back().failure);
  EXPECT_NE(all.back().failure->message.find("line 1200001"), std::string::npos)
      << all.back().failure->message;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_TRUE(all[0].is_sample);
  EXPECT_GT(all[0].points_shown, Loader::most_sample / 2);
}

TEST(Loader, AppliesTheSelectionToTheSample) {
  LoadJob job = job_of(write_sheet("a.ply", many), true);
  job.request.points.selection.crop = Bounds{dvec3(0, 0, 0), dvec3(6, 1, 2)};
  const std::vector<Loaded> all = all_of(job);
  ASSERT_EQ(all.size(), 2u);
  for (const Loaded& each : all) EXPECT_LE(each.near->world(each.near->size() - 1).x, 6.0);
  // A box that leaves nothing of the sample leaves no sample.
  job.request.points.selection.crop = Bounds{dvec3(100, 100, 100), dvec3(101, 101, 101)};
  const std::vector<Loaded> none = all_of(job);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_TRUE(none[0].failure);
}

TEST(Loader, ForgetsWhatANewerJobReplaces) {
  const std::string first = write_sheet("a.ply", many), second = write_sheet("b.ply", 1000);
  Loader loader([] {});
  loader.load(job_of(first, true));
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  LoadJob job = job_of(second, true);
  job.id = 8;
  loader.load(job);
  for (int i = 0; i < 60'000; ++i) {
    if (const auto loaded = loader.take()) {
      EXPECT_EQ(loaded->id, 8u);
      EXPECT_EQ(loaded->points_shown, 1000u);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  FAIL() << "nothing came";
}

/// Waits for what the newest job gives at the end.
Loaded whole_of(Loader& loader, LoadJob job) {
  loader.load(std::move(job));
  for (int i = 0; i < 60'000; ++i) {
    while (auto loaded = loader.take())
      if (!loaded->is_coarse || !loaded->whole.cloud.empty()) return std::move(*loaded);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

std::string build_scan(const std::string& name, const PointCloud& cloud) {
  const std::filesystem::path in = place_of("in.las"), out = place_of(name);
  io::write(in, cloud);
  copc::build({in}, out);
  return out.string();
}

LoadJob job_of_levels(const std::string& file) {
  LoadJob job = job_of(file, false);
  job.request.memory = 100'000 * scene::memory_of_point;  // fewer than there are
  return job;
}

TEST(Loader, KnowsOfFilesWithLevelsAlsoWhatIsLeftOut) {
  PointCloud cloud = test::scan(600'000);
  const std::string file = build_scan("a.copc.laz", cloud);
  const Bounds all = bounds(cloud);
  Loader loader([] {});
  LoadJob job = job_of_levels(file);
  job.request.points.selection.hide_classes = {6};
  job.request.points.selection.crop = Bounds{all.min, all.min + 0.5 * all.size()};
  const Loaded loaded = whole_of(loader, job);
  ASSERT_FALSE(loaded.failure) << loaded.failure->message;
  EXPECT_TRUE(loaded.follows_view);
  EXPECT_LT(bounds(loaded.whole.cloud).diagonal(), 0.7 * all.diagonal());
  EXPECT_LT(glm::length(loaded.box.min - all.min), 0.01);
  EXPECT_LT(glm::length(loaded.box.max - all.max), 0.01);
  ASSERT_EQ(loaded.classes.size(), 2u);
  EXPECT_EQ(loaded.classes[1].id, 6);
}

TEST(Loader, DecodesAgainWhatHasTakenTheNameOfAFile) {
  const std::string file = build_scan("a.copc.laz", test::scan(600'000));
  Loader loader([] {});
  const Loaded before = whole_of(loader, job_of_levels(file));
  ASSERT_FALSE(before.failure);
  PointCloud moved = test::scan(600'000);
  for (vec3& p : moved.positions) p.z += 50;
  std::filesystem::rename(build_scan("b.copc.laz", moved), file);
  const Loaded after = whole_of(loader, job_of_levels(file));
  ASSERT_FALSE(after.failure);
  EXPECT_NEAR(bounds(after.whole.cloud).min.z - bounds(before.whole.cloud).min.z, 50, 0.1);
}

TEST(Loader, LooksAtTheWholeWhereTheCoarseLevelsHoldNothingOfTheSelection) {
  PointCloud cloud = test::scan(600'000);
  Loader loader([] {});
  const Loaded coarse = whole_of(loader, job_of_levels(build_scan("a.copc.laz", cloud)));
  // Times tell points apart. One that the coarse levels lack becomes the only one of its class.
  const ScalarField* seen = coarse.whole.cloud.scalar("gps_time");
  ASSERT_TRUE(seen);
  std::vector<bool> is_coarse(cloud.size());
  for (std::size_t i = 0; i < seen->values.size(); ++i)
    is_coarse.at(std::size_t(std::lround((seen->value(i) - 1000) / 0.125))) = true;
  const std::size_t rare =
      std::size_t(std::find(is_coarse.begin(), is_coarse.end(), false) - is_coarse.begin());
  for (ScalarField& field : cloud.scalars)
    if (field.name == "classification") field.values.at(rare) = 17;
  LoadJob job = job_of_levels(build_scan("b.copc.laz", cloud));
  job.request.points.selection.show_classes = {17};
  const Loaded first = whole_of(loader, job);
  ASSERT_FALSE(first.failure) << first.failure->message;
  EXPECT_GT(first.whole.cloud.size(), 1000u);
  ASSERT_FALSE(first.notes.empty());
  EXPECT_NE(first.notes.back().find("nothing of the selection is in the coarse levels"), std::string::npos);
  // A view of its surroundings finds it.
  Camera camera;
  camera.target = cloud.world(rare);
  camera.position = camera.target + dvec3(1, 1, 2);
  camera.width = 320, camera.height = 200;
  job.seen = camera;
  const Loaded near = whole_of(loader, job);
  ASSERT_FALSE(near.failure) << near.failure->message;
  ASSERT_EQ(near.whole.cloud.size(), 1u);
  EXPECT_LT(glm::length(near.whole.cloud.world(0) - cloud.world(rare)), 0.002);
  // One of the sky does not, and says what it looked at.
  job.seen->target = camera.position + dvec3(0, 0, 500);
  job.seen->position = camera.position + dvec3(0, 1, 400);
  const Loaded sky = whole_of(loader, job);
  ASSERT_TRUE(sky.failure);
  EXPECT_NE(sky.failure->message.find("read for this view"), std::string::npos) << sky.failure->message;
}

TEST(Loader, IsGoneThoughAReadHangs) {
  // What hangs here is the call that tells of news, in the thread that reads: a system call could as well.
  std::promise<void> hangs, release;
  const auto released = release.get_future().share();
  std::atomic<int> calls = 0;
  {
    Loader loader([&hangs, &calls, released] {
      if (++calls > 1) return;
      hangs.set_value();
      released.wait();
    });
    loader.load(job_of(write_sheet("d.ply", many), false));
    hangs.get_future().wait();
  }  // a test that waits for ever fails here
  EXPECT_TRUE(Loader::has_left_work());
  release.set_value();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(calls, 1) << "called by a loader that is gone";
}

}  // namespace
}  // namespace sfumato::view
