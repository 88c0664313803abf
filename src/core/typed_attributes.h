// The typed attributes of points, each described once: what copies, sorts, joins, counts or writes all of
// them walks this table.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/point_cloud.h"

namespace sfumato {

/// The k-th number of a value.
inline float component(float value, std::size_t) { return value; }
inline float component(const vec3& value, std::size_t k) { return value[int(k)]; }
inline std::uint8_t component(const Rgba8& color, std::size_t k) {
  return std::array{color.r, color.g, color.b, color.a}[k];
}

/// An array of a cloud with one value per point, or empty.
template <auto member>
struct TypedAttribute {
  using Value = typename std::remove_cvref_t<decltype(std::declval<PointCloud>().*member)>::value_type;
  using Component = decltype(component(Value(), 0));
  static constexpr std::size_t width = sizeof(Value) / sizeof(Component);
  static constexpr StoredType stored =
      std::is_same_v<Component, std::uint8_t> ? StoredType::uint8 : StoredType::float32;

  const char* name;  ///< of the array
  Value missing;     ///< of a point that has none in a cloud of which others have one
  std::array<const char*, width> components;  ///< names in files

  static auto& of(auto& cloud) { return cloud.*member; }
  /// Component k of point i.
  static double number(const PointCloud& cloud, std::size_t i, std::size_t k) {
    return component(of(cloud)[i], k);
  }
};

/// Calls `visit` with each TypedAttribute, in the order in which files hold them.
template <class Visit>
void for_each_attribute(const Visit& visit) {
  visit(TypedAttribute<&PointCloud::normals>{"normals", vec3(0), {"nx", "ny", "nz"}});
  visit(TypedAttribute<&PointCloud::colors>{"colors", no_color, {"red", "green", "blue", "alpha"}});
  visit(TypedAttribute<&PointCloud::radii>{"radii", 0, {"radius"}});
}

}  // namespace sfumato
