#include "techniques/soft/one_layer.h"

#include <limits>

#include "passes/bindings.h"

namespace sfumato::soft {

void OneLayer::draw(Frame& frame, const View& view, SplatShape shape, const SplatBlend& blend,
                    float opacity) {
  const int width = view.width(), height = view.height();
  GpuCloud& cloud = frame.cloud;
  const dvec3 origin = cloud.prepared().cloud.origin;
  front_.draw(cloud, view, shape, blend, {front_albedo_, front_depth_, front_normal_}, frame.timers);
  shape = behind_surface(shape, blend);
  const float soft_threshold = shape.field_threshold;
  shape.field_threshold = -1;  // every point, with its field for the fragments

  const bool shadow = cloud.has_shadow(), gaussian = blend.kernel == SplatKernel::gaussian;
  SplatRaster& accumulate = accumulate_[(shadow ? 1 : 0) + (gaussian ? 2 : 0)];
  if (!nearest_) nearest_ = SplatRaster("techniques/soft/behind_layer.frag", {"SPLAT_FIELD"});
  if (!accumulate) {
    gl::Defines defines{"SPLAT_FIELD", "SPLAT_COLOR", "ACCUMULATE"};
    if (shadow) defines.push_back("SPLAT_SHADOW");
    if (gaussian) defines.push_back("KERNEL_GAUSSIAN");
    accumulate = SplatRaster("techniques/soft/behind_layer.frag", defines);
  }
  auto set_uniforms = [&](gl::Program& program) {
    program.set("soft_threshold", soft_threshold).set("epsilon", blend.epsilon);
  };
  const SplatBatches batches = choose_batches(cloud, view, shape);
  {
    auto timing = frame.timers.scope("visibility behind");
    gl::ensure(nearest_t_, "nearest behind", GL_R32F, width, height);
    nearest_t_.clear(vec4(std::numeric_limits<float>::infinity()));
    gl::Framebuffer framebuffer({&nearest_t_});
    framebuffer.bind();
    front_.nearest_t().bind(binding::input);
    nearest_.draw(cloud, view, shape, batches, {.blend = gl::State::Blend::min}, set_uniforms);
  }
  {
    auto timing = frame.timers.scope("accumulate behind");
    for (gl::Texture* sum : {&color_sum_, &normal_sum_}) {
      gl::ensure(*sum, "sums behind", GL_RGBA32F, width, height);
      sum->clear(vec4(0));
    }
    gl::ensure(shadow_sum_, "sum of shadow factors behind", GL_R32F, width, height);
    shadow_sum_.clear(vec4(0));
    auto draw_into = [&](const gl::Framebuffer& framebuffer) {
      framebuffer.bind();
      front_.nearest_t().bind(binding::input);
      nearest_t_.bind(binding::input + 1);
      accumulate.draw(cloud, view, shape, batches, {.blend = gl::State::Blend::add}, set_uniforms);
    };
    if (shadow)
      draw_into(gl::Framebuffer({&color_sum_, &normal_sum_, &shadow_sum_}));
    else
      draw_into(gl::Framebuffer({&color_sum_, &normal_sum_}));
  }
  gl::ensure(albedo_, "albedo behind", GL_RGBA32F, width, height);
  for (gl::Texture* color : {&front_color_, &behind_color_})
    gl::ensure(*color, "shaded layer", GL_RGBA32F, width, height);
  if (!normalize_) normalize_ = ScreenPass("passes/splat_normalize.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
  view.bind();
  normalize_.set("has_shadow", shadow);
  normalize_.run({&color_sum_, &normal_sum_, &shadow_sum_},
                 {&albedo_, &frame.target.depth, &frame.target.normal});

  auto timing = frame.timers.scope("shade");
  shade_.run(view, frame.settings, frame.light, origin, {front_albedo_, front_depth_, front_normal_},
             front_color_);
  shade_.run(view, frame.settings, frame.light, origin, {albedo_, frame.target.depth, frame.target.normal},
             behind_color_);
  if (frame.behind) {
    std::swap(behind_color_, frame.target.color);
    merge_.run(*frame.behind, frame.target, frame.wants_normal);
    std::swap(behind_color_, frame.target.color);
  }
  if (!over_) over_ = ScreenPass("techniques/soft/layer_over.glsl", {GL_RGBA32F});
  over_.set("opacity", opacity);
  over_.run({&front_color_, &front_depth_, &behind_color_, &frame.target.depth}, {&frame.target.color});
}

}  // namespace sfumato::soft
