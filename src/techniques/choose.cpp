#include "techniques/choose.h"

#include <cmath>

#include "analysis/survey.h"

namespace sfumato {
namespace {

/// Fewer points than this have too few neighbours each for normals that mean something, and discs that meet would be
/// 50 pixels wide in a picture that they fill.
constexpr std::size_t few = 2000;
/// From here on a scan is made of lines, between which nothing is known: discs would be beads on them.
constexpr float lined = 0.25f;
/// From here on clutter makes the picture.
constexpr float cluttered = 0.5f;
/// From here on hardly anything else is there: lit discs show leaves, and dots with outlines the crowns that they form. So
/// they do where clutter is sparse: discs of 100,000 points or fewer, which fill the picture, invent walls.
constexpr float only_clutter = 0.35f;
constexpr std::size_t sparse = 100'000;

std::string percent(float share) { return std::to_string(int(std::lround(100 * share))) + " %"; }

}  // namespace

TechniqueChoice choose_technique(const PreparedCloud& prepared, const analysis::NeighborTree& tree) {
  const std::size_t points = prepared.cloud.size();
  if (points < few) return {"points", "only " + std::to_string(points) + " points"};
  const analysis::Survey survey = analysis::survey(tree);
  const auto choice = [&](const char* technique, std::string reason) {
    return TechniqueChoice{technique, std::move(reason), survey.surface_share, survey.line_share};
  };
  if (survey.line_share >= lined)
    return choice("points", "lines of a scanner: " + percent(survey.line_share) + " of the points lie on one");
  if (survey.surface_share < cluttered)
    return choice(survey.surface_share < only_clutter || points < sparse ? "points" : "splats", "vegetation or other clutter: " + percent(1 - survey.surface_share) + " of the points lie on no surface");
  if (!prepared.views.grids.empty())
    return choice("splats", "a camera's depth picture: " + percent(survey.surface_share) + " of the points lie on surfaces");
  return choice("splats", "surfaces: " + percent(survey.surface_share) + " of the points lie on one");
}

}  // namespace sfumato
