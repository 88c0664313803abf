// Three-pass surface splatting (Botsch et al. 2005): visibility, accumulation, normalisation.
// The technique `splats` is this plus shading; others use it for the opaque part of their picture.
#pragma once

#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/screen_pass.h"
#include "passes/splat_cpu.h"
#include "passes/splat_raster.h"
#include "passes/splat_visit.h"

namespace sfumato {

/// The shape with the far sides of thin sheets twice as far behind as what counts as the same surface: beyond
/// that even where noise has them in front.
SplatShape behind_surface(SplatShape shape, const SplatBlend& blend);

/// What the passes leave, at the view's size: textures of the caller, made when missing.
struct SplatSurfaceTargets {
  gl::Texture& albedo;  ///< RGBA32F: linear colour, alpha 1 where covered
  gl::Texture& depth;   ///< R32F: eye depth of the weighted ray distance, +inf where nothing
  gl::Texture& normal;  ///< RGBA32F: world normal facing the camera or 0; w = shadow factor
};

class SplatSurface {
 public:
  /// All three passes. `nearest_t()` then holds the front ray distance, unshifted where `epsilon_radii` is 0,
  /// and two epsilons more where only the far side of a thin sheet is seen.
  void draw(GpuCloud& cloud, const View& view, SplatShape shape, const SplatBlend& blend,
            const SplatSurfaceTargets& targets, gl::Timers& timers);
  /// Its three steps, for splats that lie in parts: the nearest hits of these, the sums of what counts as one
  /// surface with the nearest of all parts, and the surface from the sums of all. Not with shadows.
  void find_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
                    gl::Timers& timers);
  void accumulate(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
                  const Image<float>& nearest, gl::Timers& timers);
  void normalize(const View& view, const Image<vec4>& color_sum, const Image<vec4>& normal_sum,
                 const SplatSurfaceTargets& targets, gl::Timers& timers);
  const gl::Texture& color_sum() const { return color_sum_; }
  const gl::Texture& normal_sum() const { return normal_sum_; }
  /// Only the visibility pass, for techniques that accumulate in their own way. `epsilon`: behind that, what
  /// is added up here.
  void draw_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const SplatShift& shift = {}, float epsilon = 0);

  /// R32F: ray distance of the nearest hit of every pixel, +inf where nothing.
  const gl::Texture& nearest_t() const { return nearest_t_; }
  gl::Texture& nearest_t() { return nearest_t_; }
  /// Those of all parts, in place of what is drawn here.
  void set_nearest(const Image<float>& nearest);
  /// How the batches of the last draw were chosen.
  const SplatBatches& batches() const { return batches_; }

 private:
  SplatBatches batches_;
  gl::Texture nearest_t_, front_, color_sum_, normal_sum_, shadow_sum_;
  SplatRaster nearest_, accumulate_[6];
  SplatVisit visit_;
  SplatCpu cpu_;
  ScreenPass deeper_side_, normalize_;
  void make_sums(const View& view);
  void see(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
           gl::Timers& timers);
  void add_up(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBlend& blend,
              gl::Timers& timers);
  void divide(const View& view, bool has_shadow, const SplatSurfaceTargets& targets, gl::Timers& timers);
};

}  // namespace sfumato
