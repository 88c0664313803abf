// Slices of work: how large they become, and that the drivers' calls keep to them.
#include "gl/pace.h"

#include <mutex>
#include <epoxy/gl.h>

#include <functional>
#include <set>

#include "gl/draw.h"
#include "gl/state.h"
#include "passes/screen_pass.h"
#include "reference/gl_fixture.h"
#include "techniques/technique.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A pass of `count` pieces on a machine on which piece k takes `ms(k)`: the longest stretch, and how many.
struct Drawn {
  double longest = 0;
  int stretches = 0;
};
Drawn draw(gl::Stretches& stretches, std::uint64_t work, std::uint64_t count, double units,
           const std::function<double(std::uint64_t)>& ms) {
  Drawn drawn;
  double now = 0;
  for (std::uint64_t first = 0; first < count;) {
    const std::uint64_t n = stretches.take(work, count - first, units);
    for (std::uint64_t k = first; k < first + n; ++k) now += ms(k);
    first += n;
    if (n > 0 && first < count) continue;
    stretches.end(now);
    drawn.longest = std::max(drawn.longest, now);
    now = 0;
    ++drawn.stretches;
  }
  return drawn;
}

TEST(Stretches, LearnWhatWorkCosts) {
  gl::Stretches stretches;
  // A million points: 0.8 us each is the dearest pass there is, 0.05 us a cheap one.
  for (const double us : {0.05, 0.2, 0.8}) {
    const std::uint64_t work = std::uint64_t(100 * us);
    const auto ms = [&](std::uint64_t) { return us * 2.048; };
    EXPECT_LE(draw(stretches, work, 500, 2048, ms).longest, 50) << us;  // not known yet
    draw(stretches, work, 500, 2048, ms);
    const Drawn known = draw(stretches, work, 500, 2048, ms);
    EXPECT_LE(known.longest, 1.05 * gl::Stretches::target_ms) << us;
    EXPECT_LE(known.stretches, 1.2 * us * 1024 / gl::Stretches::target_ms + 2) << us;
  }
}

TEST(Stretches, BecomeShorterAtOnceWhereWorkIsDearer) {
  gl::Stretches stretches;
  for (int frame = 0; frame < 9; ++frame) draw(stretches, 1, 500, 2048, [](auto) { return 0.5; });
  // Three times as dear from one frame to the next, and again in the middle of one.
  EXPECT_LE(draw(stretches, 1, 500, 2048, [](auto) { return 1.5; }).longest, 50);
  EXPECT_LE(draw(stretches, 1, 500, 2048, [](std::uint64_t k) { return k < 250 ? 1.5 : 4.5; }).longest, 50);
}

TEST(Stretches, HoldSmallPassesTogether) {
  gl::Stretches stretches;
  for (int times = 0; times < 5; ++times)
    for (std::uint64_t work = 0; work < 7; ++work) draw(stretches, work, 10, 1000, [](auto) { return 0.02; });
  for (std::uint64_t work = 0; work < 7; ++work) EXPECT_EQ(stretches.take(work, 10, 1000), 10u) << work;
}

TEST(Stretches, AreAllTheSameWhereTheirUnitsAreGiven) {
  gl::Stretches stretches;
  EXPECT_EQ(stretches.take(1, 100, 64, 1000), 15u);
  EXPECT_EQ(stretches.take(1, 85, 64, 1000), 0u);
  stretches.end(1);
  EXPECT_EQ(stretches.take(1, 85, 4096, 1000), 1u) << "a piece cannot be cut";
}

TEST(Stretches, SpreadStepMeetsEveryPieceOnceAndAllPartsSoon) {
  for (const std::uint64_t count : {1, 2, 3, 4, 6, 12, 36, 61, 100, 8144}) {
    const std::uint64_t step = gl::spread_step(count);
    std::set<std::uint64_t> met, thirds;
    for (std::uint64_t k = 0; k < count; ++k) {
      met.insert(k * step % count);
      if (k < 6) thirds.insert(3 * (k * step % count) / count);
    }
    EXPECT_EQ(met.size(), count);
    if (count >= 12) EXPECT_EQ(thirds.size(), 3u) << count;
  }
}

/// What was handed to the driver since somebody asked whether to go on: the largest of it.
struct Submitted {
  static inline std::uint64_t invocations, pixels, items;
  static inline std::uint64_t most_invocations, most_pixels, most_items;
  static inline decltype(epoxy_glDispatchCompute) dispatch;
  static inline decltype(epoxy_glDrawArrays) draw_arrays;
  static inline decltype(epoxy_glDrawElements) draw_elements;
  static inline decltype(epoxy_glMultiDrawArrays) multi_draw;
  static inline decltype(epoxy_glDrawArraysIndirect) indirect;
  static inline bool any_indirect;

  static void GLAPIENTRY count_dispatch(GLuint x, GLuint y, GLuint z) {
    GLint program = 0, size[3];
    glGetIntegerv(GL_CURRENT_PROGRAM, &program);
    glGetProgramiv(GLuint(program), GL_COMPUTE_WORK_GROUP_SIZE, size);
    invocations += std::uint64_t(x) * y * z * std::uint64_t(size[0]) * std::uint64_t(size[1]);
    dispatch(x, y, z);
  }
  static void add_items(GLenum mode, GLsizei count) {
    items += std::uint64_t(mode == GL_POINTS ? count : count / 6);
  }
  static void GLAPIENTRY count_draw_arrays(GLenum mode, GLint first, GLsizei count) {
    GLint box[4];
    glGetIntegerv(glIsEnabled(GL_SCISSOR_TEST) ? GL_SCISSOR_BOX : GL_VIEWPORT, box);
    if (mode == GL_TRIANGLES && count == 3)
      pixels += std::uint64_t(box[2]) * std::uint64_t(box[3]);
    else
      add_items(mode, count);
    draw_arrays(mode, first, count);
  }
  static void GLAPIENTRY count_draw_elements(GLenum mode, GLsizei count, GLenum type, const void* at) {
    add_items(mode, count);
    draw_elements(mode, count, type, at);
  }
  static void GLAPIENTRY count_multi_draw(GLenum mode, const GLint* first, const GLsizei* count, GLsizei n) {
    for (GLsizei k = 0; k < n; ++k) add_items(mode, count[k]);
    multi_draw(mode, first, count, n);
  }
  static void GLAPIENTRY note_indirect(GLenum mode, const void* at) {
    any_indirect = true;
    indirect(mode, at);
  }
  static void ask() {
    most_invocations = std::max(most_invocations, std::exchange(invocations, 0));
    most_pixels = std::max(most_pixels, std::exchange(pixels, 0));
    most_items = std::max(most_items, std::exchange(items, 0));
  }

  Submitted() {
    most_invocations = most_pixels = most_items = invocations = pixels = items = 0;
    any_indirect = false;
    dispatch = std::exchange(epoxy_glDispatchCompute, count_dispatch);
    draw_arrays = std::exchange(epoxy_glDrawArrays, count_draw_arrays);
    draw_elements = std::exchange(epoxy_glDrawElements, count_draw_elements);
    multi_draw = std::exchange(epoxy_glMultiDrawArrays, count_multi_draw);
    indirect = std::exchange(epoxy_glDrawArraysIndirect, note_indirect);
  }
  ~Submitted() {
    epoxy_glDispatchCompute = dispatch;
    epoxy_glDrawArrays = draw_arrays;
    epoxy_glDrawElements = draw_elements;
    epoxy_glMultiDrawArrays = multi_draw;
    epoxy_glDrawArraysIndirect = indirect;
  }
  Submitted(const Submitted&) = delete;
  Submitted& operator=(const Submitted&) = delete;
};

class Asked final : public Progress {
 public:
  void update(double, std::string_view) override {}
  bool cancelled() const override {
    static std::mutex mutex;  // loops of the processor ask from several threads
    const std::lock_guard lock(mutex);
    Submitted::ask();
    return false;
  }
};

class Slices : public GlTest, public ::testing::WithParamInterface<std::string> {};

// Every technique, with shadows, ground, outlines and samples: no call escapes, none is larger than asked.
TEST_P(Slices, HoldNoMoreThanAsked) {
  if (!gl::limits().software) GTEST_SKIP() << "on a GPU passes stay whole";
  constexpr int units = 4096;
  const WithPreference limit(&gl::Preferences::slice_units, units);
  Renderer renderer(context());
  auto technique = find_technique(GetParam()).create();
  show(renderer, sphere_cloud(20000), technique->needs());
  RenderSettings settings;
  settings.shadows = Shadows::soft;
  settings.light_samples = 2;
  settings.ground = true;
  settings.edl.user = true;
  settings.smooth_outlines.user = true;
  Asked asked;
  const gl::Context::Use use(context());
  // The first call of a function finds it, in a way that would take the counter's place.
  const RenderOutput whole = renderer.render(*technique, front_camera(320, 200), settings);  // nobody to ask
  renderer.render(*technique, front_camera(320, 200), settings, {}, asked);
  const Submitted submitted;
  const RenderOutput cut = renderer.render(*technique, front_camera(320, 200), settings, {}, asked);
  Submitted::ask();
  EXPECT_TRUE(std::ranges::equal(cut.rgba8, whole.rgba8));
  // A row of work groups is not cut, nor a piece of 512 x 64 px.
  EXPECT_LE(Submitted::most_invocations, 8u * units);
  EXPECT_LE(Submitted::most_pixels, 512u * 64);
  EXPECT_LE(Submitted::most_items, units / gl::splat_units);
  EXPECT_FALSE(Submitted::any_indirect);
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const TechniqueInfo& info : all_techniques()) list.push_back(info.name);
  return list;
}
INSTANTIATE_TEST_SUITE_P(Of, Slices, ::testing::ValuesIn(names()),
                         [](const auto& param_info) { return param_info.param; });

// What a pass leaves out, it leaves out in slices as well.
TEST_F(GlTest, SlicesOfAScreenPassAreTheWholePass) {
  const gl::Context::Use use(context());
  gl::Texture depth("in", GL_R32F, 700, 300), whole("whole", GL_R32F, 88, 38);
  Image<float> values(700, 300);
  for (std::size_t i = 0; i < values.size(); ++i) values.data()[i] = float(i * 7919 % 10007);
  depth.upload(values);
  for (const ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    ScreenPass pass("passes/splat_farthest.glsl", {GL_R32F}, {}, kind);
    pass.run({&depth}, {&whole});
    const Image<float> expected = whole.download<float>();
    whole.clear(vec4(-1));
    const WithPreference limit(&gl::Preferences::slice_units, 1);
    Asked asked;
    const gl::Pace pace(asked);
    pass.run({&depth}, {&whole});
    EXPECT_TRUE(std::ranges::equal(expected, whole.download<float>()));
  }
}

}  // namespace
