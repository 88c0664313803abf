// Which point is under the cursor, what it holds, and how far two of them are apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/camera.h"
#include "core/prepared_cloud.h"
#include "core/room.h"

namespace sfumato::view {

/// The point whose projection is nearest to (x, y) among those in front: of all points within `reach_px`,
/// those that lie behind the nearest by more than `depth_share` of its depth are hidden by it. Walls of
/// `room` that are not drawn for this camera are not picked. Nothing when none is within reach. Given the
/// `batches` of the cloud, it looks only into those that may hold such a point.
std::optional<std::size_t> nearest_point(const PointCloud& cloud, const Camera& camera, double x_px,
                                         double y_px, double reach_px = 12, double depth_share = 0.02,
                                         const std::optional<Room>& room = {},
                                         std::span<const Batch> batches = {});

/// A picked point with all that it holds.
struct Picked {
  std::size_t index = 0;     ///< place in its cloud in memory
  std::uint64_t source = 0;  ///< place in the scene's files, from 0
  dvec3 world{0};
  std::vector<std::pair<std::string, std::string>> attributes;  ///< name and value as text
};
/// `file_names` says what the scalar `file` counts.
Picked describe(const PointCloud& cloud, std::size_t index, const std::vector<std::string>& file_names = {});

/// From one place to another.
struct Measure {
  double distance = 0, height = 0, horizontal = 0;  ///< scene units; height along the up axis, signed
};
Measure measure(const dvec3& from, const dvec3& to, UpAxis up);

/// The decimals that coordinates of a scene of that size deserve.
int decimals_of(double scene_size);
/// A coordinate with so many.
std::string coordinate_text(double value, double scene_size);
/// "metre", "US survey foot" where the coordinate reference system says so, else "units".
std::string unit_of(const std::string& crs);

}  // namespace sfumato::view
