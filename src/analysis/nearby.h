// The nearest points of every point of a cloud, kept: what uncertainty is smoothed over and radii are
// compared with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

class Nearby {
 public:
  static constexpr std::size_t most = 12;  ///< about two rings around a point of a surface

  Nearby() = default;
  /// Of points in Morton order. Coincident points count.
  Nearby(std::span<const vec3> positions, Progress& progress);
  std::size_t size() const { return each_ == 0 ? 0 : ids_.size() / each_; }
  std::span<const std::uint32_t> of(std::size_t point) const { return {ids_.data() + point * each_, each_}; }

  /// Of every point, the radius that its surroundings would have it have: the median of those around and at
  /// most twice Eq. 20 of its six nearest. The first is that of the surface when up to six points float over
  /// it, the second their own spacing when there are more. The positions are those given first.
  std::vector<float> expected_radii(std::span<const vec3> positions, std::span<const float> radii) const;
  /// Of every point, the mean of its own value and of those around it; `times` over.
  std::vector<float> smoothed(std::vector<float> values, int times) const;

 private:
  std::size_t each_ = 0;
  std::vector<std::uint32_t> ids_;
};

/// A radius beyond twice the expected one belongs to a point that stands alone: no surface needs it. Compared
/// around each point and not over the whole cloud, whose sparse parts would get holes.
inline constexpr float isolated = 2;
/// Cuts such radii.
void limit_isolated(std::span<const vec3> positions, const Nearby& nearby, std::vector<float>& radii);

/// F of Eq. 21 made free of scale, in [0,1]: 0 where the surface is flat, 4/9 where normals are as random as
/// can be. The radius counts against those around the point; smoothed, so that an edge does not become a row
/// of specks. A point that stands alone (`isolated`) has 1.
std::vector<float> scale_free_uncertainty(const PreparedCloud& prepared, const Nearby& nearby);

/// What it takes to be uncertain, whatever the rest of the scan is like: six tenths of the way from flat to
/// random, which smoothed edges of solids do not reach and leaves do.
inline constexpr float random_normals = 4.0f / 9, uncertain_from = 0.6f * random_normals,
                       fully_uncertain = 0.75f * random_normals;

}  // namespace sfumato::analysis
