// How deep the haze of a view is: what an automatic opacity follows.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/vec.h"
#include "core/camera.h"

namespace sfumato::soft {

struct HazeSettings {
  float radius_scale = 1, radius_limit = std::numeric_limits<float>::infinity();
  float field_threshold = 1, modulation_threshold = 1;
  float cone_factor = 1;  ///< opacity of a soft point at the field threshold over that of one beyond (Eq. 22)
};

struct HazeSpheres {
  std::span<const vec3> positions;      ///< of the prepared cloud, as the radii and the field
  std::span<const float> radii;         ///< scene units
  std::span<const std::uint32_t> soft;  ///< places of the soft points
  std::span<const float> field;
};

/// Optical depth of the haze in units of a lone soft point's through its centre, along the rays that meet
/// haze: nineteen in twenty of them see less. Follows the camera without steps.
/// Of views of one size (the faces of a panorama) over the rays of all of them.
double haze_depth(const HazeSpheres& spheres, std::span<const Camera> views, const dvec3& origin,
                  const HazeSettings& settings);
/// Whether a sphere of that radius, scene units, counts in it.
bool counts_in_depth(const Camera& view, const dmat4& eye_from_cloud, const vec3& place, double radius);

}  // namespace sfumato::soft
