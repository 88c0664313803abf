// What a part of a cloud has to know of the whole to be drawn as in a picture of all of it: facts that merge
// (cloud_facts.h), in two rounds, because places are chosen before anybody looks around them.
//
//   CloudFacts facts = facts_of(part);                               merge those of all parts
//   NeighborhoodFacts around = neighborhood_facts_of(part, facts);   merge those of all parts
//   sort_cloud(part, ..., whole_of(facts, around, origin))
#pragma once

#include <memory>

#include "analysis/cloud_facts.h"
#include "analysis/prepare.h"
#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// Of the discs of a cloud, those that are no larger than WholeCloud::large_radius.
inline constexpr double large_share = 0.95;

struct NeighborhoodFacts {
  Neighborhoods dots, noise;  ///< around places of the whole, for what is named so
  Neighborhoods anywhere;     ///< around places in its box (isolation.h)
  bool operator==(const NeighborhoodFacts&) const = default;
};

/// Of a part, in any order, at the places of the whole.
NeighborhoodFacts neighborhood_facts_of(const PointCloud& part, const CloudFacts& whole);
void merge(NeighborhoodFacts& into, const NeighborhoodFacts& of);

/// `origin`: that of all parts.
std::shared_ptr<const WholeCloud> whole_of(const CloudFacts& facts, const NeighborhoodFacts& around,
                                           const dvec3& origin);

/// Of a disc at each place (Seemann 2018, Eq. 20), and how far what is around it scatters.
struct Discs {
  std::vector<float> radii, scatter;
};
Discs discs_at(const Neighborhoods& around);

/// As `prepare`. What is computed from neighbours finds them among `around` too, points of other parts
/// (analysis/regions.h), which are not in the result: `complete` does not find them there later. If `needs`
/// has Attribute::surroundings, they are kept for what techniques measure (PreparedCloud::with_surroundings).
PreparedCloud prepare_part(PointCloud part, const PointCloud& around, Attributes needs,
                           const PrepareOptions& options, Progress& progress,
                           std::shared_ptr<const WholeCloud> whole);

}  // namespace sfumato::analysis
