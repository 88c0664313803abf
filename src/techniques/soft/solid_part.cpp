#include "techniques/soft/solid_part.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/prepare.h"

namespace sfumato::soft {
namespace {

/// The solid points as a cloud of their own, with what the file brought and without what was computed.
PreparedCloud part_of(const PreparedCloud& prepared, const std::vector<std::uint32_t>& places) {
  const PointCloud& all = prepared.cloud;
  PreparedCloud part;
  PointCloud& cloud = part.cloud;
  part.median_spacing = prepared.median_spacing;
  cloud.up = all.up;
  cloud.origin = all.origin;
  cloud.scanners = all.scanners;
  const bool keep_normals = !all.normals.empty() && !prepared.computed.has(Attribute::normal);
  const bool keep_radii = !all.radii.empty() && !prepared.computed.has(Attribute::radius);
  const ScalarField* scanner = all.scalar("scanner");
  ScalarField scanners{"scanner", scanner ? scanner->offset : 0, {}};
  for (std::uint32_t i : places) {
    cloud.positions.push_back(all.positions[i]);
    if (keep_normals) cloud.normals.push_back(all.normals[i]);
    if (keep_radii) cloud.radii.push_back(all.radii[i]);
    if (scanner) scanners.values.push_back(scanner->values[i]);
  }
  if (scanner) cloud.set_scalar(std::move(scanners));
  return part;
}

std::vector<std::uint32_t> solid_places(std::span<const float> field, float threshold) {
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < field.size(); ++i)
    if (!(field[i] > threshold)) places.push_back(i);
  return places;
}

}  // namespace

analysis::Discs SolidPart::discs_at(const PreparedCloud& part, std::span<const float> field, float threshold,
                                    std::vector<dvec3> places) {
  const PreparedCloud& all = part.with_surroundings();
  if (!all.computed.has(Attribute::normal) && !all.computed.has(Attribute::radius)) return {};
  const std::vector<vec3> solid = part_of(all, solid_places(field, threshold)).cloud.positions;
  const analysis::NeighborTree tree(solid);
  return analysis::discs_at(
      analysis::neighborhoods_of(tree, all.cloud.origin, std::move(places), std::size_t(all.neighbors) + 1));
}

void SolidPart::update(GpuCloud& gpu, std::span<const float> field, float threshold, bool among_themselves,
                       bool clamp, const analysis::Nearby* all, const OfWhole* of_whole, Progress& progress) {
  const Key key{gpu.serial(),     gpu.field(), threshold,
                among_themselves, clamp,       of_whole ? *of_whole : OfWhole()};
  if (key_ == key) return;
  key_.reset();  // nothing is kept when the user stops what follows
  const PreparedCloud &own = gpu.prepared(), &prepared = own.with_surroundings();
  spacing_ = prepared.median_spacing;
  shapes_.reset();
  const std::vector<std::uint32_t> places = solid_places(field, threshold);
  std::vector<float> radii = prepared.cloud.radii;
  const bool has_soft = of_whole ? of_whole->has_soft : places.size() < field.size();
  if (among_themselves && !places.empty() && has_soft) {
    PreparedCloud part = part_of(prepared, places);
    if (of_whole && prepared.whole) {
      auto whole = std::make_shared<WholeCloud>(*prepared.whole);
      whole->points = of_whole->points;
      // Not measured, as of a lone point: that of all points, and no part's own.
      if (of_whole->median_radius > 0)
        whole->median_radius = of_whole->median_radius, whole->is_rough = of_whole->is_rough;
      part.whole = std::move(whole);
    }
    analysis::PrepareOptions options;
    options.neighbors = prepared.neighbors;
    analysis::complete(part, Attribute::normal | Attribute::radius, options, progress);
    if (clamp)
      analysis::limit_isolated(part.cloud.positions, analysis::Nearby(part.cloud.positions, progress),
                               part.cloud.radii);
    std::vector<vec3> normals = prepared.cloud.normals;
    std::vector<float> surface = prepared.on_surface;
    if (!part.on_surface.empty()) surface.resize(normals.size(), 1.0f);
    for (std::size_t k = 0; k < places.size(); ++k) {
      normals[places[k]] = part.cloud.normals[k];
      radii[places[k]] = part.cloud.radii[k];
      if (!part.on_surface.empty()) surface[places[k]] = part.on_surface[k];
    }
    // A square grid of that spacing has the radius of Eq. 20 for many neighbours.
    if (prepared.computed.has(Attribute::radius))
      spacing_ = part.median_radius / (2 * std::numbers::inv_sqrtpi_v<float>);
    shapes_ = gpu.make_shapes(own.own_of(std::move(normals)), own.own_of(std::move(radii)),
                              own.own_of(std::move(surface)));
  } else if (clamp) {
    analysis::limit_isolated(prepared.cloud.positions,
                             all ? *all : analysis::Nearby(prepared.cloud.positions, progress), radii);
    shapes_ = gpu.make_shapes({}, own.own_of(std::move(radii)), own.on_surface);
  }
  key_ = key;
}

}  // namespace sfumato::soft
