#include "passes/light.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "core/error.h"
#include "core/numbers.h"

namespace sfumato {

Light Light::parse(std::string_view text) {
  Light light;
  if (text == "shoulder") return light;
  if (text == "headlight") return {Kind::headlight};
  const bool directional = text.starts_with("dir:");
  // Doubles: a point light may stand at UTM coordinates.
  std::string_view numbers = text.substr(directional ? 4 : 0);
  for (int axis = 0; axis < 3; ++axis) {
    numbers.remove_prefix(std::min(numbers.find_first_not_of(' '), numbers.size()));
    const std::size_t end = axis < 2 ? numbers.find(',') : numbers.size();
    const auto number = end == numbers.npos ? std::nullopt : parse_real(numbers.substr(0, end));
    if (!number || !std::isfinite(*number))
      throw Error(ErrorCode::usage,
                  "--light '" + std::string(text) + "' is not shoulder, headlight, X,Y,Z or dir:X,Y,Z");
    light.vector[axis] = *number;
    numbers.remove_prefix(axis < 2 ? end + 1 : end);
  }
  light.kind = directional ? Kind::directional : Kind::point;
  if (directional) {
    if (!(glm::length(light.vector) > 0))
      throw Error(ErrorCode::usage, "--light dir: needs a direction other than 0,0,0");
    light.vector = glm::normalize(light.vector);
  }
  return light;
}

void Phong::resolve(bool is_photographed, bool are_values) {
  const bool has_own_light = is_photographed && ambient.is_auto() && diffuse.is_auto();
  ambient.resolve(has_own_light ? 1 : usual_ambient);
  diffuse.resolve(has_own_light ? 0 : usual_diffuse);
  specular.resolve(has_own_light || are_values ? 0 : usual_specular);
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

std::string light_text_of(const dvec3& towards) {
  std::string text = "dir:";
  for (int axis = 0; axis < 3; ++axis) {
    char number[32];
    const auto [end, error] =
        std::to_chars(number, std::end(number), towards[axis], std::chars_format::fixed, 6);
    text.append(axis ? "," : "").append(number, end);
  }
  return text;
}

void fix_light(RenderSettings& settings, const Camera& camera, UpAxis up) {
  if (settings.shadows == Shadows::off || !Light::parse(settings.light_text).is_of_camera()) return;
  settings.light_text = light_text_of(key_light(camera, up).vector);
}

void RenderSettings::describe(ParamList& p) {
  p.add("shading", shading, {"lit", "albedo", "normals", "depth", "occlusion", "hidden", "weight"})
      .help(
          "what the colour of a pixel shows; occlusion, hidden: hidden point removal at work (surface only); "
          "weight: of the chosen bin (denoise only)");
  p.add("light", light_text)
      .help(
          "shoulder (from the upper left) | headlight (from the eye) | X,Y,Z (point light, world) | "
          "dir:X,Y,Z "
          "(direction it comes from)");
  p.add("ambient", phong.ambient)
      .range(0, 1)
      .help(
          "share of light that reaches every point (auto: 0.3; 1 where the colours are photographed and "
          "neither a light nor shadows are given)")
      .paper("k_a");
  p.add("diffuse", phong.diffuse)
      .range(0, 1)
      .help(
          "share of light by the angle to the light (auto: 0.7; 0 where the colours are photographed, as for "
          "ambient)")
      .paper("k_d");
  p.add("specular", phong.specular)
      .range(0, 1)
      .help(
          "strength of highlights (auto: 0.1; 0 where colours stand for values, and for orthographic views)")
      .paper("k_s");
  p.add("shininess", phong.shininess).range(1, 1000).help("sharpness of highlights");
  p.add("shadows", shadows, {"off", "hard", "soft", "stored"})
      .help(
          "shadows between points; a light of the camera then moves farther to the upper left, where its "
          "shadows can be seen, "
          "and stays there on a path; stored: the scalar `shadow` of the points (convert --shadows)")
      .paper("Dobrev 2010, Sec. 4");
  p.add("light_size", light_size)
      .at_least(0)
      .unit("scene units")
      .help(
          "diameter of the light for soft shadows (auto: a tenth of the cloud's diagonal without outliers)");
  p.add("light_samples", light_samples)
      .range(1, 256)
      .help("positions on the light that are averaged")
      .paper("n");
  p.add("shadow_distance", shadow_distance)
      .at_least(0)
      .unit("scene units")
      .help("distance below which a point casts no shadow (auto: 3 point spacings)")
      .paper("d_min");
  p.add("ground", ground)
      .help("a plane under the cloud that receives its shadow (with shadows hard or soft)");
  p.add("edl", edl)
      .help(
          "eye-dome lighting: dark lines along depth edges above the noise (auto: in every "
          "technique)");
  p.add("edl_radius", edl_radius)
      .range(0.5, 16)
      .unit("px")
      .help("radius of eye-dome lighting in a picture 720 px high; scales with larger heights");
  p.add("edl_strength", edl_strength)
      .range(0, 10)
      .help("darkness of eye-dome lighting (auto: 0.12, or 0.4 where edl has to be asked for)");
  p.add("ambient_occlusion", ambient_occlusion)
      .range(0, 1)
      .help(
          "darkening of hollows by the share of the sky that their surroundings occlude, at several scales "
          "(auto: 1)");
  p.add("radiance_scaling", radiance_scaling)
      .range(0, 2)
      .help(
          "how much ridges are lightened and valleys darkened, by how normals turn above the noise, at "
          "several scales (auto: 0.25; 0 on photographs)");
  p.add("samples", samples)
      .range(1, 64)
      .help("samples per pixel, averaged: the smoothest outlines, at that many times the cost");
  p.add("smooth_outlines", smooth_outlines)
      .help(
          "antialias outlines and depth edges (auto: with one sample, unless the technique has soft edges of "
          "its own)");
  p.add("fast", fast).help("allow float atomics: faster where the driver has them, not bit-reproducible");
}

}  // namespace sfumato
