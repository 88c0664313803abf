// How deep the haze of a view is: what an automatic opacity follows.
#pragma once

#include <limits>
#include <span>

#include "core/point_cloud.h"
#include "passes/view.h"

namespace sfumato::soft {

struct HazeSettings {
  float radius_scale = 1, radius_limit = std::numeric_limits<float>::infinity();
  float field_threshold = 1, modulation_threshold = 1;
  float cone_factor = 1;  ///< opacity of a soft point at the field threshold over that of one beyond (Eq. 22)
};

/// Optical depth of the haze in units of a lone soft point's through its centre, along the rays that meet
/// haze: nineteen in twenty of them see less. Follows the camera without steps.
double haze_depth(const PointCloud& cloud, std::span<const std::uint32_t> soft, std::span<const float> field,
                  const View& view, const HazeSettings& settings);

}  // namespace sfumato::soft
