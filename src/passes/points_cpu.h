// Points to pixels by the processor, where OpenGL is software: points_to_pixels.comp in one visit, which
// keeps pairs of depth and source index, and points_resolve.glsl. Same arithmetic and results, but for
// roundings.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "passes/footprint.h"
#include "gl/texture.h"
#include "passes/gpu_cloud.h"

namespace sfumato {

/// What decides which points a visit keeps.
struct PointVisit {
  Footprint footprint;
  const gl::Texture* reference = nullptr;  ///< R32F of the view's size; null: none
  float min_gap = 0;
  const CasterRange* casters = nullptr;
  int list_length = 1;    ///< entries of a pixel, as PointsToPixels::draw_lists keeps them
  float inverse_bin = 0;  ///< of lists
};

class PointsCpu {
 public:
  /// Nothing in each pixel; of lists the height is that of all entries.
  void begin(int width, int height);
  /// What R32UI textures hold; without `index` of no source.
  void begin(const gl::Texture& depth_bits, const gl::Texture* index);
  /// Lowers them to the nearest points of the batches in view.
  void visit(GpuCloud& cloud, const View& view, const PointVisit& visit);
  const Image<std::uint32_t>& depth_bits() {
    words(depth_bits_, 32);
    return depth_bits_;
  }
  /// Into textures of their size; `index` may be null.
  void end(gl::Texture& depth_bits, gl::Texture* index) const;

  /// The least pairs of depth (bits of a float, above) and source index (below); all bits: nothing. Of lists
  /// entry k of pixel (x, y) is at (x, y + k height).
  using Pairs = Image<std::uint64_t>;

 private:
  void words(Image<std::uint32_t>& out, int shift) const;
  Pairs pairs_;
  Image<std::uint32_t> depth_bits_;
};

/// points_resolve.glsl: attributes of the points whose depths and source indices those are, into textures of
/// their size; `normal` may be null.
void resolve_points(GpuCloud& cloud, const View& view, const gl::Texture& depth_bits,
                    const gl::Texture& index, gl::Texture& albedo, gl::Texture& depth, gl::Texture* normal);

}  // namespace sfumato
