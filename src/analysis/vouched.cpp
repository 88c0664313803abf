#include "analysis/vouched.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/order.h"

namespace sfumato::analysis {
namespace {

/// Spacings: an empty disc of this radius is no chance (exp(-pi 1.7^2) = 1e-4).
constexpr float widest_gap = 1.7f;
/// A quarter of a circle around the corner of a rectangle.
constexpr float corner = 0.25f;
/// Of the same layer are those within a tenth of the reach, or within six lower quartiles of the heights:
/// those of normal noise, whose difference from the point's own is 1.41 deviations, stay in 19 of 20 times.
constexpr float bend = 0.1f, quartiles = 6;

constexpr std::size_t most = 256;

/// A convex polygon around the origin, cut by half planes; remembers which of its edges were there first.
class Polygon {
 public:
  /// A regular one around a circle.
  explicit Polygon(float radius) {
    constexpr std::size_t corners = 12;
    const float reach = radius / std::cos(std::numbers::pi_v<float> / corners);
    for (std::size_t k = 0; k < corners; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * float(k) / corners;
      corners_[k] = {reach * vec2(std::cos(angle), std::sin(angle)), true};
    }
    count_ = corners;
    reach2_ = reach * reach;
  }

  /// Keeps what is nearer to the origin than to `other`.
  void cut(const vec2& other) {
    const float middle = 0.5f * glm::dot(other, other);
    if (!(middle > 0) || middle * middle >= reach2_ * 2 * middle)
      return;  // its bisector is beyond all corners
    std::array<Corner, room> kept;
    std::size_t count = 0;
    float reach2 = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const Corner &from = corners_[k], &to = corners_[k + 1 < count_ ? k + 1 : 0];
      const float a = glm::dot(from.at, other) - middle, b = glm::dot(to.at, other) - middle;
      if (a <= 0) kept[count++] = from;
      if ((a <= 0) != (b <= 0)) {
        const vec2 at = from.at + a / (a - b) * (to.at - from.at);
        // The edge that begins here: the bisector where the polygon is left, else the rest of the one that
        // was.
        kept[count++] = {at, a <= 0 ? false : from.first};
      }
      if (count + 2 > room) return;
    }
    std::copy(kept.begin(), kept.begin() + count, corners_.begin());
    count_ = count;
    is_closed_ = true;
    for (std::size_t k = 0; k < count_; ++k) is_closed_ = is_closed_ && !corners_[k].first;
    for (std::size_t k = 0; k < count_; ++k)
      reach2 = std::max(reach2, glm::dot(corners_[k].at, corners_[k].at));
    reach2_ = reach2;
  }

  /// Nothing is left of its first edges.
  bool is_closed() const { return is_closed_; }

  VoronoiCell cell() const {
    VoronoiCell cell{0, 0};
    float open = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const Corner &from = corners_[k], &to = corners_[k + 1 < count_ ? k + 1 : 0],
                   &before = corners_[k > 0 ? k - 1 : count_ - 1];
      if (from.first) {
        const float across = from.at.x * to.at.y - from.at.y * to.at.x;
        open += std::abs(std::atan2(across, glm::dot(from.at, to.at)));
      } else if (!before.first) {
        cell.radius = std::max(cell.radius, glm::length(from.at));
      }
    }
    cell.closed = std::max(0.0f, 1 - open / (2 * std::numbers::pi_v<float>));
    return cell;
  }

 private:
  static constexpr std::size_t room = 48;
  struct Corner {
    vec2 at{0};
    bool first = false;  ///< of the edge from here to the next
  };
  std::array<Corner, room> corners_;
  std::size_t count_ = 0;
  float reach2_ = 0;
  bool is_closed_ = false;
};

}  // namespace

VoronoiCell cell_of(std::span<const vec3> positions, std::uint32_t point,
                    std::span<const std::uint32_t> neighbors, const LocalFrame& frame, const vec3& normal) {
  const std::size_t count = std::min(neighbors.size(), most);
  // Half the axes of an evenly filled ellipse are two deviations long.
  const float spacing_all = std::sqrt(4 * std::numbers::pi_v<float> *
                                      std::sqrt(frame.variance.y * frame.variance.z) / float(count + 1));
  if (!(spacing_all > 0)) return {0, 0};
  const vec3 aside = std::abs(normal.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
  const vec3 along = glm::normalize(glm::cross(normal, aside)), across = glm::cross(normal, along);
  std::array<float, most> heights, sorted, distances2;
  float reach2 = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const vec3 way = positions[neighbors[k]] - positions[point];
    sorted[k] = heights[k] = std::abs(glm::dot(way, normal));
    distances2[k] = glm::dot(way, way);
    reach2 = std::max(reach2, distances2[k]);
  }
  std::nth_element(sorted.begin(), sorted.begin() + count / 4, sorted.begin() + count);
  const float layer = std::max(bend * std::sqrt(reach2), quartiles * sorted[count / 4]);
  float spacing = spacing_all;
  if (count > 8) {
    std::nth_element(distances2.begin(), distances2.begin() + 7, distances2.begin() + count);
    spacing = std::min(spacing, std::sqrt(distances2[7] * std::numbers::pi_v<float> / 8));
  }
  Polygon polygon(widest_gap * spacing);
  // Inside a surface nobody asks how large the cell is.
  for (std::size_t k = 0; k < count && !polygon.is_closed(); ++k) {
    if (heights[k] > layer) continue;
    const vec3 way = positions[neighbors[k]] - positions[point];
    polygon.cut(vec2(glm::dot(way, along), glm::dot(way, across)));
  }
  return polygon.cell();
}

float surrounded(const VoronoiCell& cell) { return glm::smoothstep(0.5f, 1.0f, cell.closed); }

float vouched_radius(const VoronoiCell& cell) { return cell.radius * std::min(1.0f, cell.closed / corner); }

}  // namespace sfumato::analysis
