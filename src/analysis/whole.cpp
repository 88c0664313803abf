#include "analysis/whole.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "analysis/attributes.h"
#include "analysis/coincident.h"
#include "analysis/dots.h"
#include "analysis/given_normals.h"
#include "analysis/isolation.h"
#include "analysis/local_noise.h"
#include "analysis/morton.h"
#include "analysis/normals.h"
#include "analysis/quantiles.h"
#include "analysis/spacing.h"
#include "analysis/support.h"
#include "analysis/survey.h"
#include "analysis/surface_noise.h"
#include "analysis/wide_normals.h"

namespace sfumato::analysis {
namespace {

/// Neighbours are found fast along the curve.
PointCloud along_the_curve(PointCloud cloud) {
  reorder(cloud, morton_order(cloud));
  return cloud;
}

Neighborhoods nearest_of(const Neighborhoods& around, std::size_t count) {
  Neighborhoods out{around.places, {}};
  for (const std::vector<dvec3>& nearest : around.nearest)
    out.nearest.emplace_back(nearest.begin(),
                             nearest.begin() + std::ptrdiff_t(std::min(nearest.size(), count)));
  return out;
}

PointCloud places_only(const PointCloud& cloud) {
  PointCloud out;
  out.origin = cloud.origin, out.positions = cloud.positions;
  return out;
}

}  // namespace

Discs discs_at(const Neighborhoods& around) {
  Discs discs;
  for (std::size_t k = 0; k < around.places.size(); ++k) {
    const std::vector<dvec3>& nearest = around.nearest[k];
    if (nearest.size() < 2) continue;
    std::vector<vec3> near;
    for (const dvec3& at : nearest) near.emplace_back(at - around.places[k]);
    discs.radii.push_back(radius_of(glm::length(near.back()), near.size() - 1));
    std::vector<std::uint32_t> others(near.size() - 1);
    std::iota(others.begin(), others.end(), 1u);
    if (const auto frame = local_frame(near, 0, others)) discs.scatter.push_back(scatter_of(*frame));
  }
  return discs;
}

NeighborhoodFacts neighborhood_facts_of(const PointCloud& part, const CloudFacts& whole) {
  const PointCloud sorted = along_the_curve(places_only(part));
  const NeighborTree tree(sorted.positions);
  const auto around = [&](std::size_t places, std::size_t count) {
    return neighborhoods_of(tree, part.origin, first_places(whole.places, places), count);
  };
  return {around(CloudFacts::most_places, around_dot_place), around(noise_places, around_noise_place),
          neighborhoods_of(tree, part.origin, places_anywhere(whole), around_any_place)};
}

void merge(NeighborhoodFacts& into, const NeighborhoodFacts& of) {
  merge(into.dots, of.dots, around_dot_place);
  merge(into.noise, of.noise, around_noise_place);
  merge(into.anywhere, of.anywhere, around_any_place);
}

std::shared_ptr<const WholeCloud> whole_of(const CloudFacts& facts, const NeighborhoodFacts& around,
                                           const dvec3& origin) {
  auto whole = std::make_shared<WholeCloud>();
  whole->origin = origin, whole->points = facts.points;
  if (facts.points == 0) return whole;
  whole->sample = along_the_curve(sample_of(facts));
  whole->box = {facts.least, facts.most};
  whole->usual_box = robust_bounds(whole->sample);
  if (const float spacing = spacing_of(around.dots); spacing > 0) whole->median_spacing = spacing;
  if (facts.points >= around_noise_place) whole->noise = noise_of(around.noise);
  whole->residual = residual_of(nearest_of(around.noise, around_residual));
  const Discs discs = discs_at(around.dots);
  whole->median_radius = quantile(discs.radii, 0.5), whole->is_rough = need_widening(discs.scatter);
  whole->large_radius = quantile(discs.radii, large_share);
  whole->usual_reach = usual_reach_of(around.dots), whole->empty_reach = empty_reach_of(around.anywhere);
  const std::vector<vec3>& normals = whole->sample.normals;
  whole->has_normals = facts.with_normal == facts.points &&
                       !are_rough(normals, NeighborTree(whole->sample.positions), PrepareOptions().neighbors);
  whole->spacing = spacing_along_curve(around.dots, *whole, batch_count(facts.points));
  whole->placed_noise = noise_at_places(around.dots, origin);
  whole->dots = dots_at(around.dots, origin, facts.points, whole->median_spacing);
  return whole;
}

PreparedCloud prepare_part(PointCloud part, const PointCloud& around, Attributes needs,
                           const PrepareOptions& options, Progress& progress,
                           std::shared_ptr<const WholeCloud> whole) {
  const std::size_t count = part.size();
  const std::vector<std::uint32_t> numbers = std::move(part.source_index);
  part.source_index.clear();
  if (around.size() > 0) append(part, around);
  part.source_index.clear();
  SortedCloud sorted = sort_cloud(std::move(part), options, progress, std::move(whole));
  PreparedCloud& prepared = sorted.cloud;
  complete(prepared, needs, options, sorted.tree.get(), progress);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < prepared.cloud.size(); ++i)
    if (prepared.cloud.source_index[i] < count) kept.push_back(i);
  if (needs.has(Attribute::surroundings)) {
    if (kept.size() < prepared.cloud.size()) {
      auto all = std::make_shared<PreparedCloud>(prepared);
      all->cloud.colors = {};
      prepared.surroundings = std::move(all), prepared.in_surroundings = kept;
    }
    prepared.available = prepared.available | Attribute::surroundings;
  }
  keep_only(prepared.shrunk, kept), keep_only(prepared.on_surface, kept);
  keep_only(prepared.support, kept);
  prepared.cloud = select(prepared.cloud, kept);
  if (!numbers.empty())
    for (std::uint32_t& number : prepared.cloud.source_index) number = numbers[number];
  prepared.batches = cut_batches(prepared.cloud.positions);
  measure_spacing(prepared.batches, NeighborTree(prepared.cloud.positions), progress);
  return std::move(prepared);
}

}  // namespace sfumato::analysis
