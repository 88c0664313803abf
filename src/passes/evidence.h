// Where a picture has points that vouch for what it covers.
#pragma once

#include <algorithm>
#include <cmath>

#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/points_to_pixels.h"
#include "passes/screen_pass.h"

namespace sfumato {

/// How far from its points a picture may cover anything, px.
struct EvidenceReach {
  /// Between points: edges and triangles of their Delaunay triangulation on the screen that a circle of this
  /// radius can enclose. They have the parts and holes of the alpha shape, and straighter outlines (the
  /// Delaunay-Cech complex; Bauer, Edelsbrunner 2017).
  float between = 0;
  /// As far outside of its triangles, and around what is in none of them: lone points and edges. Both are
  /// below `between`, and no pixel is covered that is farther than that from all points.
  float beside = 0, around = 0;
  /// Beyond that anything counts as near, and nothing has to be looked up.
  static constexpr float most = 96;
  bool limits() const { return between > 0 && between <= most; }
  /// How far points are looked for from the centre of the circle through a triangle, px. Obtuse ones of
  /// larger circles are less than .27 of `between` high.
  constexpr int to_circle() const { return int(2 * between) + 2; }
  /// How far beside a picture its points matter. A pixel may lie beside a triangle; the pixels that show that
  /// are up to `to_circle` from it, and have their points as far away again.
  int band() const { return 2 * to_circle() + 1 + int(std::ceil(std::max(beside, around))); }
  /// Whether discs of this radius reach visibly farther.
  bool limits(float radius_px) const { return limits() && radius_px > beside + 1; }
};

class Evidence {
 public:
  /// R8 of the camera's size: above 0 where a pixel may be covered. `origin`: of the cloud.
  const gl::Texture& find(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                          const EvidenceReach& reach, gl::Timers& timers);
  /// The same from points that are drawn already, one pixel each, in a view with a band of `band` px around
  /// the picture, EvidenceReach::band or more.
  const gl::Texture& find(const gl::Texture& depth_bits, int band, int width, int height,
                          const EvidenceReach& reach);
  /// Its two steps, for points that lie in parts: one pixel each, R32UI depths in a view with a band, and
  /// from those of all parts.
  const gl::Texture& draw_points(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                                 const EvidenceReach& reach);
  const gl::Texture& find(const Image<std::uint32_t>& depth_bits, int width, int height,
                          const EvidenceReach& reach);
  /// Takes away what no point vouches for. `albedo`: RGBA32F, `depth`: R32F, `normal`: RGBA32F.
  void apply(gl::Texture& albedo, gl::Texture& depth, gl::Texture& normal);

 private:
  PointsToPixels to_pixels_;
  gl::Texture bits_, along_rows_, nearest_, shape_, mask_;
  ScreenPass rows_, nearest_of_rows_, rows_of_shape_, widened_, apply_;
  gl::Program draw_shape_;
};

}  // namespace sfumato
