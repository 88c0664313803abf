#include "passes/light.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace sfumato {

Light Light::parse(std::string_view text) {
  Light light;
  if (text == "headlight") return light;
  const bool directional = text.starts_with("dir:");
  try {
    // Doubles: a point light may stand at UTM coordinates.
    std::string numbers(text.substr(directional ? 4 : 0));
    std::size_t used = 0;
    for (int axis = 0; axis < 3; ++axis) {
      light.vector[axis] = std::stod(numbers, &used);
      numbers.erase(0, used);
      if (axis < 2) {
        if (numbers.empty() || numbers[0] != ',') throw std::invalid_argument("comma");
        numbers.erase(0, 1);
      }
    }
    if (!numbers.empty()) throw std::invalid_argument("rest");
    if (!std::isfinite(light.vector.x + light.vector.y + light.vector.z)) throw std::invalid_argument("nan");
  } catch (const std::exception&) {
    throw Error(ErrorCode::usage, "--light '" + std::string(text) + "' is not headlight, X,Y,Z or dir:X,Y,Z");
  }
  light.kind = directional ? Kind::directional : Kind::point;
  if (directional) {
    if (!(glm::length(light.vector) > 0))
      throw Error(ErrorCode::usage, "--light dir: needs a direction other than 0,0,0");
    light.vector = glm::normalize(light.vector);
  }
  return light;
}

Light key_light(const Camera& camera, UpAxis up_axis) {
  const dvec3 up = up_vector(up_axis), forward = camera.direction();
  dvec3 right = glm::cross(forward, camera.up);
  right = glm::length(right) > 1e-9 ? glm::normalize(right) : dvec3(1, 0, 0);
  Light light;
  light.kind = Light::Kind::directional;
  light.vector = glm::normalize(1.2 * up - 0.6 * forward - 0.7 * right);
  return light;
}

void fix_light(RenderSettings& settings, const Camera& camera, UpAxis up) {
  if (settings.shadows == Shadows::off || Light::parse(settings.light_text).kind != Light::Kind::headlight)
    return;
  const dvec3 towards = key_light(camera, up).vector;
  settings.light_text =
      "dir:" + std::to_string(towards.x) + "," + std::to_string(towards.y) + "," + std::to_string(towards.z);
}

void RenderSettings::describe(ParamList& p) {
  p.add("shading", shading, {"lit", "albedo", "normals", "depth", "occlusion", "hidden", "weight"})
      .help(
          "what the colour of a pixel shows; occlusion, hidden: hidden point removal at work (surface only); "
          "weight: of the chosen bin (denoise only)");
  p.add("light", light_text)
      .help("headlight | X,Y,Z (point light, world) | dir:X,Y,Z (direction it comes from)");
  p.add("ambient", phong.ambient).range(0, 1).help("share of light that reaches every point").paper("k_a");
  p.add("diffuse", phong.diffuse).range(0, 1).help("share of light by the angle to the light").paper("k_d");
  p.add("specular", phong.specular)
      .range(0, 1)
      .help(
          "strength of highlights (auto: 0.1; 0 where colours stand for values, as highlights are no value)")
      .paper("k_s");
  p.add("shininess", phong.shininess).range(1, 1000).help("sharpness of highlights");
  p.add("shadows", shadows, {"off", "hard", "soft", "stored"})
      .help(
          "shadows between points; a headlight then moves to the upper left, where its shadows can be seen, "
          "and stays there on a path; stored: the scalar `shadow` of the points (convert --shadows)")
      .paper("Dobrev 2010, Sec. 4");
  p.add("light_size", light_size)
      .at_least(0)
      .unit("scene units")
      .help("diameter of the light for soft shadows (auto: a tenth of the cloud's diagonal)");
  p.add("light_samples", light_samples)
      .range(1, 256)
      .help("positions on the light that are averaged")
      .paper("n");
  p.add("shadow_distance", shadow_distance)
      .at_least(0)
      .unit("scene units")
      .help("distance below which a point casts no shadow (auto: 3 point spacings)")
      .paper("d_min");
  p.add("ground", ground).help("a plane under the cloud that catches its shadow (with shadows hard or soft)");
  p.add("edl", edl)
      .help(
          "eye-dome lighting as a finish (auto: where the technique wants it, and on splats without "
          "colours of their own)");
  p.add("edl_radius", edl_radius).range(0.5, 16).unit("px").help("reach of eye-dome lighting");
  p.add("edl_strength", edl_strength)
      .range(0, 10)
      .help("darkness of eye-dome lighting (auto: 0.4, on splats 0.12)");
  p.add("samples", samples)
      .range(1, 64)
      .help(
          "places in every pixel whose pictures are averaged: the smoothest outlines, at as many times the "
          "work");
  p.add("smooth_outlines", smooth_outlines)
      .help(
          "blend the stairs of outlines and of edges in depth (auto: with one sample, unless the technique "
          "has soft "
          "edges of its own)");
  p.add("fast", fast).help("allow float atomics: faster where the driver has them, not bit-reproducible");
}

}  // namespace sfumato
