// A vertical profile: the points within a corridor along a line, seen from its side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::view {

struct ProfilePoint {
  double along = 0, height = 0;  ///< scene units: from the begin of the line, horizontally; along the up axis
  dvec3 world{0};
  std::uint64_t source = 0;  ///< place in the scene's files
  Rgba8 color;
};

struct Profile {
  std::uint64_t id = 0;
  std::vector<dvec3> line;
  double width = 0, length = 0;  ///< of the corridor and of the line, horizontally
  std::vector<ProfilePoint> points;
};

/// Horizontal length of a line of places.
double horizontal_length(std::span<const dvec3> line, UpAxis up);

/// Adds the points of a cloud that lie at most half of the width beside the line; each belongs to the piece
/// of the line that is nearest to it. `source` gives the place of a point in the files.
void add_to_profile(Profile& profile, const PointCloud& cloud, std::span<const Rgba8> colors, UpAxis up,
                    const std::function<std::uint64_t(std::size_t)>& source);

/// distance,height,x,y,z,point: a line each. Throws Error(io).
void write_profile(const std::filesystem::path& file, const Profile& profile, double scene_size);

}  // namespace sfumato::view
