#include "techniques/technique.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato {

int nearest_px(const GpuCloud& cloud, const Camera& camera,
               const std::function<double(const Batch&)>& length) {
  const PreparedCloud& prepared = cloud.prepared();
  const dvec3 toward = camera.direction(), from = prepared.cloud.origin - camera.position;
  double most = 0;
  for (const Batch& batch : prepared.batches) {
    const dvec3 nearest =
        glm::mix(dvec3(batch.box_min), dvec3(batch.box_max), glm::lessThan(toward, dvec3(0)));
    const double depth =
        camera.orthographic() ? 1 : std::max(glm::dot(toward, from + nearest), camera.near_plane);
    most = std::max(most, length(batch) * camera.pixels_per_unit() / depth);
  }
  return int(std::ceil(std::clamp(most, 0.0, 1536.0)));
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
