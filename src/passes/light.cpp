#include "passes/light.h"

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
  } catch (const std::exception&) {
    throw Error(ErrorCode::usage, "--light '" + std::string(text) + "' is not headlight, X,Y,Z or dir:X,Y,Z");
  }
  light.kind = directional ? Kind::directional : Kind::point;
  if (directional) {
    if (!(glm::length(light.vector) > 0)) throw Error(ErrorCode::usage, "--light dir: needs a direction other than 0,0,0");
    light.vector = glm::normalize(light.vector);
  }
  return light;
}

void RenderSettings::describe(ParamList& p) {
  p.add("shading", shading, {"lit", "albedo", "normals", "depth"}).help("what the colour of a pixel shows");
  p.add("light", light_text).help("headlight | X,Y,Z (point light, world) | dir:X,Y,Z (direction it comes from)");
  p.add("ambient", phong.ambient).range(0, 1).help("share of light that reaches every point").paper("k_a");
  p.add("diffuse", phong.diffuse).range(0, 1).help("share of light by the angle to the light").paper("k_d");
  p.add("specular", phong.specular).range(0, 1).help("strength of highlights").paper("k_s");
  p.add("shininess", phong.shininess).range(1, 1000).help("sharpness of highlights");
  p.add("edl", edl).help("eye-dome lighting as a finish (auto: where the technique wants it)");
  p.add("edl_radius", edl_radius).range(0.5, 16).unit("px").help("reach of eye-dome lighting");
  p.add("edl_strength", edl_strength).range(0, 10).help("darkness of eye-dome lighting");
  p.add("fast", fast).help("allow float atomics: faster where the driver has them, not bit-reproducible");
}

}  // namespace sfumato
