// Thin sheets that were measured on both sides: which of a point's neighbours lie on its own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "analysis/neighbors.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Two parallel layers of points.
struct Sheet {
  vec3 place{0};             ///< half way between both
  vec3 normal{0};            ///< across, unit; to either side
  float gap = 0;             ///< between the layers
  float reach = 0;           ///< of the points that told it; 0: there are no two
  bool is_doubtful = false;  ///< two known sides, but nothing tells which of them lies outside
};

/// A point's side of the sheet that lies along `axis`, as far as the file or a scanner tells: 1 or -1, 0
/// where nobody knows.
using KnownSide = std::function<int(std::uint32_t point, const vec3& axis)>;

/// The sheet that the points around one of them, itself included, make, if they do: two groups whose distance
/// across is large against what each of them is thick (as two peaks of a histogram are told apart, N. Otsu,
/// "A threshold selection method from gray-level histograms", 1979), which lie above one another, are flat
/// and about as dense. `known` may contradict; where both are known to lie apart, but too near for their
/// thickness, it decides.
Sheet sheet_of(std::span<const vec3> positions, std::uint32_t center, std::span<const std::uint32_t> points,
               const KnownSide& known);

/// The sheets of a cloud, looked for at every 64th point of the curve.
class Sides {
 public:
  Sides(const NeighborTree& tree, const KnownSide& known, Progress& progress);

  bool empty() const { return sheets_.empty(); }

  /// Whether there is one near a point, which then is to bring so many times as many neighbours as it needs.
  bool is_near(std::uint32_t point) const;
  static constexpr int wider = 3;

  struct Own {
    vec3 outward{0};                 ///< on a sheet: across it, away from its other side
    std::vector<std::uint32_t> ids;  ///< the nearest, of a point on a sheet on its side; the farthest is last
    std::vector<float> distances2;
    std::vector<std::uint64_t> keys;  ///< room to work in
  };
  /// Whether a point lies on a sheet, and the `count` neighbours that it then has, or has otherwise: so few
  /// of its side may be among those given that it has the nearest of both.
  bool find(std::uint32_t point, std::span<const std::uint32_t> ids, std::span<const float> distances2,
            std::size_t count, Own& own) const;

 private:
  const Sheet* sheet_near(std::uint32_t point) const;
  std::span<const vec3> positions_;
  KnownSide known_;
  std::vector<Sheet> sheets_;  ///< of every 64 points; empty: there is none anywhere
};

}  // namespace sfumato::analysis
