// Soft transparency: points that are uncertain, or chosen otherwise, become a haze one can look through.
//
// P. Seemann, G. Palma, M. Dellepiane, P. Cignoni, M. Goesele, "Soft Transparency for Point Cloud Rendering",
// Eurographics Symposium on Rendering - Experimental Ideas and Implementations 2018. Solid points are
// splatted; every soft point is a sphere whose density falls off towards its rim, so that overlapping spheres
// make a continuous haze in the right order.
//
// Where we differ: depth within a sphere is measured along the ray; one unit-free opacity means the same in
// all models; nested spheres have the mass of the Base model, however few, unless the printed normalisations
// are asked for; the drawing order is exact by default; spheres that are cut by a surface or the near plane
// are clamped.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/derived.h"
#include "passes/merge.h"
#include "passes/shade.h"
#include "passes/splat_surface.h"
#include "techniques/casters.h"
#include "techniques/soft/express.h"
#include "techniques/soft/field.h"
#include "techniques/soft/haze_depth.h"
#include "techniques/soft/interior.h"
#include "techniques/soft/one_layer.h"
#include "techniques/soft/parts.h"
#include "techniques/soft/solid_part.h"
#include "techniques/screen_spacing.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

using namespace soft;

enum class Model { express, concentric, base, one_layer };

/// Of the light behind the haze, what its deepest places let through while `opacity` is automatic. Pixels
/// vary about their surroundings: nine in ten let a quarter through.
constexpr float least_transmittance = 1.0f / 3;
/// modulation_opacity over opacity while it is automatic.
constexpr float modulation_factor = 3;

struct Parameters {
  Model model = Model::express;
  Auto<float> opacity;
  FieldSettings field;
  Auto<float> field_threshold, modulation_threshold, modulation_opacity;
  DrawOrder order = DrawOrder::exact;
  Auto<int> concentric_count;
  float concentric_spacing_px = 4;
  Normalization normalization = Normalization::exact;
  Density density = Density::radial;
  Auto<float> epsilon;
  bool antialias = true;
  float radius_scale = 1.5f;  // closes randomly sampled surfaces (splats.cpp) and smooths the haze alike
  bool clamp_radius = true;

  void describe(ParamList& p) {
    p.add("model", model, {"express", "concentric", "base", "one_layer"})
        .help(
            "density of a soft point: a blended sphere, nested spheres, the exact integral; or only the "
            "first "
            "soft layer transparent")
        .paper("Seemann 2018, Sec. 3");
    p.add("opacity", opacity)
        .range(0, 1)
        .help(
            "of a single soft point through its centre, in every model (auto: 0.3 by uncertainty, so that a "
            "sheet of soft points hides about half; 0.15 otherwise; lower in deep haze, until nine in ten of "
            "its pixels let a quarter through)")
        .paper("Seemann 2018, lambda");
    field.describe(p);
    p.add("field_threshold", field_threshold)
        .range(-1, 1)
        .help(
            "points with a higher field are soft (auto: so that 15 % are, by uncertainty fewer where fewer "
            "are uncertain; "
            "field = distance: 0.5)")
        .paper("Seemann 2018, t");
    p.add("modulation_threshold", modulation_threshold)
        .range(-1, 1)
        .help(
            "field from which a soft point has its full shape; at or below field_threshold: no modulation "
            "(auto: 95 % "
            "of the points are below)")
        .paper("Seemann 2018, l_m");
    p.add("modulation_opacity", modulation_opacity)
        .range(0, 1)
        .help(
            "of a soft point at the field threshold, through its centre: denser than those beyond, so that "
            "solid and soft "
            "parts meet without an edge (auto: three times opacity, 1 at most)")
        .paper("Seemann 2018, lambda of Eq. 22, Fig. 5");
    p.add("order", order, {"exact", "axis"})
        .help("express: sorted for each view, or along the nearest axis with a cross-fade (for motion)");
    p.add("concentric_count", concentric_count)
        .range(1, 1024)
        .help("nested spheres of a point (auto: by its size)")
        .paper("Seemann 2018, N");
    p.add("concentric_spacing_px", concentric_spacing_px)
        .range(0.5, 64)
        .unit("px")
        .help("concentric_count = auto: a sphere for each of these, 32 at most");
    p.add("normalization", normalization, {"exact", "eq13", "eq15"})
        .help("density of nested spheres: one with the mass of the Base model, or those of the paper");
    p.add("density", density, {"radial", "uniform"})
        .help("model = base: densest in the middle, or constant (Eq. 3)");
    p.add("epsilon", epsilon)
        .at_least(0)
        .unit("scene units")
        .help(
            "how far behind the nearest hit a splat still counts as the same surface (auto: 2 median "
            "spacings)")
        .paper("Botsch 2005, epsilon");
    p.add("antialias", antialias)
        .help(
            "a splat covers at least a disc of 1 px radius on the screen; smaller soft points grow and thin "
            "out");
    p.add("radius_scale", radius_scale).point_size().range(0.1, 10).unit("factor").help("size of all splats");
    p.add("clamp_radius", clamp_radius)
        .help(
            "limit radii to twice what the points around have, soft points' to twice that of all of them or "
            "what nine in "
            "ten keep, so that isolated points do not become big discs");
  }

  /// Up to 0.3 Express stays within 0.033 of Base. Uncertain patches of one surface should not look like
  /// holes.
  float plain_opacity() const { return opacity.user.value_or(field.is_uncertainty() ? 0.3f : 0.15f); }
  /// The same, less where the haze of a view is deep: `depth` of it (haze_depth.h) lets `least_transmittance`
  /// through.
  float resolve_opacity(double depth) {
    const double most = 1 - std::pow(double(least_transmittance), 1 / std::max(depth, 1e-6));
    return opacity.resolve(std::min(plain_opacity(), float(most)));
  }

  /// The lambda of Eq. 22. `opacity` itself would leave the edge of Figure 5 (docs/adr/0005).
  float resolve_modulation_opacity() {
    return modulation_opacity.resolve(std::min(1.0f, modulation_factor * opacity.value()));
  }
};

class Soft final : public Technique {
 public:
  void describe(ParamList& p) override { parameters_.describe(p); }

  Values in_motion() const override { return {{"order", "axis"}, {"antialias", "false"}}; }

  /// Who selects points for haze has said which ones are soft: all of them, and none more than others.
  Values of_selected(const Values& given) const override {
    if (std::any_of(given.begin(), given.end(),
                    [](const auto& parameter) { return parameter.first.starts_with("field"); }))
      return {};
    return {{"field", "distance"}, {"field_threshold", "-1"}, {"modulation_threshold", "-1"}};
  }

  Attributes needs() const override {
    // Who is solid among the points around a part decides about its solid points.
    const Attributes drawing = Attribute::normal | Attribute::radius | Attribute::surroundings;
    return parameters_.field.field == "uncertainty" ? drawing | Attribute::uncertainty : drawing;
  }

  /// The layer behind the first one would need further rounds.
  bool merges() const override {
    return parameters_.model != Model::one_layer && parameters_.field.is_of_parts();
  }
  /// The field, sizes, the nearest hits of solid points, and sums behind those with the soft points.
  int rounds() const override { return 4; }

  Transparency transparency() const override { return Transparency::haze; }

  std::shared_ptr<const GpuCloud::Casters> casters(const GpuCloud& cloud, Progress&) override {
    update_field(cloud);
    const float threshold = parameters_.field_threshold.resolve(field_.threshold);
    // That of no view: shadows do not follow the camera.
    const float soft = parameters_.plain_opacity();
    return casters_.at({field_buffers_, threshold, soft}, [&] {
      const std::span<const float> field = own_field();
      std::vector<float> opacity(field.size());
      for (std::size_t i = 0; i < opacity.size(); ++i) opacity[i] = field[i] > threshold ? soft : 1;
      return make_casters(cloud, opacity);
    });
  }

  int reach_px(const GpuCloud&, const Camera&) const override { return 2; }  // deeper_side.glsl

  bool render(Frame& frame) override {
    counted_fragments_ = 0;
    update_field(frame.cloud);
    frame.cloud.set_field(field_buffers_);
    if (frame.visible && !frame.merged) {
      frame.visible->values.push_back(sample_of_field_.at(
          field_buffers_, [&] { return sample_of_field(frame.cloud.prepared(), own_field()); }));
      return true;
    }
    if (frame.merged) take_up_field(*frame.merged);
    const View view(frame.camera, origin_of(frame.cloud));
    Parameters& p = parameters_;
    SplatShape shape;
    shape.radius_scale = p.radius_scale;
    if (p.clamp_radius) shape.widest_px = spacings_.widest_disc_px(frame);
    if (p.antialias) shape.prefilter_px = 1;
    shape.field_threshold = p.field_threshold.resolve(field_.threshold);
    p.modulation_threshold.resolve(field_.modulation_threshold);
    if (frame.visible) {
      show_part(frame, view, shape);
      return true;
    }
    if (frame.merged) {
      draw_merged(frame, view, shape);
      return true;
    }
    points_.choose(frame.cloud, own_field(), shape.field_threshold);
    point_count_ = frame.cloud.size(), soft_count_ = points_.count();
    const float opacity = resolve_opacity(frame, own_field());
    SplatBlend blend;
    if (p.model == Model::one_layer) {
      shape.part = SplatPart::above;
      if (p.clamp_radius) shape.radius_limit = 2 * frame.cloud.median_radius();
      blend.epsilon = p.epsilon.resolve(2 * frame.cloud.median_spacing());
      one_layer_.draw(frame, view, shape, blend, opacity);
    } else {
      blend = measure_solid(frame, shape.field_threshold, nullptr);
      draw_opaque(frame, view, shape, blend);  // Sec. 4, step 2
      if (points_.count() > 0 && opacity > 0) draw_soft(frame, view, shape);
    }
    return true;
  }

  std::vector<std::string> notes() const override {
    std::vector<std::string> lines = field_.notes;
    if (field_.nothing_is_uncertain) lines.push_back("nothing is uncertain: every point is solid");
    // Who asked for a threshold below all of them knows that all are soft.
    const bool is_asked = soft_count_ == point_count_ && !parameters_.field_threshold.is_auto();
    if (point_count_ > 0 && !is_asked) {
      char text[120];
      std::snprintf(text, sizeof text, "%.1f %% of the points are soft",
                    100.0 * double(soft_count_) / double(point_count_));
      std::string line = text;
      if (soft_count_ > 0) {
        std::snprintf(text, sizeof text, "%.3g", double(parameters_.field_threshold.value()));
        line += " (" + parameters_.field.field + " above " + text + "); --field-threshold moves that";
      } else if (parameters_.field.field == "class") {
        line +=
            ": none has a class of --field-classes; --color-by classification --legend shows those that "
            "occur";
      } else {
        line += ": none lies above --field-threshold; a lower one makes some soft";
      }
      lines.push_back(line);
    }
    if (const std::uint32_t count = interior_.overflows(); count > 0)
      lines.push_back(std::to_string(count) +
                      " times more than 64 spheres overlapped in a pixel: their order there is approximate");
    if (counted_fragments_ > 0) lines.push_back(std::to_string(counted_fragments_) + " fragments");
    return lines;
  }

 private:
  /// Of the points that are drawn, without what surrounds a part.
  std::span<const float> own_field() const { return own_field_.empty() ? field_.values : own_field_; }

  /// Evaluates the field when the cloud or its settings changed.
  void update_field(const GpuCloud& cloud) {
    const FieldKey key{cloud.serial(), parameters_.field};
    if (field_key_ == key) return;
    if (!field_key_ || field_key_->serial != key.serial) nearby_ = {};
    field_key_.reset();
    const PreparedCloud& prepared = cloud.prepared();
    field_ = evaluate(prepared.with_surroundings(), parameters_.field, nearby_);
    own_field_ = prepared.surroundings ? prepared.own_of(field_.values) : std::vector<float>();
    field_buffers_ = cloud.make_values("field", own_field());
    field_key_ = key;
  }

  /// That of all parts, of which one without points may have another.
  static const dvec3& origin_of(const GpuCloud& cloud) {
    const PreparedCloud& prepared = cloud.prepared();
    return prepared.whole ? prepared.whole->origin : prepared.cloud.origin;
  }

  /// Thresholds are those of the whole, and no part has its own.
  void take_up_field(const VisiblePoints& merged) {
    const VisiblePoints::Values& of_all = merged.values.at(0);
    field_.set_thresholds(parameters_.field, {of_all.sample, of_all.least, of_all.most});
  }

  /// `of_whole`: null where the cloud is no part.
  SplatBlend measure_solid(Frame& frame, float threshold, const SolidPart::OfWhole* of_whole) {
    const bool has_nearby = nearby_.size() == field_.values.size();
    solid_.update(frame.cloud, field_.values, threshold, !parameters_.field.is_uncertainty(),
                  parameters_.clamp_radius, has_nearby ? &nearby_ : nullptr, of_whole, frame.progress);
    SplatBlend blend;
    blend.epsilon = parameters_.epsilon.resolve(2 * solid_.spacing());
    return blend;
  }

  /// What parts say once they know the thresholds of the whole: sizes, then the nearest hits of their solid
  /// points, then what lies behind those of all parts, and their soft points.
  void show_part(Frame& frame, const View& view, SplatShape shape) {
    VisiblePoints& visible = *frame.visible;
    const VisiblePoints& merged = *frame.merged;
    const PreparedCloud& prepared = frame.cloud.prepared();
    const float threshold = shape.field_threshold;
    const SoftOfPart& soft = soft_of_part_.at({field_buffers_, threshold},
                                              [&] { return soft_of(prepared, own_field(), threshold); });
    if (merged.values.size() == 1) {
      const Numbers numbers = numbers_of(merged.values[0], threshold);
      visible.values = sizes_.at({field_buffers_, threshold, numbers}, [&] {
        std::vector<VisiblePoints::Values> sizes = sizes_of(prepared, soft, numbers);
        if (!parameters_.field.is_uncertainty())
          add_discs(sizes, prepared, soft, numbers, field_.values, threshold);
        return sizes;
      });
      return;
    }
    require_few(merged.values[1].count);
    const SolidPart::OfWhole of_whole = solid_of(merged.values);
    const SplatBlend blend = measure_solid(frame, shape.field_threshold, &of_whole);
    shape.part = SplatPart::not_above;
    const GpuCloud::WithShapes with_shapes(frame.cloud, solid_.shapes());
    if (merged.nearest.empty()) {
      surface_.find_nearest(frame.cloud, view, shape, blend, frame.timers);
      visible.nearest = surface_.nearest_t().download<float>();
      if (parameters_.clamp_radius)
        visible.vouching = evidence_.points(frame, frame.camera, spacings_, shape.radius_scale);
      return;
    }
    surface_.accumulate(frame.cloud, view, shape, blend, merged.nearest, frame.timers);
    visible.color_sum = surface_.color_sum().download<vec4>();
    visible.normal_sum = surface_.normal_sum().download<vec4>();
    const bool is_measured = !parameters_.opacity.user;
    visible.seen_through = soft_in_view(frame.cloud, soft, own_field(), view, shape,
                                        is_measured ? frame.views : std::span<const Camera>());
  }

  void draw_merged(Frame& frame, const View& view, const SplatShape& shape) {
    const VisiblePoints& merged = *frame.merged;
    point_count_ = merged.values.at(0).count, soft_count_ = merged.values.at(1).count;
    haze_.take_up(merged.seen_through, frame.cloud, origin_of(frame.cloud));
    // Without a sample, as where all lie in a few places: those that are handed out.
    const std::vector<float>& radii = merged.values.at(1).sample;
    points_.choose(*haze_.gpu, haze_.field, shape.field_threshold, radii.empty() ? nullptr : &radii);
    Frame of_haze{*haze_.gpu,   frame.camera,       frame.settings, frame.light,
                  frame.target, frame.wants_normal, frame.timers,   frame.progress};
    of_haze.views = frame.views;
    const float opacity = resolve_opacity(of_haze, haze_.field);
    surface_.set_nearest(merged.nearest);
    if (soft_count_ == point_count_) {
      draw_nothing_solid(frame);
    } else {
      surface_.normalize(view, merged.color_sum, merged.normal_sum,
                         {albedo_, frame.target.depth, frame.target.normal}, frame.timers);
      shade_solid(frame, view, shape);
    }
    if (points_.count() > 0 && opacity > 0) draw_soft(of_haze, view, shape);
  }

  float resolve_opacity(const Frame& frame, std::span<const float> field) {
    const bool is_given = parameters_.opacity.user || points_.count() == 0;
    return parameters_.resolve_opacity(is_given ? 0 : depth_of_haze(frame, field));
  }

  /// The solid points, and what else is opaque in the scene: what soft points are seen before.
  void draw_opaque(Frame& frame, const View& view, const SplatShape& shape, const SplatBlend& blend) {
    draw_solid(frame, view, shape, blend);
    if (!frame.behind) return;
    auto timing = frame.timers.scope("merge");
    merge_.run(*frame.behind, frame.target, frame.wants_normal);
    merge_.limit(view, frame.behind->depth, surface_.nearest_t());
  }

  void draw_solid(Frame& frame, const View& view, SplatShape shape, const SplatBlend& blend) {
    if (points_.count() == frame.cloud.size()) {  // nothing is solid
      surface_.draw_nearest(frame.cloud, view, shape, {});
      return draw_nothing_solid(frame);
    }
    shape.part = SplatPart::not_above;
    const GpuCloud::WithShapes with_shapes(frame.cloud, solid_.shapes());
    surface_.draw(frame.cloud, view, shape, blend, {albedo_, frame.target.depth, frame.target.normal},
                  frame.timers);
    shade_solid(frame, view, shape);
  }

  static void draw_nothing_solid(Frame& frame) {
    frame.target.color.clear(vec4(0));
    frame.target.depth.clear(vec4(std::numeric_limits<float>::infinity()));
    frame.target.normal.clear(vec4(0, 0, 0, 1));
  }

  void shade_solid(Frame& frame, const View& view, const SplatShape& shape) {
    if (parameters_.clamp_radius) evidence_.apply(frame, spacings_, shape.radius_scale, albedo_);
    auto timing = frame.timers.scope("shade");
    shade_.run(view, frame.settings, frame.light, origin_of(frame.cloud),
               {albedo_, frame.target.depth, frame.target.normal}, frame.target.color);
  }

  /// How deep the haze of this view is, in soft points one behind the other.
  double depth_of_haze(const Frame& frame, std::span<const float> field) const {
    HazeSettings settings;
    settings.radius_scale = parameters_.radius_scale;
    if (parameters_.clamp_radius) settings.radius_limit = points_.radius_limit();
    settings.field_threshold = parameters_.field_threshold.value();
    settings.modulation_threshold = parameters_.modulation_threshold.value();
    if (!parameters_.modulation_opacity.user) settings.cone_factor = modulation_factor;
    const PointCloud& cloud = frame.cloud.prepared().cloud;
    const HazeSpheres spheres{cloud.positions, points_.radii(), points_.places(), field};
    return haze_depth(spheres, frame.views, cloud.origin, settings);
  }

  void draw_soft(Frame& frame, const View& view, SplatShape shape) {
    const Parameters& p = parameters_;
    if (p.clamp_radius) shape.radius_limit = points_.radius_limit();
    Look look;
    look.opacity = p.opacity.value();
    look.field_threshold = p.field_threshold.value();
    look.modulation_threshold = p.modulation_threshold.value();
    look.modulation_opacity = parameters_.resolve_modulation_opacity();
    look.antialias = p.antialias;
    look.concentric_count = p.concentric_count.user.value_or(0);
    look.concentric_spacing_px = p.concentric_spacing_px;
    look.shape = shape;
    const GpuCloud::WithShapes with_shapes(frame.cloud, points_.own_radii());
    {
      auto timing = frame.timers.scope("soft points");
      points_.update(frame, view, look, surface_.nearest_t());
    }
    const bool as_quads = choose_batches(frame.cloud, view, shape).fallbacks > 0;
    if (p.model == Model::express) {
      express_.draw(points_, view, surface_.nearest_t(), frame.target.color, p.order, as_quads, frame.timers);
      return;
    }
    InteriorSettings settings;
    settings.concentric = p.model == Model::concentric;
    settings.density = p.density;
    settings.normalization = p.normalization;
    settings.most_shells = std::max(32u, std::bit_ceil(unsigned(look.concentric_count)));
    gl::ensure(result_, "soft picture", GL_RGBA32F, view.width(), view.height());
    interior_.draw(points_, view, surface_.nearest_t(), frame.target.color, result_, settings, as_quads,
                   frame.timers);
    std::swap(result_, frame.target.color);
    if (!frame.timers.results().empty()) counted_fragments_ = interior_.fragments();
  }

  Parameters parameters_;
  std::uint64_t counted_fragments_ = 0;  ///< of a picture whose passes are timed
  struct FieldKey {
    std::uint64_t serial;
    FieldSettings settings;
    bool operator==(const FieldKey&) const = default;
  };
  struct CastersKey {
    std::shared_ptr<const GpuCloud::Values> field;
    float threshold, opacity;
    bool operator==(const CastersKey&) const = default;
  };
  Field field_;                   ///< of PreparedCloud::with_surroundings
  std::vector<float> own_field_;  ///< of a part that has surroundings
  std::optional<FieldKey> field_key_;
  std::shared_ptr<const GpuCloud::Values> field_buffers_;
  Derived<CastersKey, std::shared_ptr<const GpuCloud::Casters>> casters_;
  struct SoftKey {
    std::shared_ptr<const GpuCloud::Values> field;
    float threshold;
    bool operator==(const SoftKey&) const = default;
  };
  struct SizesKey {
    std::shared_ptr<const GpuCloud::Values> field;
    float threshold;
    Numbers numbers;
    bool operator==(const SizesKey&) const = default;
  };
  // What a part says.
  Derived<std::shared_ptr<const GpuCloud::Values>, VisiblePoints::Values> sample_of_field_;
  Derived<SoftKey, SoftOfPart> soft_of_part_;
  Derived<SizesKey, std::vector<VisiblePoints::Values>> sizes_;
  analysis::Nearby nearby_;
  SplatSurface surface_;
  ScreenSpacings spacings_;
  DiscEvidence evidence_;
  SolidPart solid_;
  Haze haze_;
  SoftPoints points_;
  std::uint64_t point_count_ = 0, soft_count_ = 0;  ///< of the last picture, be they in view or not
  Express express_;
  Interior interior_;
  OneLayer one_layer_;
  gl::Texture albedo_, result_;
  Shade shade_;
  Merge merge_;
};

}  // namespace

TechniqueInfo soft_technique() {
  return {"soft", "uncertain or selected points as transparent haze",
          [] { return std::unique_ptr<Technique>(new Soft); }};
}

}  // namespace sfumato
