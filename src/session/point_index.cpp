#include "session/point_index.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace sfumato {
namespace {

/// Techniques that draw points as they are give a pixel the depth of its point, in floats: of the nearest
/// few, a point of that very depth is it, however the others lie behind it.
constexpr std::size_t most_candidates = 16;
constexpr double depth_error = 1e-6;

}  // namespace

PointIndex::PointIndex(const Session& session) : session_(session) {
  for (std::size_t k = 0; k < session.parts().size(); ++k) trees_.emplace_back(session.cloud(k).positions);
}

Image<std::int64_t> PointIndex::of(const Camera& camera, const Image<float>& depth, int first_row) const {
  Image<std::int64_t> out(depth.width(), depth.height(), -1);
  if (session_.empty()) return out;
  const dvec3& origin = session_.cloud().origin;  // of all parts
  const dmat4 eye = camera.view(origin), local = camera.inverse_view(origin);
  const Intrinsics k = camera.intrinsics();
  tbb::parallel_for(0, depth.height(), [&](int y) {
    analysis::KNearest nearest(most_candidates);
    for (int x = 0; x < depth.width(); ++x) {
      const double z = depth.at(x, y);
      if (!std::isfinite(z)) continue;
      const double w = camera.orthographic() ? 1 : z;
      const vec3 place(
          local * glm::dvec4((x + 0.5 - k.cx) * w / k.fx, -(first_row + y + 0.5 - k.cy) * w / k.fy, -z, 1));
      std::pair best(true, std::numeric_limits<float>::infinity());  // not of that depth, distance
      for (std::size_t part = 0; part < trees_.size(); ++part) {
        nearest.start(std::numeric_limits<std::uint32_t>::max());
        trees_[part].search(place, nearest);
        for (const std::uint64_t key : nearest.heap()) {
          const dvec3 p(trees_[part].positions()[analysis::id_of(key)]);
          const double own_z = -(eye * glm::dvec4(p, 1)).z;
          const std::pair found(std::abs(own_z - z) > depth_error * z, analysis::distance2_of(key));
          if (!(found < best)) continue;
          best = found;
          out.at(x, y) = std::int64_t(session_.source(part, analysis::id_of(key)));
        }
      }
    }
  });
  return out;
}

}  // namespace sfumato
