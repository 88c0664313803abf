#include "techniques/choose.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/survey.h"
#include "core/counted.h"

namespace sfumato {
namespace {

/// Fewer points than this have too few neighbours each for normals that mean something, and discs that meet
/// would be 50 pixels wide in a picture that they fill.
constexpr std::size_t few = 2000;
/// From here on a scan is made of lines, between which nothing is known: discs would be beads on them.
/// 0.65 to 0.9 of sweeps of 16 to 64 rings and of vertices on the rims of a mesh, 0 to 0.11 of all others.
constexpr float lined = 0.35f;
/// Unless they are profiles of a scanner that moves, as far apart as it goes in a turn: rings fan out with
/// distance, profiles do not. Of twice the speed in one place as in another they still are even. Discs are
/// right where another profile is among the neighbours that their sizes and normals come from.
constexpr float even = 2, meet = 0.5f;
/// From here on clutter makes the picture.
constexpr float cluttered = 0.5f;
/// From here on hardly anything else is there: lit discs show leaves, and dots with outlines the crowns that
/// they form. So they do where clutter is sparse: discs of 100,000 points or fewer, which fill the picture,
/// invent walls.
constexpr float only_clutter = 0.35f;
constexpr std::size_t sparse = 100'000;
/// The spacing that a tenth of the scan exceeds over that which nine tenths do: 1 to 2.3 of objects, rooms
/// and tiles, 3 and more around a scanner in the open. Of a few points those far off would be discs as large
/// as what they show.
constexpr float thinning = 2.7f;
constexpr std::size_t few_of_thinning = 10'000;

float spacing_spread(const PreparedCloud& prepared) {
  std::vector<float> spacings;  // of batches, which hold the same number of points each
  for (const Batch& batch : prepared.batches) spacings.push_back(batch.spacing);
  std::sort(spacings.begin(), spacings.end());
  const std::size_t tenth = spacings.size() / 10;
  return spacings[spacings.size() - 1 - tenth] / spacings[tenth];
}

/// Points in one place count once.
std::size_t places_of(const std::vector<vec3>& in_order) {
  std::size_t places = in_order.empty() ? 0 : 1;
  for (std::size_t i = 1; i < in_order.size(); ++i) places += in_order[i] != in_order[i - 1];
  return places;
}

std::string percent(float share) { return std::to_string(int(std::lround(100 * share))) + " %"; }

}  // namespace

TechniqueChoice choose_technique(const PreparedCloud& prepared, const analysis::NeighborTree* tree,
                                 bool by_levels) {
  const std::size_t points = places_of(prepared.cloud.positions);
  if (points < few) return {"points", "only " + counted(points, "point")};
  const Survey survey = analysis::survey_of(prepared, tree);
  const auto choice = [&](const char* technique, std::string reason) {
    return TechniqueChoice{technique, std::move(reason), survey.surface_share, survey.line_share};
  };
  // Of 28.8 million points that a view of 1920x1080 reads, `splats` measures the neighbours for 36 s on two
  // cores; `surface` needs none.
  const char* const discs = by_levels ? "surface" : "splats";
  const bool profiles = survey.gap_spread < even && survey.closed_lines > meet;
  if (survey.line_share >= lined && !profiles)
    return choice("points",
                  "lines of a scanner or mesh: " + percent(survey.line_share) + " of the points lie on one");
  if (survey.surface_share < cluttered)
    return choice(survey.surface_share < only_clutter || points < sparse ? "points" : discs,
                  "scattered points: " + percent(1 - survey.surface_share) + " of them lie on no surface");
  const float spread = spacing_spread(prepared);
  if (points < few_of_thinning && spread > thinning)
    return choice("points", "only " + std::to_string(points) + " points, " + std::to_string(int(spread)) +
                                " times as far apart in some places as in others");
  if (!prepared.views.grids.empty())
    return choice(discs, "a camera's depth picture: " + percent(survey.surface_share) +
                             " of the points lie on surfaces");
  if (survey.line_share >= lined)
    return choice(discs, "even profiles of a scanner that moved: " + percent(survey.surface_share) +
                             " of the points lie on surfaces");
  return choice(discs, "surfaces: " + percent(survey.surface_share) + " of the points lie on one");
}

}  // namespace sfumato
