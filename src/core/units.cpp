#include "core/units.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace sfumato {
namespace {

/// The text from one of these keywords to the bracket that closes it; empty when none is there.
std::string part_of(const std::string& wkt, std::initializer_list<const char*> keywords) {
  for (const char* keyword : keywords) {
    const std::size_t start = wkt.find(std::string(keyword) + "[");
    if (start == std::string::npos) continue;
    int depth = 0;
    for (std::size_t i = start; i < wkt.size(); ++i) {
      depth += wkt[i] == '[' ? 1 : wkt[i] == ']' ? -1 : 0;
      if (wkt[i] == ']' && depth == 0) return wkt.substr(start, i - start);
    }
    return wkt.substr(start);
  }
  return {};
}

LengthUnit unit_of_length(const std::string& name, double metres) {
  const auto is = [&](double length) { return std::abs(metres - length) < 1e-5 * length; };
  if (is(1)) return {"m", metres};
  if (is(0.3048)) return {"ft", metres};  // both feet: they differ by two millionths
  if (is(1000)) return {"km", metres};
  if (is(0.01)) return {"cm", metres};
  if (is(0.001)) return {"mm", metres};
  return {name, metres};
}

/// The last unit of a part is that of its axes.
LengthUnit last_unit(const std::string& part) {
  const std::size_t unit = part.rfind("UNIT[\"");
  if (unit == std::string::npos) return {};
  const std::size_t name = unit + 6, end = part.find('"', name);
  if (end == std::string::npos) return {};
  const std::string word = part.substr(name, end - name);
  const std::size_t comma = part.find(',', end);
  const double factor = comma == std::string::npos ? 0 : std::strtod(part.c_str() + comma + 1, nullptr);
  const bool is_angle = word.find("DEGREE") != std::string::npos || word.find("RADIAN") != std::string::npos;
  if (is_angle) return {"°", 0};
  return factor > 0 ? unit_of_length(word, factor) : LengthUnit{};
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

}  // namespace

LengthUnit horizontal_unit(const std::string& crs) {
  const std::string wkt = upper(crs);
  std::string part = part_of(wkt, {"PROJCS", "PROJCRS", "GEOCCS", "LOCAL_CS", "ENGCRS", "GEOGCS", "GEOGCRS"});
  return last_unit(part);
}

LengthUnit vertical_unit(const std::string& crs) {
  const LengthUnit vertical = last_unit(part_of(upper(crs), {"VERT_CS", "VERTCRS", "VERTICALCRS"}));
  if (vertical.metres > 0) return vertical;
  const LengthUnit horizontal = horizontal_unit(crs);
  return horizontal.symbol == "°" ? LengthUnit{"m", 1} : horizontal;
}

LengthUnit unit_named(const std::string& name) {
  if (name == "m" || name == "metre" || name == "meter") return {"m", 1};
  if (name == "km") return {"km", 1000};
  if (name == "cm") return {"cm", 0.01};
  if (name == "mm") return {"mm", 0.001};
  if (name == "ft" || name == "feet" || name == "foot") return {"ft", 0.3048};
  if (name == "ft-us" || name == "us-ft") return {"ft", 1200.0 / 3937};
  if (name == "in") return {"in", 0.0254};
  if (name == "mi") return {"mi", 1609.344};
  return {name, 0};
}

}  // namespace sfumato
