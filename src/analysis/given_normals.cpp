#include "analysis/given_normals.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/normals.h"
#include "analysis/support.h"
#include "analysis/wide_normals.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t given_places = 1024, fewest_given = 24;
/// Radians and times the error of computed ones, medians over the flat places. Of 28 public files with
/// normals, those of meshes and of well-made scans scatter by 0 to 2.0 degrees, four others by 4.4 to 25, 5
/// to 12 times what 24 neighbours are off.
constexpr float given_scatter = 0.052f, times_worse = 3;

struct Roughness {
  float given2 = 0, computed2 = 0;  ///< squares of angles
};

/// Nothing where the points lie in no plane, or have no normals.
std::optional<Roughness> roughness_at(const std::vector<vec3>& normals, const NeighborTree& tree,
                                      std::uint32_t at, int neighbors) {
  const std::span<const vec3> positions = tree.positions();
  KNearest nearest(std::size_t(neighbors) + 1);  // itself among them
  tree.search(positions[at], nearest);
  std::vector<std::uint32_t> ids;
  float reach = 0;
  for (const std::uint64_t key : nearest.heap()) {
    const std::uint32_t id = id_of(key);
    if (id == at) continue;
    ids.push_back(id);
    reach = std::max(reach, glm::distance(positions[id], positions[at]));
  }
  const auto frame = local_frame(positions, at, ids);
  if (!frame || !is_flat(scatter_of(*frame)) || normals[at] == vec3(0)) return std::nullopt;
  const auto [along, across] = tangents_of(frame->normal);
  // Least squares of both tilts of the normals over the place, sign by sign of the point's own.
  ids.push_back(at);
  glm::dmat3 moments(0);
  dvec3 tilt_along(0), tilt_across(0);
  double squares = 0;
  std::size_t known = 0;
  for (const std::uint32_t id : ids) {
    if (normals[id] == vec3(0)) continue;
    ++known;
    const vec3 way = (positions[id] - positions[at]) / reach,
               normal = glm::dot(normals[id], normals[at]) < 0 ? -normals[id] : normals[id];
    const dvec3 place(1, glm::dot(way, along), glm::dot(way, across));
    const glm::dvec2 tilt(glm::dot(normal, along), glm::dot(normal, across));
    moments += glm::outerProduct(place, place);
    tilt_along += tilt.x * place, tilt_across += tilt.y * place;
    squares += glm::dot(tilt, tilt);
  }
  if (known < 4 || !(std::abs(glm::determinant(moments)) > 1e-6)) return std::nullopt;  // few, or on a line
  const glm::dmat3 inverse = glm::inverse(moments);
  const double left =
      squares - glm::dot(tilt_along, inverse * tilt_along) - glm::dot(tilt_across, inverse * tilt_across);
  return Roughness{float(std::max(left, 0.0)) / float(known - 3),
                   error2_of_noise(scatter_of(*frame), float(ids.size()))};
}

}  // namespace

bool are_rough(const std::vector<vec3>& normals, const NeighborTree& tree, int neighbors) {
  const std::size_t n = normals.size(), count = std::min(n, given_places);
  if (n <= std::size_t(neighbors) || neighbors < 8) return false;
  std::vector<std::optional<Roughness>> found(count);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
    found[k] = roughness_at(normals, tree, std::uint32_t(k * n / count), neighbors);
  });
  std::vector<float> given2, ratio2;
  for (const auto& place : found) {
    if (!place) continue;
    given2.push_back(place->given2);
    ratio2.push_back(place->given2 / place->computed2);
  }
  return given2.size() >= fewest_given && median(given2) > given_scatter * given_scatter &&
         median(ratio2) > times_worse * times_worse;
}

}  // namespace sfumato::analysis
