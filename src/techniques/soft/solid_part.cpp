#include "techniques/soft/solid_part.h"

#include <cmath>
#include <numbers>

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

}  // namespace

void SolidPart::update(GpuCloud& gpu, std::span<const float> field, float threshold, bool among_themselves,
                       bool clamp, const analysis::Nearby* all, Progress& progress) {
  const Key key{gpu.serial(), gpu.field(), threshold, among_themselves, clamp};
  if (key_ == key) return;
  key_.reset();  // nothing is kept when the user stops what follows
  const PreparedCloud& prepared = gpu.prepared();
  spacing_ = prepared.median_spacing;
  shapes_.reset();
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < field.size(); ++i)
    if (!(field[i] > threshold)) places.push_back(i);
  std::vector<float> radii = prepared.cloud.radii;
  if (among_themselves && !places.empty() && places.size() < field.size()) {
    PreparedCloud part = part_of(prepared, places);
    analysis::PrepareOptions options;
    options.neighbors = prepared.neighbors;
    analysis::complete(part, Attribute::normal | Attribute::radius, options, progress);
    if (clamp)
      analysis::limit_isolated(part.cloud.positions, analysis::Nearby(part.cloud.positions, progress),
                               part.cloud.radii);
    std::vector<vec3> normals = prepared.cloud.normals;
    std::vector<float> surface(part.on_surface.empty() ? 0 : normals.size(), 1.0f);
    for (std::size_t k = 0; k < places.size(); ++k) {
      normals[places[k]] = part.cloud.normals[k];
      radii[places[k]] = part.cloud.radii[k];
      if (!surface.empty()) surface[places[k]] = part.on_surface[k];
    }
    // A square grid of that spacing has the radius of Eq. 20 for many neighbours.
    if (prepared.computed.has(Attribute::radius))
      spacing_ = part.median_radius / (2 * std::numbers::inv_sqrtpi_v<float>);
    shapes_ = gpu.make_shapes(normals, radii, surface);
  } else if (clamp) {
    analysis::limit_isolated(prepared.cloud.positions,
                             all ? *all : analysis::Nearby(prepared.cloud.positions, progress), radii);
    shapes_ = gpu.make_shapes({}, radii, prepared.on_surface);
  }
  key_ = key;
}

}  // namespace sfumato::soft
