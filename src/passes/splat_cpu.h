// Surface splatting by the processor, where OpenGL is software: the loops of splat_visit.comp and the
// fragment stages, eight pixels of a row at a time and without a list of fragments between the stages. Same
// arithmetic, order of sums and results, but for roundings.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/image.h"
#include "passes/shaders_cpu.h"
#include "passes/splat_raster.h"

namespace sfumato {

class SplatCpu {
 public:
  /// Whether splats are drawn so: OpenGL is software, and nobody prefers another way.
  static bool is_used();

  /// A splat at pixels [x, x + n) of row y.
  struct Hits {
    const cpu::Points& points;  ///< of which it is `disc.point`
    const cpu::Disc& disc;
    int x, y, n;
    const float* t;     ///< distances along the rays
    const float* rho2;  ///< squared distances from its centre in radii, 1 and more where the ray misses
  };
  /// Gives `take` all hits of `batches`, about from front to back, from several threads, until it returns
  /// false. `wants`: whether it
  /// asks for those of a splat; null: all.
  static void for_each_hit(GpuCloud& cloud, const View& view, const SplatShape& shape,
                           const SplatBatches& batches, const std::function<bool(const cpu::Disc&)>& wants,
                           const std::function<bool(const Hits&)>& take);

  /// Lowers `nearest` (of the view's size, ray distances) to the nearest hits of `batches`, each moved back
  /// by `shift`, and keeps the splats that reach a pixel no more than `epsilon` behind it.
  void find_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const SplatShift& shift, float epsilon, Image<float>& nearest);
  /// Weighted sums as splat_accumulate.frag writes them, of some rows of a picture.
  struct Sums {
    Image<vec4> color, normal;
    Image<float> shadow;  ///< empty where the cloud has none
    int first_row = 0, rows = 0;
  };
  /// Over the splats that `find_nearest` has kept, of the same view, cloud and `nearest` or a nearer one;
  /// gives away a stripe after the other, so that no sums of a whole large picture take memory.
  void add_up(GpuCloud& cloud, const View& view, const SplatBlend& blend, float epsilon,
              const Image<float>& nearest, const std::function<void(const Sums&)>& take) const;

  /// The surface of a picture from those sums of its rows, as splat_normalize.glsl writes it.
  struct Surface {
    Image<vec4> albedo, normal;
    Image<float> depth;
  };
  static void normalize(const View& view, const Sums& sums, Surface& surface);

 private:
  struct OfBatch {
    std::size_t chunk = 0;
    std::uint32_t first = 0, count = 0;  // points of the chunk
    float depth = 0;                     // of one of them: distance from the eye
    std::vector<cpu::Disc> discs;
  };
  std::vector<OfBatch> kept_;
  float prefilter_px_ = 0;
};

}  // namespace sfumato
