// Layers by the letter of the papers, in double and without a graphics card: Dobrev, Rosenthal, Linsen 2010,
// Sec. 3 with the filters of Rosenthal and Linsen 2008. A fold over a two-dimensional array per step; points
// are searched anew for every layer.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/camera.h"
#include "core/image.h"

namespace sfumato::testing::layers_oracle {

struct Point {
  dvec3 eye{0};
  dvec3 color{0};  ///< linear
  double opacity = 1;
  dvec3 normal_eye{0};  ///< 0: none
};

struct Options {
  int layers = 4, background_iterations = 1, occluded_iterations = 1, smoothing_iterations = 1;
  double d_min = 0;
  bool scale_by_angle = false, antialias = true;
};

struct Pixel {
  double depth = INFINITY;
  int point = -1;
};
using Layer = Image<Pixel>;
using Colors = Image<glm::dvec4>;

template <class T>
T at_or(const Image<T>& image, int x, int y, const T& outside) {
  return x < 0 || y < 0 || x >= image.width() || y >= image.height() ? outside : image.at(x, y);
}

inline Layer nearest(const std::vector<Point>& points, const Camera& camera, const Image<double>& limit) {
  Layer layer(camera.width, camera.height);
  const Intrinsics k = camera.intrinsics();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const dvec3& p = points[i].eye;
    const double w = camera.orthographic() ? 1 : -p.z;
    const int x = int(std::floor(k.fx * p.x / w + k.cx)), y = int(std::floor(-k.fy * p.y / w + k.cy));
    if (-p.z <= 0 || x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
    if (-p.z < limit.at(x, y) || -p.z >= layer.at(x, y).depth) continue;
    layer.at(x, y) = {-p.z, int(i)};
  }
  return layer;
}

/// The eight masks as printed (Rosenthal and Linsen 2008, Fig. 4); 1 = must be white.
inline Layer fill(const Layer& in, bool occluded, double d_min) {
  constexpr std::array<const char*, 8> masks = {"011011011", "111111000", "110110110", "000111111",
                                                "111011001", "111110100", "100110111", "001011111"};
  Layer out = in;
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x) {
      const double d = in.at(x, y).depth;
      if (std::isinf(d) == occluded) continue;
      bool stays = false;
      for (const char* mask : masks) {
        bool matches = true;
        for (int cell = 0; cell < 9; ++cell) {
          if (cell == 4 || mask[cell] == '0') continue;
          const double other = at_or(in, x + cell % 3 - 1, y + cell / 3 - 1, {}).depth;
          matches = matches && (occluded ? other > d - d_min : std::isinf(other));
        }
        stays = stays || matches;
      }
      if (stays) continue;
      Pixel best;
      for (int cell = 0; cell < 9; ++cell) {
        const Pixel other = at_or(in, x + cell % 3 - 1, y + cell / 3 - 1, {});
        if (cell != 4 && other.depth < best.depth) best = other;
      }
      out.at(x, y) = best;
    }
  return out;
}

inline Colors smooth(const Colors& in, const Layer& layer, double d_min) {
  Colors out(in.width(), in.height(), glm::dvec4(0));
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x) {
      const double d = layer.at(x, y).depth;
      if (std::isinf(d)) continue;
      double weights = 0;
      for (int cell = 0; cell < 9; ++cell) {
        const int dx = cell % 3 - 1, dy = cell / 3 - 1;
        if (!(std::abs(at_or(layer, x + dx, y + dy, {}).depth - d) <= d_min)) continue;
        const double weight = 4 / std::pow(2, std::abs(dx) + std::abs(dy));  // 1 2 1, 2 4 2, 1 2 1
        out.at(x, y) += weight * in.at(x + dx, y + dy);
        weights += weight;
      }
      out.at(x, y) /= weights;
    }
  return out;
}

inline Colors antialias(const Colors& in, const Layer& layer, double d_min) {
  Colors out = in;
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x) {
      const double d = layer.at(x, y).depth;
      bool marked = false;
      for (auto [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const double other = at_or(layer, x + dx, y + dy, {}).depth;
        marked = marked || (std::isinf(d) != std::isinf(other)) || std::abs(other - d) > d_min;
      }
      if (!marked) continue;
      out.at(x, y) = glm::dvec4(0);
      for (int cell = 0; cell < 9; ++cell) {
        const int dx = cell % 3 - 1, dy = cell / 3 - 1;
        const double weight = 0.25 / std::pow(2, std::abs(dx) + std::abs(dy));
        out.at(x, y) += weight * at_or(in, x + dx, y + dy, glm::dvec4(0));
      }
    }
  return out;
}

struct Result {
  Colors color;         ///< premultiplied
  Image<double> depth;  ///< of the first layer
};

/// Unlit. `camera` has the guard band that the operators need; the result has `guard` pixels less on each
/// side.
inline Result render(const std::vector<Point>& points, const Camera& camera, int guard,
                     const Options& options) {
  const int w = camera.width, h = camera.height;
  const Intrinsics k = camera.intrinsics();
  Image<double> limit(w, h, 0), first_depth(w, h, INFINITY);
  Colors front(w, h, glm::dvec4(0));
  for (int n = 0; n < options.layers; ++n) {
    Layer layer = nearest(points, camera, limit);
    for (int i = 0; i < options.background_iterations; ++i) layer = fill(layer, false, options.d_min);
    for (int i = 0; i < options.occluded_iterations; ++i) layer = fill(layer, true, options.d_min);
    Colors color(w, h, glm::dvec4(0));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const Pixel& pixel = layer.at(x, y);
        if (n == 0) first_depth.at(x, y) = pixel.depth;
        if (pixel.point < 0) continue;
        const Point& p = points[std::size_t(pixel.point)];
        color.at(x, y) = glm::dvec4(p.color * p.opacity, p.opacity);
      }
    for (int i = 0; i < options.smoothing_iterations; ++i) color = smooth(color, layer, options.d_min);
    if (options.antialias) color = antialias(color, layer, options.d_min);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        glm::dvec4& c = front.at(x, y);
        c += (1 - c.a) * color.at(x, y);
        const Pixel& pixel = layer.at(x, y);
        double gap = options.d_min;
        if (options.scale_by_angle && pixel.point >= 0) {
          const dvec3 n_eye = points[std::size_t(pixel.point)].normal_eye;
          const dvec3 ray =
              camera.orthographic()
                  ? dvec3(0, 0, -1)
                  : glm::normalize(dvec3((x + 0.5 - k.cx) / k.fx, -(y + 0.5 - k.cy) / k.fy, -1));
          if (glm::length(n_eye) > 0.5) gap /= std::max(std::abs(glm::dot(n_eye, ray)), 0.1);
        }
        const double bin = std::exp2(std::floor(std::log2(options.d_min / 2)));
        const double next = std::isinf(pixel.depth) ? INFINITY : std::ceil((pixel.depth + gap) / bin) * bin;
        limit.at(x, y) = 1 - c.a < 1e-3 ? INFINITY : std::max(limit.at(x, y), next);
      }
  }
  Result result{Colors(w - 2 * guard, h - 2 * guard), Image<double>(w - 2 * guard, h - 2 * guard)};
  for (int y = 0; y < result.depth.height(); ++y)
    for (int x = 0; x < result.depth.width(); ++x) {
      result.color.at(x, y) = front.at(x + guard, y + guard);
      result.depth.at(x, y) = first_depth.at(x + guard, y + guard);
    }
  return result;
}

}  // namespace sfumato::testing::layers_oracle
