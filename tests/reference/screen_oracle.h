// Operators on the screen, written again from the papers' equations in double precision over plain arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/image.h"

namespace sfumato::testing {

/// Eye position of a place of the picture at an eye depth.
inline dvec3 unproject(const Camera& camera, double x_px, double y_px, double depth) {
  const Intrinsics k = camera.intrinsics();
  const double x = (x_px - k.cx) / k.fx, y = -(y_px - k.cy) / k.fy;
  return camera.orthographic() ? dvec3(x, y, -depth) : dvec3(x * depth, y * depth, -depth);
}

/// What NearestPyramid starts from: eye positions with that point spacing; where there is none, far behind
/// everything.
inline Image<vec4> eye_positions(const Camera& camera, const Image<float>& depth, float spacing) {
  Image<vec4> eye(depth.width(), depth.height(), vec4(0, 0, -3e38f, 0));
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x)
      if (!std::isinf(depth.at(x, y)))
        eye.at(x, y) = vec4(unproject(camera, x + 0.5, y + 0.5, depth.at(x, y)), spacing);
  return eye;
}

/// Nearest point of the square of 2^level pixels a side with this place in its grid, by looking at every
/// pixel.
inline std::optional<dvec3> nearest_in_square(const Camera& camera, const Image<float>& depth, int x, int y,
                                              int level) {
  const int side = 1 << level;
  std::optional<dvec3> best;
  for (int j = y * side; j < (y + 1) * side; ++j)
    for (int i = x * side; i < (x + 1) * side; ++i) {
      if (i < 0 || j < 0 || i >= depth.width() || j >= depth.height() || std::isinf(depth.at(i, j))) continue;
      if (!best || depth.at(i, j) < -best->z) best = unproject(camera, i + 0.5, j + 0.5, depth.at(i, j));
    }
  return best;
}

/// 1 - cos of the angle at x between y and the camera as seen from y (Bouchiba 2018, Sec. 3.1.2).
inline double occlusion_value(const Camera& camera, const dvec3& x, const dvec3& y) {
  const dvec3 to_camera = camera.orthographic() ? dvec3(0, 0, 1) : glm::normalize(-y);
  return 1 - glm::dot(glm::normalize(y - x), to_camera);
}

/// Mean over eight compass sectors of the least occlusion value of the rings on levels 0..level; the ring
/// beyond the whole part of `level` counts by its fraction. Also the number of neighbours looked at.
struct MeanOcclusion {
  double mean = 0;
  int looked_at = 0;
};
/// `disc`: a looked-at point nearer than 6 spacings that is drawn within that many px hides the pixel, unless
/// most sides of its own point are open.
inline MeanOcclusion mean_occlusion(const Camera& camera, const Image<float>& depth, int px, int py,
                                    double level, double disc_radius = 0, double spacing = 0) {
  bool under_disc = false;
  const bool covered = !std::isinf(depth.at(px, py));
  const dvec3 x = unproject(camera, px + 0.5, py + 0.5, covered ? depth.at(px, py) : 1e4 * camera.far_plane);
  const auto least_up_to = [&](int last, std::array<double, 8>& least) {
    int looked_at = 0;
    for (int l = 0; l <= last; ++l)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          ++looked_at;
          const int sector = int(std::lround(std::atan2(dy, dx) / (M_PI / 4)) + 8) % 8;
          const auto y = nearest_in_square(camera, depth, (px >> l) + dx, (py >> l) + dy, l);
          if (!y) continue;
          least[std::size_t(sector)] = std::min(least[std::size_t(sector)], occlusion_value(camera, x, *y));
          const double scale = camera.pixels_per_unit() / (camera.orthographic() ? 1 : -y->z);
          const Intrinsics k = camera.intrinsics();
          const dvec3 away(scale * y->x + k.cx - (px + 0.5), -scale * y->y + k.cy - (py + 0.5), 0);
          if (glm::length(away) <= (covered ? 1 : 0.7) * disc_radius * spacing * scale &&
              y->z - x.z > 6 * spacing)
            under_disc = true;
        }
    return looked_at;
  };
  std::array<double, 8> low, high;
  low.fill(2), high.fill(2);
  least_up_to(int(std::floor(level)), low);
  MeanOcclusion result;
  result.looked_at = least_up_to(int(std::ceil(level)), high);
  const double t = level - std::floor(level);
  for (std::size_t k = 0; k < 8; ++k) result.mean += ((1 - t) * low[k] + t * high[k]) / 8;
  if (under_disc && (!covered || result.mean < 0.8)) result.mean = 0;
  return result;
}

/// The exhaustive operator over a window (Pintus 2011): sectors of 45 degrees about the compass directions.
inline double window_occlusion(const Camera& camera, const Image<float>& depth, int px, int py, int radius) {
  const bool covered = !std::isinf(depth.at(px, py));
  const dvec3 x = unproject(camera, px + 0.5, py + 0.5, covered ? depth.at(px, py) : 1e4 * camera.far_plane);
  std::array<double, 8> least;
  least.fill(2);
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const auto y = dx || dy ? nearest_in_square(camera, depth, px + dx, py + dy, 0) : std::nullopt;
      if (!y) continue;
      const std::size_t sector = std::size_t(int(std::floor(std::atan2(dy, dx) / (M_PI / 4) + 0.5)) + 8) % 8;
      least[sector] = std::min(least[sector], occlusion_value(camera, x, *y));
    }
  double sum = 0;
  for (double o : least) sum += o;
  return sum / 8;
}

/// Weighted pull-push of one channel: kernel (1 3 3 1), gain 4, bilinear push. A recursion over whole images.
struct Weighted {
  Image<double> value, weight;  ///< value is not premultiplied
};
inline Image<double> pull_push(const Weighted& fine, double gain = 4) {
  const int w = fine.value.width(), h = fine.value.height();
  Image<double> filled = fine.value;
  if (w == 1 && h == 1) return filled;
  Weighted coarse{Image<double>((w + 1) / 2, (h + 1) / 2), Image<double>((w + 1) / 2, (h + 1) / 2)};
  const double kernel[4] = {1 / 8.0, 3 / 8.0, 3 / 8.0, 1 / 8.0};
  for (int y = 0; y < coarse.value.height(); ++y)
    for (int x = 0; x < coarse.value.width(); ++x) {
      double sum = 0, weight = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
          const int fx = 2 * x + i - 1, fy = 2 * y + j - 1;
          if (fx < 0 || fy < 0 || fx >= w || fy >= h) continue;
          const double g = kernel[i] * kernel[j] * fine.weight.at(fx, fy);
          sum += g * fine.value.at(fx, fy);
          weight += g;
        }
      coarse.value.at(x, y) = weight > 0 ? sum / weight : 0;
      coarse.weight.at(x, y) = std::min(1.0, gain * weight);
    }
  const Image<double> above = pull_push(coarse, gain);
  const auto sample = [&](int x, int y) {
    return above.at(std::clamp(x, 0, above.width() - 1), std::clamp(y, 0, above.height() - 1));
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      // Bilinear at the centre of the fine pixel, in coarse coordinates.
      const double cx = (x + 0.5) / 2 - 0.5, cy = (y + 0.5) / 2 - 0.5;
      const int ix = int(std::floor(cx)), iy = int(std::floor(cy));
      const double tx = cx - ix, ty = cy - iy;
      const double b = (1 - ty) * ((1 - tx) * sample(ix, iy) + tx * sample(ix + 1, iy)) +
                       ty * ((1 - tx) * sample(ix, iy + 1) + tx * sample(ix + 1, iy + 1));
      filled.at(x, y) = fine.weight.at(x, y) * fine.value.at(x, y) + (1 - fine.weight.at(x, y)) * b;
    }
  return filled;
}

}  // namespace sfumato::testing
