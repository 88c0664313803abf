#include "passes/evidence_cpu.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>

#include "core/wide.h"

namespace sfumato {
namespace {

/// px to the side of a pixel, or `none`.
using Side = std::int16_t;
constexpr Side none = 1000;

/// From each pixel of a row to the nearest of those with `is_goal(x)`, no farther than `reach`; to the left
/// where two are as near.
template <class IsGoal>
void along_row(Side* out, int width, int reach, const IsGoal& is_goal) {
  int since = reach + 1;
  for (int x = 0; x < width; ++x) {
    since = is_goal(x) ? 0 : std::min(since + 1, reach + 1);
    out[x] = Side(since);
  }
  since = reach + 1;
  for (int x = width - 1; x >= 0; --x) {
    const int left = out[x];
    since = left == 0 ? 0 : std::min(since + 1, reach + 1);
    out[x] = std::min(left, since) > reach ? none : Side(left <= since ? -left : since);
  }
}

/// A squared distance, px, and across how many rows, as one number: the nearest is least, and of those as
/// near the topmost.
constexpr std::uint32_t nowhere = 1 << 30;
constexpr int most_rows = 255;
static_assert(EvidenceReach{EvidenceReach::most}.to_circle() <= most_rows);
static_assert(most_rows < none && 2 * most_rows * most_rows * 512 + 511 < nowhere);
constexpr std::uint32_t packed(int distance2, int rows) {
  return std::uint32_t(distance2 * 512 + rows + 256);
}
constexpr int distance2_of(std::uint32_t packed) { return int(packed >> 9); }
constexpr int rows_of(std::uint32_t packed) { return int(packed & 511) - 256; }

SFUMATO_WIDE void lower(std::uint32_t* least, const Side* row, int width, int rows) {
  const std::uint32_t across = packed(rows * rows, rows);
  for (int x = 0; x < width; ++x) {
    const std::uint32_t along = row[x] == none ? nowhere : std::uint32_t(row[x] * row[x] * 512);
    least[x] = std::min(least[x], along + across);
  }
}

/// To the nearest goal of pixels [first, first + width) of row y, from those along all rows.
void across_rows(const Image<Side>& along, int first, int y, int width, int reach, std::uint32_t* least) {
  std::fill_n(least, width, nowhere);
  for (int k = -reach; k <= reach; ++k)
    if (y + k >= 0 && y + k < along.height()) lower(least, along.row(y + k) + first, width, k);
}

/// The pixel of a point. Negative: there is none as near.
using Place = glm::i16vec2;

Image<Place> nearest_points(const Image<std::uint32_t>& depth_bits, int reach) {
  const int width = depth_bits.width(), height = depth_bits.height();
  Image<Side> along(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    along_row(&along.at(0, y), width, reach, [&](int x) { return depth_bits.at(x, y) != 0xffffffffu; });
  });
  Image<Place> nearest(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    std::vector<std::uint32_t> least(static_cast<std::size_t>(width));
    across_rows(along, 0, y, width, reach, least.data());
    for (int x = 0; x < width; ++x) {
      const std::uint32_t found = least[std::size_t(x)];
      const int row = y + rows_of(found);
      nearest.at(x, y) = found < nowhere ? Place(x + along.at(x, row), row) : Place(-1);
    }
  });
  return nearest;
}

int cross(ivec2 a, ivec2 b) { return a.x * b.y - a.y * b.x; }
int squared(ivec2 a) { return a.x * a.x + a.y * a.y; }
int extent(ivec2 a) { return std::max(std::abs(a.x), std::abs(a.y)); }

/// The complex as pixels, which threads add to at once.
class Shape {
 public:
  enum Part : std::uint8_t { of_edge = 1, of_triangle = 2 };
  Shape(int width, int height, float radius) : pixels_(width, height), radius2_(radius * radius) {}
  bool in_triangle(int x, int y) const { return pixels_.at(x, y) >= of_triangle; }
  bool is_lone(int x, int y) const { return pixels_.at(x, y) == of_edge; }
  void add(ivec2 at, Part part) {
    std::atomic_ref(pixels_.at(at.x, at.y)).fetch_or(part, std::memory_order_relaxed);
  }
  /// An edge whose smallest circle is around `middle`, doubled.
  void add_edge(ivec2 a, ivec2 b, ivec2 middle) {
    if (extent(a + b - middle) <= 2 && float(squared(b - a)) <= 4 * radius2_) add_line(a, b, of_edge);
  }
  void add_triangle(ivec2 a, ivec2 b, ivec2 c) {
    const int area = cross(b - a, c - a);  // twice
    if (area == 0) return;
    if (area < 0) std::swap(b, c);
    const float ab = float(squared(b - a)), bc = float(squared(c - b)), ca = float(squared(a - c)),
                longest = std::max({ab, bc, ca});
    // Around an obtuse one that of its longest side, else that through all three, whose radius is the product
    // of the sides divided by four times the area.
    const bool is_obtuse = 2 * longest > ab + bc + ca;
    if (is_obtuse ? longest > 4 * radius2_ : ab * bc * ca > 4 * radius2_ * (float(area) * float(area)))
      return;
    add_line(a, b, of_triangle);
    add_line(b, c, of_triangle);
    add_line(c, a, of_triangle);
    const ivec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec2 p(x, y);
        if (cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0)
          add(p, of_triangle);
      }
  }

 private:
  void add_line(ivec2 a, ivec2 b, Part part) {
    const ivec2 along = b - a;
    const int steps = extent(along);
    // Halves are rounded up, whichever end is first.
    for (int k = 1; k < steps; ++k)
      add(a - steps + (2 * (along * k + steps * steps) + steps) / (2 * steps), part);
  }

  Image<std::uint8_t> pixels_;
  float radius2_;
};

/// Pixels are a triangulation of the plane, and so are the points that they are nearest to: that of Delaunay.
Shape complex_of(const Image<Place>& nearest, float radius) {
  Shape shape(nearest.width(), nearest.height(), radius);
  tbb::parallel_for(0, nearest.height() - 1, [&](int y) {
    for (int x = 0; x + 1 < nearest.width(); ++x) {
      const ivec2 here(nearest.at(x, y)), right(nearest.at(x + 1, y)), below(nearest.at(x, y + 1)),
          opposite(nearest.at(x + 1, y + 1));
      if (here == ivec2(x, y)) shape.add(here, Shape::of_edge);
      if (right.x < 0 || below.x < 0) continue;
      if (here.x >= 0) {
        shape.add_triangle(here, right, below);
        shape.add_edge(here, right, {2 * x + 1, 2 * y});
        shape.add_edge(here, below, {2 * x, 2 * y + 1});
      }
      if (opposite.x >= 0) shape.add_triangle(opposite, right, below);
    }
  });
  return shape;
}

}  // namespace

Image<std::uint8_t> evidence_by_rows(const Image<std::uint32_t>& depth_bits, int band, int width, int height,
                                     const EvidenceReach& reach) {
  const Image<Place> nearest = nearest_points(depth_bits, reach.to_circle());
  const Shape shape = complex_of(nearest, reach.between);
  Image<Side> along(depth_bits.width(), depth_bits.height());
  Image<std::uint8_t> mask(width, height);
  const auto widen = [&](float by, const auto& is_part) {
    tbb::parallel_for(0, along.height(), [&](int y) {
      along_row(&along.at(0, y), along.width(), int(by), [&](int x) { return is_part(x, y); });
    });
    tbb::parallel_for(0, height, [&](int y) {
      std::vector<std::uint32_t> least(static_cast<std::size_t>(width));
      across_rows(along, band, y + band, width, int(by), least.data());
      for (int x = 0; x < width; ++x) {
        const ivec2 pixel = ivec2(x, y) + band, point(nearest.at(pixel.x, pixel.y));
        const bool vouched = float(distance2_of(least[std::size_t(x)])) <= by * by && point.x >= 0 &&
                             float(squared(point - pixel)) <= reach.between * reach.between;
        if (vouched) mask.at(x, y) = 255;
      }
    });
  };
  widen(reach.beside, [&](int x, int y) { return shape.in_triangle(x, y); });
  widen(reach.around, [&](int x, int y) { return shape.is_lone(x, y); });
  return mask;
}

}  // namespace sfumato
