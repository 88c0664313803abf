// Named colour maps: a number in [0,1] to an sRGB colour.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace sfumato {

class Colormap {
 public:
  /// One of `names()`, with "_r" behind it from its other end; or two colours or more, equally spaced, as in
  /// "white,#ff8800,black". Throws Error(usage) naming the nearest when there is none of that name.
  static Colormap named(std::string_view name);
  static const std::vector<std::string>& names();
  /// Those names, and then each of them reversed: what a list offers.
  static std::vector<std::string> choices();

  /// `t` is clamped to [0,1]; between the stops the sRGB values are interpolated.
  Rgba8 at(double t) const;
  /// The map whose equally spaced stops are those of this one at `places`, two or more.
  Colormap spread(const std::vector<double>& places) const;
  /// As `named` takes it: "#6994c1,#5e9ebc,...".
  std::string text() const;

 private:
  std::vector<Rgba8> stops_;  // equally spaced over [0,1]
};

}  // namespace sfumato
