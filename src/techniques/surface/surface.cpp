// Raw points as a smooth lit surface, with nothing precomputed.
//
// Bouchiba, Deschaud, Goulette 2018, "Raw point cloud deferred shading through screen space pyramidal
// operators", Eurographics short papers. One pixel per point; a pyramid of nearest points tells which of them
// are seen through the surface in front; what is left closes the gaps.
//
// By default it does so as oriented discs, found in a pyramid of centroids (discs.h): the paper's pull-push
// and its normals from push levels know the grid of the screen, and show it
// (docs/adr/0020-surface-fills-with-discs.md). `filling pull_push` is the paper's way; where that differs
// from the paper: the point spacing s_0 is measured and varies over the screen, levels are interpolated, the
// background is infinitely far instead of on the far plane, weights have a gain of 4, normals next to depth
// edges lean on the flatter side.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "analysis/spacing.h"
#include "passes/points_to_pixels.h"
#include "passes/pyramid.h"
#include "passes/shade.h"
#include "techniques/surface/discs.h"
#include "techniques/surface/screen_operators.h"
#include "techniques/screen_spacing.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

using surface::Discs;
using surface::HiddenPoints;
using surface::LevelNormals;
using surface::Removal;

enum class Filling { discs, pull_push };

class SurfaceTechnique final : public Technique {
 public:
  void describe(ParamList& p) override {
    p.add("point_spacing", point_spacing_)
        .at_least(1e-9)
        .unit("scene units")
        .help("distance between neighbouring points; auto: measured, and different from region to region")
        .paper("Bouchiba 2018, s_0");
    p.add("filling", filling_, {"discs", "pull_push"})
        .help(
            "discs: each visible point stands for a disc in the plane of its neighbours; pull_push: pyramids "
            "of "
            "weighted means, as in the paper")
        .paper("Bouchiba 2018, Sec. 3.2");
    p.add("disc_scale", discs_options_.disc_scale)
        .point_size()
        .range(0.1, 10)
        .unit("point spacings")
        .help("radius of a disc");
    p.add("hidden_point_removal", removal_.method, {"pyramid", "window", "none"})
        .help(
            "pyramid: by depth, fast; window: every pixel around (Pintus 2011); none: points behind shine "
            "through");
    p.add("occlusion_threshold", removal_.threshold)
        .range(0, 1)
        .help(
            "mean sector occlusion below which a pixel counts as hidden; above 0.125 one open side is not "
            "enough")
        .paper("Bouchiba 2018, Sec. 3.1.2");
    p.add("removal_scale", removal_scale_)
        .range(0.1, 1000)
        .unit("point spacings")
        .help(
            "search distance for occluders; auto: 10 with pull_push, 4 with discs, which hide what is "
            "behind them")
        .paper("Bouchiba 2018, s_hpr / s_0");
    p.add("gap_scale", removal_.gap_scale)
        .range(0.1, 1000)
        .unit("point spacings")
        .help("how wide gaps between points are closed");
    p.add("disc_radius", removal_.disc_radius)
        .range(0, 4)
        .unit("point spacings")
        .help(
            "with pull_push, piece of the surface that a point stands for: at outlines, where one side is "
            "open, what is behind it "
            "is hidden all the same");
    p.add("depth_edge", depth_edge_)
        .range(0, 1000)
        .unit("depth over width")
        .help(
            "with pull_push, filled colours and depths do not mix across steeper jumps of depth; 0: they do, "
            "as in the paper");
    p.add("coarse_level", removal_.coarse_level)
        .range(0, NearestPyramid::levels - 1)
        .help("pyramid level that serves as coarse depth map")
        .paper("Bouchiba 2018, Sec. 3.1.2");
    p.add("window_radius", removal_.window_radius)
        .range(1, 64)
        .unit("px")
        .help("reach of hidden_point_removal = window");
    p.add("normal_scale", normal_scale_)
        .range(0, 1000)
        .unit("point spacings")
        .help("size of the patch a normal is taken from; larger is smoother (auto: 3, more where noise asks)")
        .paper("Bouchiba 2018, s_n / s_0");
  }

  bool shows(Shading shading) const override { return shading != Shading::weight; }
  bool merges() const override { return true; }

  int reach_px(const GpuCloud& cloud, const Camera& camera) const override {
    // Hidden point removal looks at nine squares of up to 64 px, and at levels beside its own; then
    // planes.glsl, and the discs themselves. Pull-push mixes in what is
    // ever farther away, and ever less of it.
    constexpr int removal = 192;
    if (filling_ == Filling::pull_push) return 512;
    const double occluders = 2 * removal_scale_.user.value_or(disc_removal_scale);  // `ball` there
    const double looked_at = std::max(double(removal_.gap_scale), occluders);
    // Discs, and outline.glsl and through_gaps.glsl, which look at them from around.
    const double discs = 2 + std::max({2 * discs_options_.disc_scale, removal_.gap_scale, 6.0f});
    const float noise = noise_of(cloud), scale = std::max(scale_of_normals(), 1.0f);
    const auto length = [&](const Batch& batch) {
      const bool given = !point_spacing_.is_auto();
      const float least = given ? point_spacing_.value() : std::exp2(batch.least_log2_spacing);
      const float most = given ? point_spacing_.value() : std::exp2(batch.most_log2_spacing);
      const float ball =
          std::max(Discs::widest_ball(scale, least, noise), Discs::widest_ball(scale, most, noise));
      return std::max(double(ball), looked_at * double(most)) + discs * double(most);
    };
    // Points count as 1.3 px apart at least (least_spacing.glsl).
    const int finest = noise > 0 ? int(std::ceil(1.3f * scale * Discs::most_of_noise * Discs::grown)) : 0;
    return removal + finest + nearest_px(cloud, camera, length);
  }

  bool render(Frame& frame) override {
    removal_.removal_scale = removal_scale_.resolve(filling_ == Filling::discs ? disc_removal_scale : 10.0f);
    const dvec3& origin = frame.cloud.prepared().cloud.origin;
    const int guard = guard_band(frame);
    Camera camera = frame.camera.with_guard_band(guard);
    camera.width = NearestPyramid::padded(camera.width);
    camera.height = NearestPyramid::padded(camera.height);
    const View wide(camera, origin);

    // One pixel per point (Sec. 3), each with the spacing around it.
    const float same_spacing = point_spacing_.is_auto() ? 0 : point_spacing_.value();
    gl::Texture& points = pyramid_.points(camera.width, camera.height);
    if (frame.merged) {
      take_up(frame, wide, same_spacing, points);
    } else {
      to_pixels_.draw(frame.cloud, wide, {SizeMode::pixels, 1}, layer_, frame.timers);
      to_pixels_.resolve_eye(frame.cloud, wide, layer_, points, same_spacing, frame.timers);
    }
    if (frame.visible) {
      show_part(frame, points);
      return true;
    }
    wide.bind();
    {
      auto timing = frame.timers.scope("pyramid");  // Sec. 3.1.1
      pyramid_.build();
    }
    {
      auto timing = frame.timers.scope("hidden point removal");  // Sec. 3.1.2
      removal_.disc_level = highest_level(removal_.disc_radius, frame);
      if (filling_ == Filling::discs)
        hidden_points_.run_squares(pyramid_, removal_);
      else
        hidden_points_.run(pyramid_, removal_);
    }
    const Tiles tiles = hidden_points_.tiles();
    if (filling_ == Filling::discs) {
      draw_discs(frame, {tiles.on, 2 * tiles.size, ivec2(guard)});
      return true;
    }
    const auto [first, last] = normal_levels(frame);
    const gl::Texture& colors =
        frame.cloud.has_shadow() ? front_factors(wide, frame.timers) : layer_.shadowed;
    {
      auto timing =
          frame.timers.scope("pull-push");  // Sec. 3.2; the last step, to level 0, is left to compose
      pull_push_.run(hidden_points_.visible(), colors, depth_edge_, std::min(first, 1), &tiles);
    }
    const gl::Texture* normals;
    {
      auto timing = frame.timers.scope("normals");  // Sec. 3.3
      normals = &level_normals_.run(pull_push_.filled(), first, last);
    }
    auto timing = frame.timers.scope("compose");  // Sec. 3.4
    compose(frame, wide, {tiles.on, tiles.size, ivec2(guard)}, colors, *normals, {first, last});
    return true;
  }

 private:
  /// What the points of this part show; spacings are those of the whole.
  void show_part(Frame& frame, const gl::Texture& points) {
    VisiblePoints& visible = *frame.visible;
    visible = {layer_.depth_bits.download<std::uint32_t>(),
               layer_.index.download<std::uint32_t>(),
               layer_.shadowed.download<vec4>(),
               {},
               points.download<vec4>()};
    for (vec4& place : visible.places) place.w = 0;
    const auto [spacing, reach, limits] = evidence_of(frame);
    if (filling_ == Filling::discs && limits)
      visible.vouching =
          evidence_.draw_points(frame.cloud, frame.camera, frame.cloud.prepared().cloud.origin, reach)
              .download<std::uint32_t>();
  }

  /// What `resolve_eye` would leave of the whole.
  void take_up(const Frame& frame, const View& wide, float same_spacing, gl::Texture& points) {
    const VisiblePoints& merged = *frame.merged;
    Image<vec4> places = merged.places;
    std::vector<vec4*> seen;
    for (vec4& place : places)
      if (place != VisiblePoints::nowhere) seen.push_back(&place);
    const WholeCloud* whole = frame.cloud.prepared().whole.get();
    if (same_spacing > 0 || !whole) {
      const float spacing = same_spacing > 0 ? same_spacing : frame.cloud.median_spacing();
      for (vec4* place : seen) place->w = spacing;
    } else {
      const glm::dmat4 cloud_from_eye = glm::inverse(wide.eye_from_cloud());
      std::vector<vec3> positions;
      for (const vec4* place : seen) positions.emplace_back(cloud_from_eye * glm::dvec4(vec3(*place), 1));
      const std::vector<float> spacings = analysis::spacings_at(positions, whole->spacing, frame.progress);
      for (std::size_t i = 0; i < seen.size(); ++i) seen[i]->w = spacings[i];
    }
    points.upload(places);
    gl::ensure(layer_.shadowed, "color and shadow", GL_RGBA16F, places.width(), places.height());
    layer_.shadowed.upload(merged.colors);
  }

  struct OfEvidence {
    ScreenSpacing spacing;
    EvidenceReach reach;
    bool limits = false;
  };
  OfEvidence evidence_of(const Frame& frame) {
    const ScreenSpacing spacing = spacings_.measure(frame.cloud, frame.views);
    const EvidenceReach reach = evidence_reach(spacing, frame.camera.whole_height());
    return {spacing, reach, reach.limits(spacing.largest_px * removal_.gap_scale)};
  }

  float scale_of_normals() const { return normal_scale_.user.value_or(3.0f); }
  /// By which planes choose how far they look; who gives `normal_scale` has chosen.
  float noise_of(const GpuCloud& cloud) const {
    return normal_scale_.is_auto() ? cloud.prepared().surface_noise : 0;
  }

  /// The second half of the default way: planes of the visible points, discs, and their average.
  void draw_discs(Frame& frame, const Tiles& tiles) {
    discs_options_.normal_scale = std::max(normal_scale_.resolve(scale_of_normals()), 1.0f);
    discs_options_.noise = noise_of(frame.cloud);
    discs_options_.gap_scale = removal_.gap_scale;
    const auto [spacing, reach, limits] = evidence_of(frame);
    const int height = frame.camera.whole_height();
    discs_options_.widest_px = std::min(64.0f, 1.3f * widest_disc_px(spacing, height));  // half of gap_scale
    discs_options_.with_shadow = frame.cloud.has_shadow();
    {
      auto timing = frame.timers.scope("planes");
      discs_.find(pyramid_, hidden_points_, layer_.shadowed, discs_options_);
    }
    const View view(frame.camera, frame.cloud.prepared().cloud.origin);
    {
      auto timing = frame.timers.scope("discs");
      discs_.draw(view, discs_options_);
    }
    const gl::Texture& evidence = limits ? find_evidence(frame, reach) : discs_.about(3);  // not read
    auto timing = frame.timers.scope("compose");
    const RenderSettings& settings = frame.settings;
    ScreenPass& pass = compose_discs_[settings.shading];
    if (!pass) {
      gl::Defines defines{"SHADING " + std::to_string(int(settings.shading))};
      pass = ScreenPass("techniques/surface/compose_discs.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F}, defines);
    }
    set_light_uniforms(pass.program(), view, settings, frame.light, frame.cloud.prepared().cloud.origin);
    pass.set("offset", tiles.offset).set("point_threshold", removal_.point_threshold());
    pass.set("crack_scale", 0.96f * removal_.gap_scale / removal_.removal_scale)
        .set("coarse_level", std::max(1, removal_.coarse_level));
    // Level 0 of Eq. 1 is where `removal_scale` spacings are a square of 2 px. Of round gaps in random
    // points, those of 0.95 gap_scale are then closed.
    pass.set("spacing_px", 2 / removal_.removal_scale)
        .set("widest_gap", 0.78f * removal_.gap_scale)
        .set("levels", Discs::levels);
    pass.set("has_shadow", discs_options_.with_shadow).set("has_evidence", limits);
    const gl::Texture& shadow = discs_options_.with_shadow ? discs_.shadow_sum() : discs_.color_sum();
    view.bind();
    pass.run(tiles,
             {&pyramid_.texture(), &hidden_points_.mean(), &hidden_points_.levels(), &layer_.shadowed,
              &discs_.color_sum(), &discs_.normal_sum(), &shadow, &discs_.all_clusters(), &discs_.colors(),
              &discs_.about(3), &evidence},
             {&frame.target.color, &frame.target.depth, &frame.target.normal},
             {vec4(0), vec4(INFINITY), vec4(0, 0, 0, 1)});
  }

  const gl::Texture& find_evidence(Frame& frame, const EvidenceReach& reach) {
    if (frame.merged)
      return evidence_.find(frame.merged->vouching, frame.camera.width, frame.camera.height, reach);
    return evidence_.find(frame.cloud, frame.camera, frame.cloud.prepared().cloud.origin, reach,
                          frame.timers);
  }

  /// Colours, and shadow factors in which points behind gaps do not count.
  const gl::Texture& front_factors(const View& view, gl::Timers& timers) {
    auto timing = timers.scope("shadow factors");
    if (!front_factors_) front_factors_ = ScreenPass("techniques/surface/front_factors.glsl", {GL_RGBA16F});
    gl::ensure(lit_colors_, "colours and shadow factors", GL_RGBA16F, view.width(), view.height());
    view.bind();
    front_factors_.set("gap_scale", removal_.gap_scale);
    front_factors_.run(hidden_points_.tiles(),
                       {&hidden_points_.visible(), &layer_.shadowed, &pyramid_.texture()}, {&lit_colors_},
                       {vec4(0, 0, 0, 1)});
    return lit_colors_;
  }

  /// Background, finest push level and lighting, in one pass over the picture.
  void compose(Frame& frame, const View& wide, const Tiles& tiles, const gl::Texture& colors,
               const gl::Texture& normals, const vec2& normal_levels) {
    const RenderSettings& settings = frame.settings;
    ScreenPass& pass = compose_[settings.shading];
    if (!pass) {
      gl::Defines defines{"SHADING " + std::to_string(int(settings.shading))};
      pass = ScreenPass("techniques/surface/compose.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F}, defines);
    }
    set_light_uniforms(pass.program(), wide, settings, frame.light, frame.cloud.prepared().cloud.origin);
    pass.set("offset", tiles.offset).set("hole_threshold", removal_.threshold).set("depth_edge", depth_edge_);
    pass.set("point_threshold", removal_.point_threshold()).set("normal_scale", scale_of_normals());
    pass.set("normal_levels", normal_levels);
    const PullPush::Level& filled = pull_push_.filled()[1];
    pass.run(tiles,
             {&hidden_points_.visible(), &colors, &filled.a, &filled.b, &pyramid_.texture(),
              &hidden_points_.mean(), &normals},
             {&frame.target.color, &frame.target.depth, &frame.target.normal},
             {vec4(0), vec4(INFINITY), vec4(0, 0, 0, 1)});
  }

  /// Level of a length at an eye depth (Eq. 1).
  static double level_of(double length, double depth, const Camera& camera) {
    return std::log2(length * camera.pixels_per_unit() / (camera.orthographic() ? 1 : depth));
  }
  std::pair<float, float> spacing_range(const Frame& frame) {
    point_spacing_.resolve(frame.cloud.median_spacing());
    float lo = point_spacing_.value(), hi = lo;
    const PreparedCloud& prepared = frame.cloud.prepared();
    if (point_spacing_.is_auto())
      for (const Batch& batch : prepared.whole ? prepared.whole->spacing.stretches : prepared.batches)
        lo = std::min(lo, std::exp2(batch.least_log2_spacing)),
        hi = std::max(hi, std::exp2(batch.most_log2_spacing));
    return {lo, hi};
  }
  /// The level of a number of point spacings where they are largest and nearest, rounded up.
  int highest_level(double spacings, const Frame& frame) {
    const double level =
        level_of(spacings * spacing_range(frame).second, frame.camera.near_plane, frame.camera);
    return int(std::ceil(std::clamp(level, 0.0, double(NearestPyramid::levels - 1))));
  }
  /// As far as the operator may look from the border of the picture, at most as far as it looks at all.
  int guard_band(const Frame& frame) { return 1 << highest_level(removal_.removal_scale, frame); }
  /// The push levels that some pixel may ask normals from.
  std::pair<int, int> normal_levels(const Frame& frame) {
    const double least =
        level_of(scale_of_normals() * spacing_range(frame).first, frame.camera.far_plane, frame.camera);
    return {int(std::clamp(least, 0.0, double(NearestPyramid::levels - 1))),
            highest_level(scale_of_normals(), frame)};
  }

  Auto<float> point_spacing_;
  HiddenPoints::Options removal_;
  static constexpr float disc_removal_scale = 4;  ///< of filling = discs
  Auto<float> removal_scale_;
  Auto<float> normal_scale_;
  float depth_edge_ = 6;

  Filling filling_ = Filling::discs;
  Discs::Options discs_options_;
  Discs discs_;
  ScreenSpacings spacings_;
  Evidence evidence_;
  std::map<Shading, ScreenPass> compose_discs_;
  PointsToPixels to_pixels_;
  PixelLayer layer_;
  NearestPyramid pyramid_;
  HiddenPoints hidden_points_;
  PullPush pull_push_;
  LevelNormals level_normals_;
  gl::Texture lit_colors_;
  ScreenPass front_factors_;
  std::map<Shading, ScreenPass> compose_;
};

}  // namespace

TechniqueInfo surface_technique() {
  return {"surface", "raw points as a smooth lit surface, nothing precomputed",
          [] { return std::unique_ptr<Technique>(new SurfaceTechnique); }};
}

}  // namespace sfumato
