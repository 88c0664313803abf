// Several view models over one scene: read once, in memory once, each with a view and a look of its own.
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

using Clock = std::chrono::steady_clock;

class SharedScenesTest : public ::testing::Test {
 protected:
  SharedScenesTest() {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("sfumato_shared_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    PointCloud cloud;
    ScalarField classes{"classification", 0, {}, StoredType::uint8};
    for (int i = 0; i < 2500; ++i) {
      cloud.positions.push_back({float(i % 50), float(i / 50), float(i % 7)});
      classes.values.push_back(i % 2 ? 2.0f : 6.0f);
    }
    cloud.scalars = {classes};
    file_ = (folder_ / "scan.las").string();
    io::write(file_, cloud);
  }
  ~SharedScenesTest() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<ViewModel> open(std::shared_ptr<SharedScenes> shared) const {
    Start start;
    start.request.files = {file_};
    start.request.technique = "points";
    start.wake = [] {};
    start.shared = std::move(shared);
    auto model = std::make_unique<ViewModel>(std::move(start));
    model->set_size(160, 100);
    return model;
  }
  void settle(std::initializer_list<ViewModel*> models) const {
    for (const auto from = Clock::now(); Clock::now() - from < std::chrono::minutes(1);) {
      bool all = true;
      for (ViewModel* model : models) {
        model->tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
        for (const Message& message : model->take_messages()) EXPECT_FALSE(message.is_error) << message.text;
        all = all && model->settled();
      }
      if (all) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    FAIL() << "the pictures did not come within a minute";
  }
  /// The last has so many points.
  void until(std::uint64_t points, std::initializer_list<ViewModel*> models) const {
    const ViewModel* last = *(models.end() - 1);
    for (const auto from = Clock::now(); Clock::now() - from < std::chrono::minutes(1);) {
      settle(models);
      if (last->scene.loaded()->points_shown == points) return;
    }
    FAIL() << "other points did not come within a minute";
  }
  static bool same(const Picture& a, const Picture& b) {
    return a.image.width() == b.image.width() && std::equal(a.image.begin(), a.image.end(), b.image.begin());
  }

  std::filesystem::path folder_;
  std::string file_;
  Clock::time_point began_ = Clock::now();
};

TEST_F(SharedScenesTest, SecondReadsNothingAndSharesThePoints) {
  const auto shared = std::make_shared<SharedScenes>();
  const auto first = open(shared);
  settle({first.get()});
  std::filesystem::remove(file_);  // whoever reads it now fails
  const auto second = open(shared);
  settle({first.get(), second.get()});
  EXPECT_EQ(first->scene.loaded()->near, second->scene.loaded()->near);
  EXPECT_EQ(first->memory().points, second->memory().points);
  EXPECT_TRUE(same(*first->picture(), *second->picture()));
}

TEST_F(SharedScenesTest, EachHasTheViewAndTheLookThatItHasAlone) {
  const auto look = [](ViewModel& model) {
    model.change("technique", [](ViewRequest& next) { next.technique = "splats"; });
    model.change("color", [](ViewRequest& next) { next.color.color_by = "classification"; });
    model.move("turn", [](Navigator& hand) { hand.rotate(40, 10, 100, dvec3(25, 25, 3)); });
  };
  const auto alone = open(nullptr), alone_with_look = open(nullptr);
  settle({alone.get(), alone_with_look.get()});
  look(*alone_with_look);
  settle({alone.get(), alone_with_look.get()});
  const auto shared = std::make_shared<SharedScenes>();
  const auto first = open(shared), second = open(shared);
  settle({first.get(), second.get()});
  look(*second);
  settle({first.get(), second.get()});
  first->repaint();
  settle({first.get(), second.get()});
  second->repaint();
  settle({first.get(), second.get()});
  EXPECT_TRUE(same(*first->picture(), *alone->picture()));
  EXPECT_TRUE(same(*second->picture(), *alone_with_look->picture()));
  EXPECT_FALSE(same(*first->picture(), *second->picture()));
}

TEST_F(SharedScenesTest, AnotherSelectionOfPointsIsNobodyElses) {
  const auto shared = std::make_shared<SharedScenes>();
  const auto first = open(shared);
  settle({first.get()});
  auto second = open(shared);
  settle({first.get(), second.get()});
  second->change("classes", [](ViewRequest& next) { next.hide_classes = {2}; });
  until(1250, {first.get(), second.get()});
  settle({first.get(), second.get()});
  EXPECT_EQ(first->scene.loaded()->points_shown, 2500u);
  EXPECT_EQ(second->scene.loaded()->points_shown, 1250u);
  EXPECT_FALSE(same(*first->picture(), *second->picture()));
  second->undo();  // what the first has is here
  std::filesystem::remove(file_);
  until(2500, {first.get(), second.get()});
  settle({first.get(), second.get()});
  EXPECT_TRUE(same(*first->picture(), *second->picture()));
  second.reset();
  first->repaint();
  settle({first.get()});
}

}  // namespace
}  // namespace sfumato::view
