#include "analysis/coincident.h"

#include <vector>

namespace sfumato::analysis {

void thin_places(PreparedCloud& prepared) {
  // Equal positions are neighbours on the Morton curve, in file order.
  const std::vector<vec3>& positions = prepared.cloud.positions;
  std::size_t run = 0, surplus = 0;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    run = positions[i] == positions[i - 1] ? run + 1 : 0;
    surplus += run >= most_in_one_place;
  }
  if (surplus == 0) return;
  std::vector<std::uint32_t> kept;
  kept.reserve(positions.size() - surplus);
  run = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    run = i > 0 && positions[i] == positions[i - 1] ? run + 1 : 0;
    if (run < most_in_one_place) kept.push_back(std::uint32_t(i));
  }
  keep_only(prepared.views.grid, kept);
  keep_only(prepared.views.cell, kept);
  prepared.cloud = select(prepared.cloud, kept);
}

}  // namespace sfumato::analysis
