// Points in the OpenGL of another program: a context that this file makes itself, with state of every kind.
#include "sfumato/embedded.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "core/error.h"

using namespace sfumato;

namespace {

constexpr int width = 96, height = 64;

/// A program of its own: an EGL context and a framebuffer in it, bottom row first as OpenGL has it.
class Host {
 public:
  explicit Host(bool compatibility = false) {
    display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    eglInitialize(display_, nullptr, nullptr);
    eglBindAPI(EGL_OPENGL_API);
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,
        4,
        EGL_CONTEXT_MINOR_VERSION,
        5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        compatibility ? EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT : EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
    glCreateTextures(GL_TEXTURE_2D, 2, textures_);
    glTextureStorage2D(textures_[0], 1, GL_RGBA8, width, height);
    glTextureStorage2D(textures_[1], 1, GL_DEPTH_COMPONENT32F, width, height);
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, textures_[0], 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, textures_[1], 0);
  }
  ~Host() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  bool is_there() const { return context_ != EGL_NO_CONTEXT; }

  void clear(const vec4& color, float depth) const {
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, &color.x);
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &depth);
  }
  /// Depth 0..1 in the columns from `first` on.
  void put_depth(int first, float depth) const {
    const std::vector<float> values(std::size_t(width) * height, depth);
    glTextureSubImage2D(textures_[1], 0, first, 0, width - first, height, GL_DEPTH_COMPONENT, GL_FLOAT,
                        values.data());
  }
  /// Top row first.
  Image<Rgba8> color() const {
    Image<Rgba8> rows(width, height), out(width, height);
    glGetTextureImage(textures_[0], 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rows.size() * 4), rows.data());
    for (int y = 0; y < height; ++y) std::memcpy(&out.at(0, y), rows.row(height - 1 - y), width * 4);
    return out;
  }
  Image<float> depth() const {
    Image<float> rows(width, height), out(width, height);
    glGetTextureImage(textures_[1], 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(rows.size() * 4), rows.data());
    for (int y = 0; y < height; ++y) std::memcpy(&out.at(0, y), rows.row(height - 1 - y), width * 4);
    return out;
  }

  GLuint framebuffer = 0;

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  GLuint textures_[2] = {};
};

/// A sheet of green points at x = -0.5..0.5, z = -0.5..0.5 in the plane y = 0, seen from (0, -3, 0).
PointCloud sheet() {
  PointCloud cloud;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) {
      cloud.positions.push_back({float(i) / 200 - 0.5f, 0, float(j) / 200 - 0.5f});
      cloud.colors.push_back({0, 200, 0, 255});
    }
  return cloud;
}

HostView front() {
  return {glm::lookAt(dvec3(0, -3, 0), dvec3(0), dvec3(0, 0, 1)),
          glm::perspective(0.5, double(width) / height, 1.0, 10.0), width, height};
}

const Parameters plain{{"shading", "albedo"}, {"edl", "off"}, {"smooth_outlines", "false"}};

/// Depth in the buffer of what lies at distance d, by the projection of `front`.
float depth_at(double d) {
  return float(0.5 + 0.5 * ((10 + 1) / (10.0 - 1) - 2 * 10 * 1 / ((10.0 - 1) * d)));
}

class EmbeddedTest : public ::testing::Test {
 protected:
  void draw() {
    points.set_cloud(sheet());
    points.request("points", front(), plain);
    ASSERT_TRUE(points.wait(100));
    ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
  }
  Host host;
  EmbeddedRenderer points;
};

// Columns of the sheet: |x| <= 0.5 at distance 3, that is 64 / 2 / tan(0.25) / 3 * 0.5 = 20.9 px from the
// middle.
bool is_inside(int x, int y) {
  return std::abs(x + 0.5 - width / 2) < 20 && std::abs(y + 0.5 - height / 2) < 20;
}
bool is_outside(int x, int y) {
  return std::abs(x + 0.5 - width / 2) > 23 || std::abs(y + 0.5 - height / 2) > 23;
}

TEST_F(EmbeddedTest, StandsWhereTheHostsMatricesSay) {
  host.clear({0.2, 0.4, 0.6, 1}, 1);
  draw();
  const Image<Rgba8> color = host.color();
  const Image<float> depth = host.depth();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (is_inside(x, y)) {
        EXPECT_EQ(color.at(x, y), (Rgba8{0, 200, 0, 255})) << x << ' ' << y;
        EXPECT_NEAR(depth.at(x, y), depth_at(3), 1e-6) << x << ' ' << y;
      } else if (is_outside(x, y)) {
        EXPECT_EQ(color.at(x, y), (Rgba8{51, 102, 153, 255})) << x << ' ' << y;
        EXPECT_EQ(depth.at(x, y), 1) << x << ' ' << y;
      }
    }
}

// Who puts pictures together by depth takes the farthest for nothing.
TEST_F(EmbeddedTest, SoftOutlinesHaveADepth) {
  host.clear({0, 0, 0, 0}, 1);
  PointCloud turned = sheet();
  for (vec3& p : turned.positions) p = {0.8f * p.x - 0.6f * p.z, 0, 0.6f * p.x + 0.8f * p.z};
  points.set_cloud(std::move(turned));
  points.request("points", front(), {{"smooth_outlines", "true"}});
  ASSERT_TRUE(points.wait(100));
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
  const Image<Rgba8> color = host.color();
  const Image<float> depth = host.depth();
  int soft = 0;
  for (std::size_t i = 0; i < color.size(); ++i) {
    const int alpha = color.data()[i].a;
    soft += alpha > 0 && alpha < 255;
    EXPECT_EQ(depth.data()[i]<1, alpha> 0) << i;
  }
  EXPECT_GT(soft, 20);
}

TEST_F(EmbeddedTest, HidesAndIsHiddenByWhatTheHostDrew) {
  host.clear({1, 0, 0, 1}, depth_at(2.9));
  host.put_depth(width / 2, depth_at(3.1));
  draw();
  const Image<Rgba8> color = host.color();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (is_inside(x, y)) {
        EXPECT_EQ(color.at(x, y), x < width / 2 ? (Rgba8{255, 0, 0, 255}) : (Rgba8{0, 200, 0, 255}))
            << x << ' ' << y;
      }
}

TEST_F(EmbeddedTest, LetsTheHostShineThrough) {
  host.clear({0, 0, 1, 1}, 1);
  points.set_cloud(sheet());
  points.request("points", front(), plain);
  ASSERT_TRUE(points.wait(100));
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}, 0.25f));
  const Rgba8 middle = host.color().at(width / 2, height / 2), corner = host.color().at(0, 0);
  EXPECT_NEAR(middle.g, 50, 1);
  EXPECT_NEAR(middle.b, 191, 1);
  EXPECT_EQ(corner, (Rgba8{0, 0, 255, 255}));
  EXPECT_NEAR(host.depth().at(width / 2, height / 2), depth_at(3), 1e-6);
}

// Depth 1 is near and 0 infinitely far, as engines of games have it.
TEST_F(EmbeddedTest, KnowsReversedDepths) {
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  const double f = 1 / std::tan(0.25);
  dmat4 reversed(0.0);
  reversed[0][0] = f * height / width, reversed[1][1] = f, reversed[3][2] = 1,
  reversed[2][3] = -1;  // depth = 1 / d
  HostView view = front();
  view.projection = reversed;
  host.clear({1, 0, 0, 1}, 1 / 2.9f);
  host.put_depth(width / 2, 1 / 3.1f);
  points.set_cloud(sheet());
  points.request("points", view, plain);
  ASSERT_TRUE(points.wait(100));
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
  const Image<Rgba8> color = host.color();
  const Image<float> depth = host.depth();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (is_inside(x, y)) {
        EXPECT_EQ(color.at(x, y), x < width / 2 ? (Rgba8{255, 0, 0, 255}) : (Rgba8{0, 200, 0, 255}))
            << x << ' ' << y;
        EXPECT_NEAR(depth.at(x, y), x < width / 2 ? 1 / 2.9 : 1 / 3.0, 1e-6);
      }
}

/// Everything that can be asked of a context about what a draw may touch, by name.
std::map<std::string, std::vector<double>> state_of(bool compatibility) {
  std::map<std::string, std::vector<double>> out;
  const auto take = [&](const std::string& name, GLenum what, int count) {
    std::vector<GLdouble> values(std::size_t(count), -77);
    glGetDoublev(what, values.data());
    out[name] = values;
  };
#define TAKE(name, count) take(#name, name, count)
  TAKE(GL_DRAW_FRAMEBUFFER_BINDING, 1), TAKE(GL_READ_FRAMEBUFFER_BINDING, 1), TAKE(GL_CURRENT_PROGRAM, 1);
  TAKE(GL_PROGRAM_PIPELINE_BINDING, 1), TAKE(GL_VERTEX_ARRAY_BINDING, 1), TAKE(GL_ARRAY_BUFFER_BINDING, 1);
  TAKE(GL_PIXEL_UNPACK_BUFFER_BINDING, 1), TAKE(GL_PIXEL_PACK_BUFFER_BINDING, 1), TAKE(GL_ACTIVE_TEXTURE, 1);
  TAKE(GL_UNPACK_SWAP_BYTES, 1), TAKE(GL_UNPACK_LSB_FIRST, 1), TAKE(GL_UNPACK_ROW_LENGTH, 1),
      TAKE(GL_UNPACK_SKIP_ROWS, 1);
  TAKE(GL_UNPACK_SKIP_PIXELS, 1), TAKE(GL_UNPACK_ALIGNMENT, 1), TAKE(GL_UNPACK_SKIP_IMAGES, 1);
  TAKE(GL_UNPACK_IMAGE_HEIGHT, 1), TAKE(GL_PACK_ALIGNMENT, 1), TAKE(GL_PACK_ROW_LENGTH, 1);
  TAKE(GL_DEPTH_FUNC, 1), TAKE(GL_DEPTH_WRITEMASK, 1), TAKE(GL_DEPTH_CLEAR_VALUE, 1),
      TAKE(GL_COLOR_CLEAR_VALUE, 4);
  TAKE(GL_BLEND_COLOR, 4), TAKE(GL_LOGIC_OP_MODE, 1), TAKE(GL_CULL_FACE_MODE, 1), TAKE(GL_FRONT_FACE, 1);
  TAKE(GL_POLYGON_OFFSET_FACTOR, 1), TAKE(GL_POLYGON_OFFSET_UNITS, 1), TAKE(GL_POINT_SIZE, 1),
      TAKE(GL_LINE_WIDTH, 1);
  TAKE(GL_CLIP_ORIGIN, 1), TAKE(GL_CLIP_DEPTH_MODE, 1), TAKE(GL_SAMPLE_COVERAGE_VALUE, 1),
      TAKE(GL_PROVOKING_VERTEX, 1);
  TAKE(GL_STENCIL_FUNC, 1), TAKE(GL_STENCIL_REF, 1), TAKE(GL_STENCIL_WRITEMASK, 1), TAKE(GL_STENCIL_FAIL, 1);
  TAKE(GL_POLYGON_MODE, compatibility ? 2 : 1);
#undef TAKE
  const auto indexed = [&](const std::string& name, GLenum what, GLuint i, int count) {
    std::vector<GLdouble> values(std::size_t(count), -77);
    glGetDoublei_v(what, i, values.data());
    out[name + std::to_string(i)] = values;
  };
  for (GLuint i = 0; i < 4; ++i) {
    indexed("viewport", GL_VIEWPORT, i, 4), indexed("depth range", GL_DEPTH_RANGE, i, 2);
    indexed("scissor", GL_SCISSOR_BOX, i, 4);
    out["scissor test" + std::to_string(i)] = {double(glIsEnabledi(GL_SCISSOR_TEST, i))};
    out["blend" + std::to_string(i)] = {double(glIsEnabledi(GL_BLEND, i))};
    for (const GLenum what : {GL_BLEND_SRC_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_RGB, GL_BLEND_DST_ALPHA,
                              GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA}) {
      GLint value = 0;
      glGetIntegeri_v(what, i, &value);
      out["blend " + std::to_string(what) + " of " + std::to_string(i)] = {double(value)};
    }
    GLboolean mask[4];
    glGetBooleani_v(GL_COLOR_WRITEMASK, i, mask);
    out["color mask" + std::to_string(i)] = {double(mask[0]), double(mask[1]), double(mask[2]),
                                             double(mask[3])};
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    for (const GLenum what :
         {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_3D, GL_TEXTURE_BINDING_BUFFER, GL_SAMPLER_BINDING}) {
      GLint value = 0;
      glGetIntegerv(what, &value);
      out["unit " + std::to_string(i) + ": " + std::to_string(what)] = {double(value)};
    }
  }
  glActiveTexture(GLenum(out["GL_ACTIVE_TEXTURE"][0]));
  std::vector<GLenum> capabilities{GL_BLEND,
                                   GL_CULL_FACE,
                                   GL_DEPTH_TEST,
                                   GL_STENCIL_TEST,
                                   GL_SCISSOR_TEST,
                                   GL_DITHER,
                                   GL_COLOR_LOGIC_OP,
                                   GL_RASTERIZER_DISCARD,
                                   GL_SAMPLE_COVERAGE,
                                   GL_SAMPLE_MASK,
                                   GL_SAMPLE_ALPHA_TO_COVERAGE,
                                   GL_SAMPLE_ALPHA_TO_ONE,
                                   GL_SAMPLE_SHADING,
                                   GL_MULTISAMPLE,
                                   GL_FRAMEBUFFER_SRGB,
                                   GL_DEPTH_CLAMP,
                                   GL_POLYGON_OFFSET_FILL,
                                   GL_PROGRAM_POINT_SIZE,
                                   GL_PRIMITIVE_RESTART,
                                   GL_LINE_SMOOTH,
                                   GL_POLYGON_SMOOTH,
                                   GL_TEXTURE_CUBE_MAP_SEAMLESS,
                                   GL_CLIP_DISTANCE0,
                                   GL_CLIP_DISTANCE3};
  if (compatibility)
    capabilities.insert(capabilities.end(), {GL_ALPHA_TEST, GL_POLYGON_STIPPLE, GL_LIGHTING, GL_FOG});
  for (const GLenum each : capabilities) out["enabled " + std::to_string(each)] = {double(glIsEnabled(each))};
  return out;
}

/// Nothing of it is at its default, and much of it would spoil a picture.
void make_odd() {
  GLuint buffers[2], textures[2], samplers[2], array = 0, other = 0, pipeline = 0;
  glCreateBuffers(2, buffers);
  glCreateTextures(GL_TEXTURE_2D, 2, textures);
  glCreateSamplers(2, samplers);
  glCreateVertexArrays(1, &array);
  glCreateFramebuffers(1, &other);
  glCreateProgramPipelines(1, &pipeline);
  glBindFramebuffer(GL_FRAMEBUFFER, other);
  glBindVertexArray(array);
  glBindProgramPipeline(pipeline);
  glNamedBufferStorage(buffers[0], 64, nullptr, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[0]);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[1]);
  for (GLuint i = 0; i < 2; ++i) glBindTextureUnit(i, textures[i]), glBindSampler(i, samplers[i]);
  glActiveTexture(GL_TEXTURE3);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 7), glPixelStorei(GL_UNPACK_SKIP_ROWS, 2),
      glPixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 8), glPixelStorei(GL_UNPACK_SWAP_BYTES, 1),
      glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 5);
  glEnable(GL_CULL_FACE), glCullFace(GL_FRONT_AND_BACK), glFrontFace(GL_CW);
  glEnable(GL_STENCIL_TEST), glStencilFunc(GL_NEVER, 3, 0xf);
  glEnable(GL_SCISSOR_TEST), glScissor(1, 2, 3, 4);
  glViewport(5, 6, 7, 8), glViewportIndexedf(1, 1, 2, 3, 4);
  glEnable(GL_COLOR_LOGIC_OP), glLogicOp(GL_INVERT);
  glEnable(GL_RASTERIZER_DISCARD), glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE), glEnable(GL_SAMPLE_MASK),
      glEnable(GL_DEPTH_CLAMP);
  glEnable(GL_FRAMEBUFFER_SRGB), glEnable(GL_CLIP_DISTANCE0), glEnable(GL_CLIP_DISTANCE3),
      glEnable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_DITHER), glDisable(GL_DEPTH_TEST), glDepthFunc(GL_NEVER), glDepthMask(GL_FALSE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_POINT), glPolygonOffset(3, 400);
  glEnable(GL_BLEND), glBlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_DST_COLOR, GL_ZERO);
  glBlendEquationSeparate(GL_FUNC_SUBTRACT, GL_MIN);
  glDisablei(GL_BLEND, 1), glBlendFunci(2, GL_ONE, GL_DST_ALPHA);
  glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE), glColorMaski(2, GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
}

class OddHostTest : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Profiles, OddHostTest, ::testing::Values(false, true),
                         [](const auto& each) { return each.param ? "compatibility" : "core"; });

TEST_P(OddHostTest, StateComesBackAndThePictureIsTheSame) {
  const bool compatibility = GetParam();
  Host host(compatibility);
  if (!host.is_there()) GTEST_SKIP() << "SKIPPED: this driver has no compatibility profile";
  EmbeddedRenderer points;
  points.set_cloud(sheet());
  points.request("points", front(), plain);
  ASSERT_TRUE(points.wait(100));
  host.clear({0.2, 0.4, 0.6, 1}, 1);
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
  const Image<Rgba8> expected = host.color();
  const Image<float> expected_depth = host.depth();
  host.clear({0.2, 0.4, 0.6, 1}, 1);
  points.release();  // so that uploading happens among odd state as well
  ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR));

  make_odd();
  if (compatibility)
    glEnable(GL_ALPHA_TEST), glAlphaFunc(GL_NEVER, 0), glEnable(GL_POLYGON_STIPPLE),
        glPolygonMode(GL_BACK, GL_LINE);
  glEnable(GL_TEXTURE_CUBE_MAP);  // an error of the host in core profiles, which is the host's to see
  if (compatibility) glEnable(0xffff);
  const auto before = state_of(compatibility);
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
  const auto after = state_of(compatibility);
  for (const auto& [name, value] : before) EXPECT_EQ(value, after.at(name)) << name;
  EXPECT_EQ(glGetError(), GLenum(GL_INVALID_ENUM));
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));

  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  EXPECT_EQ(std::memcmp(host.color().data(), expected.data(), expected.size() * 4), 0);
  EXPECT_EQ(std::memcmp(host.depth().data(), expected_depth.data(), expected_depth.size() * 4), 0);
}

TEST_F(EmbeddedTest, ANewerRequestWins) {
  host.clear({0, 0, 0, 1}, 1);
  points.set_cloud(sheet());
  HostView view = front();
  for (int i = 1; i <= 20; ++i) {
    view.view = glm::lookAt(dvec3(0.01 * i, -3, 0), dvec3(0), dvec3(0, 0, 1));
    points.request("surface", view);
  }
  ASSERT_TRUE(points.wait(100));
  EXPECT_EQ(points.drawn(), view);
  ASSERT_TRUE(points.draw(host.framebuffer, {0, 0, width, height}));
}

TEST_F(EmbeddedTest, SaysWhatWentWrongOnce) {
  points.set_cloud(sheet());
  EXPECT_FALSE(points.draw(host.framebuffer, {0, 0, width, height}));
  points.request("sketch", front());
  EXPECT_THROW(points.wait(100), Error);
  points.request("points", front());
  EXPECT_TRUE(points.wait(100));
  points.set_cloud(PointCloud());
  EXPECT_THROW(points.wait(100), Error);
  HostView flat = front();
  flat.projection = dmat4(0);
  EXPECT_THROW(points.request("points", flat), Error);
}

TEST(Embedded, NeedsAContextToDrawIn) {
  EmbeddedRenderer points;
  try {
    points.draw(0, {0, 0, width, height});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::no_gl);
  }
}

}  // namespace
