#include "passes/evidence_cpu.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>

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
constexpr int most_rows = 255;
static_assert(EvidenceReach{EvidenceReach::most}.to_circle() <= most_rows);
constexpr std::uint32_t packed(int distance2, int rows) {
  return std::uint32_t(distance2 * 512 + rows + 256);
}
constexpr int rows_of(std::uint32_t packed) { return int(packed & 511) - 256; }
/// More than that of anything as near as that.
constexpr std::uint32_t beyond(int distance2) { return packed(distance2 + 1, -256); }
constexpr std::uint32_t nowhere = 1 << 30;
static_assert(most_rows < none && beyond(most_rows * most_rows) < nowhere);

/// Pixels of a row that are looked at together.
constexpr int block = 128;

/// From all pixels along their rows.
struct Along {
  Along(int width, int height) : sides(width, height), found((width + block - 1) / block, height) {}
  template <class IsGoal>
  void find_row(int y, int reach, const IsGoal& is_goal) {
    along_row(&sides.at(0, y), sides.width(), reach, is_goal);
    for (int x = 0; x < sides.width(); x += block) {
      const Side* first = &sides.at(x, y);
      found.at(x / block, y) =
          std::any_of(first, first + std::min(block, sides.width() - x), [](Side s) { return s != none; });
    }
  }
  Image<Side> sides;
  Image<std::uint8_t> found;  ///< whether there is any, of each block of a row
};

/// To the nearest goal of a block of `columns` pixels of row y; `beyond(most2)` where none is as near.
SFUMATO_WIDE void across_rows(const Along& along, int x, int y, int columns, int most2,
                              std::uint32_t* least) {
  const auto lower = [&](int rows) {
    if (y + rows < 0 || y + rows >= along.sides.height() || !along.found.at(x / block, y + rows)) return;
    const Side* row = &along.sides.at(x, y + rows);
    const std::uint32_t across = packed(rows * rows, rows);
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t side = row[i] == none ? nowhere : std::uint32_t(row[i] * row[i] * 512);
      least[i] = std::min(least[i], side + across);
    }
  };
  std::fill_n(least, columns, beyond(most2));
  for (int k = 0; k * k <= most2; ++k) {
    lower(-k), lower(k);
    if (k % 4 != 0) continue;
    std::uint32_t farthest = 0;
    for (int i = 0; i < columns; ++i) farthest = std::max(farthest, least[i]);
    if (farthest < packed(k * k, -most_rows)) break;  // than all rows that follow
  }
}

/// The pixel of a point. Negative: there is none as near.
using Place = glm::i16vec2;

Image<Place> nearest_points(const Image<std::uint32_t>& depth_bits, int reach, Along& along) {
  const int width = depth_bits.width(), height = depth_bits.height();
  tbb::parallel_for(0, height, [&](int y) {
    along.find_row(y, reach, [&](int x) { return depth_bits.at(x, y) != 0xffffffffu; });
  });
  Image<Place> nearest(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    std::uint32_t least[block];
    for (int x = 0; x < width; x += block) {
      const int columns = std::min(block, width - x);
      across_rows(along, x, y, columns, reach * reach, least);
      for (int i = 0; i < columns; ++i) {
        const int row = y + rows_of(least[i]);
        nearest.at(x + i, y) =
            least[i] < beyond(reach * reach) ? Place(x + i + along.sides.at(x + i, row), row) : Place(-1);
      }
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
    std::atomic_ref<std::uint8_t> pixel(pixels_.at(at.x, at.y));
    if (!(pixel.load(std::memory_order_relaxed) & part)) pixel.fetch_or(part, std::memory_order_relaxed);
  }
  /// An edge whose smallest circle is around `middle`, doubled.
  void add_edge(ivec2 a, ivec2 b, ivec2 middle) {
    if (extent(a + b - middle) <= 2 && float(squared(b - a)) <= 4 * radius2_) add_line(a, b, of_edge);
  }
  void add_triangle(ivec2 a, ivec2 b, ivec2 c) {
    const int area = cross(b - a, c - a);  // twice
    if (area == 0) return;
    const float ab = float(squared(b - a)), bc = float(squared(c - b)), ca = float(squared(a - c)),
                longest = std::max({ab, bc, ca});
    // Around an obtuse one that of its longest side, else that through all three, whose radius is the product
    // of the sides divided by four times the area.
    const bool is_obtuse = 2 * longest > ab + bc + ca;
    if (is_obtuse ? longest > 4 * radius2_ : ab * bc * ca > 4 * radius2_ * (float(area) * float(area)))
      return;
    const ivec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    const int turn = area < 0 ? -1 : 1;
    add_line(a, b, of_triangle);
    add_line(b, c, of_triangle);
    add_line(c, a, of_triangle);
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec2 p(x, y);
        if (turn * cross(b - a, p - a) >= 0 && turn * cross(c - b, p - b) >= 0 &&
            turn * cross(a - c, p - c) >= 0)
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

/// Pixels are a triangulation of the plane, and so are the points that they are nearest to: that of Delaunay
/// but where four points lie on nearly one circle, or cells of the Voronoi diagram are thinner than a pixel.
Shape complex_of(const Image<Place>& nearest, float radius) {
  Shape shape(nearest.width(), nearest.height(), radius);
  tbb::parallel_for(0, nearest.height() - 1, [&](int y) {
    const Place *row = nearest.row(y), *next = nearest.row(y + 1);
    for (int x = 0; x + 1 < nearest.width(); ++x) {
      if (row[x] == Place(x, y)) shape.add({x, y}, Shape::of_edge);
      const bool is_inside = row[x] == row[x + 1] && row[x] == next[x] && row[x] == next[x + 1];
      if (is_inside || row[x + 1].x < 0 || next[x].x < 0) continue;
      const ivec2 here(row[x]), right(row[x + 1]), below(next[x]), opposite(next[x + 1]);
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

Image<std::uint8_t> evidence_mask(const Image<std::uint32_t>& depth_bits, int band, int width, int height,
                                  const EvidenceReach& reach) {
  Along along(depth_bits.width(), depth_bits.height());
  const Image<Place> nearest = nearest_points(depth_bits, reach.to_circle(), along);
  const Shape shape = complex_of(nearest, reach.between);
  Image<std::uint8_t> mask(width, height);
  const auto widen = [&](float by, const auto& is_part) {
    const int most2 = int(by * by);
    tbb::parallel_for(band - int(by), band + height + int(by),
                      [&](int y) { along.find_row(y, int(by), [&](int x) { return is_part(x, y); }); });
    tbb::parallel_for(band, band + height, [&](int y) {
      std::uint32_t least[block];
      for (int x = band - band % block; x < band + width; x += block) {
        const int columns = std::min(block, band + width - x);
        across_rows(along, x, y, columns, most2, least);
        for (int i = std::max(0, band - x); i < columns; ++i) {
          const ivec2 pixel(x + i, y), point(nearest.at(x + i, y));
          if (least[i] < beyond(most2) && point.x >= 0 &&
              float(squared(point - pixel)) <= reach.between * reach.between)
            mask.at(x + i - band, y - band) = 255;
        }
      }
    });
  };
  widen(reach.beside, [&](int x, int y) { return shape.in_triangle(x, y); });
  widen(reach.around, [&](int x, int y) { return shape.is_lone(x, y); });
  return mask;
}

void apply_evidence(const Image<std::uint8_t>& mask, Image<vec4>& albedo, Image<float>& depth,
                    Image<vec4>& normal) {
  tbb::parallel_for(0, mask.height(), [&](int y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.at(x, y) > 0 || std::isinf(depth.at(x, y))) continue;
      albedo.at(x, y) = vec4(0), normal.at(x, y) = vec4(0, 0, 0, 1);
      depth.at(x, y) = std::numeric_limits<float>::infinity();
    }
  });
}

}  // namespace sfumato
