#include "core/classes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/error.h"
#include "core/numbers.h"

namespace sfumato {

int class_at(const ScalarField& field, std::size_t i) {
  constexpr double most = std::numeric_limits<int>::max();
  return int(std::lround(std::clamp(field.value(i), -most, most)));
}

std::string class_name(int id) {
  static const char* names[] = {"never classified",
                                "unclassified",
                                "ground",
                                "low vegetation",
                                "medium vegetation",
                                "high vegetation",
                                "building",
                                "low noise",
                                "model key point",
                                "water",
                                "rail",
                                "road surface",
                                "overlap",
                                "wire guard",
                                "wire conductor",
                                "transmission tower",
                                "wire connector",
                                "bridge deck",
                                "high noise",
                                "overhead structure",
                                "ignored ground",
                                "snow",
                                "temporal exclusion"};
  return id >= 0 && id < int(std::size(names)) ? names[id] : "class " + std::to_string(id);
}

std::optional<int> class_named(std::string_view name) {
  for (int id = 0; id < 256; ++id)
    if (class_name(id) == name) return id;
  return std::nullopt;
}

std::vector<ClassShare> count_classes(const ScalarField& field) {
  std::map<int, std::size_t> counts;
  int last_id = 0;
  std::size_t* last = nullptr;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (!std::isfinite(field.values[i])) continue;
    const int id = class_at(field, i);
    if (!last || id != last_id) last_id = id, last = &counts[id];
    ++*last;
  }
  std::vector<ClassShare> shares;
  for (const auto& [id, points] : counts) shares.push_back({id, points});
  return shares;
}

Rgba8 class_color(int id) {
  static const std::uint32_t colors[] = {0x8c8c8c, 0x9a9a9a, 0xa1522e, 0x8fdc5a, 0x45b83a, 0x127a2c,
                                         0xffa800, 0xff00ff, 0xff2a2a, 0x2a5cff, 0x6b4f8a, 0x5a5a66,
                                         0xffe600, 0xc9b037, 0xe0c84a, 0x7f6a2a, 0xb39a2f, 0x3fb8c4,
                                         0xc800c8, 0x2f8f9d, 0x7a5a45, 0xf2f6ff, 0x555555};
  if (id >= 0 && id < int(std::size(colors))) {
    const std::uint32_t c = colors[id];
    return {std::uint8_t(c >> 16), std::uint8_t(c >> 8 & 255), std::uint8_t(c & 255), 255};
  }
  // Codes that users define: spread over hues so that neighbours differ, always the same colour for one code.
  const float hue = std::fmod(std::abs(float(id)) * 0.61803399f, 1.0f) * 6;
  auto channel = [&](float centre) {
    const float d = std::abs(std::fmod(hue - centre + 9, 6.0f) - 3);
    return std::uint8_t(60 + 170 * std::clamp(2 - d, 0.0f, 1.0f));
  };
  return {channel(0), channel(2), channel(4), 255};
}

std::map<int, Rgba8> parse_class_colors(std::string_view text) {
  std::map<int, Rgba8> colors;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find_first_of(",\n", from), text.size());
    std::string_view pair = text.substr(from, to - from);
    from = to + 1;
    while (!pair.empty() && std::isspace(static_cast<unsigned char>(pair.back()))) pair.remove_suffix(1);
    while (!pair.empty() && std::isspace(static_cast<unsigned char>(pair.front()))) pair.remove_prefix(1);
    if (pair.empty()) continue;
    const std::size_t sign = pair.find('=');
    const std::string_view name = pair.substr(0, sign);
    std::optional<int> id = class_named(name);
    if (!id)
      if (const std::optional<double> code = parse_real(name);
          code && *code >= 0 && *code < 65536 && *code == std::floor(*code))
        id = int(*code);
    const std::optional<vec3> color = sign == pair.npos ? std::nullopt : parse_color(pair.substr(sign + 1));
    if (!id || !color)
      throw Error(ErrorCode::usage, "'" + std::string(pair) + "' is not CLASS=COLOUR: " +
                                        (id ? "write a name (tan) or #hex (#aa7744)"
                                            : "the class is a code (2) or its name (ground)"));
    colors[*id] = to_rgba8(*color);
  }
  if (colors.empty()) throw Error(ErrorCode::usage, "no class has a colour in it; write 2=#aa7744,6=orange");
  return colors;
}

std::size_t hide_classes(PointCloud& cloud, const std::vector<int>& classes) {
  const ScalarField* code = cloud.scalar("classification");
  const ScalarField* withheld = cloud.scalar("withheld");
  if ((!code || classes.empty()) && !withheld) return 0;
  std::vector<std::uint32_t> kept;
  kept.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (withheld && withheld->value(i) > 0.5) continue;
    if (code && std::isfinite(code->values[i]) &&
        std::find(classes.begin(), classes.end(), int(std::lround(code->value(i)))) != classes.end())
      continue;
    kept.push_back(std::uint32_t(i));
  }
  const std::size_t hidden = cloud.size() - kept.size();
  if (hidden > 0) cloud = select(cloud, kept);
  return hidden;
}

}  // namespace sfumato
