// What the thread that reads gives, and in which order.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <future>
#include <thread>

#include "view/loader.h"

namespace sfumato::view {
namespace {

constexpr std::size_t many = 1'200'000;

std::filesystem::path place_of(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) /
         (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" + name);
}

/// A sheet of points 1 high and 2 deep, as a binary PLY, and a last point far above it.
std::string write_sheet(const std::string& name, std::size_t points) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < points; ++i)
    for (const float value : {float(i) * 1e-5f, float(i % 1000) * 1e-3f, float(i % 777) / 777 * 2})
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
  const std::vector<Loaded> all = all_of(job_of(write_sheet("a.ply", many), true));
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
  job.options.selection.crop = Bounds{dvec3(0, 0, 0), dvec3(6, 1, 2)};
  const std::vector<Loaded> all = all_of(job);
  ASSERT_EQ(all.size(), 2u);
  for (const Loaded& each : all) EXPECT_LE(each.near->world(each.near->size() - 1).x, 6.0);
  // A box that leaves nothing of the sample leaves no sample.
  job.options.selection.crop = Bounds{dvec3(100, 100, 100), dvec3(101, 101, 101)};
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
