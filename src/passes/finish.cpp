#include "passes/finish.h"

#include <utility>

#include "gl/commands.h"
#include "gl/pace.h"
#include "gl/preferences.h"
#include "passes/finish_cpu.h"

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

void PostProcessing::run(const View& view, const Relief::Options& relief, bool with_smooth_outlines,
                         gl::Texture& color, const gl::Texture& depth, const gl::Texture& normal,
                         gl::Timers& timers) {
  if (!relief.any() && !with_smooth_outlines) return;
  if (gl::place_of_work(gl::preferences().finish) == gl::Place::cpu) {
    gl::end_stretch();
    Image<vec4> here = color.take<vec4>();
    if (relief.any()) {
      auto timing = timers.scope("relief");
      static const Image<vec4> none;
      shade_relief(view, relief, depth.peek<float>(), relief.scaling > 0 ? normal.peek<vec4>() : none, here);
    }
    if (with_smooth_outlines) {
      auto timing = timers.scope("smooth outlines");
      smooth_outlines(view, depth.peek<float>(), here);
    }
    color.give(std::move(here));
    return;
  }
  gl::ensure(scratch_, "finish scratch", GL_RGBA32F, color.width(), color.height());
  if (relief.any()) {
    auto timing = timers.scope("relief");
    relief_.run(view, relief, color, depth, normal, scratch_);
    std::swap(scratch_, color);
  }
  if (with_smooth_outlines) {
    auto timing = timers.scope("smooth outlines");
    outlines_.run(view, color, depth, scratch_);
    std::swap(scratch_, color);
  }
}

namespace {
void set_background(ScreenPass& pass, const RenderSettings& settings) {
  pass.set("background_srgb", settings.background).set("is_transparent", settings.transparent);
}
}  // namespace

void Finish::run(const RenderSettings& settings, const gl::Texture& color, gl::Texture& rgba8) {
  if (gl::place_of_work(gl::preferences().finish) == gl::Place::cpu) {
    gl::end_stretch();
    Image<Rgba8> here = rgba8.blank<Rgba8>();
    encode(settings, color.peek<vec4>(), here);
    rgba8.give(std::move(here));
    return;
  }
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
