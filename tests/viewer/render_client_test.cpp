// Render clients that are asked for much at once, and render clients when the driver fails them: faults are
// put in the place of the driver's own functions.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "view/render_client.h"

namespace sfumato::view {
namespace {

using ::testing::HasSubstr;

GLenum GLAPIENTRY reset_by_us() { return GL_GUILTY_CONTEXT_RESET; }
GLenum GLAPIENTRY no_memory() { return GL_OUT_OF_MEMORY; }

class RenderClientTest : public ::testing::Test {
 protected:
  RenderClientTest() : client_(std::make_shared<RenderClient::Gate>(1), [] {}) {
    SceneJob job = scene(1, 4000);
    pose_ = job.pose;
    client_.show(std::move(job));
    EXPECT_TRUE(std::holds_alternative<SceneReady>(next()));
  }

  static SceneJob scene(std::uint64_t id, int points) {
    SceneJob job;
    job.id = id;
    for (int i = 0; i < points; ++i)
      job.scene.cloud.positions.push_back({float(i % 63), float(i / 63), float(i % 7)});
    job.pose = stand_upright(job.scene);
    return job;
  }
  Answer next() {
    for (int i = 0; i < 60'000; ++i) {
      if (waiting_.empty()) waiting_ = client_.take_answers();
      if (!waiting_.empty()) {
        Answer first = std::move(waiting_.front());
        waiting_.erase(waiting_.begin());
        return first;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "no answer within a minute";
    return JobCancelled{};
  }
  PictureJob picture(std::uint64_t id, int width, const std::string& technique = "points") {
    PictureJob job;
    job.id = id;
    job.technique = technique;
    job.camera = first_view(pose_, width, 200);
    return job;
  }
  Answer paint(std::uint64_t id, int width) {
    client_.render_to_keep(picture(id, width));
    return next();
  }

  RenderClient client_;
  Pose pose_;
  std::vector<Answer> waiting_;
};

// A hand that goes on does not lose the pictures it has saved, nor get them of other points.
TEST_F(RenderClientTest, FinishesPicturesForKeepsBeforeTheNextScene) {
  const Answer first = paint(2, 200);
  ASSERT_TRUE(std::holds_alternative<Picture>(first));
  client_.render_to_keep(picture(3, 200, "strokes"));
  while (client_.activity().text.empty()) std::this_thread::yield();  // it is under way
  client_.render_to_keep(picture(4, 200));
  client_.show(scene(5, 2000));
  const Answer under_way = next(), waiting = next(), shown = next();
  ASSERT_TRUE(std::holds_alternative<Picture>(under_way));
  EXPECT_EQ(std::get<Picture>(under_way).id, 3u);
  ASSERT_TRUE(std::holds_alternative<Picture>(waiting));
  EXPECT_EQ(std::get<Picture>(waiting).id, 4u);
  EXPECT_EQ(std::get<Picture>(waiting).points_drawn, std::get<Picture>(first).points_drawn);
  ASSERT_TRUE(std::holds_alternative<SceneReady>(shown));
  EXPECT_EQ(std::get<SceneReady>(shown).points, 2000u);
}

// Whoever moves on is told so, and no error.
TEST_F(RenderClientTest, ACancelledPictureIsNoFailure) {
  int cancelled = 0;
  for (std::uint64_t id = 2; id < 22; ++id) {
    client_.render(picture(id, 800, "strokes"));
    while (client_.activity().text.empty() && waiting_.empty()) waiting_ = client_.take_answers();
    client_.cancel();
    const Answer answer = next();
    ASSERT_FALSE(std::holds_alternative<Failure>(answer)) << std::get<Failure>(answer).message;
    cancelled += std::holds_alternative<JobCancelled>(answer);
  }
  EXPECT_GT(cancelled, 0);
}

// While nothing is asked for the thread goes through its render clients: for `make tsan`.
TEST(RenderThreadTest, ClientsComeWhileItMeasuresAhead) {
  const auto thread = RenderClient::make_thread(std::make_shared<RenderClient::Gate>(1));
  std::vector<std::unique_ptr<RenderClient>> clients;
  for (int i = 0; i < 2500; ++i) {
    clients.push_back(std::make_unique<RenderClient>(thread, [] {}));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(clients.back()->renderer_name().empty());
}

TEST_F(RenderClientTest, SaysThatGraphicsMemoryIsFullAndGoesOn) {
  ASSERT_TRUE(std::holds_alternative<Picture>(paint(2, 200)));
  const auto real = epoxy_glGetError;
  epoxy_glGetError = no_memory;
  const Answer answer = paint(3, 300);
  epoxy_glGetError = real;
  ASSERT_TRUE(std::holds_alternative<Failure>(answer));
  EXPECT_EQ(std::get<Failure>(answer).id, 3u);
  EXPECT_EQ(std::get<Failure>(answer).code, ErrorCode::out_of_memory);
  EXPECT_THAT(std::get<Failure>(answer).message, HasSubstr("out of graphics memory"));
  const Answer after = paint(4, 250);
  ASSERT_TRUE(std::holds_alternative<Picture>(after));
  EXPECT_EQ(std::get<Picture>(after).image.width(), 250);
}

TEST_F(RenderClientTest, SaysThatTheDriverWasResetAndEnds) {
  ASSERT_TRUE(std::holds_alternative<Picture>(paint(2, 200)));
  const auto real = epoxy_glGetGraphicsResetStatus;
  epoxy_glGetGraphicsResetStatus = reset_by_us;
  Answer answer = paint(3, 200);
  if (!std::holds_alternative<Failure>(answer)) answer = next();  // its last picture
  epoxy_glGetGraphicsResetStatus = real;
  ASSERT_TRUE(std::holds_alternative<Failure>(answer));
  EXPECT_EQ(std::get<Failure>(answer).id, 0u);  // of no job: nothing more can be drawn
  EXPECT_EQ(std::get<Failure>(answer).code, ErrorCode::no_gl);
  EXPECT_THAT(std::get<Failure>(answer).message, HasSubstr("driver was reset"));
}

}  // namespace
}  // namespace sfumato::view
