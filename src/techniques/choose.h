// Which technique suits a scan: what `-t auto` draws.
#pragma once

#include <string>

#include "analysis/neighbors.h"
#include "core/prepared_cloud.h"

namespace sfumato {

struct TechniqueChoice {
  std::string technique;
  std::string reason;       ///< one line: kind of scan, and the number that says so
  float surface_share = 1;  ///< analysis/survey.h
  bool too_few = false;     ///< points for anything to be said of a surface
};

/// `prepared` needs no attributes yet; `tree` is over its positions, or nothing where it is still to be
/// built. `by_levels`: they stand for more points than are read at once, and every view reads others, whose
/// neighbours nobody should have to wait for.
TechniqueChoice choose_technique(const PreparedCloud& prepared, const analysis::NeighborTree* tree,
                                 bool by_levels = false);

}  // namespace sfumato
