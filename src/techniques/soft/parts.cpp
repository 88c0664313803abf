#include "techniques/soft/parts.h"

#include <algorithm>

#include "analysis/morton.h"
#include "analysis/prepare.h"
#include "analysis/quantiles.h"
#include "analysis/whole.h"
#include "analysis/wide_normals.h"
#include "core/error.h"
#include "techniques/soft/haze_depth.h"
#include "techniques/soft/soft_points.h"

namespace sfumato::soft {
namespace {

/// Of so many points like this one.
bool is_sampled(const PreparedCloud& part, std::size_t i, std::uint64_t points) {
  return !part.whole || analysis::is_sampled(part.cloud.world(i), points);
}

}  // namespace

VisiblePoints::Values sample_of_field(const PreparedCloud& part, std::span<const float> own_field) {
  VisiblePoints::Values out;
  out.count = part.cloud.size();
  for (std::size_t i = 0; i < out.count; ++i) {
    const float value = own_field[i];
    out.least = std::min(out.least, value), out.most = std::max(out.most, value);
    if (!part.whole || is_sampled(part, i, part.whole->points)) out.sample.push_back(value);
  }
  std::sort(out.sample.begin(), out.sample.end());
  return out;
}

Numbers numbers_of(const VisiblePoints::Values& field, float threshold) {
  const auto above = std::upper_bound(field.sample.begin(), field.sample.end(), threshold);
  const auto about = [&](std::ptrdiff_t of_sample) {
    const double share = double(of_sample) / double(std::max<std::size_t>(1, field.sample.size()));
    return std::max<std::uint64_t>(1, std::uint64_t(share * double(field.count)));
  };
  return {about(field.sample.end() - above), about(above - field.sample.begin())};
}

SoftOfPart soft_of(const PreparedCloud& part, std::span<const float> own_field, float threshold) {
  SoftOfPart out;
  const std::vector<float> radii = haze_radii(part);
  for (std::uint32_t i = 0; i < own_field.size(); ++i)
    if (own_field[i] > threshold) out.places.push_back(i), out.radii.push_back(radii[i]);
  return out;
}

std::vector<VisiblePoints::Values> sizes_of(const PreparedCloud& part, const SoftOfPart& soft,
                                            const Numbers& numbers) {
  VisiblePoints::Values of_soft;
  of_soft.count = soft.places.size();
  for (std::size_t k = 0; k < soft.places.size(); ++k)
    if (is_sampled(part, soft.places[k], numbers.soft)) of_soft.sample.push_back(soft.radii[k]);
  std::sort(of_soft.sample.begin(), of_soft.sample.end());
  return {std::move(of_soft), {}, {}};
}

void add_discs(std::vector<VisiblePoints::Values>& sizes, const PreparedCloud& part, const SoftOfPart& soft,
               const Numbers& numbers, std::span<const float> field, float threshold) {
  std::vector<dvec3> places;
  auto next = soft.places.begin();
  for (std::uint32_t i = 0; i < part.cloud.size(); ++i)
    if (next != soft.places.end() && *next == i)
      ++next;
    else if (is_sampled(part, i, numbers.solid))
      places.push_back(part.cloud.world(i));
  if (places.empty()) return;
  analysis::Discs discs = SolidPart::discs_at(part, field, threshold, std::move(places));
  std::sort(discs.radii.begin(), discs.radii.end()), std::sort(discs.scatter.begin(), discs.scatter.end());
  sizes[1].sample = std::move(discs.radii), sizes[2].sample = std::move(discs.scatter);
}

SolidPart::OfWhole solid_of(const std::vector<VisiblePoints::Values>& merged) {
  return {merged.at(0).count - merged.at(1).count, merged.at(1).count > 0,
          analysis::quantile(merged.at(2).sample, 0.5), analysis::need_widening(merged.at(3).sample)};
}

void require_few(std::uint64_t soft) {
  // Handed out they are 40 bytes each, 1.6 GB in all: what the bytes of an MPI message are counted in is an
  // int.
  constexpr std::uint64_t most = 40'000'000;
  if (soft > most)
    throw Error(ErrorCode::usage, std::to_string(soft) +
                                      " soft points in parts of a cloud are too many for " +
                                      "one process, which draws up to " + std::to_string(most) +
                                      "; a higher field_threshold makes fewer of them soft");
}

std::vector<VisiblePoints::SeenThrough> soft_in_view(const GpuCloud& part, const SoftOfPart& soft,
                                                     std::span<const float> own_field, const View& view,
                                                     const SplatShape& shape,
                                                     std::span<const Camera> measured) {
  const PointCloud& cloud = part.prepared().cloud;
  const float pixel = filter_reach(view, shape);
  std::vector<dmat4> to_eye;
  for (const Camera& camera : measured) to_eye.push_back(camera.view(cloud.origin));
  std::vector<VisiblePoints::SeenThrough> out;
  for (std::size_t k = 0; k < soft.places.size(); ++k) {
    const std::uint32_t i = soft.places[k];
    const vec3& place = cloud.positions[i];
    const float radius = soft.radii[k] * shape.radius_scale;
    const vec3 reach(std::max(radius, pixel));
    bool counts = view.may_see(place - reach, place + reach);
    for (std::size_t at = 0; at < measured.size() && !counts; ++at)
      counts = counts_in_depth(measured[at], to_eye[at], place, radius);
    if (!counts) continue;
    const vec3 normal = cloud.normals.empty() ? vec3(0) : cloud.normals[i];
    out.push_back({cloud.source_index[i], place, normal, soft.radii[k], own_field[i], part.colors()[i]});
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
  for (const VisiblePoints::SeenThrough& point : points) {
    cloud.positions.push_back(point.place), cloud.source_index.push_back(point.number);
    cloud.colors.push_back(point.color);
  }
  // As every cloud: batches that are cut from it are small. Equal depths follow the numbers all the same.
  const std::vector<std::uint32_t> order = analysis::morton_order(cloud);
  analysis::reorder(cloud, order);
  for (const std::uint32_t i : order) {
    cloud.normals.push_back(points[i].normal), cloud.radii.push_back(points[i].radius);
    field.push_back(points[i].field);
  }
  std::vector<Rgba8> colors = std::move(cloud.colors);
  cloud.colors = {};
  if (!cloud.empty()) prepared->batches = analysis::cut_batches(cloud.positions);
  prepared->median_spacing = part.median_spacing();
  gpu = std::make_unique<GpuCloud>(*prepared, std::move(colors));
  gpu->set_cut(part.cut());
  gpu->set_field(gpu->make_values("field", field));
}

}  // namespace sfumato::soft
