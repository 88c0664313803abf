// How dense the points in view are on the screen.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/camera.h"
#include "core/derived.h"
#include "passes/evidence.h"
#include "passes/frame.h"
#include "passes/gpu_cloud.h"

namespace sfumato {

/// Over the batches in view, so that a few outliers do not decide.
struct ScreenSpacing {
  float median_px = 1, largest_px = 0;  ///< point spacing in pixels
  float pixel = 0;                      ///< median size of a pixel where they are, scene units
};

/// Radius of the widest disc in a picture of this height: whether anything is farther from a measured point
/// nobody knows. 8 px of 720; where most points in view are farther apart, as wide as the gaps between them.
float widest_disc_px(const ScreenSpacing& spacing, int height);
/// What such a picture may cover: between points what is no hole of a surface of the spacing in view, at
/// least 11 px of 720, half a spacing beside that, 1 to 8 px, and around lone points 4 to 8 px.
EvidenceReach evidence_reach(const ScreenSpacing& spacing, int height);

class ScreenSpacings {
 public:
  /// `views`: whole pictures (Frame::views).
  ScreenSpacing measure(const GpuCloud& cloud, std::span<const Camera> views);
  /// `widest_disc_px` of a frame.
  float widest_disc_px(const Frame& frame);

 private:
  Derived<std::uint64_t, Bounds> most_;  ///< of most points: a batch is as wide as its farthest stray
};

/// Takes away what discs cover that no point vouches for.
class DiscEvidence {
 public:
  /// Discs of Eq. 20 (1.13 spacings) leave exp(-pi 1.13^2) = 2 % of a randomly sampled surface open; times
  /// 1.5, 1e-4.
  static constexpr float usual_scale = 1.5f;
  /// Where points vouch for anything, those of all parts where these are merged, R8 of the camera's size
  /// (Evidence::find); null: all over the picture.
  const gl::Texture* find(Frame& frame, const Camera& camera, ScreenSpacings& spacings, float radius_scale);
  /// Once discs of `radius_scale` are drawn into `albedo`, depth and normal of the target. What is larger
  /// than usual may cover as much more.
  void apply(Frame& frame, ScreenSpacings& spacings, float radius_scale, gl::Texture& albedo);
  /// Of a part of a cloud: which pixels its points vouch for, in a view with a band around it, as
  /// VisiblePoints::vouching. Nothing is there where nothing is to be taken away.
  Image<std::uint32_t> points(Frame& frame, const Camera& camera, ScreenSpacings& spacings,
                              float radius_scale);

 private:
  std::optional<EvidenceReach> reach_of(const Frame& frame, ScreenSpacings& spacings, float radius_scale);
  Evidence evidence_;
};

}  // namespace sfumato
