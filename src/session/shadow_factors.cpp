#include "session/shadow_factors.h"

#include <array>
#include <map>
#include <tuple>

#include "analysis/prepare.h"
#include "core/error.h"
#include "passes/shadows.h"

namespace sfumato {
namespace {

/// `analysis::prepare` leaves out points that share a place with too many others: what is at a place is as
/// lit as whatever else is there.
void share_by_place(const PreparedCloud& prepared, const PointCloud& cloud, std::vector<float>& factors) {
  using Place = std::tuple<float, float, float>;
  const auto place = [](const vec3& p) { return Place{p.x, p.y, p.z}; };
  std::vector<bool> is_known(cloud.size());
  for (std::uint32_t source : prepared.cloud.source_index) is_known[source] = true;
  std::map<Place, float> of_place;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!is_known[i]) of_place.emplace(place(cloud.positions[i]), 1.0f);
  for (std::uint32_t source : prepared.cloud.source_index)
    if (const auto found = of_place.find(place(cloud.positions[source])); found != of_place.end())
      found->second = factors[source];
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!is_known[i]) factors[i] = of_place.at(place(cloud.positions[i]));
}

}  // namespace

std::vector<float> shadow_factors(gl::Context& context, const PointCloud& cloud,
                                  const RenderSettings& settings, Progress& progress) {
  const Light light = Light::parse(settings.light_text);
  if (!casts_shadows(settings.shadows) || light.is_of_camera())
    throw Error(ErrorCode::usage,
                "shadow factors are those of --shadows hard or soft and a light that stands somewhere");
  if (cloud.empty()) return {};
  PointCloud bare;  // colours and scalars would be sorted for nothing
  bare.origin = cloud.origin, bare.up = cloud.up;
  bare.positions = cloud.positions, bare.normals = cloud.normals;
  const PreparedCloud prepared = analysis::prepare(std::move(bare), Attribute::normal, {}, progress);

  std::vector<float> factors(cloud.size(), 1.0f);
  const gl::Context::Use use(context);
  {
    GpuCloud gpu(prepared, {});
    gl::Timers untimed(false);
    ShadowMaps maps;
    maps.update(std::array{&gpu}, settings, light, untimed, progress);
    for (GpuCloud::Chunk& chunk : gpu.chunks()) {
      std::vector<float> values(chunk.count);
      chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
      for (std::uint32_t i = 0; i < chunk.count; ++i)
        factors[prepared.cloud.source_index[chunk.first + i]] = values[i];
    }
  }
  if (prepared.cloud.size() < cloud.size()) share_by_place(prepared, cloud, factors);
  return factors;
}

}  // namespace sfumato
