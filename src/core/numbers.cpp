#include "core/numbers.h"

#include <cmath>

#include "core/number_in.h"
#include "core/param.h"

namespace sfumato {

std::function<double(std::size_t)> numbers_of(const PointCloud& cloud, const std::string& name) {
  if (const ScalarField* field = cloud.scalar(name))
    return [field](std::size_t i) { return field->value(i); };
  const PointCloud* c = &cloud;
  for (int k = 0; k < 3; ++k)
    if (name == std::string(1, "xyz"[k])) return [c, k](std::size_t i) { return c->world(i)[k]; };
  if (name == "elevation")
    return [c, up = up_vector(cloud.up)](std::size_t i) { return glm::dot(up, c->world(i)); };
  if (!cloud.colors.empty()) {
    const auto channel = [c](std::uint8_t Rgba8::*own) {
      return [c, own](std::size_t i) {
        return c->colors[i] == no_color ? std::nan("") : double(c->colors[i].*own);
      };
    };
    if (name == "red") return channel(&Rgba8::r);
    if (name == "green") return channel(&Rgba8::g);
    if (name == "blue") return channel(&Rgba8::b);
  }
  if (!cloud.radii.empty() && name == "radius") return [c](std::size_t i) { return double(c->radii[i]); };
  return {};
}

std::vector<std::string> number_names(const PointCloud& cloud) {
  std::vector<std::string> names = {"x", "y", "z", "elevation"};
  if (!cloud.colors.empty()) names.insert(names.end(), {"red", "green", "blue"});
  if (!cloud.radii.empty()) names.push_back("radius");
  for (const ScalarField& field : cloud.scalars) names.push_back(field.name);
  return names;
}

std::string no_such_number(const PointCloud& cloud, const std::string& name) {
  const std::vector<std::string> names = number_names(cloud);
  std::string all;
  for (const std::string& each : names) all += " " + each;
  const std::string near = nearest_word(name, names);
  return "the points have no '" + name + "' to filter by" +
         (near.empty() ? "" : "; did you mean '" + near + "'?") + "; they have:" + all;
}

std::optional<double> parse_real(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const std::optional<double> value = number_in<double>(text);
  return value && std::isnan(*value) ? std::nullopt : value;
}

}  // namespace sfumato
