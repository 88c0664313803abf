// Named colour maps: a number in [0,1] to an sRGB colour.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace sfumato {

class Colormap {
 public:
  /// viridis, land, plasma, inferno, magma, turbo, gray, coolwarm, spectral, cividis, jet or
  /// rainbow; with `_r` behind it, backwards.
  /// Throws Error(usage) naming the nearest when there is none of that name.
  static Colormap named(std::string_view name);
  static const std::vector<std::string>& names();

  /// `t` is clamped to [0,1]; between the stops the sRGB values are interpolated.
  Rgba8 at(double t) const;

 private:
  std::vector<Rgba8> stops_;  // equally spaced over [0,1]
};

}  // namespace sfumato
