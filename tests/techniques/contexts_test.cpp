// Renderers of their own: interleaved on a thread, side by side on two, one after the other.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <map>
#include <thread>

#include "reference/gl_fixture.h"
#include "sfumato/renderer.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

const std::vector<std::string> drawn{"points", "splats", "surface", "soft", "layers", "denoise"};

PointCloud cloud_of(int which) { return sphere_cloud(which == 0 ? 4000u : 7000u, which == 0 ? 1 : 0.7f); }

Pictures picture(HeadlessRenderer& renderer, const std::string& technique, int which) {
  return renderer.render(technique, front_camera(96 + 32 * which, 72), {{"shadows", "hard"}});
}

/// Each technique's picture of each cloud by a renderer that does nothing else.
std::map<std::pair<std::string, int>, Image<Rgba8>> alone() {
  std::map<std::pair<std::string, int>, Image<Rgba8>> pictures;
  for (const std::string& technique : drawn)
    for (int which : {0, 1}) {
      HeadlessRenderer renderer;
      renderer.set_cloud(cloud_of(which));
      pictures[{technique, which}] = picture(renderer, technique, which).color;
    }
  return pictures;
}

TEST(ContextsTest, InterleavedOnOneThread) {
  const auto expected = alone();
  HeadlessRenderer first;
  first.set_cloud(cloud_of(0));
  HeadlessRenderer second;
  second.set_cloud(cloud_of(1));
  for (const std::string& technique : drawn) {
    EXPECT_TRUE(std::ranges::equal(picture(first, technique, 0).color, expected.at({technique, 0})))
        << technique;
    EXPECT_TRUE(std::ranges::equal(picture(second, technique, 1).color, expected.at({technique, 1})))
        << technique;
  }
}

TEST(ContextsTest, SideBySideOnTwoThreads) {
  const auto expected = alone();
  const auto draw_all = [&](int which, std::vector<std::string>& wrong) {
    HeadlessRenderer renderer;
    renderer.set_cloud(cloud_of(which));
    for (const std::string& technique : drawn)
      if (!std::ranges::equal(picture(renderer, technique, which).color, expected.at({technique, which})))
        wrong.push_back(technique);
  };
  std::vector<std::string> wrong[2];
  std::thread other(draw_all, 1, std::ref(wrong[1]));
  draw_all(0, wrong[0]);
  other.join();
  for (const auto& each : wrong) EXPECT_TRUE(each.empty()) << each.front();
}

TEST(ContextsTest, ARendererThatGoesTakesNothingWithIt) {
  HeadlessRenderer stays;
  stays.set_cloud(cloud_of(0));
  const Image<Rgba8> before = picture(stays, "splats", 0).color;
  {
    HeadlessRenderer goes;
    goes.set_cloud(cloud_of(1));
    picture(goes, "strokes", 1);
  }
  EXPECT_TRUE(std::ranges::equal(picture(stays, "splats", 0).color, before));
  EXPECT_TRUE(std::any_of(before.begin(), before.end(), [](const Rgba8& c) {
    return !(c == Rgba8{255, 255, 255, 255});
  }));
}

/// A program's own context, current on this thread, on the display that renderers choose: one a process.
class Program {
 public:
  Program() {
    {
      const std::unique_ptr<gl::Context> probe = gl::Context::create_headless();
      display_ = eglGetCurrentDisplay();
    }
    eglInitialize(display_, nullptr, nullptr);
    eglBindAPI(EGL_OPENGL_API);
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, nullptr);
    make_current();
  }
  ~Program() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  bool make_current() { return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }
  bool is_current() const { return context_ != EGL_NO_CONTEXT && eglGetCurrentContext() == context_; }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

TEST(ContextsTest, TheProgramsOwnContextStaysCurrent) {
  Program program;
  ASSERT_TRUE(program.is_current());
  HeadlessRenderer renderer;
  EXPECT_TRUE(program.is_current()) << "after one was made";
  renderer.set_cloud(cloud_of(0));
  picture(renderer, "points", 0);
  EXPECT_TRUE(program.is_current()) << "after a picture";
  { const HeadlessRenderer other; }
  EXPECT_TRUE(program.is_current()) << "after one has gone";
}

// What its renderers shared with the program, the display, is there when the last of them has gone.
TEST(ContextsTest, TheProgramsDisplayStays) {
  Program program;
  { const HeadlessRenderer renderer; }
  ASSERT_TRUE(program.make_current());
  ASSERT_TRUE(program.is_current());
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  EXPECT_TRUE(glIsTexture(texture));
}

TEST(ContextsTest, ARendererOfAnotherThreadIsRefused) {
  HeadlessRenderer renderer;
  renderer.set_cloud(cloud_of(0));
  std::string complaint;
  std::thread([&] {
    try {
      picture(renderer, "points", 0);
    } catch (const Error& error) {
      complaint = error.what();
    }
  }).join();
  EXPECT_NE(complaint.find("another thread"), std::string::npos) << complaint;
}

}  // namespace
