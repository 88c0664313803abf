// What shaders share (frame.glsl, cloud.glsl, splat.glsl), for the loops that do their work where OpenGL is
// software. Same arithmetic; inlined, so that a loop for wider registers has them too.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/packing.hpp>
#include <vector>

#include "core/color.h"
#include "passes/gpu_cloud.h"
#include "passes/relief.h"
#include "passes/view.h"

namespace sfumato::cpu {

/// Pixels of a row at a time.
constexpr int lanes = 8;

/// What the shaders know as `frame`.
struct Eye {
  explicit Eye(const View& view) : eye_from_cloud(view.eye_from_cloud()) {
    const Camera& camera = view.camera();
    const Intrinsics k = camera.whole_intrinsics();
    orthographic = camera.orthographic();
    near_plane = float(camera.near_plane), near = 1e-4f * float(camera.far_plane);
    pixels_per_unit = float(camera.pixels_per_unit());
    focal = vec2(float(k.fx), -float(k.fy)), middle = vec2(k.cx, k.cy);
    tile = vec2(camera.tile_origin()), size = vec2(camera.width, camera.height);
    room = 1e-3f + 2.5e-7f * float(std::max(camera.whole_width(), camera.whole_height()));
    slopes_x.resize(std::size_t(camera.width + lanes));
    slopes_y.resize(std::size_t(camera.height));
    for (std::size_t x = 0; x < slopes_x.size(); ++x)
      slopes_x[x] = (float(x) + 0.5f + tile.x - middle.x) / focal.x;
    for (std::size_t y = 0; y < slopes_y.size(); ++y)
      slopes_y[y] = (float(y) + 0.5f + tile.y - middle.y) / focal.y;
  }
  float pixels_at(float depth) const { return orthographic ? pixels_per_unit : pixels_per_unit / depth; }
  vec3 to_camera(const vec3& eye) const { return orthographic ? vec3(0, 0, 1) : glm::normalize(-eye); }
  vec3 turned(const vec3& v) const {
    return vec3(eye_from_cloud[0]) * v.x + vec3(eye_from_cloud[1]) * v.y + vec3(eye_from_cloud[2]) * v.z;
  }
  vec2 pixel_from_eye(const vec3& eye) const {
    return focal * vec2(eye) / (orthographic ? 1.0f : -eye.z) + middle - tile;
  }

  mat4 eye_from_cloud;
  bool orthographic;
  float near_plane;
  float near;  ///< hits of discs nearer than that are not drawn
  float pixels_per_unit, room;
  vec2 focal, middle, tile, size;
  std::vector<float> slopes_x, slopes_y;  ///< of the rays of columns and rows
};

/// point_noise.glsl, at a place in eye space.
[[gnu::always_inline]] inline float point_noise_at(const Relief::Options& look, const vec3& eye) {
  if (look.sensor_noise == 0) return look.noise;
  const vec3 away = eye - look.sensor;
  return look.sensor_noise * glm::dot(away, away);
}

/// The points of a chunk as shaders read them.
struct Points {
  /// What is not asked for stays null.
  struct Reads {
    bool normals = true, radii = true, colors = true;
  };
  Points(GpuCloud& cloud, std::size_t c, const Reads& reads) {
    GpuCloud::Chunk& chunk = cloud.chunks()[c];
    const auto at = [](const gl::TextureBuffer* buffer) {
      return buffer ? buffer->buffer().memory() : nullptr;
    };
    positions = static_cast<const vec3*>(at(&cloud.positions(chunk)));
    source_index = static_cast<const std::uint32_t*>(at(&cloud.source_index(chunk)));
    if (reads.normals) normals = static_cast<const std::uint32_t*>(at(&cloud.normals(chunk)));
    if (reads.radii) radii = static_cast<const vec2*>(at(&cloud.radii(chunk)));
    if (reads.colors) colors = static_cast<const Rgba8*>(at(&cloud.colors(chunk)));
    field = at(cloud.field(chunk));
    opacity = static_cast<const float*>(at(cloud.opacity(chunk)));
    if (cloud.has_shadow()) shadow = static_cast<const float*>(at(&cloud.shadow(chunk)));
  }

  /// Unit normal in cloud space, or 0 where the cloud knows none.
  vec3 normal(std::uint32_t i) const {
    const std::uint32_t code = normals[i];
    if (code == 0) return vec3(0);
    const vec2 e = vec2(float(code & 0xffff) / 65535, float(code >> 16) / 65535) * 2.0f - 1.0f;
    vec3 n(e, 1 - std::abs(e.x) - std::abs(e.y));
    if (n.z < 0) {
      const vec2 folded = 1.0f - glm::abs(vec2(n.y, n.x));
      n.x = n.x >= 0 ? folded.x : -folded.x;
      n.y = n.y >= 0 ? folded.y : -folded.y;
    }
    return glm::normalize(n);
  }

  float field_at(std::uint32_t i) const { return static_cast<const float*>(field)[i]; }
  vec2 fields_at(std::uint32_t i) const {
    return glm::unpackHalf2x16(static_cast<const std::uint32_t*>(field)[i]);
  }
  vec3 linear_color(std::uint32_t i) const {
    const Rgba8 srgb = colors[i];
    return {linear[srgb.r], linear[srgb.g], linear[srgb.b]};
  }

  const vec3* positions = nullptr;
  const std::uint32_t *source_index = nullptr, *normals = nullptr;
  const vec2* radii = nullptr;
  const Rgba8* colors = nullptr;
  const void* field = nullptr;
  const float *opacity = nullptr, *shadow = nullptr;
  const float* linear = linear_of_srgb_codes().data();
};

[[gnu::always_inline]] inline bool is_cut(const GpuCloud::Cut& cut, const vec3& position) {
  for (const vec4& plane : cut.planes)
    if (glm::dot(vec3(plane), position) + plane.w > 0) return true;
  if (cut.heights.empty()) return false;
  const vec4 p(position, 1);
  const float u = glm::dot(cut.u, p), v = glm::dot(cut.v, p);
  if (!(u >= 0 && v >= 0 && u < float(cut.across) && v < float(cut.across))) return false;
  return glm::dot(cut.up, position) > cut.heights[std::size_t(int(v) * cut.across + int(u))];
}

/// splat_weight of shaders/splat.glsl (H. Wendland, 1995), of a squared distance from the centre in radii.
[[gnu::always_inline]] inline float wendland(float rho2) {
  const float rho = std::sqrt(rho2), rest = 1 - rho;
  return rest * rest * rest * rest * (4 * rho + 1);
}

/// What of a splat the pixels ask for.
struct Disc {
  vec3 center;  // eye
  float behind;
  vec3 normal;  // eye, unit
  float radius;
  std::uint16_t first_x, first_y, last_x, last_y;  // pixels
  std::uint32_t point;                             // of its chunk
};

/// splat_pixels of shaders/splat.glsl.
[[gnu::always_inline]] inline bool find_pixels(Disc& disc, const Eye& eye, float prefilter_px) {
  const float depth = -disc.center.z, r2 = disc.radius * disc.radius;
  const vec3 n = disc.normal;
  vec2 a = r2 * glm::max(1.0f - vec2(n) * vec2(n), vec2(0)), b = r2 * vec2(n) * n.z;
  float d = r2 * std::max(1 - n.z * n.z, 0.0f);
  if (!(disc.radius > 0) || depth + std::sqrt(d) < eye.near) return false;
  vec2 low(-1), high = eye.size;
  const bool anywhere = [&] {
    vec2 lo, hi;
    if (eye.orthographic) {
      lo = vec2(disc.center) - glm::sqrt(a);
      hi = vec2(disc.center) + glm::sqrt(a);
    } else {
      if (depth <= 0) return true;
      const float unit = 1 / depth, unit2 = unit * unit;
      const vec2 c = vec2(disc.center) * unit;
      a *= unit2, b *= unit2, d *= unit2;
      const float front = 1 - d;
      if (front <= 1e-6f) return true;
      const vec2 root = glm::sqrt(glm::max((b * b - a * d) - 2.0f * b * c + a + c * c * d, vec2(0)));
      lo = (c - b - root) / front;
      hi = (c - b + root) / front;
    }
    const vec2 one = lo * eye.focal + eye.middle - eye.tile, two = hi * eye.focal + eye.middle - eye.tile;
    low = glm::min(one, two), high = glm::max(one, two);
    return false;
  }();
  if (!anywhere && prefilter_px > 0 && depth > 0) {
    const vec2 center = eye.pixel_from_eye(disc.center);
    low = glm::min(low, center - prefilter_px);
    high = glm::max(high, center + prefilter_px);
  }
  const vec2 first = glm::clamp(glm::ceil(glm::max(low - 0.5f - eye.room, vec2(-1))), vec2(0), eye.size);
  const vec2 last = glm::min(glm::floor(glm::min(high - 0.5f + eye.room, eye.size)), eye.size - 1.0f);
  if (!(first.x <= last.x && first.y <= last.y)) return false;
  disc.first_x = std::uint16_t(first.x), disc.first_y = std::uint16_t(first.y);
  disc.last_x = std::uint16_t(last.x), disc.last_y = std::uint16_t(last.y);
  return true;
}

}  // namespace sfumato::cpu
