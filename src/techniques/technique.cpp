#include "techniques/technique.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato {

void Technique::cast(GpuCloud& cloud, Progress&) {
  if (cloud.casters_key() != "solid") cloud.set_casters({}, 0, "solid");
}

int nearest_px(double length, const Camera& camera) {
  const double depth = camera.orthographic() ? 1 : camera.near_plane;
  return int(std::ceil(std::clamp(length * camera.pixels_per_unit() / depth, 0.0, 512.0)));
}

const TechniqueInfo& find_technique(std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const TechniqueInfo& info : all_techniques()) {
    if (info.name == name) return info;
    names.push_back(info.name);
    list += (list.empty() ? "" : ", ") + info.name;
  }
  const std::string nearest = nearest_word(name, names);
  throw Error(ErrorCode::usage, "there is no technique '" + std::string(name) + "'" +
                                    (nearest.empty() ? "" : "; did you mean " + nearest + "?") + " (" + list +
                                    ")");
}

}  // namespace sfumato
