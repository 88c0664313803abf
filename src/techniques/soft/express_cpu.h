// The Express model on software GL: most soft points are a few pixels wide, and the rasteriser spends more on
// the set-up of such a sprite than on its pixels. The processor, which does the work anyway, blends them
// itself.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "techniques/soft/soft_points.h"

namespace sfumato::soft {

class ExpressCpu {
 public:
  /// Blends the points over `color` (RGBA32F, premultiplied) in their order, clipped by `solid_t` (R32F, ray
  /// distances). The picture does not depend on the number of threads.
  void draw(const SoftPoints& points, const Order& order, const View& view, const gl::Texture& solid_t,
            gl::Texture& color);

 private:
  /// First and last pixel, x in the low 16 bits, y in the high ones; as points.comp leaves them.
  using Box = glm::uvec2;
  void list_bands(const Order& order, std::uint32_t rows);
  void blend_band(std::uint32_t band, const View& view, const Image<float>& solid_t,
                  Image<vec4>& color) const;

  std::vector<Box> boxes_;
  std::vector<vec4> shapes_;
  std::vector<glm::uvec4> looks_;
  std::vector<std::uint32_t> slots_, starts_, entries_;  // spheres of each band of rows, in drawing order
};

}  // namespace sfumato::soft
