#include "techniques/layers/screen_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gl/commands.h"
#include "passes/points_to_pixels.h"

namespace sfumato::layers {

ScreenExtent::ScreenExtent(const PreparedCloud& prepared, const Camera& picture, float point_size, int reach)
    : camera(picture) {
  const dmat4 eye_from_cloud = picture.view(prepared.cloud.origin);
  const Intrinsics k = picture.intrinsics();
  const double largest = 0.5 * largest_footprint(picture.whole_height());  // px
  double lo_x = 1e9, lo_y = 1e9, hi_x = -1e9, hi_y = -1e9;
  for (const Batch& batch : prepared.batches)
    for (const dvec3& p : batch.box().corners()) {
      const dvec3 eye(eye_from_cloud * glm::dvec4(p, 1));
      if (!picture.orthographic() && -eye.z < picture.near_plane) {  // anywhere on the screen
        lo_x = lo_y = -1e9, hi_x = hi_y = 1e9;
        continue;
      }
      const double w = picture.orthographic() ? 1 : -eye.z;
      const double x_px = k.fx * eye.x / w + k.cx, y_px = -k.fy * eye.y / w + k.cy;
      const double radius =
          std::min(0.5 * point_size * batch.spacing * picture.pixels_per_unit() / w, largest) + 1;
      lo_x = std::min(lo_x, x_px - radius), hi_x = std::max(hi_x, x_px + radius);
      lo_y = std::min(lo_y, y_px - radius), hi_y = std::max(hi_y, y_px + radius);
    }
  // Sizes are multiples of 64, so that a turning view does not make new textures for every frame.
  auto part = [&](double lo, double hi, int size, int& first, int& count) {
    const int least = -reach, most = size + reach;
    first = int(std::clamp(std::floor(lo) - reach, double(least), double(most - 1)));
    const int end = int(std::clamp(std::ceil(hi) + reach, double(first + 1), double(most)));
    count = std::min((end - first + 63) / 64 * 64, most - least);
    first = std::min(first, most - count);
  };
  int width = 0, height = 0;
  part(lo_x, hi_x, picture.width, x, width);
  part(lo_y, hi_y, picture.height, y, height);
  // Counted from a corner that no extent lies before: moving places by whole pixels towards 0 rounds nothing,
  // so that those of tiles are those of the whole picture.
  camera = picture.with_guard_band(most_reach).tile(x + most_reach, y + most_reach, width, height);
}

ScreenExtent::ScreenExtent(const Camera& picture, int band) : x(-band), y(-band) {
  const int corner = std::max(most_reach, band);
  camera = picture.with_guard_band(corner).tile(corner - band, corner - band, picture.width + 2 * band,
                                                picture.height + 2 * band);
}

void ScreenExtent::copy(const gl::Texture& part, const gl::Texture& picture) const {
  const int x0 = std::max(x, 0), y0 = std::max(y, 0);
  const int x1 = std::min(x + part.width(), picture.width()),
            y1 = std::min(y + part.height(), picture.height());
  if (x1 <= x0 || y1 <= y0) return;
  gl::copy(part, ivec2(x0 - x, y0 - y), picture, ivec2(x0, y0), ivec2(x1 - x0, y1 - y0));
}

void ScreenExtent::take(const gl::Texture& picture, gl::Texture& part) const {
  part.clear(vec4(std::numeric_limits<float>::infinity()));
  const int x0 = std::max(x, 0), y0 = std::max(y, 0);
  const int x1 = std::min(x + part.width(), picture.width()),
            y1 = std::min(y + part.height(), picture.height());
  if (x1 <= x0 || y1 <= y0) return;
  gl::copy(picture, ivec2(x0, y0), part, ivec2(x0 - x, y0 - y), ivec2(x1 - x0, y1 - y0));
}

}  // namespace sfumato::layers
