#include "techniques/soft/parts.h"

#include <algorithm>

#include "analysis/prepare.h"
#include "analysis/quantiles.h"
#include "analysis/whole.h"
#include "analysis/wide_normals.h"
#include "techniques/soft/soft_points.h"

namespace sfumato::soft {
namespace {

/// The part's own of the values of what surrounds it, too.
float own_value(const PreparedCloud& part, std::span<const float> values, std::size_t i) {
  return values[part.surroundings ? part.in_surroundings[i] : i];
}

bool is_sampled(const PreparedCloud& part, std::size_t i) {
  return !part.whole || analysis::is_sampled(part.cloud.world(i), part.whole->points);
}

}  // namespace

VisiblePoints::Values sample_of_field(const PreparedCloud& part, std::span<const float> field) {
  VisiblePoints::Values out;
  out.count = part.cloud.size();
  for (std::size_t i = 0; i < out.count; ++i) {
    const float value = own_value(part, field, i);
    out.least = std::min(out.least, value), out.most = std::max(out.most, value);
    if (is_sampled(part, i)) out.sample.push_back(value);
  }
  std::sort(out.sample.begin(), out.sample.end());
  return out;
}

std::vector<VisiblePoints::Values> sizes_of(const PreparedCloud& part, std::span<const float> field,
                                            float threshold, bool among_themselves) {
  VisiblePoints::Values of_soft, of_solid, scatter;
  const std::vector<float> radii = haze_radii(part);
  for (std::size_t i = 0; i < part.cloud.size(); ++i) {
    if (!(own_value(part, field, i) > threshold)) continue;
    ++of_soft.count;
    if (is_sampled(part, i)) of_soft.sample.push_back(radii[i]);
  }
  if (among_themselves && !part.cloud.empty()) {
    analysis::Discs discs = SolidPart::discs_of(part, field, threshold);
    of_solid.sample = std::move(discs.radii), scatter.sample = std::move(discs.scatter);
  }
  std::vector<VisiblePoints::Values> out{std::move(of_soft), std::move(of_solid), std::move(scatter)};
  for (VisiblePoints::Values& each : out) std::sort(each.sample.begin(), each.sample.end());
  return out;
}

SolidPart::OfWhole solid_of(const std::vector<VisiblePoints::Values>& merged) {
  return {merged.at(0).count - merged.at(1).count, merged.at(1).count > 0,
          analysis::quantile(merged.at(2).sample, 0.5), analysis::need_widening(merged.at(3).sample)};
}

std::vector<VisiblePoints::SeenThrough> soft_in_view(const GpuCloud& part, std::span<const float> field,
                                                     const View& view, const SplatShape& shape) {
  const PreparedCloud& prepared = part.prepared();
  const PointCloud& cloud = prepared.cloud;
  const std::vector<float> radii = haze_radii(prepared);
  const Camera& camera = view.camera();
  // Small ones grow to a pixel, at most to one on the far side.
  const float pixel =
      shape.prefilter_px * float((camera.orthographic() ? 1 : camera.far_plane) / camera.pixels_per_unit());
  std::vector<VisiblePoints::SeenThrough> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float value = own_value(prepared, field, i);
    if (!(value > shape.field_threshold)) continue;
    const vec3 &place = cloud.positions[i], reach(std::max(radii[i] * shape.radius_scale, pixel));
    if (!view.may_see(place - reach, place + reach)) continue;
    const vec3 normal = cloud.normals.empty() ? vec3(0) : cloud.normals[i];
    out.push_back({cloud.source_index[i], place, normal, radii[i], value, part.colors()[i]});
  }
  std::sort(out.begin(), out.end());
  return out;
}

void Haze::take_up(std::span<const VisiblePoints::SeenThrough> points, const GpuCloud& part,
                   const dvec3& origin) {
  gpu.reset();  // before what it refers to
  prepared = std::make_unique<PreparedCloud>();
  field.clear();
  PointCloud& cloud = prepared->cloud;
  cloud.origin = origin;
  std::vector<Rgba8> colors;
  for (const VisiblePoints::SeenThrough& point : points) {
    cloud.positions.push_back(point.place), cloud.normals.push_back(point.normal);
    cloud.radii.push_back(point.radius), cloud.source_index.push_back(point.number);
    field.push_back(point.field), colors.push_back(point.color);
  }
  if (!cloud.empty()) prepared->batches = analysis::cut_batches(cloud.positions);
  prepared->median_spacing = part.median_spacing();
  gpu = std::make_unique<GpuCloud>(*prepared, std::move(colors));
  gpu->set_cut(part.cut());
  gpu->set_field(gpu->make_values("field", field));
}

}  // namespace sfumato::soft
