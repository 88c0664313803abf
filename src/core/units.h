// Units of length that coordinate reference systems and users name.
#pragma once

#include <string>

namespace sfumato {

struct LengthUnit {
  std::string symbol = "units";  ///< "m", "ft", "°" ..., "units" where nobody says
  double metres = 0;             ///< length of one in metres; 0 where it is not known, or an angle
  bool operator==(const LengthUnit&) const = default;
};

/// Unit of the horizontal axes of a reference system given as WKT (1 or 2): its factor in metres.
LengthUnit horizontal_unit(const std::string& crs);
/// Unit of its heights: that of the vertical part of a compound system, else of the horizontal axes (metres
/// where these are degrees).
LengthUnit vertical_unit(const std::string& crs);
/// m, km, cm, mm, ft, ft-us, in or mi; any other name is a symbol whose length is not known.
LengthUnit unit_named(const std::string& name);

}  // namespace sfumato
