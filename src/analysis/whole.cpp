#include "analysis/whole.h"

#include "analysis/dots.h"
#include "analysis/given_normals.h"
#include "analysis/morton.h"
#include "analysis/prepare.h"
#include "analysis/surface_noise.h"

namespace sfumato::analysis {
namespace {

/// Neighbours are found fast along the curve.
PointCloud along_the_curve(PointCloud cloud) {
  reorder(cloud, morton_order(cloud));
  return cloud;
}

PointCloud places_only(const PointCloud& cloud) {
  PointCloud out;
  out.origin = cloud.origin, out.positions = cloud.positions;
  return out;
}

}  // namespace

Surroundings surroundings_of(const PointCloud& part, const CloudFacts& whole) {
  const PointCloud sorted = along_the_curve(places_only(part));
  const NeighborTree tree(sorted.positions);
  const auto around = [&](std::size_t places, std::size_t count) {
    return neighborhoods_of(tree, part.origin, first_places(whole.places, places), count);
  };
  return {around(CloudFacts::most_places, around_dot_place), around(noise_places, around_noise_place)};
}

void merge(Surroundings& into, const Surroundings& of) {
  merge(into.dots, of.dots, around_dot_place);
  merge(into.noise, of.noise, around_noise_place);
}

std::shared_ptr<const WholeCloud> whole_of(const CloudFacts& facts, const Surroundings& around,
                                           const dvec3& origin) {
  auto whole = std::make_shared<WholeCloud>();
  whole->origin = origin, whole->points = facts.points;
  if (facts.points == 0) return whole;
  whole->sample = along_the_curve(sample_of(facts));
  whole->box = {facts.least, facts.most};
  whole->usual_box = robust_bounds(whole->sample);
  if (const float spacing = spacing_of(around.dots); spacing > 0) whole->median_spacing = spacing;
  if (facts.points >= around_noise_place) whole->noise = noise_of(around.noise);
  const std::vector<vec3>& normals = whole->sample.normals;
  whole->has_normals = facts.with_normal == facts.points &&
                       !are_rough(normals, NeighborTree(whole->sample.positions), PrepareOptions().neighbors);
  whole->dots = dots_at(around.dots, origin, facts.points, whole->median_spacing);
  return whole;
}

}  // namespace sfumato::analysis
