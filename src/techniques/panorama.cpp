#include "techniques/panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "passes/light.h"

namespace sfumato {
namespace {

/// One of the six views: where it looks, and its pixels.
struct Face {
  dvec3 forward, right, up;
  Camera camera;
  RenderOutput out;

  /// Pixel coordinates of a direction in front of the face; centres at half integers.
  glm::dvec2 place(const dvec3& d) const {
    const Intrinsics k = camera.intrinsics();
    const double z = glm::dot(d, forward);
    return {k.fx * glm::dot(d, right) / z + k.cx, k.cy - k.fy * glm::dot(d, up) / z};
  }
};

float to_linear(std::uint8_t code) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {  // IEC 61966-2-1
      const double c = i / 255.0;
      t[std::size_t(i)] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table[code];
}

std::uint8_t to_code(float linear) {
  const double c = std::clamp(double(linear), 0.0, 1.0);
  return std::uint8_t(std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
}

vec4 premultiplied(const Rgba8& c) {
  const float alpha = float(c.a) / 255.0f;
  return {to_linear(c.r) * alpha, to_linear(c.g) * alpha, to_linear(c.b) * alpha, alpha};
}

Rgba8 straight(const vec4& c) {
  if (c.a <= 0) return {0, 0, 0, 0};
  return {to_code(c.r / c.a), to_code(c.g / c.a), to_code(c.b / c.a),
          std::uint8_t(std::lround(255 * std::min(c.a, 1.0f)))};
}

/// Between the four pixels around a place; `get` gives linear premultiplied colour.
template <class T, class Get>
vec4 sample(const Image<T>& image, const glm::dvec2& place, Get&& get) {
  const double x = std::clamp(place.x - 0.5, 0.0, image.width() - 1.0),
               y = std::clamp(place.y - 0.5, 0.0, image.height() - 1.0);
  const int left = std::min(int(x), image.width() - 2), top = std::min(int(y), image.height() - 2);
  const float u = float(x - left), v = float(y - top);
  return glm::mix(glm::mix(get(image.at(left, top)), get(image.at(left + 1, top)), u),
                  glm::mix(get(image.at(left, top + 1)), get(image.at(left + 1, top + 1)), u), v);
}

}  // namespace

RenderOutput render_panorama(Renderer& renderer, std::span<const Item> items, const Camera& camera,
                             const dvec3& up, const RenderSettings& settings, const RenderWants& wants,
                             Progress& progress) {
  const int width = camera.width, height = camera.height;
  if (width != 2 * height)
    throw Error(ErrorCode::usage, "a panorama is twice as wide as high, not " + std::to_string(width) + "x" +
                                      std::to_string(height));
  const dvec3 level_up = glm::normalize(up);
  dvec3 ahead = camera.direction() - glm::dot(camera.direction(), level_up) * level_up;
  if (glm::length(ahead) < 1e-9) ahead = camera.up - glm::dot(camera.up, level_up) * level_up;
  if (glm::length(ahead) < 1e-9) ahead = std::abs(level_up.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
  ahead = glm::normalize(ahead - glm::dot(ahead, level_up) * level_up);
  const dvec3 right = glm::cross(ahead, level_up);

  RenderSettings fixed = settings;
  const Light light = Light::parse(settings.light_text);
  if (settings.shadows == Shadows::off && light.kind == Light::Kind::shoulder) {
    fixed.light_text = "headlight";  // the same from all six faces
  } else if (settings.shadows != Shadows::off && light.is_of_camera()) {
    const dvec3 from =
        glm::normalize(1.2 * level_up - 0.6 * ahead - 0.7 * right);  // as key_light, for all six
    fixed.light_text = light_text_of(from);
  }
  const RenderSettings& used = fixed.light_text == settings.light_text ? settings : fixed;

  // As many pixels an angle in the middle of a face as along the horizon of the panorama.
  const int side = std::max(4, int(std::ceil(width / std::numbers::pi)));
  const int overlap = std::max(2, side / 12);  // screen-space operators see past the edge of a face
  std::array<Face, 6> faces{{{ahead, right, level_up},
                             {right, -ahead, level_up},
                             {-ahead, -right, level_up},
                             {-right, ahead, level_up},
                             {level_up, right, -ahead},
                             {-level_up, right, ahead}}};
  std::vector<Camera> cameras;
  for (const Face& face : faces) {
    Camera view;
    view.position = camera.position;
    view.target = camera.position + face.forward;
    view.up = face.up;
    view.fov_y = std::numbers::pi / 2;
    view.width = view.height = side;
    cameras.push_back(view.with_guard_band(overlap));
  }
  std::vector<RenderOutput> pictures = renderer.render_together(items, cameras, used, wants, progress);
  RenderOutput out;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    Face& face = faces[i];
    face.camera = cameras[i];
    face.out = std::move(pictures[i]);
    out.total_ms += face.out.total_ms;
    out.points_drawn += face.out.points_drawn;
    out.timings.insert(out.timings.end(), face.out.timings.begin(), face.out.timings.end());
    out.notes = face.out.notes;
    out.outliers = face.out.outliers;
  }

  if (wants.color) out.rgba8 = Image<Rgba8>(width, height);
  if (wants.color_linear) out.color_linear = Image<vec4>(width, height);
  if (wants.depth) out.depth = Image<float>(width, height);
  if (wants.normal) out.normal = Image<vec3>(width, height);
  for (int y = 0; y < height; ++y) {
    const double latitude = std::numbers::pi * (0.5 - (y + 0.5) / height);
    for (int x = 0; x < width; ++x) {
      const double longitude = std::numbers::pi * (2 * (x + 0.5) / width - 1);
      const dvec3 d = std::cos(latitude) * (std::cos(longitude) * ahead + std::sin(longitude) * right) +
                      std::sin(latitude) * level_up;
      const Face* face = &faces[0];
      for (const Face& other : faces)
        if (glm::dot(d, other.forward) > glm::dot(d, face->forward)) face = &other;
      const glm::dvec2 place = face->place(d);
      const int px = std::clamp(int(place.x), 0, face->camera.width - 1);
      const int py = std::clamp(int(place.y), 0, face->camera.height - 1);
      if (wants.color) out.rgba8.at(x, y) = straight(sample(face->out.rgba8, place, premultiplied));
      if (wants.color_linear)
        out.color_linear.at(x, y) = sample(face->out.color_linear, place, [](const vec4& c) { return c; });
      if (wants.depth) out.depth.at(x, y) = float(face->out.depth.at(px, py) / glm::dot(d, face->forward));
      if (wants.normal) out.normal.at(x, y) = face->out.normal.at(px, py);
    }
  }
  return out;
}

}  // namespace sfumato
