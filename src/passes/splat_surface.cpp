#include "passes/splat_surface.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "passes/bindings.h"

namespace sfumato {

void SplatSurface::draw_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape,
                                const SplatBatches& batches, const SplatShift& shift, float epsilon) {
  if (SplatCpu::is_used()) {
    gl::ensure(nearest_t_, "nearest ray distance", GL_R32F, view.width(), view.height());
    Image<float> nearest = nearest_t_.blank<float>();
    std::fill(nearest.begin(), nearest.end(), std::numeric_limits<float>::infinity());
    cpu_.find_nearest(cloud, view, shape, batches, shift, epsilon, nearest);
    nearest_t_.give(std::move(nearest));
    return;
  }
  gl::ensure(nearest_t_, "nearest ray distance", GL_R32F, view.width(), view.height());
  nearest_t_.clear(vec4(std::numeric_limits<float>::infinity()));
  if (!nearest_) nearest_ = SplatRaster("passes/splat_nearest.frag");
  visit_.draw_nearest(cloud, view, shape, batches, shift, nearest_t_);
  gl::Framebuffer framebuffer({&nearest_t_});
  framebuffer.bind();
  nearest_.draw(
      cloud, view, shape, batches, {.blend = gl::State::Blend::min},
      [&](gl::Program& program) { shift.set(program, shape); }, false);
}

void SplatSurface::set_nearest(const Image<float>& nearest) {
  gl::ensure(nearest_t_, "nearest ray distance", GL_R32F, nearest.width(), nearest.height());
  nearest_t_.upload(nearest);
}

SplatShape behind_surface(SplatShape shape, const SplatBlend& blend) {
  shape.behind = 2 * blend.epsilon, shape.behind_radii = 2 * blend.epsilon_radii;
  return shape;
}

/// Where epsilon differs from splat to splat, that of the nearest counts: only the first pass knows which it
/// is.
static bool is_shifted(const SplatBlend& blend) { return !blend.opaque && blend.epsilon_radii > 0; }
/// What is left to add behind the nearest hits.
static float epsilon_of(const SplatBlend& blend) {
  return blend.opaque || is_shifted(blend) ? 0 : blend.epsilon;
}

static SplatShift shift_of(const SplatBlend& blend) {
  return is_shifted(blend) ? SplatShift{blend.epsilon, blend.epsilon_radii} : SplatShift{};
}

static void make(const SplatSurfaceTargets& targets, const View& view) {
  gl::ensure(targets.albedo, "albedo", GL_RGBA32F, view.width(), view.height());
  gl::ensure(targets.depth, "eye depth", GL_R32F, view.width(), view.height());
  gl::ensure(targets.normal, "normal", GL_RGBA32F, view.width(), view.height());
}

void SplatSurface::draw(GpuCloud& cloud, const View& view, SplatShape shape, const SplatBlend& blend,
                        const SplatSurfaceTargets& targets, gl::Timers& timers) {
  shape = behind_surface(shape, blend);
  batches_ = choose_batches(cloud, view, shape);
  see(cloud, view, shape, blend, timers);
  if (SplatCpu::is_used()) {
    auto timing = timers.scope("accumulate");
    make(targets, view);
    SplatCpu::Surface surface{targets.albedo.blank<vec4>(), targets.normal.blank<vec4>(),
                              targets.depth.blank<float>()};
    cpu_.add_up(cloud, view, blend, epsilon_of(blend), nearest_t_.peek<float>(),
                [&](const SplatCpu::Sums& sums) { SplatCpu::normalize(view, sums, surface); });
    targets.albedo.give(std::move(surface.albedo));
    targets.normal.give(std::move(surface.normal));
    targets.depth.give(std::move(surface.depth));
    return;
  }
  add_up(cloud, view, shape, blend, timers);
  divide(view, cloud.has_shadow(), targets, timers);
}

void SplatSurface::find_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape,
                                const SplatBlend& blend, gl::Timers& timers) {
  const SplatShape behind = behind_surface(shape, blend);
  batches_ = choose_batches(cloud, view, behind);
  see(cloud, view, behind, blend, timers);
}

void SplatSurface::accumulate(GpuCloud& cloud, const View& view, const SplatShape& shape,
                              const SplatBlend& blend, const Image<float>& nearest, gl::Timers& timers) {
  const SplatShape behind = behind_surface(shape, blend);
  batches_ = choose_batches(cloud, view, behind);
  set_nearest(nearest);
  if (SplatCpu::is_used()) {
    auto timing = timers.scope("accumulate");
    Image<float> lowered = nearest;
    cpu_.find_nearest(cloud, view, behind, batches_, shift_of(blend), epsilon_of(blend), lowered);
    make_sums(view);
    cpu_.add_up(cloud, view, blend, epsilon_of(blend), lowered, [&](const SplatCpu::Sums& sums) {
      color_sum_.upload_rows(sums.color, sums.first_row, sums.rows);
      normal_sum_.upload_rows(sums.normal, sums.first_row, sums.rows);
    });
    return;
  }
  add_up(cloud, view, behind, blend, timers);
}

void SplatSurface::make_sums(const View& view) {
  gl::ensure(color_sum_, "sum of colours", GL_RGBA32F, view.width(), view.height());
  gl::ensure(normal_sum_, "sum of normals", GL_RGBA32F, view.width(), view.height());
}

void SplatSurface::normalize(const View& view, const Image<vec4>& color_sum, const Image<vec4>& normal_sum,
                             const SplatSurfaceTargets& targets, gl::Timers& timers) {
  make_sums(view);
  color_sum_.upload(color_sum), normal_sum_.upload(normal_sum);
  divide(view, false, targets, timers);
}

void SplatSurface::see(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
                       gl::Timers& timers) {
  auto timing = timers.scope("visibility");
  draw_nearest(cloud, view, shape, batches_, shift_of(blend), epsilon_of(blend));
}

void SplatSurface::add_up(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
                          gl::Timers& timers) {
  const int width = view.width(), height = view.height();
  auto timing = timers.scope("accumulate");
  const bool shadow = cloud.has_shadow(), gaussian = blend.kernel == SplatKernel::gaussian;
  const float epsilon = epsilon_of(blend);
  make_sums(view);
  color_sum_.clear(vec4(0));
  normal_sum_.clear(vec4(0));
  SplatRaster& raster = accumulate_[(shadow ? 1 : 0) + (blend.opaque ? 4 : gaussian ? 2 : 0)];
  if (!raster) {
    gl::Defines defines{"SPLAT_COLOR"};
    if (shadow) defines.push_back("SPLAT_SHADOW");
    if (gaussian) defines.push_back("KERNEL_GAUSSIAN");
    if (blend.opaque) defines.push_back("BLEND_OPAQUE");
    raster = SplatRaster("passes/splat_accumulate.frag", defines);
  }
  visit_.measure_farthest(view, nearest_t_);
  if (!blend.opaque) {
    gl::ensure(front_, "nearest hit and deeper side", GL_RGBA32F, width, height);
    if (!deeper_side_) deeper_side_ = ScreenPass("passes/deeper_side.glsl", {GL_RGBA32F});
    view.bind();
    deeper_side_.set("full_step", blend.epsilon).run({&nearest_t_}, {&front_});
  }
  const gl::Texture& front = blend.opaque ? nearest_t_ : front_;
  auto draw_into = [&](const gl::Framebuffer& framebuffer) {
    framebuffer.bind();
    const gl::State state{.blend = gl::State::Blend::add};
    auto set_epsilon = [&](gl::Program& program) { program.set("epsilon", epsilon); };
    front.bind(binding::input);
    raster.draw(cloud, view, shape, batches_, state, set_epsilon, false);
    for (std::size_t c = 0; c < batches_.chunks.size(); ++c) {
      {
        auto cull_timing = timers.scope("cull");
        if (!visit_.list_survivors(cloud, c, view, shape, batches_, nearest_t_, epsilon)) continue;
      }
      framebuffer.bind();
      front.bind(binding::input);
      raster.draw_list(cloud, c, view, shape, visit_.list(), visit_.command(), state, set_epsilon);
    }
  };
  if (shadow) {
    gl::ensure(shadow_sum_, "sum of shadow factors", GL_R32F, width, height);
    shadow_sum_.clear(vec4(0));
    draw_into(gl::Framebuffer({&color_sum_, &normal_sum_, &shadow_sum_}));
  } else {
    draw_into(gl::Framebuffer({&color_sum_, &normal_sum_}));
  }
}

void SplatSurface::divide(const View& view, bool has_shadow, const SplatSurfaceTargets& targets,
                          gl::Timers& timers) {
  auto timing = timers.scope("normalize");
  make(targets, view);
  if (!normalize_) normalize_ = ScreenPass("passes/splat_normalize.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
  normalize_.set("has_shadow", has_shadow);
  view.bind();
  const gl::Texture& shadow_sum = has_shadow ? shadow_sum_ : color_sum_;
  normalize_.run({&color_sum_, &normal_sum_, &shadow_sum},
                 {&targets.albedo, &targets.depth, &targets.normal});
}

}  // namespace sfumato
