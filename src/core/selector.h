// Words that choose points: "classification 3-5 and not box 0,0,0,10,10,4".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato {

/// Terms joined by "and", each maybe after "not":
///
///   *                        every point
///   SCALAR RANGES            "classification 3-5", "intensity 10..200,900..", "z ..3", "return_number 1"
///   classification NAMES     "classification ground,building" (names of ASPRS; "class" is the same word);
///                            "class vegetation" is each whose name ends so
///   file N                   of several files; counts from 1
///   box x0,y0,z0,x1,y1,z1    world
class Selector {
 public:
  /// Throws Error(usage) that says what was not understood.
  static Selector parse(std::string_view text);
  /// One flag a point. Throws Error(usage) for a number that the cloud does not have, naming those it has.
  std::vector<bool> matches(const PointCloud& cloud) const;
  const std::string& text() const { return text_; }

 private:
  struct Range {
    double low, high;
  };
  struct Term {
    enum class Kind { all, scalar, box } kind = Kind::all;
    bool negated = false;
    std::string scalar;
    std::vector<Range> ranges;
    Bounds box;
  };
  static Term parse_term(std::string_view text, const std::string& whole);
  std::string text_;
  std::vector<Term> terms_;
};

}  // namespace sfumato
