#include "passes/finish.h"

#include "gl/commands.h"

namespace sfumato {
void SmoothOutlines::run(const View& view, const gl::Texture& color, const gl::Texture& depth,
                         const gl::Texture& out) {
  if (!smooth_) {
    find_edges_ = ScreenPass("passes/depth_edges.glsl", {GL_R32UI});
    smooth_ = ScreenPass("passes/smooth_outlines.glsl", {GL_RGBA32F});
  }
  gl::ensure(edges_, "edges in depth", GL_R32UI, color.width(), color.height());
  view.bind();
  edges_.clear_uint(0);
  find_edges_.mark(mask_, {&depth}, {&edges_});
  gl::copy(color, ivec2(0), out, ivec2(0), ivec2(color.width(), color.height()));
  smooth_.run(mask_, {&color, &edges_, &depth}, {&out});
}

namespace {
void set_background(ScreenPass& pass, const RenderSettings& settings) {
  pass.set("background_srgb", settings.background).set("is_transparent", settings.transparent);
}
}  // namespace

void Finish::run(const RenderSettings& settings, const gl::Texture& color, const gl::Texture& rgba8) {
  if (!encode_) encode_ = ScreenPass("passes/finish.glsl", {GL_RGBA8}, {"ENCODE_SRGB"});
  set_background(encode_, settings);
  encode_.run({&color}, {&rgba8});
}

void Finish::run_linear(const RenderSettings& settings, const gl::Texture& color, const gl::Texture& linear) {
  if (!linear_) linear_ = ScreenPass("passes/finish.glsl", {GL_RGBA32F});
  set_background(linear_, settings);
  linear_.run({&color}, {&linear});
}

}  // namespace sfumato
