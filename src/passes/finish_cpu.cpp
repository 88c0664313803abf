#include "passes/finish_cpu.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/wide.h"
#include "passes/loops_cpu.h"
#include "passes/openness_cpu.h"
#include "passes/shaders_cpu.h"

namespace sfumato {
namespace {

using cpu::for_each_row;
using cpu::lanes;

/// Shaders clamp what they look up to the picture: here it has a border of its last pixels.
class Bordered {
 public:
  /// `fill` writes a row of the picture.
  template <class Fill>
  Bordered(int width, int height, int border, const Fill& fill)
      : border_(border), pixels_(width + 2 * border + lanes, height + 2 * border) {
    for_each_row(pixels_.height(), [&](int y) {
      float *row = &pixels_.at(0, y), *picture = row + border;
      fill(std::clamp(y - border, 0, height - 1), picture);
      std::fill(row, picture, picture[0]);
      std::fill_n(picture + width, border + lanes, picture[width - 1]);
    });
  }
  Bordered(const Image<float>& image, int border)
      : Bordered(image.width(), image.height(), border,
                 [&](int y, float* to) { std::copy_n(image.row(y), image.width(), to); }) {}
  const float& at(int x, int y) const { return pixels_.at(x + border_, y + border_); }
  const float& at(const ivec2& p) const { return at(p.x, p.y); }

 private:
  int border_;
  Image<float> pixels_;
};

// relief.glsl.

constexpr int compass = 8;  // opposite ways follow each other
constexpr float most_near = 0.008f, darkest = 1.2f, along_radii = 3, within_radii = 0.25f, own_way = 0.1f,
                steepest = 4, fine_px = 2.5f, coarse_px = 6, well_opened = 0.35f, most_sudden = 1.5f,
                least_spacings = 1, enough_spacings = 2;

/// What eight neighbours of pixels side by side tell.
struct Around {
  float behind[compass][lanes], bounded[compass][lanes];
  float any[lanes];  ///< above 0 where one of them is bounded from below
};

/// What of the normals of a picture lies across it, and how far surfaces face the camera.
struct Surfaces {
  Surfaces(const View& view, const Image<float>& depths, const Image<vec4>& normals, int border)
      : eye(view),
        normal(normals),
        right(normal.width(), normal.height(), border, [&](int y, float* to) { along_axis(0, y, to); }),
        above(normal.width(), normal.height(), border, [&](int y, float* to) { along_axis(1, y, to); }),
        depth(normal.width(), normal.height(), border, [&](int y, float* to) {
          for (int x = 0; x < normal.width(); ++x) {
            const vec3 n(normal.at(x, y));
            to[x] = glm::dot(n, n) < 0.25f ? INFINITY : depths.at(x, y);
          }
        }) {}
  void along_axis(int axis, int y, float* to) const {
    for (int x = 0; x < normal.width(); ++x) to[x] = eye.turned(vec3(normal.at(x, y)))[axis];
  }
  float facing(int x, int y) const {
    const vec3 ray(eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(y)], -1);
    return std::abs(glm::dot(eye.turned(vec3(normal.at(x, y))), eye.to_camera(ray)));
  }

  cpu::Eye eye;
  const Image<vec4>& normal;
  Bordered right, above;
  Bordered depth;  ///< infinite where there is no normal
};

struct ReliefLoop {
  ReliefLoop(const View& view, const Relief::Options& options, float square, const Bordered& depths,
             const Image<vec2>& openness, const Surfaces* normals)
      : look(options),
        radius_px(Relief::radius_px(options, view.picture_height())),
        orthographic_distance(Relief::orthographic_distance(view)),
        depth(depths),
        open(openness),
        surfaces(normals),
        columns(between(view.width(), square, openness.width())),
        rows(between(view.height(), square, openness.height())),
        orthographic(view.camera().orthographic()),
        pixels_per_unit(float(view.camera().pixels_per_unit())) {
    for (int k = 0; k < Relief::scaling_distances; ++k)
      scaling_px[k] = Relief::scaling_px(k, view.picture_height());
    for (int k = 0; k < compass; ++k) {
      const float angle = float(k / 2) * 0.785398163f, side = k % 2 == 0 ? 1.0f : -1.0f;
      aways[k] = side * radius_px * vec2(std::cos(angle), std::sin(angle));
      offsets[k] = ivec2(glm::floor(aways[k] + 0.5f));
    }
  }

  /// Between the centres of four squares.
  struct Between {
    int low, high;
    float t;
  };
  static std::vector<Between> between(int pixels, float square_px, int squares) {
    std::vector<Between> out;
    for (int i = 0; i < pixels; ++i) {
      const float at = (float(i) + 0.5f) / square_px - 0.5f, low = std::floor(at);
      out.push_back(
          {std::clamp(int(low), 0, squares - 1), std::clamp(int(low) + 1, 0, squares - 1), at - low});
    }
    return out;
  }
  [[gnu::always_inline]] vec2 around(const Between& x, const Between& y) const {
    return (1 - x.t) * (1 - y.t) * open.at(x.low, y.low) + x.t * (1 - y.t) * open.at(x.high, y.low) +
           (1 - x.t) * y.t * open.at(x.low, y.high) + x.t * y.t * open.at(x.high, y.high);
  }

  [[gnu::always_inline]] void look_around(int x, int y, const float* noises, Around& out) const {
    const float* own = &depth.at(x, y);
    const float* neighbors[compass];
    for (int k = 0; k < compass; ++k) neighbors[k] = &depth.at(x + offsets[k].x, y + offsets[k].y);
    for (int i = 0; i < lanes; ++i) {
      const float d = own[i], pixels = pixels_at(d);
      const float scale = 1 / ((orthographic ? orthographic_distance : d) * 0.69314718f);
      const float lowest = -steepest * radius_px / pixels;
      float sum = 0;
      for (int k = 0; k < compass; k += 2) {
        const float a = d - neighbors[k][i], b = d - neighbors[k + 1][i];
        // A plane lies before it on one side as far as behind on the other. Background is no side.
        const float slope_a = b > -INFINITY ? std::min(std::max(b, lowest), 0.0f) : 0,
                    slope_b = a > -INFINITY ? std::min(std::max(a, lowest), 0.0f) : 0;
        const float of_a = std::clamp((a + slope_a - noises[i]) * scale, 0.0f, most_near),
                    of_b = std::clamp((b + slope_b - noises[i]) * scale, 0.0f, most_near);
        out.behind[k][i] = a, out.behind[k + 1][i] = b;
        out.bounded[k][i] = of_a, out.bounded[k + 1][i] = of_b;
        sum += of_a + of_b;
      }
      out.any[i] = sum;
    }
  }

  /// Of eye-dome lighting, of pixels side by side of which one has something in front.
  [[gnu::always_inline]] void darken(int x, int y, const Around& of, float* shades) const {
    const float* own = &depth.at(x, y);
    float toward_x[lanes] = {}, toward_y[lanes] = {}, response[lanes] = {}, lighter[lanes];
    for (int k = 0; k < compass; ++k)
      for (int i = 0; i < lanes; ++i) {
        const float bounded = of.bounded[k][i] > 0 ? of.bounded[k][i] : 0;  // nothing has no depth
        toward_x[i] += bounded * aways[k].x, toward_y[i] += bounded * aways[k].y;
      }
    const float within = within_radii * radius_px, beside = along_radii * radius_px;
    for (int k = 0; k < compass; ++k) {
      float any = 0;
      for (int i = 0; i < lanes; ++i) any += lighter[i] = of.bounded[k][i] > 0 ? of.bounded[k][i] : 0;
      if (!(any > 0)) continue;
      // To both sides of where it was met.
      int at_x[2][lanes], at_y[2][lanes];
      for (int i = 0; i < lanes; ++i) {
        float way_x = toward_x[i] + own_way * lighter[i] * aways[k].x,
              way_y = toward_y[i] + own_way * lighter[i] * aways[k].y;
        const float unit = 1 / std::sqrt(std::max(way_x * way_x + way_y * way_y, 1e-30f));
        way_x *= unit, way_y *= unit;
        const vec2 middle(aways[k].x + within * way_x, aways[k].y + within * way_y);
        const float center_x = float(x + i) + 0.5f, center_y = float(y) + 0.5f;
        at_x[0][i] = int(std::floor(center_x + (middle.x - beside * way_y)));
        at_y[0][i] = int(std::floor(center_y + (middle.y + beside * way_x)));
        at_x[1][i] = int(std::floor(center_x + (middle.x + beside * way_y)));
        at_y[1][i] = int(std::floor(center_y + (middle.y - beside * way_x)));
      }
      float there[2][lanes];
      for (int side = 0; side < 2; ++side)
        for (int i = 0; i < lanes; ++i) there[side][i] = depth.at(at_x[side][i], at_y[side][i]);
      for (int i = 0; i < lanes; ++i) {
        const float behind = of.behind[k][i], a = own[i] - behind - there[0][i],
                    b = own[i] - behind - there[1][i], half = 0.5f * std::abs(a + b);
        const float of_a = std::max(1 - 2.0f / behind * std::min(std::abs(a), half), 0.0f),
                    of_b = std::max(1 - 2.0f / behind * std::min(std::abs(b), half), 0.0f);
        response[i] += lighter[i] > 0 ? lighter[i] * (0.5f * of_a + 0.5f * of_b) : 0;
      }
    }
    for (int i = 0; i < lanes; ++i) {
      if (!(of.any[i] > 0)) continue;
      const float exponent = response[i] / 8 * 300 * look.edl_strength * 2.2f;
      shades[i] *= std::exp(-darkest * (1 - std::exp(-exponent / darkest)));
    }
  }

  [[gnu::always_inline]] static float bounded(float angle, float most) {
    return std::clamp(angle, std::min(most, 0.0f), std::max(most, 0.0f));
  }

  /// ridge_at of pixels side by side, as if they faced the camera.
  [[gnu::always_inline]] void find_ridges(int x, int y, float* ridges) const {
    const float* own = &surfaces->depth.at(x, y);
    float half_turned[2][lanes] = {}, half_angles[2][lanes] = {}, half_counts[2][lanes] = {};
    int half_px[2] = {};
    float of_points[lanes];
    for (int i = 0; i < lanes; ++i) of_points[i] = point_noise_at(x + i, y, own[i]);
    std::fill_n(ridges, lanes, 0.0f);
    for (int k = 0; k < Relief::scaling_distances; ++k) {
      const int px = scaling_px[k];
      float angles[lanes] = {};
      for (int axis = 0; axis < 2; ++axis) {
        const ivec2 away = axis == 0 ? ivec2(px, 0) : ivec2(0, -px), a(x + away.x, y + away.y),
                    b(x - away.x, y - away.y);
        const Bordered& normal = axis == 0 ? surfaces->right : surfaces->above;
        const float *normal_a = &normal.at(a), *normal_b = &normal.at(b), *depth_a = &surfaces->depth.at(a),
                    *depth_b = &surfaces->depth.at(b);
        for (int i = 0; i < lanes; ++i) {
          const float reach = steepest * float(px) / pixels_at(own[i]);
          const float farther = std::max(std::abs(depth_a[i] - own[i]), std::abs(depth_b[i] - own[i]));
          angles[i] += farther < reach ? 0.5f * (normal_a[i] - normal_b[i]) : 0.0f;
        }
      }
      for (int i = 0; i < lanes; ++i) {
        const float pixels = pixels_at(own[i]), noise = 4 * of_points[i] * pixels / float(px);
        const float spacings = float(px) / std::max(look.median_spacing * pixels, 1e-6f);
        const float turned = angles[i], promised = most_sudden * float(px) * half_angles[k % 2][i],
                    added = most_sudden * float(px) / float(px - half_px[k % 2]) *
                            (turned - half_turned[k % 2][i]);
        const float bound = half_counts[k % 2][i],
                    angle = turned * (1 - bound) + bounded(bounded(turned, promised), added) * bound;
        const float counts = glm::smoothstep(least_spacings, enough_spacings, spacings);
        half_turned[k % 2][i] = turned, half_angles[k % 2][i] = angle / float(px),
                        half_counts[k % 2][i] = counts;
        if (k >= 2) ridges[i] += std::copysign(std::max(std::abs(angle) - noise, 0.0f), angle) * counts;
      }
      half_px[k % 2] = px;
    }
    for (int i = 0; i < lanes; ++i)
      ridges[i] = own[i] < INFINITY ? ridges[i] / (Relief::scaling_distances - 2) : 0;
  }

  [[gnu::always_inline]] void row(int y, Image<vec4>& color) const {
    const int width = color.width();
    Around of;
    float noises[lanes] = {}, shades[lanes] = {}, ridges[lanes] = {};
    for (int first = 0; first < width; first += lanes) {
      const int n = std::min(lanes, width - first);
      const float* own = &depth.at(first, y);
      vec4* pixels = &color.at(first, y);
      bool covered = false;
      for (int i = 0; i < n; ++i) covered = covered || (own[i] < INFINITY && pixels[i].a > 0);
      if (!covered) continue;
      for (int i = 0; i < n; ++i) {
        const vec2 here = around(columns[std::size_t(first + i)], rows[std::size_t(y)]);
        const float between = look.spacing * pixels_at(own[i]);
        noises[i] = std::max(look.spacing * glm::smoothstep(fine_px, coarse_px, between), here.y);
        shades[i] = 1 - look.occlusion + look.occlusion * here.x;
      }
      if (look.edl_strength > 0) {
        look_around(first, y, noises, of);
        if (std::any_of(of.any, of.any + n, [](float any) { return any > 0; })) darken(first, y, of, shades);
      }
      if (surfaces) find_ridges(first, y, ridges);
      for (int i = 0; i < n; ++i) {
        if (!(own[i] < INFINITY && pixels[i].a > 0)) continue;
        vec3 shaded = vec3(pixels[i]) * shades[i];
        if (surfaces) {
          const float lightest = std::max({shaded.r, shaded.g, shaded.b, 1e-6f});
          const float ridge = ridges[i] == 0 ? 0 : ridges[i] * surfaces->facing(first + i, y);
          const float gain = std::exp(look.scaling * std::tanh(ridge / well_opened));
          shaded *= std::min(gain, std::max(pixels[i].a / lightest, 1.0f));
        }
        pixels[i] = vec4(shaded, pixels[i].a);
      }
    }
  }

  /// point_noise.glsl
  [[gnu::always_inline]] float point_noise_at(int x, int y, float d) const {
    const vec2 slope(surfaces->eye.slopes_x[std::size_t(x)], surfaces->eye.slopes_y[std::size_t(y)]);
    return cpu::point_noise_at(look, vec3(slope * (orthographic ? 1 : d), -d));
  }
  float pixels_at(float d) const { return orthographic ? pixels_per_unit : pixels_per_unit / d; }

  const Relief::Options& look;
  float radius_px, orthographic_distance;
  int scaling_px[Relief::scaling_distances];
  const Bordered& depth;
  const Image<vec2>& open;
  const Surfaces* surfaces;  ///< null without radiance scaling
  std::vector<Between> columns, rows;
  bool orthographic;
  float pixels_per_unit;
  vec2 aways[compass];
  ivec2 offsets[compass];
};

SFUMATO_WIDE void shade_row(const ReliefLoop& loop, int y, Image<vec4>& color) { loop.row(y, color); }

// depth_edges.glsl.

enum Edge : std::uint8_t { above = 1, below = 2, left = 4, right = 8 };

struct EdgeFinder {
  const Bordered& depth;
  bool orthographic;
  float pixels_per_unit;

  /// Of pixels side by side, 1 where there is an edge with those `across`.
  [[gnu::always_inline]] void find(int x, int y, const ivec2& across, std::int32_t* out) const {
    constexpr float steepest_px = 4, sharpest = 2;
    const float *before = &depth.at(x - across.x, y - across.y), *here = &depth.at(x, y),
                *there = &depth.at(x + across.x, y + across.y),
                *beyond = &depth.at(x + 2 * across.x, y + 2 * across.y);
    for (int i = 0; i < lanes; ++i) {
      const float h = here[i], t = there[i], b = before[i], f = beyond[i];
      const bool is_here = h < INFINITY, is_there = t < INFINITY;
      const float jump = std::abs(t - h), nearer = std::min(h, t);
      const float pixels = orthographic ? pixels_per_unit : pixels_per_unit / nearer;
      const float slope_b = b < INFINITY ? std::abs(h - b) : 0, slope_f = f < INFINITY ? std::abs(f - t) : 0;
      const bool is_sharp = (jump * pixels > steepest_px) & (jump > sharpest * std::max(slope_b, slope_f));
      out[i] = (is_here != is_there) | (is_here & is_there & is_sharp);
    }
  }
};

SFUMATO_WIDE void find_edges(const EdgeFinder& finder, int y, Image<std::uint8_t>& edges) {
  const int width = edges.width();
  std::int32_t beside[lanes], under[lanes];
  for (int first = 0; first < width; first += lanes) {
    finder.find(first, y, {1, 0}, beside), finder.find(first, y, {0, 1}, under);
    const int n = std::min(lanes, width - first);
    for (int i = 0; i < n; ++i)
      edges.at(first + i, y) = std::uint8_t((beside[i] ? right : 0) | (under[i] ? below : 0));
  }
}

// smooth_outlines.glsl.

struct Outlines {
  const Image<std::uint8_t>& edges;  ///< with the pixels below and on the right
  const Image<float>& depth;

  ivec2 clamped(const ivec2& p) const {
    return glm::clamp(p, ivec2(0), ivec2(depth.width() - 1, depth.height() - 1));
  }
  bool is_edge(const ivec2& pixel, const ivec2& across) const {
    const ivec2 at = clamped(glm::min(pixel, pixel + across));
    return edges.at(at.x, at.y) & (across.x != 0 ? right : below);
  }
  float depth_at(const ivec2& pixel) const {
    const ivec2 at = clamped(pixel);
    return depth.at(at.x, at.y);
  }
  float step_at_corner(const ivec2& at, const ivec2& across, const ivec2& way) const {
    const float ours = depth_at(at), other = depth_at(at + across), next = depth_at(at + way),
                beyond = depth_at(at + across + way);
    if (std::max(ours, beyond) < std::min(other, next)) return -0.5f;
    return std::max(other, next) < std::min(ours, beyond) ? 0.5f : 0;
  }
  bool is_thin_end(const ivec2& at, const ivec2& across, const ivec2& way) const {
    if (depth_at(at) > depth_at(at + across)) return false;
    const ivec2 under = at - across;
    if (is_edge(at, -across)) return !is_edge(under, way);
    return is_edge(under, way) && is_edge(under, -across) && !is_edge(under - across, way);
  }
  vec2 end_of_edge(const ivec2& pixel, const ivec2& across, const ivec2& way) const {
    constexpr int reach = 12;
    bool ours = false, other = false;
    int i = 0;
    for (; i < reach; ++i) {
      const ivec2 at = pixel + i * way;
      ours = is_edge(at, way), other = is_edge(at + across, way);
      if (ours || other || !is_edge(at + way, across)) break;
    }
    const ivec2 at = pixel + i * way;
    float turn = 0;
    if (ours != other)
      turn = !ours ? -0.5f : is_thin_end(at, across, way) ? 0 : 0.5f;
    else if (ours)
      turn = step_at_corner(at, across, way);
    return {float(i), turn};
  }
  float share_across(const ivec2& pixel, const ivec2& across) const {
    const ivec2 way(across.y, across.x);
    const vec2 one = end_of_edge(pixel, across, -way), two = end_of_edge(pixel, across, way);
    const float middle = 0.5f * (one.x + two.x + 1);
    float from = std::min(one.x, middle), to = std::min(one.x + 1, middle);
    const float of_one = one.y * (to - from) * (1 - 0.5f * (from + to) / middle);
    from = std::max(one.x, middle), to = std::max(one.x + 1, middle);
    const float of_two = two.y * (to - from) * (0.5f * (from + to) / middle - 1);
    return std::max(of_one, 0.0f) + std::max(of_two, 0.0f);
  }

  vec4 smoothed(const ivec2& pixel, unsigned sides, const Image<vec4>& color) const {
    static constexpr ivec2 ways[] = {{0, -1}, {0, 1}, {-1, 0}, {1, 0}};  // in the order of Edge
    vec4 sum(0);
    float shares = 0;
    for (; sides != 0; sides &= sides - 1) {
      const ivec2 across = ways[std::countr_zero(sides)], other = pixel + across;
      const float share = share_across(pixel, across);
      sum += share * color.at(other.x, other.y);
      shares += share;
    }
    if (shares > 1) sum /= shares, shares = 1;
    return shares > 0 ? (1 - shares) * color.at(pixel.x, pixel.y) + sum : color.at(pixel.x, pixel.y);
  }
};

// shade.glsl.

float linear(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

struct Shader {
  const RenderSettings& settings;
  const vec4& light;
  cpu::Eye eye;
  vec4 phong;
  float far_plane;

  [[gnu::always_inline]] vec3 lit(const vec3& albedo, const vec3& place, const vec3& normal,
                                  float shadow) const {
    const vec3 to_eye = eye.to_camera(place);
    vec3 to_light = light.w > 0.5f ? vec3(light) - place : vec3(light);
    to_light /= std::max(glm::length(to_light), 1e-30f);
    float diffuse = 1, specular = 0;
    if (glm::dot(normal, normal) > 0.25f) {
      const float facing = glm::dot(normal, to_eye);
      const vec3 n = facing < 0 ? -normal : normal;
      if (light.w < 0)
        to_light = glm::normalize(glm::mix(to_eye, to_light, glm::smoothstep(0.0f, 0.5f, std::abs(facing))));
      diffuse = std::max(glm::dot(n, to_light), 0.0f);
      if (diffuse > 0 && phong.z > 0)
        specular = std::pow(std::max(glm::dot(glm::reflect(-to_light, n), to_eye), 0.0f), phong.w);
    }
    return albedo * (phong.x + shadow * phong.y * diffuse) + shadow * phong.z * specular;
  }

  vec3 nearest_category(const vec3& color) const {
    const vec3* nearest = &color;
    float least = INFINITY;
    for (const vec3& each : settings.palette) {
      const vec3 away = each - color;
      if (glm::dot(away, away) < least) least = glm::dot(away, away), nearest = &each;
    }
    return *nearest;
  }

  [[gnu::always_inline]] void row(int y, const vec4* albedo, const float* depths, const vec4* normals,
                                  vec4* out, int width) const {
    for (int x = 0; x < width; ++x) {
      const float alpha = albedo[x].a;
      if (!(alpha > 0)) {
        out[x] = vec4(0);
        continue;
      }
      vec3 color = vec3(albedo[x]) / alpha;
      if (!settings.palette.empty()) color = nearest_category(color);
      const vec3 normal(normals[x]);
      if (settings.shading == Shading::lit) {
        const vec2 slope(eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(y)]);
        const vec3 place(eye.orthographic ? slope : slope * depths[x], -depths[x]);
        color = lit(color, place, eye.turned(normal), normals[x].w);
      } else if (settings.shading == Shading::normals) {
        const vec3 s = glm::dot(normal, normal) > 0.25f ? normal * 0.5f + 0.5f : vec3(0.5f);
        color = {linear(s.r), linear(s.g), linear(s.b)};
      } else if (settings.shading == Shading::depth) {
        const float near_to_far = (depths[x] - eye.near_plane) / (far_plane - eye.near_plane);
        color = vec3(linear(std::clamp(1 - near_to_far, 0.0f, 1.0f)));
      }
      out[x] = vec4(color * alpha, alpha);
    }
  }
};

SFUMATO_WIDE void shade_pixels(const Shader& shader, int y, const vec4* albedo, const float* depths,
                               const vec4* normals, vec4* out, int width) {
  shader.row(y, albedo, depths, normals, out, width);
}

// finish.glsl.

/// Rounds what srgb_from_linear gives to 8 bits: it is the number of linear values below, halfway between two
/// codes, that are not above it.
class Encoder {
 public:
  Encoder() {
    for (int k = 0; k < 256; ++k) {
      const double s = (k - 0.5) / 255;
      least_[std::size_t(k)] = float(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    least_[0] = -INFINITY, least_[256] = INFINITY;
    int code = 0;
    for (int i = 0; i < steps + 1; ++i) {
      while (float(i) / steps >= least_[std::size_t(code + 1)]) ++code;
      first_[std::size_t(i)] = std::uint8_t(code);
    }
  }
  [[gnu::always_inline]] std::uint8_t operator()(float linear) const {
    const float value = std::min(std::max(linear, 0.0f), 1.0f);  // 0 where it is no number
    int code = first_[std::size_t(value * steps)];
    while (value >= least_[std::size_t(code + 1)]) ++code;
    return std::uint8_t(code);
  }

 private:
  static constexpr int steps = 4096;
  std::array<float, 257> least_;               // that is encoded so
  std::array<std::uint8_t, steps + 1> first_;  // the code of the beginning of each step
};

}  // namespace

void shade_relief(const View& view, const Relief::Options& options, const Image<float>& depth,
                  const Image<vec4>& normal, Image<vec4>& color) {
  const Image<vec2> openness = find_openness(view, options, depth);
  const float square_px = Relief::octaves(options, view.picture_height()).square_px();
  const float farthest = (1 + along_radii + within_radii) * Relief::radius_px(options, view.picture_height());
  const Bordered bordered(depth, int(std::ceil(farthest)) + 1);
  std::optional<Surfaces> surfaces;
  if (options.scaling > 0)
    surfaces.emplace(view, depth, normal,
                     Relief::scaling_px(Relief::scaling_distances - 1, view.picture_height()));
  const ReliefLoop loop(view, options, square_px, bordered, openness, surfaces ? &*surfaces : nullptr);
  for_each_row(color.height(), [&](int y) { shade_row(loop, y, color); });
}

void smooth_outlines(const View& view, const Image<float>& depth, Image<vec4>& color) {
  const int width = color.width(), height = color.height();
  Image<std::uint8_t> edges(width, height);
  {
    const Bordered bordered(depth, 2);
    const EdgeFinder finder{bordered, view.camera().orthographic(), float(view.camera().pixels_per_unit())};
    for_each_row(height, [&](int y) { find_edges(finder, y, edges); });
  }
  // Colours are taken before any is replaced.
  struct Change {
    int x;
    vec4 color;
  };
  std::vector<std::vector<Change>> changes(static_cast<std::size_t>(height));
  const Outlines outlines{edges, depth};
  for_each_row(height, [&](int y) {
    const std::uint8_t *own = edges.row(y), *over = edges.row(std::max(y - 1, 0));
    for (int x = 0; x < width; ++x) {
      unsigned sides = own[x];
      if (y > 0 && (over[x] & below)) sides |= above;
      if (x > 0 && (own[x - 1] & right)) sides |= left;
      if (sides != 0) changes[std::size_t(y)].push_back({x, outlines.smoothed({x, y}, sides, color)});
    }
  });
  for_each_row(height, [&](int y) {
    for (const Change& change : changes[std::size_t(y)]) color.at(change.x, y) = change.color;
  });
}

void shade(const View& view, const RenderSettings& settings, const vec4& light_eye, const Image<vec4>& albedo,
           const Image<float>& depth, const Image<vec4>& normal, Image<vec4>& color) {
  const Phong& phong = settings.phong;
  const Shader shader{
      settings, light_eye, cpu::Eye(view),
      vec4(phong.ambient.value(), phong.diffuse.value(), phong.specular.value(), phong.shininess),
      float(view.camera().far_plane)};
  for_each_row(color.height(), [&](int y) {
    shade_pixels(shader, y, albedo.row(y), depth.row(y), normal.row(y), &color.at(0, y), color.width());
  });
}

void encode(const RenderSettings& settings, const Image<vec4>& color, Image<Rgba8>& rgba8) {
  static const Encoder encoder;
  const Rgba8 background = settings.transparent ? Rgba8{0, 0, 0, 0} : to_rgba8(settings.background);
  const vec3 s = settings.background, behind(linear(s.r), linear(s.g), linear(s.b));
  for_each_row(color.height(), [&](int y) {
    const vec4* from = color.row(y);
    Rgba8* to = &rgba8.at(0, y);
    for (int x = 0; x < color.width(); ++x) {
      vec4 c = from[x];
      if (!(c.a > 0)) {
        to[x] = background;
        continue;
      }
      c.a = std::min(c.a, 1.0f);
      vec3 straight = settings.transparent ? vec3(c) / c.a : vec3(c) + (1 - c.a) * behind;
      to[x] = {encoder(straight.r), encoder(straight.g), encoder(straight.b),
               settings.transparent ? std::uint8_t(c.a * 255 + 0.5f) : std::uint8_t(255)};
    }
  });
}

}  // namespace sfumato
