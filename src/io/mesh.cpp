// What the readers of meshes share.
#include "io/format.h"

namespace sfumato::io {

bool add_fan(const std::vector<std::int64_t>& polygon, const std::vector<std::int64_t>& vertex_of,
             Mesh& mesh) {
  for (std::int64_t corner : polygon)
    if (corner < 0 || corner >= std::int64_t(vertex_of.size())) return false;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const std::int64_t a = vertex_of[std::size_t(polygon[0])], b = vertex_of[std::size_t(polygon[i - 1])],
                       c = vertex_of[std::size_t(polygon[i])];
    if (a >= 0 && b >= 0 && c >= 0)
      mesh.triangles.push_back({std::uint32_t(a), std::uint32_t(b), std::uint32_t(c)});
  }
  return true;
}

std::vector<std::int64_t> kept_vertices(const PointCloud& cloud, std::uint64_t records) {
  std::vector<std::int64_t> vertex_of(std::size_t(records), -1);
  for (std::size_t i = 0; i < cloud.grid_index.size(); ++i) vertex_of[cloud.grid_index[i]] = std::int64_t(i);
  return vertex_of;
}

}  // namespace sfumato::io
