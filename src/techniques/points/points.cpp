// Raw points: the baseline every paper compares with, and the fastest honest look at a scan.
//
// One compute visit finds the nearest point of every pixel (Schuetz, Kerbl, Wimmer 2021, "Rendering Point
// Clouds with Compute Shaders"; without 64-bit atomics a depth visit and an index visit), a resolve fetches
// colours for the survivors only. Points are round and as large as the local spacing asks for, so that a
// surface near the camera does not fall apart; eye-dome lighting gives shape to clouds without normals.

#include <algorithm>
#include <cmath>

#include "analysis/dots.h"
#include "passes/points_to_pixels.h"
#include "passes/shade.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

/// Spacings: a random sample of a surface is closed but for exp(-1.56 pi) = 0.7 %. Readers preferred it to 2,
/// and 3 not to it; docs/measurements/dots.md.
constexpr float usual_size = 2.5f;
/// Of that: lines whose steps vary by a fifth are closed, and crowns are no skeleton.
constexpr float dot_share = 0.6f;
/// At 720 lines: from what viewers of points draw them as, to what still tells leaves apart.
constexpr float least_dot_px = 1.9f, most_dot_px = 5;
/// Points farther apart than this, and than usual, recede.
constexpr float sparse_px = 3;

class Points final : public Technique {
 public:
  void describe(ParamList& p) override {
    p.add("size_mode", footprint_.mode, {"adaptive", "pixels", "world"})
        .help("adaptive: local point spacing times point_size; pixels; world: scene units");
    p.add("point_size", footprint_.size)
        .point_size()
        .range(0.01, 1e6)
        .unit("factor, px or scene units")
        .help(
            "diameter of a point, by size_mode; drawn at 1 to 64 px, scaled up in pictures higher than 720 "
            "px");
  }

  bool merges() const override { return true; }
  bool closes_depth() const override { return false; }
  float edl_strength(bool) const override { return slight_edl; }

  int reach_px(const GpuCloud&, const Camera& camera) const override {
    // Half the largest point: batches whose centres are beyond the border are not visited.
    return 1 + int(std::ceil(0.5f * largest_footprint(camera.whole_height())));
  }

  bool render(Frame& frame) override {
    const View view(frame.camera, frame.cloud.prepared().cloud.origin);
    // 8 px of 720, so that a picture looks the same in every size.
    footprint_.wide_px = std::max(4.0f, float(frame.camera.whole_height()) / 90);
    footprint_.most_px = largest_footprint(frame.camera.whole_height());
    if (footprint_.mode == SizeMode::adaptive) {
      frame.cloud.set_field(frame.cloud.dots([&] { return analysis::dots_of(frame.cloud.prepared()); }));
      const float height = std::max(0.5f, float(frame.camera.whole_height()) / 720);
      const float scale = footprint_.size / usual_size * height;
      footprint_.sparse_px = sparse_px * height;
      footprint_.dot_share = dot_share;
      footprint_.least_dot_px = scale * least_dot_px, footprint_.most_dot_px = scale * most_dot_px;
    }
    if (!frame.merged) to_pixels_.draw(frame.cloud, view, footprint_, layer_, frame.timers);
    if (frame.visible) {
      to_pixels_.resolve(frame.cloud, view, layer_, frame.timers, frame.cloud.has_normals());
      *frame.visible = {layer_.depth_bits.download<std::uint32_t>(),
                        layer_.index.download<std::uint32_t>(),
                        layer_.albedo.download<vec4>(),
                        {}};
      if (frame.cloud.has_normals()) frame.visible->normals = layer_.normal.download<vec4>();
      return true;
    }

    // Resolve straight into the target; only what has to be shaded takes the way through another texture.
    // Points without normals and shadows are lit evenly: their colour is their albedo.
    const Shading shading = frame.settings.shading;
    const bool has_normals = frame.merged ? !frame.merged->normals.empty() : frame.cloud.has_normals();
    const bool has_light = (has_normals && (frame.settings.phong.diffuse.value() > 0 ||
                                            frame.settings.phong.specular.value() > 0)) ||
                           frame.cloud.has_shadow();
    const bool shade =
        shading == Shading::lit ? has_light || !evenly_lit(frame.settings.phong) : shading != Shading::albedo;
    std::swap(layer_.depth, frame.target.depth);
    std::swap(layer_.normal, frame.target.normal);
    if (!shade) std::swap(layer_.albedo, frame.target.color);
    if (frame.merged)
      take_up(*frame.merged);
    else
      to_pixels_.resolve(frame.cloud, view, layer_, frame.timers, shade || frame.wants_normal);
    std::swap(layer_.depth, frame.target.depth);
    std::swap(layer_.normal, frame.target.normal);
    if (!shade) {
      std::swap(layer_.albedo, frame.target.color);
      return true;
    }
    auto timing = frame.timers.scope("shade");
    shade_.run(view, frame.settings, frame.light, frame.cloud.prepared().cloud.origin,
               {layer_.albedo, frame.target.depth, frame.target.normal}, frame.target.color);
    return true;
  }

 private:
  /// What `resolve` would leave.
  void take_up(const VisiblePoints& merged) {
    const int width = merged.colors.width(), height = merged.colors.height();
    gl::ensure(layer_.albedo, "albedo", GL_RGBA32F, width, height);
    layer_.albedo.upload(merged.colors);
    layer_.depth.upload(merged.depth());
    if (merged.normals.empty())
      layer_.normal.clear(vec4(0, 0, 0, 1));
    else
      layer_.normal.upload(merged.normals);
  }
  static bool evenly_lit(const Phong& phong) { return phong.ambient.value() + phong.diffuse.value() == 1; }

  Footprint footprint_{SizeMode::adaptive, usual_size, 2};
  PointsToPixels to_pixels_;
  PixelLayer layer_;
  Shade shade_;
};

}  // namespace

TechniqueInfo points_technique() {
  return {"points", "raw points, adaptive size, eye-dome lighting",
          [] { return std::unique_ptr<Technique>(new Points); }};
}

}  // namespace sfumato
