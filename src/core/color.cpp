#include "core/color.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "core/number_in.h"
#include "core/param.h"

namespace sfumato {
namespace {

struct Named {
  const char* name;
  std::uint32_t rgb;
};

/// The names of CSS that people write; grey and gray are the same.
constexpr Named names[] = {{"black", 0x000000},        {"white", 0xffffff},      {"red", 0xff0000},
                           {"green", 0x008000},        {"blue", 0x0000ff},       {"yellow", 0xffff00},
                           {"cyan", 0x00ffff},         {"magenta", 0xff00ff},    {"gray", 0x808080},
                           {"silver", 0xc0c0c0},       {"lightgray", 0xd3d3d3},  {"darkgray", 0xa9a9a9},
                           {"dimgray", 0x696969},      {"slategray", 0x708090},  {"darkslategray", 0x2f4f4f},
                           {"gainsboro", 0xdcdcdc},    {"whitesmoke", 0xf5f5f5}, {"snow", 0xfffafa},
                           {"ivory", 0xfffff0},        {"linen", 0xfaf0e6},      {"beige", 0xf5f5dc},
                           {"wheat", 0xf5deb3},        {"tan", 0xd2b48c},        {"khaki", 0xf0e68c},
                           {"gold", 0xffd700},         {"orange", 0xffa500},     {"darkorange", 0xff8c00},
                           {"coral", 0xff7f50},        {"tomato", 0xff6347},     {"salmon", 0xfa8072},
                           {"orangered", 0xff4500},    {"crimson", 0xdc143c},    {"firebrick", 0xb22222},
                           {"darkred", 0x8b0000},      {"maroon", 0x800000},     {"brown", 0xa52a2a},
                           {"sienna", 0xa0522d},       {"chocolate", 0xd2691e},  {"peru", 0xcd853f},
                           {"pink", 0xffc0cb},         {"hotpink", 0xff69b4},    {"deeppink", 0xff1493},
                           {"orchid", 0xda70d6},       {"violet", 0xee82ee},     {"purple", 0x800080},
                           {"indigo", 0x4b0082},       {"plum", 0xdda0dd},       {"lavender", 0xe6e6fa},
                           {"lime", 0x00ff00},         {"limegreen", 0x32cd32},  {"lightgreen", 0x90ee90},
                           {"forestgreen", 0x228b22},  {"darkgreen", 0x006400},  {"seagreen", 0x2e8b57},
                           {"olive", 0x808000},        {"olivedrab", 0x6b8e23},  {"yellowgreen", 0x9acd32},
                           {"springgreen", 0x00ff7f},  {"teal", 0x008080},       {"turquoise", 0x40e0d0},
                           {"aqua", 0x00ffff},         {"aquamarine", 0x7fffd4}, {"skyblue", 0x87ceeb},
                           {"lightblue", 0xadd8e6},    {"steelblue", 0x4682b4},  {"cornflowerblue", 0x6495ed},
                           {"dodgerblue", 0x1e90ff},   {"royalblue", 0x4169e1},  {"deepskyblue", 0x00bfff},
                           {"slateblue", 0x6a5acd},    {"darkblue", 0x00008b},   {"navy", 0x000080},
                           {"midnightblue", 0x191970}, {"fuchsia", 0xff00ff}};

vec3 unpack(std::uint32_t rgb) {
  return vec3(float(rgb >> 16), float(rgb >> 8 & 255), float(rgb & 255)) / 255.0f;
}

std::string spelling(std::string_view text) {
  std::string name;
  for (char c : text)
    if (c != ' ' && c != '-' && c != '_') name += char(std::tolower(static_cast<unsigned char>(c)));
  for (std::size_t at = name.find("grey"); at != std::string::npos; at = name.find("grey"))
    name[at + 2] = 'a';
  return name;
}

}  // namespace

std::optional<vec3> parse_color(std::string_view text) {
  if (text.starts_with('#')) {
    text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    if (text.size() == 6) return unpack(value);
    if (text.size() == 3)
      return unpack((value >> 8 & 15) * 0x110000 + (value >> 4 & 15) * 0x1100 + (value & 15) * 0x11);
    return std::nullopt;
  }
  const std::string name = spelling(text);
  for (const Named& each : names)
    if (name == each.name) return unpack(each.rgb);
  std::array<float, 3> channels{};
  for (int k = 0; k < 3; ++k) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k == 2)) return std::nullopt;
    const std::optional<float> channel = number_in<float>(text.substr(0, comma));
    if (!channel || !(*channel >= 0 && *channel <= 1)) return std::nullopt;
    channels[std::size_t(k)] = *channel;
    text.remove_prefix(std::min(text.size(), comma == std::string_view::npos ? text.size() : comma + 1));
  }
  return vec3(channels[0], channels[1], channels[2]);
}

std::string nearest_color(std::string_view name) {
  std::vector<std::string> all;
  for (const Named& each : names) all.emplace_back(each.name);
  return nearest_word(spelling(name), all);
}

Rgba8 to_rgba8(const vec3& srgb) {
  const vec3 c = glm::clamp(srgb, 0.0f, 1.0f) * 255.0f + 0.5f;
  return {std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255};
}

std::string hex_of(const Rgba8& color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color.r, color.g, color.b);
  return text;
}

const std::array<float, 256>& linear_of_srgb_codes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values;
    for (int i = 0; i < 256; ++i) {
      const float s = float(i) / 255;
      values[std::size_t(i)] = s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
    }
    return values;
  }();
  return table;
}

double luma(const Rgba8& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

Rgba8 swatch_color(std::size_t n) {
  static constexpr std::uint32_t colors[] = {0x0072b2, 0xe69f00, 0x009e73, 0xd55e00,
                                             0xcc79a7, 0x56b4e9, 0xf0e442, 0x595959};
  if (n < std::size(colors)) return to_rgba8(unpack(colors[n]));
  // Hues in steps of the golden angle never repeat.
  const float hue = std::fmod(float(n) * 0.61803399f, 1.0f) * 6;
  const auto channel = [&](float centre) {
    return std::clamp(2 - std::abs(std::fmod(hue - centre + 9, 6.0f) - 3), 0.0f, 1.0f);
  };
  return to_rgba8(0.15f + 0.65f * vec3(channel(0), channel(2), channel(4)));
}

}  // namespace sfumato
