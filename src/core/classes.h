// Classes of points: their names, colours and how many points have each.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato {

/// ASPRS name of a classification code ("ground", "building", "class 70"), LAS 1.4 R15 table 17.
std::string class_name(int id);
/// "ground": 2. Nothing for other words.
std::optional<int> class_named(std::string_view name);
/// The colours Potree users know: 2 brown, 3-5 greens, 6 orange, 7 magenta, 9 blue, 12 yellow.
Rgba8 class_color(int id);

/// The code of a point. Any scalar may be asked for as classes.
int class_at(const ScalarField& field, std::size_t i);
struct ClassShare {
  int id = 0;
  std::size_t points = 0;
};
/// How many points have each code, ascending; points without one are not counted.
std::vector<ClassShare> count_classes(const ScalarField& field);
/// "2=#aa7744,6=orange,ground=tan": codes or their names, and colours. Throws Error(usage).
std::map<int, Rgba8> parse_class_colors(std::string_view text);

/// Removes points of the named classes and points flagged withheld. Returns how many were removed.
std::size_t hide_classes(PointCloud& cloud, const std::vector<int>& classes);

}  // namespace sfumato
