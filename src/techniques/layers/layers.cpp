// See-through surfaces in the right order, from points, in image space.
//
// P. Dobrev, P. Rosenthal, L. Linsen 2010, "Interactive Image-space Point Cloud Rendering with Transparency
// and Shadows", WSCG; filters of P. Rosenthal, L. Linsen 2008, "Image-space Point Cloud Rendering", CGI.
// Layer by layer: the points nearest behind the previous layer become pixels, filters on the image make a
// surface of them, and the surfaces are blended front to back.
//
// Ours differs where pictures or numbers asked for it (docs/techniques/layers.md): a point is a disc in the
// plane of its normal, as large as the spacing asks for; the occluded-pixel filter has its minus sign; layers
// that the filters pulled forward do not bring back what was peeled; several layers come out of one visit of
// the points.

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "analysis/spacing.h"
#include "core/derived.h"
#include "core/error.h"
#include "passes/bindings.h"
#include "passes/fill.h"
#include "passes/merge.h"
#include "passes/shade.h"
#include "techniques/casters.h"
#include "techniques/layers/opacity.h"
#include "techniques/layers/peel.h"
#include "techniques/layers/screen_extent.h"
#include "techniques/layers/thickness.h"
#include "techniques/screen_spacing.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

enum class Peeling { automatic, cascade, passes };
enum class PointShape { automatic, disc, round };

struct Parameters {
  int layers = 4;
  Auto<std::vector<float>> opacity;
  Auto<bool> opaque_last;
  std::string opacity_by = "auto";
  Auto<float> min_layer_distance;
  bool scale_by_angle = true;
  Peeling peeling = Peeling::automatic;
  int show_layer = 0;
  PointShape point_shape = PointShape::automatic;
  Auto<float> point_size;
  Auto<int> background_iterations, occluded_iterations;
  int smoothing_iterations = 1;
  bool antialias = true;

  bool operator==(const Parameters&) const = default;
  void describe(ParamList& p) {
    p.add("layers", layers).range(1, 32).help("surfaces that are peeled and blended; 1 is plain rendering");
    p.add("opacity", opacity)
        .range(0, 1)
        .help("of a layer: one number, or a list in the order of the files or of opacity_by (auto: 0.5)")
        .paper("alpha");
    p.add("opaque_last", opaque_last)
        .help(
            "the last surface of a pixel is opaque, as there is nothing to see behind it (auto: unless "
            "opacity is given)");
    p.add("opacity_by", opacity_by)
        .help(
            "scalar whose values, ascending, choose from a list of opacities (auto: file, layer, "
            "classification)");
    p.add("min_layer_distance", min_layer_distance)
        .at_least(0)
        .unit("scene units")
        .help(
            "points closer than this behind a layer belong to it (auto: at each place 1.5 spacings, or 5 "
            "times the noise where that is more, and 1.25 px; of round points 3 spacings and a px for each "
            "iteration of filling)")
        .paper("d_min");
    p.add("scale_by_angle", scale_by_angle)
        .help("min_layer_distance / |n.v|: a layer seen edge-on is thicker along the view");
    p.add("peeling", peeling, {"auto", "cascade", "passes"})
        .help(
            "cascade: several layers out of one visit of the points; passes: one visit a layer; the same "
            "picture");
    p.add("show_layer", show_layer)
        .range(0, 32)
        .help("only this layer, opaque, counted from 1 at the front; 0: all");
    p.add("point_shape", point_shape, {"auto", "disc", "round"})
        .help(
            "disc: in the plane of its normal, which is computed where the cloud has none; round: facing the "
            "camera, as in the paper; auto: discs, but round where noise is more than 0.7 spacings");
    p.add("point_size", point_size)
        .point_size()
        .range(0.01, 1e6)
        .unit("point spacings")
        .help(
            "diameter of a point, at least 1 px (auto: 3, round 2); round and 0.01 is the paper's one pixel "
            "a point");
    p.add("background_iterations", background_iterations)
        .range(0, 16)
        .help(
            "times that pixels without a point are filled (auto: 1, of round points two more than the point "
            "spacing in px, 2 or 3)")
        .paper("n_b");
    p.add("occluded_iterations", occluded_iterations)
        .range(0, 16)
        .help(
            "times that pixels showing something behind the layer are filled (auto: as "
            "background_iterations, "
            "of discs 2 where points are half a pixel apart or more)")
        .paper("n_o");
    p.add("smoothing_iterations", smoothing_iterations)
        .range(0, 16)
        .help("times that a layer is smoothed")
        .paper("n_s");
    p.add("antialias", antialias).help("smooth the edges of layers");
  }
};

class Layers final : public Technique {
 public:
  void describe(ParamList& p) override { parameters_.describe(p); }

  Values in_motion() const override {
    // Two layers show that there is something behind; closing the gaps of so coarse a picture takes one step.
    Values less{{"antialias", "false"},
                {"smoothing_iterations", "0"},
                {"background_iterations", "1"},
                {"occluded_iterations", "1"}};
    if (parameters_.layers > 1 && parameters_.show_layer == 0) less.emplace_back("layers", "2");
    return less;
  }

  Attributes needs() const override {
    return parameters_.point_shape == PointShape::round ? Attributes() : Attributes(Attribute::normal);
  }

  Transparency transparency() const override { return Transparency::layers; }

  /// Scalars, from which a list of opacities chooses, are no part of what pixels show.
  bool merges() const override { return !parameters_.opacity.user || parameters_.opacity.user->size() < 2; }
  /// The layers that are peeled.
  int rounds() const override {
    return parameters_.show_layer > 0 ? parameters_.show_layer : parameters_.layers;
  }

  std::shared_ptr<const GpuCloud::Casters> casters(const GpuCloud& cloud, Progress&) override {
    std::vector<float> list = opacity_list();
    if (cloud.size() == 0) return nullptr;
    if (parameters_.layers == 1 && parameters_.opaque_last.resolve(parameters_.opacity.is_auto())) list = {1};
    return casters_.at({cloud.serial(), parameters_.opacity_by, list}, [&] {
      return make_casters(
          cloud, list.size() > 1 ? opacities_of_list(cloud) : std::vector<float>(cloud.size(), list[0]));
    });
  }

  int reach_px(const GpuCloud& cloud, const Camera& camera) const override {
    // The extent looks past its border by itself, but for points of 64 px and more; image_normal.glsl as far
    // as it may.
    const int point = 1 + int(std::ceil(0.5f * largest_footprint(camera.whole_height())));
    return cloud.has_normals() ? point : point + farthest_image_normal;
  }

  bool render(Frame& frame) override {
    const layers::ScreenExtent extent = choose_extent(frame);
    const View view(extent.camera, frame.cloud.prepared().cloud.origin);
    begin(frame, extent, view);
    if (frame.visible) {
      show_part(frame, view, extent.camera);
      keep(frame);
    } else {
      draw(frame, extent, view);
    }
    return true;
  }

  std::vector<std::string> notes() const override {
    std::vector<std::string> lines{std::to_string(peeled_) + (peeled_ == 1 ? " layer" : " layers")};
    if (peel_.visits() > 0)
      lines.front() += ", " + std::to_string(peel_.visits()) + (peel_.visits() == 1 ? " visit" : " visits") +
                       " of the points (" + (cascade_ ? "cascade" : "passes") + ")";
    if (is_noisy_) lines.push_back("the points are too noisy for discs in the surface: drawn round");
    return lines;
  }

 private:
  /// Textures of the view, with nothing drawn, or peeled but what is kept.
  void begin(Frame& frame, const layers::ScreenExtent& extent, const View& view) {
    const bool goes_on = takes_kept(frame);
    make_textures(view, frame.behind != nullptr, has_categories(frame));
    {
      auto timing = frame.timers.scope("clear");
      frame.target.color.clear(vec4(0));
      frame.target.depth.clear(vec4(INFINITY));
      if (frame.wants_normal) frame.target.normal.clear(vec4(0, 0, 0, 1));
      if (!goes_on) {
        front_.clear(vec4(0));
        limit_.clear(vec4(0));
        peeled_ = 0, is_open_ = true;
      }
    }
    if (frame.behind) extent.take(frame.behind->depth, behind_depth_);
    cascade_ = parameters_.peeling == Peeling::cascade && layers::Peel::can_cascade(view) && !frame.visible &&
               !frame.merged;
    peel_.begin(view, footprint_, cascade_, bin_);
    const bool has_layers = !frame.visible || frame.merged;  // not in the first round of a part
    evidence_mask_ =
        keeps_to_evidence() && has_layers ? evidence_.find(frame, extent.camera, spacings_, 1) : nullptr;
  }

  /// The picture: layers from the front until the last of them, or until no pixel can hold another one.
  void draw(Frame& frame, const layers::ScreenExtent& extent, const View& view) {
    while (is_open_ && peeled_ < rounds()) {
      draw_layer(frame, view);
      if (is_first_shown()) extent.copy(depth_, frame.target.depth);
      if (is_first_shown() && frame.wants_normal) extent.copy(normal_, frame.target.normal);
      if (knows_last_) blend_late(frame);
    }
    if (knows_last_) {
      if (frame.behind) cover(frame, behind_depth_, next_coverage_);
      blend_held(frame, frame.behind != nullptr, true);
    }
    auto timing = frame.timers.scope("copy");
    extent.copy(front_, frame.target.color);
    if (frame.behind) merge_.run(*frame.behind, frame.target, frame.wants_normal);
  }

  /// The next layer, in the steps of Dobrev 2010: peeled, filled, lit, smoothed and blended under those in
  /// front, unless that has to wait (`blend_late`).
  void draw_layer(Frame& frame, const View& view) {
    ++peeled_;
    const bool is_filled = n_background_ + n_occluded_ > 0;
    fill(frame, frame.merged
                    ? take_up(frame, view)
                    : peel_.next(frame.cloud, view, limit_, depth_, index_, is_filled, frame.timers));
    if (frame.behind) clip(frame);
    // A part blends to know where the layers in front of its points end, which late blending does not decide.
    const bool is_shown =
        (parameters_.show_layer == 0 || parameters_.show_layer == peeled_) && !(frame.visible && knows_last_);
    light(frame, view, is_first_shown() && frame.wants_normal);
    if (is_shown) smooth(frame);
    is_open_ = advance(frame, view, is_shown && !knows_last_);
    if (is_open_) frame.progress.check();
  }
  bool is_first_shown() const { return peeled_ == std::max(parameters_.show_layer, 1); }

  /// Automatic values and what follows from the view.
  layers::ScreenExtent choose_extent(Frame& frame) {
    const PreparedCloud& prepared = frame.cloud.prepared();
    const ScreenSpacing spacing = spacings_.measure(frame.cloud, frame.views);
    const bool discs = draws_discs(frame.cloud, frame.progress);
    const float point_size = parameters_.point_size.resolve(discs ? 3.0f : 2.0f);
    footprint_ = {SizeMode::adaptive, point_size};
    const int height = frame.camera.whole_height();
    footprint_.most_px = std::min(largest_footprint(height), 2 * widest_disc_px(spacing, height));
    footprint_.oriented = discs;
    if (!discs && spacing.largest_px * point_size <= 0.5f) footprint_ = {SizeMode::pixels, 1};
    // Points scattered at random leave one place in exp(pi) free between round discs of two spacings, and a
    // few of the gaps are several pixels wide: 6M points of tori had 35 pixels in which the next layer stood
    // out with one iteration less. Between discs in the surface of three spacings it is one place in exp(9 pi
    // / 4).
    const int iterations =
        discs ? 1 : std::clamp(2 + int(std::lround(std::min(spacing.median_px, 100.0f))), 2, 3);
    n_background_ = parameters_.background_iterations.resolve(iterations);
    // Scans are no random samples: where points are about as far apart as pixels, a second iteration closes
    // most of the gaps that one leaves.
    const bool is_sparse = spacing.median_px >= 0.5f;
    n_occluded_ = parameters_.occluded_iterations.resolve(discs && is_sparse ? 2 : n_background_);
    // What a pixel shows of one slanted surface lies apart by a round disc in front (one spacing) and one
    // behind, which bulges by its radius, and by as far as filling brings a depth from. Discs in the surface
    // lie at its own depths: what is left is its bend within the radius of a disc, and noise, from two sigma
    // in front to three behind. The quarter of a pixel: where points are closer than pixels, 2 % more of
    // those at silhouettes are right (make eval-layers).
    rule_ = discs ? layers::ThicknessRule{1.5f, 5, 1.25f}
                  : layers::ThicknessRule{3, 0, float(n_background_ + n_occluded_)};
    const float noise = discs && is_placed() ? thickness_.noise_in_spacings(frame.cloud, frame.progress) : 0;
    const float usual = frame.cloud.median_spacing() * std::max(rule_.spacings, rule_.deviations * noise);
    d_min_ = parameters_.min_layer_distance.resolve(usual + rule_.pixels * spacing.pixel);
    const float least = is_placed() ? layers::least_thickness(prepared, rule_) : d_min_;
    bin_ = std::exp2(std::max(std::floor(std::log2(0.5f * least)), -60.0f));
    choose_opacities(frame);

    // As far as a pixel of the last layer can see: every layer's limit comes from a filled image.
    const int last = std::max(parameters_.show_layer, parameters_.layers);
    const int reach = last * (n_background_ + n_occluded_) + parameters_.smoothing_iterations + 3;
    if (!prepared.whole)
      return {prepared, frame.camera, point_size, std::min(reach, layers::ScreenExtent::most_reach)};
    take_spacings(frame);
    // Of points farther out some parts draw more than others, as their batches lie.
    const int of_normals = needs().empty() && !prepared.whole->has_normals ? farthest_image_normal : 0;
    return {frame.camera, reach + of_normals + 1 + int(std::ceil(0.75f * footprint_.most_px))};
  }

  /// Sizes of points by the whole of which this is a part, whose batches are others.
  void take_spacings(Frame& frame) {
    if (has_list_) return;  // the field has opacities
    const PreparedCloud& prepared = frame.cloud.prepared();
    frame.cloud.set_field(point_spacings_.at(frame.cloud.serial(), [&] {
      return frame.cloud.make_values(
          "spacing",
          analysis::spacings_at(prepared.cloud.positions, prepared.whole->spacing, frame.progress));
    }));
    footprint_.spacing_is_field = true;
  }

  /// Each place has its own d_min.
  bool is_placed() const { return parameters_.min_layer_distance.is_auto(); }

  /// Noise as large as the spacing tilts normals and scatters discs along the view: they would lie behind one
  /// another.
  bool draws_discs(const GpuCloud& cloud, Progress& progress) {
    is_noisy_ = false;
    if (parameters_.point_shape == PointShape::round) return false;
    // Of parts all have normals, but for one without points.
    if (!cloud.prepared().whole && !cloud.has_normals()) return false;
    // Points in one place lie on no surface: edge-on discs there would show nothing.
    if (!(cloud.bounds().diagonal() > 0)) return false;
    is_noisy_ = parameters_.point_shape == PointShape::automatic &&
                thickness_.noise_in_spacings(cloud, progress) > most_noise;
    return !is_noisy_;
  }

  std::vector<float> opacity_list() {
    const std::vector<float> list = parameters_.opacity.resolve({0.5f});
    if (list.empty()) throw Error(ErrorCode::usage, "opacity: give at least one number between 0 and 1");
    return list;
  }

  std::vector<float> opacities_of_list(const GpuCloud& cloud) const {
    const PointCloud& points = cloud.prepared().cloud;
    return layers::opacities(layers::opacity_scalar(points, parameters_.opacity_by),
                             parameters_.opacity.value());
  }

  void choose_opacities(Frame& frame) {
    const PreparedCloud& prepared = frame.cloud.prepared();
    const std::vector<float> list = opacity_list();
    knows_last_ =
        parameters_.opaque_last.resolve(parameters_.opacity.is_auto()) && parameters_.show_layer == 0;
    has_list_ = list.size() > 1 && parameters_.show_layer == 0 && !prepared.cloud.empty();
    if (!has_list_) return;
    const ScalarField& scalar = layers::opacity_scalar(prepared.cloud, parameters_.opacity_by);
    frame.cloud.set_field(field_.at({frame.cloud.serial(), scalar.name, list}, [&] {
      return frame.cloud.make_values("opacity", layers::opacities(scalar, list));
    }));
  }

  /// Colours stand for categories, of which a layer shows one and nothing between.
  static bool has_categories(const Frame& frame) { return !frame.settings.palette.empty(); }

  void make_textures(const View& view, bool has_behind, bool has_categories) {
    const int w = view.width(), h = view.height();
    for (gl::Texture* t : {&behind_depth_, &next_depth_})
      if (has_behind) gl::ensure(*t, "layer depth", GL_R32F, w, h);
    for (gl::Texture* t : {&shape_, &held_shape_})
      gl::ensure(*t, "layer shape", has_categories ? GL_RGBA32F : GL_RG32F, w, h);
    for (gl::Texture* t :
         {&depth_, &other_depth_, &held_depth_, &limit_, &other_limit_, &coverage_, &next_coverage_})
      gl::ensure(*t, "layer depth", GL_R32F, w, h);
    for (gl::Texture* t : {&index_, &other_index_}) gl::ensure(*t, "layer source index", GL_R32UI, w, h);
    for (gl::Texture* t : {&normal_, &color_, &held_color_, &front_, &other_front_, &scratch_})
      gl::ensure(*t, "layer colour", GL_RGBA32F, w, h);
  }

  /// Rosenthal and Linsen 2008, Sec. 4: background first, then what shines through. Source indices follow;
  /// their attributes are read afterwards.
  void fill(Frame& frame, const gl::Texture& peeled) {
    auto timing = frame.timers.scope("fill");
    for (int i = 0; i < n_background_ + n_occluded_; ++i) {
      const FillKind kind = i < n_background_ ? FillKind::background : FillKind::occluded;
      fill_.run_index(kind, d_min_, i == 0 ? peeled : depth_, other_depth_, index_, other_index_);
      std::swap(depth_, other_depth_);
      std::swap(index_, other_index_);
    }
    if (!evidence_mask_) return;
    if (!keep_vouched_)
      keep_vouched_ = ScreenPass("techniques/layers/keep_vouched.glsl", {GL_R32F, GL_R32UI});
    keep_vouched_.run({evidence_mask_}, {&depth_, &index_});
  }

  /// The layer that all parts show. The index of a point is that of its pixel, by which its colour and normal
  /// are found.
  const gl::Texture& take_up(Frame& frame, const View& view) {
    const VisiblePoints& merged = *frame.merged;
    const std::size_t before = std::size_t(peeled_) - 1;
    const VisiblePoints& layer = before < merged.in_front.size() ? merged.in_front[before] : merged;
    const Image<std::uint32_t>& bits = layer.depth_bits;
    if (!frame.cloud.prepared().whole)
      throw Error(ErrorCode::usage, "layers of parts need what is known of the whole cloud");
    if (before > merged.in_front.size() || bits.width() != depth_.width() || bits.height() != depth_.height())
      throw Error(ErrorCode::usage, "layers that parts showed with another camera or other parameters");
    Image<std::uint32_t> pixels(bits.width(), bits.height(), VisiblePoints::nothing);
    for (std::size_t i = 0; i < bits.size(); ++i)
      if (bits.data()[i] != VisiblePoints::nothing) pixels.data()[i] = std::uint32_t(i);
    depth_.upload(layer.depth());
    index_.upload(pixels);
    gl::ensure(pixel_colors_, "colours of points", GL_RGBA32F, bits.width(), bits.height());
    pixel_colors_.upload(layer.colors);
    has_pixel_normals_ = !layer.normals.empty();
    if (has_pixel_normals_) {
      gl::ensure(pixel_normals_, "normals of points", GL_RGBA32F, bits.width(), bits.height());
      pixel_normals_.upload(layer.normals);
    }
    if (is_placed()) {
      gl::ensure(pixel_thickness_, "thickness of points", GL_R32F, bits.width(), bits.height());
      pixel_thickness_.upload(
          thickness_.of_pixels(frame.cloud, rule_, layer.depth(), view.camera(), frame.progress));
    }
    return depth_;
  }

  /// The nearest points of this part behind the layers of all parts, which the first round does not know.
  void show_part(Frame& frame, const View& view, const Camera& camera) {
    VisiblePoints& visible = *frame.visible;
    const int known = frame.merged ? int(frame.merged->in_front.size()) + 1 : 0;
    while (is_open_ && peeled_ < known) draw_layer(frame, view);
    if (!is_open_) {
      visible.depth_bits = visible.number =
          Image<std::uint32_t>(view.width(), view.height(), VisiblePoints::nothing);
      visible.colors = Image<vec4>(view.width(), view.height(), vec4(0));
      return;
    }
    to_pixels_.draw(frame.cloud, view, footprint_, part_, frame.timers, peeled_ > 0 ? &limit_ : nullptr);
    to_pixels_.resolve(frame.cloud, view, part_, frame.timers, frame.cloud.has_normals());
    visible.depth_bits = part_.depth_bits.download<std::uint32_t>();
    visible.number = part_.index.download<std::uint32_t>();
    visible.colors = part_.albedo.download<vec4>();
    if (frame.cloud.has_normals()) visible.normals = part_.normal.download<vec4>();
    if (keeps_to_evidence() && peeled_ == 0) visible.vouching = evidence_.points(frame, camera, spacings_, 1);
  }

  /// What `limit_`, `front_`, `peeled_` and `is_open_` follow from, once all merged layers are peeled.
  struct Round {
    std::uint64_t layers;  ///< VisiblePoints::serial
    std::uint64_t cloud;   ///< GpuCloud::serial: parts may be drawn in turns
    Camera camera;
    RenderSettings settings;
    Parameters parameters;
    bool operator==(const Round&) const = default;
  };
  Round round_of(const Frame& frame, std::uint64_t layers) const {
    return {layers, frame.cloud.serial(), frame.camera, frame.settings, parameters_};
  }
  /// Whether they are those of the round before in the same picture, which this one goes on from. They are
  /// about to change: nothing is kept until a round ends.
  bool takes_kept(const Frame& frame) {
    const std::optional<Round> kept = std::exchange(kept_, std::nullopt);
    if (!kept || !frame.visible || !frame.merged || frame.merged->in_front.empty()) return false;
    return *kept == round_of(frame, frame.merged->in_front.back().serial);
  }
  void keep(const Frame& frame) {
    if (frame.merged && frame.merged->serial != 0) kept_ = round_of(frame, frame.merged->serial);
  }

  /// Points of a size that somebody asked for are as large as that.
  bool keeps_to_evidence() const { return parameters_.point_size.is_auto(); }

  /// Attributes of the points that the pixels took, lit. `write_normals`: into `normal_`.
  void light(Frame& frame, const View& view, bool write_normals) {
    auto timing = frame.timers.scope("light");
    GpuCloud& cloud = frame.cloud;
    const int shading = int(frame.settings.shading);
    const bool merged = frame.merged, has_normals = merged ? has_pixel_normals_ : cloud.has_normals();
    ScreenPass& pass = light_[has_normals * 1 + cloud.has_shadow() * 2 + has_list_ * 4 + write_normals * 8 +
                              has_categories(frame) * 16 + merged * 32 + is_placed() * 64 + shading * 128];
    if (!pass) {
      gl::Defines defines{"SHADING " + std::to_string(shading)};
      std::vector<GLenum> formats{GL_RGBA32F, has_categories(frame) ? GLenum(GL_RGBA32F) : GLenum(GL_RG32F)};
      if (has_categories(frame)) defines.push_back("CATEGORIES");
      if (merged) defines.push_back("MERGED");
      if (has_normals) defines.push_back("HAS_NORMALS");
      if (cloud.has_shadow()) defines.push_back("HAS_SHADOW");
      if (has_list_) defines.push_back("HAS_OPACITY");
      if (is_placed()) defines.push_back("PLACED_THICKNESS");
      if (write_normals) {
        defines.push_back("WRITE_NORMAL");
        formats.push_back(GL_RGBA32F);
      }
      pass = ScreenPass("techniques/layers/light.glsl", formats, defines);
    }
    if (!has_list_)
      pass.set("opacity", parameters_.show_layer > 0 ? 1.0f : parameters_.opacity.value().front());
    if (is_placed())
      pass.set("thickness_px", rule_.pixels);
    else
      pass.set("thickness", d_min_);
    if (!has_normals) pass.set("spacing", 0.5f * parameters_.point_size.value() * cloud.median_spacing());
    set_light_uniforms(pass.program(), view, frame.settings, frame.light, cloud.prepared().cloud.origin);
    view.bind();
    if (merged) {
      const gl::Texture& normals = has_normals ? pixel_normals_ : pixel_colors_;  // not read
      if (is_placed()) pixel_thickness_.bind(binding::input + 4);
      if (write_normals)
        pass.run({&depth_, &index_, &pixel_colors_, &normals}, {&color_, &shape_, &normal_});
      else
        pass.run({&depth_, &index_, &pixel_colors_, &normals}, {&color_, &shape_});
      return;
    }
    const GpuCloud::Values* thickness =
        is_placed() && cloud.size() > 0 ? &thickness_.of_points(cloud, rule_, frame.progress) : nullptr;
    cloud.for_each_place(pass, [&](GpuCloud::Chunk& chunk) {
      cloud.bind_geometry(chunk);
      cloud.bind_colors(chunk);
      if (cloud.has_normals()) cloud.bind_normals(chunk);
      if (cloud.has_shadow()) cloud.bind_shadow(chunk);
      if (has_list_) cloud.bind_field(chunk);
      if (thickness) (*thickness)[std::size_t(&chunk - cloud.chunks().data())].bind(binding::thickness);
      if (write_normals)
        pass.run({&depth_, &index_}, {&color_, &shape_, &normal_});
      else
        pass.run({&depth_, &index_}, {&color_, &shape_});
    });
    if (cloud.chunks().empty()) {
      color_.clear(vec4(0));
      shape_.clear(vec4(1, 0, 1, 1));
      normal_.clear(vec4(0, 0, 0, 1));
    }
  }

  void smooth(Frame& frame) {
    auto timing = frame.timers.scope("smooth");
    const bool categories = has_categories(frame);
    ScreenPass& pass = smooth_[categories];
    if (!pass)
      pass = ScreenPass("techniques/layers/smooth.glsl", {GL_RGBA32F},
                        categories ? gl::Defines{"CATEGORIES"} : gl::Defines{});
    for (int i = 0; i < parameters_.smoothing_iterations; ++i) {
      pass.run({&color_, &depth_, &shape_}, {&scratch_});
      std::swap(color_, scratch_);
    }
  }

  /// Blends the layer when it is shown and moves the limit behind it; false when no pixel can hold another
  /// layer.
  bool advance(Frame& frame, const View& view, bool is_shown) {
    auto timing = frame.timers.scope("blend");
    ScreenPass& pass = advance_[is_shown * 1 + parameters_.scale_by_angle * 2];
    if (!pass) {
      gl::Defines defines;
      std::vector<GLenum> formats{GL_R32F};
      if (is_shown) {
        defines.push_back("BLEND");
        formats.push_back(GL_RGBA32F);
      }
      if (parameters_.scale_by_angle) defines.push_back("SCALE_BY_ANGLE");
      pass = ScreenPass("techniques/layers/advance.glsl", formats, defines);
    }
    pass.set("bin", bin_);
    if (is_shown) pass.set("antialias", parameters_.antialias);
    view.bind();
    open_.arm();
    if (is_shown) {
      pass.run({&depth_, &limit_, &shape_, &color_, &front_}, {&other_limit_, &other_front_});
      std::swap(front_, other_front_);
    } else {
      pass.run({&depth_, &limit_, &shape_}, {&other_limit_});
    }
    std::swap(limit_, other_limit_);
    return open_.is_set();
  }

  /// Nothing is seen through what is opaque: layers end there, and another surface follows the last of them.
  void clip(Frame& frame) {
    auto timing = frame.timers.scope("fill");
    if (!clip_) clip_ = ScreenPass("techniques/layers/clip.glsl", {GL_R32F, GL_R32F});
    clip_.run({&depth_, &behind_depth_}, {&other_depth_, &next_depth_});
    std::swap(depth_, other_depth_);
  }

  void cover(Frame& frame, const gl::Texture& depth, const gl::Texture& coverage) {
    auto timing = frame.timers.scope("blend");
    if (!cover_) cover_ = ScreenPass("techniques/layers/coverage.glsl", {GL_R32F});
    cover_.set("antialias", parameters_.antialias).run({&depth}, {&coverage});
  }

  /// Blends the layer before, as it is now known where this one follows it, and holds this one back.
  void blend_late(Frame& frame) {
    const bool is_first = peeled_ == 1;
    cover(frame, frame.behind && !is_first ? next_depth_ : depth_, is_first ? coverage_ : next_coverage_);
    if (!is_first) blend_held(frame, true, false);
    std::swap(color_, held_color_);
    std::swap(depth_, held_depth_);
    std::swap(shape_, held_shape_);
  }

  /// `is_followed`: somewhere, as `next_coverage_` says; `ends`: no layer comes after it.
  void blend_held(Frame& frame, bool is_followed, bool ends) {
    auto timing = frame.timers.scope("blend");
    if (!blend_held_) blend_held_ = ScreenPass("techniques/layers/blend_last.glsl", {GL_RGBA32F});
    blend_held_.set("antialias", parameters_.antialias).set("is_followed", is_followed).set("ends", ends);
    blend_held_.run({&held_depth_, &held_color_, &front_, &coverage_, &next_coverage_, &held_shape_},
                    {&other_front_});
    std::swap(front_, other_front_);
  }

  Parameters parameters_;
  float d_min_ = 0, bin_ = 0;                        ///< d_min: the usual one, for filling
  static constexpr float most_noise = 0.7f;          ///< spacings
  static constexpr int farthest_image_normal = 128;  ///< px: image_normal.glsl
  bool is_noisy_ = false;
  layers::ThicknessRule rule_;
  layers::Thickness thickness_;
  Derived<std::uint64_t, std::shared_ptr<const GpuCloud::Values>> point_spacings_;
  /// Of a cloud: opacities that a scalar picks from a list.
  struct OpacityKey {
    std::uint64_t serial;
    std::string by;
    std::vector<float> list;
    bool operator==(const OpacityKey&) const = default;
  };
  Derived<OpacityKey, std::shared_ptr<const GpuCloud::Values>> field_;
  Derived<OpacityKey, std::shared_ptr<const GpuCloud::Casters>> casters_;
  int n_background_ = 1, n_occluded_ = 1, peeled_ = 0;
  Footprint footprint_;
  ScreenSpacings spacings_;
  bool cascade_ = false, has_list_ = false;
  bool knows_last_ = false;  ///< layers are blended one late, when it is known whether another follows

  layers::Peel peel_;
  Flag open_;
  Fill fill_;
  std::map<int, ScreenPass> light_;
  ScreenPass smooth_[2], advance_[4], cover_, blend_held_, clip_;
  Merge merge_;
  DiscEvidence evidence_;
  const gl::Texture* evidence_mask_ = nullptr;  ///< of the frame; null: points vouch for all of it
  ScreenPass keep_vouched_;
  gl::Texture behind_depth_, next_depth_;  ///< of scenes with other items
  gl::Texture depth_, other_depth_, limit_, other_limit_, index_, other_index_;
  gl::Texture held_depth_, held_color_, coverage_, next_coverage_;
  gl::Texture shape_, held_shape_, normal_, color_, front_, other_front_, scratch_;
  /// Of clouds in parts: what is found of one of them, and what all of them show in a layer.
  PointsToPixels to_pixels_;
  PixelLayer part_;
  gl::Texture pixel_colors_, pixel_normals_, pixel_thickness_;
  bool has_pixel_normals_ = false;
  bool is_open_ = true;  ///< a pixel can hold another layer
  std::optional<Round> kept_;
};

}  // namespace

TechniqueInfo layers_technique() {
  return {"layers", "transparent surfaces, blended in depth order",
          [] { return std::unique_ptr<Technique>(new Layers); }};
}

}  // namespace sfumato
