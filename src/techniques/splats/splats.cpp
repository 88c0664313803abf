// Surface splatting: every point is a disc in its tangent plane, and the discs of a surface are averaged.
//
// M. Botsch, A. Hornung, M. Zwicker, L. Kobbelt, "High-Quality Surface Splatting on Today's GPUs", Symposium
// on Point-Based Graphics 2005: nearest hit first, then weighted sums of everything within epsilon of it,
// then division and lighting once a pixel. The classic that all five papers compare with.
//
// Where we differ: the depth that is compared is the distance along the ray and not eye depth, so that
// epsilon means the same in the corners of a wide view; normals are averaged facing the camera, because scans
// know no inside.

#include <algorithm>
#include <numbers>

#include "passes/shade.h"
#include "passes/splat_surface.h"
#include "techniques/screen_spacing.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

struct Parameters {
  Auto<float> epsilon;
  SplatKernel kernel = SplatKernel::wendland;
  enum class Blend { weighted, opaque } blend = Blend::weighted;
  bool antialias = true;
  float radius_scale = DiscEvidence::usual_scale;
  bool clamp_radius = true;

  void describe(ParamList& p) {
    p.add("epsilon", epsilon)
        .at_least(0)
        .unit("scene units")
        .help(
            "how far behind the nearest hit a splat still counts as the same surface (auto: 2 median "
            "spacings, where points are sparser 2 of theirs)")
        .paper("Botsch 2005, epsilon");
    p.add("kernel", kernel, {"wendland", "gaussian"})
        .help("weight of a hit by its distance from the splat's centre");
    p.add("blend", blend, {"weighted", "opaque"})
        .help("average of the surface's splats, or the nearest disc only");
    p.add("antialias", antialias).help("a splat covers at least a disc of 1 px radius on the screen");
    p.add("radius_scale", radius_scale).point_size().range(0.1, 10).unit("factor").help("size of all splats");
    p.add("clamp_radius", clamp_radius)
        .help("limit radii to four times their median, so that isolated points do not become big discs");
  }
};

/// In radii of Eq. 20 (Seemann 2018) on a square grid.
constexpr float two_spacings = 1 / std::numbers::inv_sqrtpi_v<float>;

class Splats final : public Technique {
 public:
  void describe(ParamList& p) override { parameters_.describe(p); }

  Attributes needs() const override { return Attribute::normal | Attribute::radius; }
  bool merges() const override { return true; }
  int rounds() const override { return 2; }

  int reach_px(const GpuCloud&, const Camera&) const override { return 2; }  // deeper_side.glsl

  bool render(Frame& frame) override {
    const View view(frame.camera, frame.cloud.prepared().cloud.origin);
    SplatShape shape;
    shape.radius_scale = parameters_.radius_scale;
    if (parameters_.clamp_radius) shape.radius_limit = frame.cloud.radius_limit();
    if (parameters_.clamp_radius)
      shape.widest_px =
          spacings_.widest_disc_px(frame) * std::max(1.0f, shape.radius_scale / DiscEvidence::usual_scale);
    shape.dots = parameters_.clamp_radius;
    if (parameters_.antialias) shape.prefilter_px = 1;
    SplatBlend blend;
    blend.epsilon = parameters_.epsilon.resolve(2 * frame.cloud.median_spacing());
    if (parameters_.epsilon.is_auto()) blend.epsilon_radii = two_spacings;
    blend.kernel = parameters_.kernel;
    blend.opaque = parameters_.blend == Parameters::Blend::opaque;

    if (frame.visible) {
      show_part(frame, view, shape, blend);
      return true;
    }
    const SplatSurfaceTargets targets{albedo_, frame.target.depth, frame.target.normal};
    if (frame.merged)
      surface_.normalize(view, frame.merged->color_sum, frame.merged->normal_sum, targets, frame.timers);
    else
      surface_.draw(frame.cloud, view, shape, blend, targets, frame.timers);
    if (parameters_.clamp_radius) evidence_.apply(frame, spacings_, shape.radius_scale, albedo_);

    auto timing = frame.timers.scope("shade");
    shade_.run(view, frame.settings, frame.light, frame.cloud.prepared().cloud.origin,
               {albedo_, frame.target.depth, frame.target.normal}, frame.target.color);
    return true;
  }

 private:
  /// The nearest hits of this part, and then its share of the surface that those of all parts begin.
  void show_part(Frame& frame, const View& view, const SplatShape& shape, const SplatBlend& blend) {
    VisiblePoints& visible = *frame.visible;
    if (frame.merged) {
      surface_.accumulate(frame.cloud, view, shape, blend, frame.merged->nearest, frame.timers);
      visible.color_sum = surface_.color_sum().download<vec4>();
      visible.normal_sum = surface_.normal_sum().download<vec4>();
      return;
    }
    surface_.find_nearest(frame.cloud, view, shape, blend, frame.timers);
    visible.nearest = surface_.nearest_t().download<float>();
    if (parameters_.clamp_radius)
      visible.vouching = evidence_.points(frame, frame.camera, spacings_, shape.radius_scale);
  }

  Parameters parameters_;
  SplatSurface surface_;
  ScreenSpacings spacings_;
  DiscEvidence evidence_;
  gl::Texture albedo_;
  Shade shade_;
};

}  // namespace

TechniqueInfo splats_technique() {
  return {"splats", "surface splatting: discs averaged to a smooth lit surface",
          [] { return std::unique_ptr<Technique>(new Splats); }};
}

}  // namespace sfumato
