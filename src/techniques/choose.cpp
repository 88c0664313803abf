#include "techniques/choose.h"

#include <cmath>
#include <vector>

#include "analysis/survey.h"
#include "core/counted.h"

namespace sfumato {
namespace {

/// Fewer points than this have too few neighbours each for normals that mean something, and discs that meet
/// would be 50 pixels wide in a picture that they fill.
constexpr std::size_t few = 2000;
/// Points in one place count once.
std::size_t places_of(const std::vector<vec3>& in_order) {
  std::size_t places = in_order.empty() ? 0 : 1;
  for (std::size_t i = 1; i < in_order.size(); ++i) places += in_order[i] != in_order[i - 1];
  return places;
}

}  // namespace

TechniqueChoice choose_technique(const PreparedCloud& prepared, const analysis::NeighborTree* tree,
                                 bool by_levels) {
  const std::size_t places = places_of(prepared.cloud.positions);
  if (places < few) {
    const bool all_apart = places == prepared.cloud.size();
    return {"points", "only " + counted(places, all_apart ? "point" : "place"), 1, true};
  }
  const float surface = analysis::surface_share_of(prepared, tree);
  const std::string percent = std::to_string(int(std::lround(100 * surface))) + " %";
  if (surface < analysis::enough_surface)
    return {"points", "scattered points or lines: neighbours vouch for " + percent + " of a surface",
            surface};
  // Of 28.8 million points that a view of 1920x1080 reads, `splats` measures the neighbours for 36 s on two
  // cores; `surface` needs none.
  return {by_levels ? "surface" : "splats", "surfaces: neighbours vouch for " + percent, surface};
}

}  // namespace sfumato
