#include "view/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/atomic_writer.h"
#include "view/picking.h"

namespace sfumato::view {
namespace {

dvec3 flat(const dvec3& v, const dvec3& up) { return v - glm::dot(v, up) * up; }

}  // namespace

double horizontal_length(std::span<const dvec3> line, UpAxis up) {
  double length = 0;
  for (std::size_t k = 1; k < line.size(); ++k)
    length += glm::length(flat(line[k] - line[k - 1], up_vector(up)));
  return length;
}

void add_to_profile(Profile& profile, const PointCloud& cloud, std::span<const Rgba8> colors, UpAxis up_axis,
                    const std::function<std::uint64_t(std::size_t)>& source) {
  const dvec3 up = up_vector(up_axis);
  struct Piece {
    dvec3 from, way;  // horizontal, relative to the cloud's origin; `way` a unit vector
    double length, before;
  };
  std::vector<Piece> pieces;
  double before = 0;
  for (std::size_t k = 1; k < profile.line.size(); ++k) {
    const dvec3 step = flat(profile.line[k] - profile.line[k - 1], up);
    const double length = glm::length(step);
    if (length == 0) continue;
    pieces.push_back({flat(profile.line[k - 1] - cloud.origin, up), step / length, length, before});
    before += length;
  }
  profile.length = before;
  const double reach2 = 0.25 * profile.width * profile.width;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 local(cloud.positions[i]), at = flat(local, up);
    double nearest2 = std::numeric_limits<double>::infinity(), along = 0;
    for (const Piece& piece : pieces) {
      const double t = std::clamp(glm::dot(at - piece.from, piece.way), 0.0, piece.length);
      const dvec3 aside = at - piece.from - t * piece.way;
      // Beyond the ends of the whole line there is no corridor, between two pieces it has a round corner.
      const bool is_beyond =
          (t == 0 && &piece == &pieces.front()) || (t == piece.length && &piece == &pieces.back());
      if (is_beyond && std::abs(glm::dot(aside, piece.way)) > 1e-9 * piece.length) continue;
      if (const double distance2 = glm::dot(aside, aside); distance2 < nearest2)
        nearest2 = distance2, along = piece.before + t;
    }
    if (nearest2 > reach2) continue;
    const dvec3 world = cloud.world(i);
    profile.points.push_back(
        {along, glm::dot(world, up), world, source(i), colors.empty() ? Rgba8{0, 0, 0, 255} : colors[i]});
  }
}

void write_profile(const std::filesystem::path& file, const Profile& profile, double scene_size) {
  std::string text = "distance,height,x,y,z,point\n";
  for (const ProfilePoint& each : profile.points) {
    for (const double value : {each.along, each.height, each.world.x, each.world.y, each.world.z})
      text += coordinate_text(value, scene_size) + ",";
    text += std::to_string(each.source) + "\n";
  }
  io::AtomicWriter writer(file);
  writer.write(text);
  writer.commit();
}

}  // namespace sfumato::view
