#include "core/colormap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "core/color.h"
#include "core/error.h"
#include "core/param.h"

namespace sfumato {
namespace {

struct Table {
  const char* name;
  std::vector<std::uint32_t> stops;  // 0xRRGGBB
};

// viridis, plasma, inferno, magma: every sixteenth colour of the maps of Smith, van der Walt and Firing
// (2015, CC0). turbo: Mikhailov (2019), its polynomial at 33 places. coolwarm: Moreland (2009), interpolated
// in Msh space. spectral: ColorBrewer's eleven classes. All stay within 9/255 of the full maps.
const std::vector<Table>& tables() {
  static const std::vector<Table> all = {
      {"viridis",
       {0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21908c, 0x1f9f88,
        0x27ad81, 0x3ebc74, 0x5cc863, 0x82d34d, 0xaadc32, 0xd5e21a, 0xfde725}},
      // viridis without its dark third, its lightness (CIE L*) 60 to 84: where light from the eye meets level
      // ground from 32 degrees, 60 is drawn as 50, the middle, and shades show on all of it, as on
      // the tints of maps (Imhof 1965); beyond 84 the contrast with a white page would fall below 1.5.
      {"land",
       {0x6994c1, 0x5e9ebc, 0x54a9b5, 0x4bb1ad, 0x44baa2, 0x43c295, 0x4eca81, 0x64d06a, 0x83d44e, 0xa4d62b,
        0xc8d500, 0xe8d400}},
      {"plasma",
       {0x0d0887, 0x310597, 0x4c02a1, 0x6600a7, 0x7e03a8, 0x9511a1, 0xa92395, 0xbc3587, 0xcc4678, 0xd9596a,
        0xe56b5d, 0xf07f4f, 0xf89441, 0xfdab33, 0xfdc328, 0xf9dd25, 0xf0f921}},
      {"inferno",
       {0x000004, 0x0b0724, 0x210c4a, 0x3d0965, 0x56106e, 0x70196e, 0x89226a, 0xa32c61, 0xbb3654, 0xd14545,
        0xe35932, 0xf1721e, 0xf98c0a, 0xfcaa0f, 0xf9c932, 0xf2e865, 0xfcffa4}},
      {"magma",
       {0x000004, 0x0a0822, 0x1d1147, 0x36106b, 0x50127c, 0x691c81, 0x822681, 0x9c2e7f, 0xb6367a, 0xcf4070,
        0xe65164, 0xf46a5c, 0xfb8861, 0xfea571, 0xfec287, 0xfde0a1, 0xfcfdbf}},
      {"turbo", {0x23171b, 0x3e2a72, 0x493eaf, 0x4a54d7, 0x446aee, 0x3c80f8, 0x3295f7, 0x2aa9ef, 0x26bce2,
                 0x25cdd0, 0x29dcbc, 0x32e9a7, 0x3ff393, 0x50fa80, 0x65fd6e, 0x7dfd5e, 0x94fa50, 0xadf545,
                 0xc4ec3c, 0xdae034, 0xedd12e, 0xfabf29, 0xffac25, 0xff9821, 0xff821d, 0xfd6c1a, 0xf05616,
                 0xdf4212, 0xcb2f0d, 0xb61f07, 0xa31302, 0x950c00, 0x900c00}},
      // Nuñez, Anderton and Renslow (2018), every 28th colour: nearly alike to eyes with and without red and
      // green.
      {"cividis",
       {0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838}},
      // From where shades show (CIE L* 34) to short of white, so that no point drowns in the background.
      {"gray", {0x505050, 0xf0f0f0}},
      {"coolwarm",
       {0x3b4cc0, 0x4e68d7, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2fe, 0xb8d0f9, 0xccd9ed, 0xdcdcdc, 0xebd3c6,
        0xf4c5ad, 0xf7b194, 0xf49a7b, 0xec7f63, 0xde614d, 0xcb3e38, 0xb40426}},
      {"spectral",
       {0x9e0142, 0xd53e4f, 0xf46d43, 0xfdae61, 0xfee08b, 0xffffbf, 0xe6f598, 0xabdda4, 0x66c2a5, 0x3288bd,
        0x5e4fa2}},
      {"jet", {0x000080, 0x0000ff, 0x0080ff, 0x00ffff, 0x80ff80, 0xffff00, 0xff8000, 0xff0000, 0x800000}},
  };
  return all;
}

/// Matplotlib's rainbow: three waves, from violet over green to red.
std::vector<Rgba8> rainbow() {
  std::vector<Rgba8> stops;
  for (int i = 0; i <= 32; ++i) {
    const double t = i / 32.0, pi = std::numbers::pi;
    auto byte = [](double v) { return std::uint8_t(std::lround(255 * std::clamp(v, 0.0, 1.0))); };
    stops.push_back({byte(std::abs(2 * t - 0.5)), byte(std::sin(pi * t)), byte(std::cos(0.5 * pi * t)), 255});
  }
  return stops;
}

/// "white,#ff8800,black": equally spaced.
std::vector<Rgba8> stops_of_list(std::string_view text) {
  std::vector<Rgba8> stops;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string word(text.substr(from, to - from));
    from = to + 1;
    const std::optional<vec3> color = parse_color(word);
    if (!color)
      throw Error(ErrorCode::usage, "the colour map '" + std::string(text) + "': '" + word +
                                        "' is no colour; write names (steelblue) or #hex (#4682b4)");
    stops.push_back(to_rgba8(*color));
  }
  return stops;
}

}  // namespace

const std::vector<std::string>& Colormap::names() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const Table& table : tables()) names.emplace_back(table.name);
    names.emplace_back("rainbow");
    return names;
  }();
  return all;
}

std::vector<std::string> Colormap::choices() {
  std::vector<std::string> all = names();
  for (const std::string& name : names()) all.push_back(name + "_r");
  return all;
}

Colormap Colormap::named(std::string_view name) {
  if (name.ends_with("_r")) {  // as Matplotlib names what runs backwards
    Colormap map = named(name.substr(0, name.size() - 2));
    std::reverse(map.stops_.begin(), map.stops_.end());
    return map;
  }
  Colormap map;
  if (name.find(',') != std::string_view::npos) {
    map.stops_ = stops_of_list(name);
    return map;
  }
  if (name == "rainbow") map.stops_ = rainbow();
  for (const Table& table : tables())
    if (name == table.name)
      for (std::uint32_t c : table.stops)
        map.stops_.push_back({std::uint8_t(c >> 16), std::uint8_t(c >> 8 & 255), std::uint8_t(c & 255), 255});
  if (!map.stops_.empty()) return map;
  const std::string near = nearest_word(name, names());
  std::string all;
  for (const std::string& n : names()) all += " " + n;
  throw Error(ErrorCode::usage, "no colour map '" + std::string(name) + "'" +
                                    (near.empty() ? "" : "; did you mean '" + near + "'?") + " There are:" +
                                    all + "; NAME_r reverses one, and white,#ff8800,black makes one");
}

Rgba8 Colormap::at(double t) const {
  const double place = std::clamp(t, 0.0, 1.0) * double(stops_.size() - 1);
  const std::size_t i = std::min(std::size_t(place), stops_.size() - 2);
  const double f = place - double(i);
  auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return std::uint8_t(std::lround(a + f * (double(b) - a)));
  };
  const Rgba8 &a = stops_[i], &b = stops_[i + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), 255};
}

Colormap Colormap::spread(const std::vector<double>& places) const {
  Colormap map;
  for (const double place : places) map.stops_.push_back(at(place));
  return map;
}

std::string Colormap::text() const {
  std::string text;
  for (const Rgba8& c : stops_) text += (text.empty() ? "" : ",") + hex_of(c);
  return text;
}

}  // namespace sfumato
