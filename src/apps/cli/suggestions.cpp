#include "suggestions.h"

#include <algorithm>
#include <map>

#include "core/param.h"

namespace sfumato::cli {
namespace {

std::string bare(const std::string& name) {
  std::string text;
  for (char c : name)
    if (c != '-' && c != '_') text += char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// What other programs, and people, call our options.
const std::map<std::string, std::string>& synonyms() {
  static const std::map<std::string, std::string> table = {{"size", "--resolution"},
                                                           {"width", "--resolution"},
                                                           {"height", "--resolution"},
                                                           {"geometry", "--resolution"},
                                                           {"res", "--resolution"},
                                                           {"fov", "--camera-view-angle"},
                                                           {"scalars", "--color-by"},
                                                           {"colour-by", "--color-by"},
                                                           {"colour", "--color"},
                                                           {"colour-map", "--colormap"},
                                                           {"palette", "--colormap"},
                                                           {"cmap", "--colormap"},
                                                           {"bg", "--background-color"},
                                                           {"background", "--background-color"},
                                                           {"transparent", "--no-background"},
                                                           {"out", "--output"},
                                                           {"eye", "--camera-position"},
                                                           {"pos", "--camera-position"},
                                                           {"center", "--look-at"},
                                                           {"focus", "--look-at"},
                                                           {"target", "--look-at"},
                                                           {"rotate", "--camera-azimuth-angle"},
                                                           {"ortho", "--camera-orthographic"},
                                                           {"limit", "--max-points"},
                                                           {"bounds", "--crop"},
                                                           {"bbox", "--crop"},
                                                           {"clip", "--crop"},
                                                           {"section", "--crop"},
                                                           {"slice", "--crop"},
                                                           {"class", "--show-classes"},
                                                           {"classes", "--show-classes"},
                                                           {"jobs", "--threads"},
                                                           {"where", "--filter"},
                                                           {"animate", "--path"},
                                                           {"turntable", "--path"},
                                                           {"batch", "--each"},
                                                           {"silent", "--quiet"},
                                                           {"config", "--preset"},
                                                           {"method", "--technique"},
                                                           {"renderer", "--technique"},
                                                           {"depth", "--output-depth"},
                                                           {"normals", "--output-normal"},
                                                           {"decimate", "--max-points"},
                                                           {"colorbar", "--legend"},
                                                           {"scalebar", "--scale-bar"},
                                                           {"bar", "--scale-bar"},
                                                           {"colors", "--color"}};
  return table;
}

}  // namespace

std::string suggest_option(const std::string& word, const std::vector<std::string>& names) {
  const auto exists = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const std::string plain = bare(word);
  std::string key =
      word.substr(word.find_first_not_of('-') == std::string::npos ? 0 : word.find_first_not_of('-'));
  for (const std::string& name : names)  // --pointsize, --point_size, -point-size
    if (bare(name) == plain) return "; did you mean " + name + "?";
  if (const auto found = synonyms().find(key); found != synonyms().end() && exists(found->second))
    return "; did you mean " + found->second + "?";
  // Without the dashes, which any two options share: --gpu is nothing like --up.
  std::vector<std::string> bodies;
  for (const std::string& name : names) bodies.push_back(name.substr(2));
  if (const std::string near = nearest_word(key, bodies); !near.empty())
    return "; did you mean --" + near + "?";
  // --azimuth is a part of one name.
  std::string parts;
  int count = 0;
  for (const std::string& name : names)
    if (key.size() >= 4 && ("-" + name.substr(2) + "-").find("-" + key + "-") != std::string::npos &&
        ++count <= 3)
      parts += (parts.empty() ? "" : " or ") + name;
  if (count > 0 && count <= 3) return "; did you mean " + parts + "?";
  return "";
}

}  // namespace sfumato::cli
