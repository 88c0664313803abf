#include "gl/preferences.h"

#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace sfumato::gl {
namespace {

std::string text_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text ? text : "";
}

template <class T>
T one_of(const char* variable, std::initializer_list<std::pair<std::string_view, T>> words) {
  const std::string text = text_of(variable);
  if (text.empty()) return T::automatic;
  std::string all;
  for (const auto& [word, value] : words) {
    if (text == word) return value;
    all += (all.empty() ? "" : word == (words.end() - 1)->first ? " or " : ", ") + std::string(word);
  }
  throw Error(ErrorCode::usage, std::string(variable) + " is '" + text + "', not " + all);
}

int side_of_tiles() {
  const std::string text = text_of("SFUMATO_TILE");
  if (text.empty()) return 0;
  char* end = nullptr;
  const long side = std::strtol(text.c_str(), &end, 10);
  if (*end != 0 || side <= 0 || side > 8192 || side % 64 != 0)
    throw Error(ErrorCode::usage, "SFUMATO_TILE is '" + text + "', not a multiple of 64 up to 8192");
  return int(side);
}

/// Of `take_shaders_from`.
std::string& chosen_shader_folder() {
  static std::string folder;
  return folder;
}

Place place(const char* variable) {
  return one_of<Place>(variable, {{"gpu", Place::gpu}, {"cpu", Place::cpu}});
}

}  // namespace

Preferences Preferences::from_environment() {
  Preferences out;
  out.shader_folder = chosen_shader_folder().empty() ? text_of("SFUMATO_SHADER_DIR") : chosen_shader_folder();
  out.kept_shaders = text_of("SFUMATO_KEEP_SHADERS");
  out.screen_passes = one_of<ScreenPassKind>(
      "SFUMATO_SCREEN_PASS", {{"fragment", ScreenPassKind::fragment}, {"compute", ScreenPassKind::compute}});
  out.splat_path = one_of<SplatPath>("SFUMATO_SPLAT_PATH", {{"automatic", SplatPath::automatic},
                                                            {"points", SplatPath::points},
                                                            {"quads", SplatPath::quads},
                                                            {"compute", SplatPath::compute}});
  out.tile_side = side_of_tiles();
  out.depth_sort = place("SFUMATO_DEPTH_SORT");
  out.soft_blend = place("SFUMATO_SOFT_BLEND");
  out.stroke_lists = place("SFUMATO_STROKE_LISTS");
  out.splats = place("SFUMATO_SPLATS");
  out.points = place("SFUMATO_POINTS");
  out.evidence = place("SFUMATO_EVIDENCE");
  out.finish = place("SFUMATO_FINISH");
  return out;
}

void Preferences::take_shaders_from(const std::string& folder) { chosen_shader_folder() = folder; }

}  // namespace sfumato::gl
