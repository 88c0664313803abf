// Which point each pixel of a picture shows, whatever the technique that drew it.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/neighbors.h"
#include "core/image.h"
#include "session/session.h"

namespace sfumato {

/// Keeps views of the session's points.
class PointIndex {
 public:
  explicit PointIndex(const Session& session);
  /// The point of the depth that each pixel has, else the nearest to the surface that it shows, as its place
  /// in the scene's files (Session::source); -1 where nothing is. `depth`: rows of the picture of `camera`
  /// from `first_row` on.
  Image<std::int64_t> of(const Camera& camera, const Image<float>& depth, int first_row = 0) const;

 private:
  const Session& session_;
  std::vector<analysis::NeighborTree> trees_;  ///< of the parts
};

}  // namespace sfumato
