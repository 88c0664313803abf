// Which points of a cloud are wanted: a box, classes, ranges of numbers.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/point_cloud.h"

namespace sfumato {

/// Keeps the points whose number lies in [low, high]. A point without the number (NaN) is not kept.
struct Filter {
  std::string scalar;  ///< a scalar of the cloud, or x, y, z (world), elevation, red, green, blue, radius
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool operator==(const Filter&) const = default;
};

/// "intensity 10..200", "z 3..", "row ..5", "return_number 1". Throws Error(usage).
Filter parse_filter(std::string_view text);

struct Selection {
  std::optional<Bounds> crop;        ///< world
  std::optional<Bounds> crop_share;  ///< 0,0,0 to 1,1,1 is the box of all points
  std::vector<int> show_classes;     ///< only these classes; empty: all
  std::vector<int> hide_classes;     ///< not these
  bool hide_withheld = false;        ///< nor points flagged withheld
  std::vector<Filter> filters;       ///< all of them hold

  bool empty() const {
    return !crop && !crop_share && show_classes.empty() && hide_classes.empty() && !hide_withheld &&
           filters.empty();
  }
  bool operator==(const Selection&) const = default;
};

struct SelectionReport {
  std::size_t cropped = 0, of_other_classes = 0, hidden = 0,
              filtered = 0;  ///< points removed, each counted once
  std::vector<std::string>
      notes;  ///< what asks for nothing: classes that do not occur, filters without effect
};

/// No point is left.
class NothingSelected : public Error {
 public:
  explicit NothingSelected(const std::string& message) : Error(ErrorCode::bad_input, message) {}
};

/// Removes the points that are not wanted; the order of the others stays. Throws Error(usage) for a number
/// that the cloud does not have, naming those it has, and NothingSelected when no point is left, saying what
/// would show some.
SelectionReport apply(const Selection& selection, PointCloud& cloud);

}  // namespace sfumato
