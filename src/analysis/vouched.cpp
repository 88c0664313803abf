#include "analysis/vouched.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/wide.h"

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
constexpr float turn = 2 * std::numbers::pi_v<float>;

constexpr std::size_t sides = 12;

using Eight = float __attribute__((vector_size(32)));
using EightInts = std::int32_t __attribute__((vector_size(32)));

/// The corners of a regular polygon around the unit circle, then the first ones again: the ends of two eights
/// of edges.
struct Ring {
  std::array<float, 17> x, y;
};
const Ring& ring() {
  static const Ring corners = [] {
    Ring ring;
    for (std::size_t k = 0; k < ring.x.size(); ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * float(k % sides) / sides;
      const float reach = 1 / std::cos(std::numbers::pi_v<float> / sides);
      ring.x[k] = reach * std::cos(angle), ring.y[k] = reach * std::sin(angle);
    }
    return ring;
  }();
  return corners;
}

/// A convex polygon around the origin, cut by half planes; remembers which of its edges were there first. One
/// for every point of a cloud: nothing is written that is not read.
class Polygon {
 public:
  explicit Polygon(float radius) : count_(sides) {
    for (std::size_t k = 0; k < sides; ++k) {
      corners_[k] = {radius * ring().x[k], radius * ring().y[k], true};
      reach2_ = std::max(reach2_, corners_[k].x * corners_[k].x + corners_[k].y * corners_[k].y);
    }
  }

  /// Keeps what is nearer to the origin than to `other`.
  void cut(const vec2& other) {
    const float middle = 0.5f * glm::dot(other, other);
    if (!(middle > 0) || middle * middle >= reach2_ * 2 * middle)
      return;  // its bisector is beyond all corners
    std::array<float, room> beyond;
    bool is_cut = false;
    for (std::size_t k = 0; k < count_; ++k) {
      beyond[k] = corners_[k].x * other.x + corners_[k].y * other.y - middle;
      is_cut = is_cut || beyond[k] > 0;
    }
    if (!is_cut || count_ + 2 > room) return;
    std::array<Corner, room> kept;
    std::size_t count = 0;
    float reach2 = 0;
    bool is_closed = true;
    const auto keep = [&](const Corner& place) {
      kept[count++] = place;
      is_closed = is_closed && !place.first;
      reach2 = std::max(reach2, place.x * place.x + place.y * place.y);
    };
    for (std::size_t k = 0; k < count_; ++k) {
      const std::size_t next = k + 1 < count_ ? k + 1 : 0;
      const Corner &from = corners_[k], &to = corners_[next];
      const float a = beyond[k], b = beyond[next];
      if (a <= 0) keep(from);
      if ((a <= 0) == (b <= 0)) continue;
      // The edge that begins here: the bisector where the polygon is left, else the rest of the one that was.
      const float t = a / (a - b);
      keep({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), a <= 0 ? false : from.first});
    }
    std::copy(kept.begin(), kept.begin() + count, corners_.begin());
    count_ = count, is_closed_ = is_closed, reach2_ = reach2;
  }

  /// Nothing is left of its first edges.
  bool is_closed() const { return is_closed_; }
  /// To the farthest corner.
  float reach() const { return std::sqrt(reach2_); }

  /// Corners that lie strictly between two angles, from `gap_from` on counter-clockwise by `gap`, do not
  /// count.
  VoronoiCell cell(float gap_from, float gap) const {
    VoronoiCell cell{0, 0, gap};
    float open = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const Corner &from = corners_[k], &to = corners_[k + 1 < count_ ? k + 1 : 0],
                   &before = corners_[k > 0 ? k - 1 : count_ - 1];
      if (from.first) {
        open += std::abs(std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y));
      } else if (!before.first) {
        float beyond = std::atan2(from.y, from.x) - gap_from;
        beyond -= turn * std::floor(beyond / turn);
        if (beyond > 0 && beyond < gap) continue;
        cell.radius = std::max(cell.radius, std::sqrt(from.x * from.x + from.y * from.y));
      }
    }
    cell.closed = std::max(0.0f, 1 - open / (2 * std::numbers::pi_v<float>));
    return cell;
  }

 private:
  static constexpr std::size_t room = 48;
  struct Corner {
    float x, y;
    bool first;  ///< of the edge from here to the next
  };
  std::array<Corner, room> corners_;
  std::size_t count_;
  float reach2_ = 0;
  bool is_closed_ = false;
};

/// The value that `n` of `count` others do not exceed, as std::nth_element finds it, by the ranks of all.
/// They fill whole eights with infinity.
SFUMATO_WIDE float nth_smallest(const float* values, std::size_t count, int n) {
  Eight most_of = {};
  for (std::size_t first = 0; first < count; first += 8) {
    Eight own;
    std::memcpy(&own, values + first, sizeof own);
    EightInts less = {};
    for (std::size_t k = 0; k < count; ++k) less -= values[k] < own;
    own = less <= n ? own : Eight{};
    most_of = own > most_of ? own : most_of;
  }
  float nth = 0;
  for (int k = 0; k < 8; ++k) nth = std::max(nth, most_of[k]);
  return nth;
}

/// Whether nothing would be left of the first edges of a polygon of this radius: each lies beyond one
/// bisector whole, and by more than rounding, which is so nearly everywhere inside a surface.
SFUMATO_WIDE bool closes(const std::uint16_t* which, std::size_t count, const vec2* ways, float radius) {
  const Ring& corners = ring();
  Eight from_x[2], from_y[2], to_x[2], to_y[2];
  std::memcpy(from_x, corners.x.data(), sizeof from_x), std::memcpy(from_y, corners.y.data(), sizeof from_y);
  std::memcpy(to_x, corners.x.data() + 1, sizeof to_x), std::memcpy(to_y, corners.y.data() + 1, sizeof to_y);
  EightInts closed[2] = {};
  bool all = false;
  for (std::size_t k = 0; k < count && !all; ++k) {
    const vec2 way = ways[which[k]] / radius;
    const float middle = 0.5001f * glm::dot(way, way);
    for (int half = 0; half < 2; ++half)
      closed[half] |= (from_x[half] * way.x + from_y[half] * way.y > middle) &
                      (to_x[half] * way.x + to_y[half] * way.y > middle);
    if (k % 4 != 3 && k + 1 < count) continue;
    all = true;
    for (int lane = 0; lane < 8; ++lane) all &= (closed[0] & closed[1])[lane] != 0;
  }
  return all;
}

VoronoiCell open_cell_of(std::span<const vec3> positions, std::uint32_t point,
                         std::span<const std::uint32_t> neighbors, const LocalFrame& frame,
                         const vec3& normal, float& evenness, float& aside) {
  const std::size_t count = std::min(neighbors.size(), most);
  // Half the axes of an evenly filled ellipse are two deviations long.
  const float spacing_all = std::sqrt(4 * std::numbers::pi_v<float> *
                                      std::sqrt(frame.variance.y * frame.variance.z) / float(count + 1));
  if (!(spacing_all > 0)) return {0, 0};
  const auto [along, across] = tangents_of(normal);
  std::array<float, most> heights, distances2;
  std::array<vec2, most> ways;
  float reach2 = 0;
  vec3 middle(0);
  for (std::size_t k = 0; k < count; ++k) {
    const vec3 way = positions[neighbors[k]] - positions[point];
    middle += way;
    heights[k] = std::abs(glm::dot(way, normal));
    distances2[k] = glm::dot(way, way);
    ways[k] = vec2(glm::dot(way, along), glm::dot(way, across));
    reach2 = std::max(reach2, distances2[k]);
  }
  if (reach2 > 0 && count == neighbors.size())
    aside = glm::length(middle) / (float(count) * std::sqrt(reach2));
  for (std::size_t k = count; k % 8 != 0; ++k)
    heights[k] = distances2[k] = std::numeric_limits<float>::infinity();
  const float layer =
      std::max(bend * std::sqrt(reach2), quartiles * nth_smallest(heights.data(), count, int(count / 4)));
  float spacing = spacing_all, near2 = reach2;
  if (count > 8) {
    near2 = nth_smallest(distances2.data(), count, 7);
    spacing = std::min(spacing, std::sqrt(near2 * std::numbers::pi_v<float> / 8));
    if (reach2 > 0) evenness = near2 * float(count) / (reach2 * 8);
  }
  // The nearest eight first, which mostly close it; inside a surface nobody asks how large the cell is.
  std::array<std::uint16_t, most + 1> order, farther;
  std::size_t there = 0, farther_there = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const bool counts = heights[k] <= layer, is_near = distances2[k] <= near2;
    order[there] = farther[farther_there] = std::uint16_t(k);
    there += counts && is_near, farther_there += counts && !is_near;
  }
  std::copy(farther.begin(), farther.begin() + farther_there, order.begin() + there);
  there += farther_there;
  Polygon polygon(widest_gap * spacing);
  if (closes(order.data(), there, ways.data(), widest_gap * spacing)) return {polygon.reach(), 1, 0};
  for (std::size_t k = 0; k < there && !polygon.is_closed(); ++k) polygon.cut(ways[order[k]]);
  if (polygon.is_closed()) return {polygon.reach(), 1, 0};
  std::array<float, most + 1> angles;
  for (std::size_t k = 0; k < there; ++k) angles[k] = std::atan2(ways[order[k]].y, ways[order[k]].x);
  if (there == 0) return polygon.cell(0, turn);
  std::sort(angles.begin(), angles.begin() + there);
  angles[there] = angles[0] + turn;
  std::size_t widest = 0;
  for (std::size_t k = 1; k < there; ++k)
    if (angles[k + 1] - angles[k] > angles[widest + 1] - angles[widest]) widest = k;
  return polygon.cell(angles[widest], angles[widest + 1] - angles[widest]);
}

}  // namespace

VoronoiCell cell_of(std::span<const vec3> positions, std::uint32_t point,
                    std::span<const std::uint32_t> neighbors, const LocalFrame& frame, const vec3& normal) {
  float evenness = 1, aside = 1;
  VoronoiCell cell = open_cell_of(positions, point, neighbors, frame, normal, evenness, aside);
  if (frame.variance.z > 0) cell.aspect = std::sqrt(frame.variance.y / frame.variance.z);
  cell.evenness = evenness, cell.aside = aside;
  return cell;
}

float two_sided(const VoronoiCell& cell) {
  return glm::smoothstep(0.25f, 0.5f, cell.aspect) * glm::smoothstep(0.33f, 0.6f, cell.evenness);
}

float surrounded(const VoronoiCell& cell) { return glm::smoothstep(0.5f, 1.0f, cell.closed); }

float enclosed(const VoronoiCell& cell) {
  constexpr float quarter = 0.5f * std::numbers::pi_v<float>;
  return 1 - glm::smoothstep(quarter, 2 * quarter, cell.widest_angle);
}

float vouched_radius(const VoronoiCell& cell) { return cell.radius * std::min(1.0f, cell.closed / corner); }

}  // namespace sfumato::analysis
