// The A-buffer of strokes: at once and step by step, in one piece and in bands, on the processor and on the
// GPU.

#include "reference/stroke_scenes.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// Where fragments are listed: the processor on software GL, the GPU elsewhere.
struct ListedOn : WithPreference<gl::Place> {
  explicit ListedOn(const std::string& place)
      : WithPreference(&gl::Preferences::stroke_lists, place == "cpu" ? gl::Place::cpu : gl::Place::gpu) {}
};

using ListsTest = GlTest;

/// Draws the next picture of the view; whether all of its strokes are sorted.
bool sorted(StrokeScene& scene) {
  EXPECT_TRUE(scene.step());
  for (const std::string& note : scene.technique->notes())
    if (note.find("not sorted") != std::string::npos) return false;
  return true;
}

const char* const software_only = "the processor fills the lists of software GL only, where they lie";

class StrokeListsTest : public GlTest, public ::testing::WithParamInterface<const char*> {
  void SetUp() override {
    GlTest::SetUp();
    if (GetParam() == std::string("cpu") && !gl::limits().software) GTEST_SKIP() << software_only;
  }
  const ListedOn listed_on_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Places, StrokeListsTest, ::testing::Values("cpu", "gpu"),
                         [](const auto& place) { return std::string(place.param); });

TEST_P(StrokeListsTest, RefiningStepByStepEndsInTheSameBits) {
  for (const char* order : {"stroke", "fragment"})
    for (auto [style, sort_steps] : {std::pair{"oil", "1"}, {"watercolor", "1"}, {"watercolor", "3"}}) {
      StrokeScene at_once(two_spheres()), by_step(two_spheres());
      for (StrokeScene* s : {&at_once, &by_step}) s->set("stroke_order", order), s->set("style", style);
      by_step.set("refine", "per_frame");
      by_step.set("sort_steps", sort_steps);
      by_step.set("min_sorted", "0");
      ASSERT_TRUE(at_once.step());
      int frames = 1;
      Image<vec4> before(112, 80);
      bool done = sorted(by_step);
      EXPECT_FALSE(done);  // the frame that builds the lists shows the blurred picture
      for (; !done && frames < 200; ++frames) {
        done = sorted(by_step);
        const Image<vec4> now = by_step.picture();
        // Transmittance falls: every step covers as much as the one before, or more.
        for (std::size_t i = 0; frames > 1 && i < now.size(); ++i)
          ASSERT_GE(now.data()[i].a, before.data()[i].a - 1e-6f);
        before = now;
      }
      EXPECT_GT(frames, 3);
      const Image<vec4> a = at_once.picture(), b = by_step.picture();
      for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], b.data()[i]) << order << style << i;
    }
}

// What stands in until fragments are sorted is taken from the lists; the moving picture from a depth buffer.
TEST_P(StrokeListsTest, TheFirstFrameOfARefinementIsTheBlurredPicture) {
  for (const char* order : {"stroke", "fragment"}) {
    StrokeScene moving(two_spheres()), stopped(two_spheres());
    for (StrokeScene* s : {&moving, &stopped}) s->set("stroke_order", order);
    moving.set("blend", "blur");
    stopped.set("refine", "per_frame");
    ASSERT_TRUE(moving.step());
    ASSERT_FALSE(sorted(stopped));
    const Image<vec4> a = moving.picture(), b = stopped.picture();
    ASSERT_FALSE(sorted(stopped));  // fewer steps than `min_sorted`: blurred once more, from a depth buffer
    const Image<vec4> again = stopped.picture();
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], again.data()[i]) << i;
    std::size_t covered = 0, apart = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      covered += a.data()[i].a > 0.5f;
      apart += glm::distance(a.data()[i], b.data()[i]) > 1 / 255.0f;
    }
    EXPECT_GT(covered, a.size() / 10);
    // Strokes as near as each other to the last bits of a depth buffer: their pixels, and those the blur
    // mixes with them. 0 on llvmpipe; on an H200 .3 % of the pixels by fragments, by .01 at most.
    EXPECT_LE(apart, a.size() / 200) << order;
  }
}

TEST_F(ListsTest, AChangeStartsOver) {
  StrokeScene scene(two_spheres());
  scene.set("refine", "per_frame");
  scene.set("min_sorted", "0");
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(sorted(scene));
  scene.camera.position.x += 0.5;
  for (int k = 0; k < 200 && !sorted(scene); ++k) {
  }
  const Image<vec4> moved = scene.picture();
  StrokeScene fresh(two_spheres());
  fresh.camera.position.x += 0.5;
  EXPECT_TRUE(fresh.step());
  const Image<vec4> expected = fresh.picture();
  for (std::size_t i = 0; i < moved.size(); ++i) ASSERT_EQ(moved.data()[i], expected.data()[i]) << i;
}

TEST_P(StrokeListsTest, LittleMemoryMeansBandsAndNoLoss) {
  StrokeScene roomy(two_spheres()), narrow(two_spheres());
  for (StrokeScene* s : {&roomy, &narrow})
    s->set("opacity", "0.1"), s->set("coverage", "32"), s->set("stroke_length", "12"), s->set("detail", "0");
  narrow.set("fragment_memory", "1");
  ASSERT_TRUE(roomy.step());
  ASSERT_TRUE(narrow.step());
  const Image<vec4> a = roomy.picture(), b = narrow.picture();
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], b.data()[i]) << i;
  ASSERT_EQ(narrow.technique->notes().size(), 2u);
  EXPECT_NE(narrow.technique->notes()[1].find("bands, none left out"), std::string::npos);
  EXPECT_EQ(roomy.technique->notes().size(), 1u);
}

// A view needs more fragments than the one before, and the buffer grows; then fewer.
TEST_P(StrokeListsTest, ListsGrowWithTheView) {
  StrokeScene used(two_spheres());
  for (const char* coverage : {"1", "32", "2"}) {
    StrokeScene fresh(two_spheres());
    for (StrokeScene* s : {&used, &fresh}) s->set("opacity", "0.2"), s->set("coverage", coverage);
    ASSERT_TRUE(used.step());
    ASSERT_TRUE(fresh.step());
    const Image<vec4> a = used.picture(), b = fresh.picture();
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], b.data()[i]) << coverage << " " << i;
  }
}

// One pass on the processor against the depth test and the lists of the GPU: coincident points of other
// colours, strokes through the eye, both projections, paint that covers and paint that does not.
TEST_F(ListsTest, ListsOfTheProcessorAreThoseOfTheGpu) {
  if (!gl::limits().software) GTEST_SKIP() << software_only;
  PointCloud cloud = two_spheres();
  for (std::size_t i = 0; i < 500; ++i) cloud.positions[i] = cloud.positions[i + 500];
  for (const char* style : {"oil", "watercolor"})
    for (const char* view : {"perspective", "orthographic", "inside"}) {
      StrokeScene cpu(cloud), gpu(cloud);
      for (StrokeScene* s : {&cpu, &gpu}) {
        s->set("style", style);
        if (view == std::string("orthographic")) {
          s->camera.projection = Projection::orthographic;
          s->camera.height_world = 3;
        }
        if (view == std::string("inside")) s->camera.position = {-0.2, -0.3, 0.1};
        s->camera.fit_depth_range(s->gpu->bounds());
      }
      {
        const ListedOn listed_on("cpu");
        ASSERT_TRUE(cpu.step());
      }
      {
        const ListedOn listed_on("gpu");
        ASSERT_TRUE(gpu.step());
      }
      const Image<vec4> a = cpu.picture(), b = gpu.picture();
      std::size_t covered = 0, apart = 0;
      double mean = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        covered += a.data()[i].a > 0.5f;
        apart += glm::distance(a.data()[i], b.data()[i]) > 1e-3f;
        mean += glm::distance(a.data()[i], b.data()[i]) / double(a.size());
      }
      EXPECT_GT(covered, a.size() / 10);
      // Fragments within a rounding of what is seen, of what is opaque, or of the border of a quad: a pixel
      // in a hundred.
      EXPECT_LE(apart, a.size() / 100) << style << " " << view;
      EXPECT_LT(mean, 1e-4) << style << " " << view;
    }
}

}  // namespace
