// Stroke-based splatting: a scan becomes a painting.
//
// R. K. dos Anjos, C. S. Ribeiro, D. Simões Lopes, J. Madeiras Pereira, "Stroke-based splatting: an efficient
// multi-resolution point cloud visualization technique", 2017: every point is a brush stroke in its tangent
// plane, a sum of Gaussians whose columns turn at random; strokes follow the clusters of the cloud; they are
// blurred while the picture moves and sorted in an A-buffer when it stands still.
//
// Where we differ: strokes have at least a size on the screen, and as many points as that needs become
// strokes, chosen by a hash of their place, so that a dense scan is painted and not textured; whole strokes
// are stacked in one order (the paper sorts each pixel, so that large strokes interleave); fragments behind
// an opaque one are not stored, and lists are as long as they need to be; paint has a relief, lit by the
// shared shading pass.

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/derived.h"
#include "gl/commands.h"
#include "gl/state.h"
#include "passes/bindings.h"
#include "passes/shade.h"
#include "techniques/screen_spacing.h"
#include "techniques/strokes/stroke_lists.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

using namespace strokes;

const char* const unsorted_note = "not sorted to the end: the next picture of this view sorts on";

/// Whether `drawn` are a scan's own colours, as they are or with another exposure: each channel then follows
/// from itself and the strongest (core/coloring.h).
bool are_own(const std::vector<Rgba8>& own, const std::vector<Rgba8>& drawn) {
  if (own.empty() || own.size() != drawn.size()) return false;
  std::vector<std::int16_t> shown(std::size_t(256) * 256, -1);
  auto follows = [&](std::uint8_t most, std::uint8_t before, std::uint8_t after) {
    std::int16_t& known = shown[std::size_t(256) * most + before];
    if (known < 0) known = after;
    return known == after;
  };
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Rgba8 &a = own[i], &b = drawn[i];
    const std::uint8_t most = std::max({a.r, a.g, a.b});
    if (!follows(most, a.r, b.r) || !follows(most, a.g, b.g) || !follows(most, a.b, b.b)) return false;
  }
  return true;
}

class Strokes final : public Technique {
 public:
  void describe(ParamList& p) override { parameters_.describe(p); }

  Values in_motion() const override { return {{"two_layers", "false"}, {"underpainting", "false"}}; }

  Attributes needs() const override { return Attribute::normal | Attribute::cluster; }
  bool has_soft_edges() const override { return true; }  // of brushes
  bool is_on_paper() override { return parameters_.resolve_look().medium != Medium::paint; }
  bool holds_still() const override { return parameters_.hold_still; }

  int reach_px(const GpuCloud&, const Camera& camera) const override {
    // underpaint.glsl twice, then the wider ring of medium.glsl, or blur.glsl.
    const int ring = int(std::ceil(2.0 * camera.whole_height() / 720));
    return 2 * 24 + std::max(ring, int(std::ceil(2.5f * parameters_.blur_radius))) + 1;
  }

  bool render(Frame& frame) override {
    const View view(frame.camera, frame.cloud.prepared().cloud.origin);
    notes_.clear();
    if (refining_ && same_frame(frame)) {
      refine(frame, view);
      return true;
    }
    refining_ = has_evidence_ = false;
    {
      auto timing = frame.timers.scope("set up strokes");
      brush_.update(parameters_.resolve_brush());
      look_ = parameters_.resolve_look();
      if (strict(frame)) look_.relief = 0;
      const float step = parameters_.seed_step.resolve(float(seed_quantum(frame.cloud.median_spacing())));
      data_.update(frame.cloud, parameters_.tangent, step, frame.progress);
      // Who asks for longer strokes has them.
      const float longer =
          std::max(1.0f, parameters_.stroke_length.user.value_or(0) / strokes::Look().length_percent);
      const int height = frame.camera.whole_height();
      // Beside points a brush reaches farther beyond an outline than a disc.
      reach_ = evidence_reach(spacings_.measure(frame.cloud, frame.views), height);
      reach_.between *= longer;
      reach_.beside = reach_.around = longer * widest_disc_px({}, height);
      strokes_.limit(reach_);
      strokes_.update(frame.cloud, data_, view, look_, brush_, parameters_.orientation_noise.value(),
                      parameters_.two_layers, strict(frame));
    }
    notes_.push_back(std::to_string(strokes_.count()) + " strokes");
    if (parameters_.blend != BlendMode::a_buffer) {
      draw_nearest(frame, view, parameters_.blend == BlendMode::blur);
      return true;
    }
    build(frame, view);
    if (parameters_.refine == Refine::at_once || lists_.bands() > 1) {
      auto timing = frame.timers.scope("sort and mix");
      lists_.sort_all(view, strokes_, brush_, look_.relief);
      finish(frame, view, true);
      return true;
    }
    // The frame that builds the lists shows the blurred picture; sorting starts with the next.
    show_listed(frame, view);
    copy(frame.target, blurred_, view);
    remember(frame);
    notes_.push_back(unsorted_note);
    return true;
  }

  std::vector<std::string> notes() const override { return notes_; }

 private:
  /// Anything but the lit picture shows the cloud's own colours, or no colours.
  static bool strict(const Frame& frame) { return frame.settings.shading != Shading::lit; }

  /// Light when the colours show an attribute; a scan's own were lit when it was taken, and no material is
  /// known (dos Anjos 2017, Sec. 5.2).
  bool lit(const Frame& frame) {
    if (frame.settings.shading != Shading::lit) return false;
    if (parameters_.lighting != Lighting::automatic) return parameters_.lighting == Lighting::on;
    return !own_colors_.at(frame.cloud.look_serial(), [&] {
      return are_own(frame.cloud.prepared().cloud.colors, frame.cloud.colors());
    });
  }

  void build(Frame& frame, const View& view) {
    auto timing = frame.timers.scope("list fragments");
    lists_.build(view, strokes_, brush_, parameters_.stroke_order,
                 std::uint64_t(parameters_.fragment_memory) << 20);
    if (lists_.bands() > 1)
      notes_.push_back(std::to_string(lists_.fragments()) + " fragments exceed fragment_memory: sorted in " +
                       std::to_string(lists_.bands()) + " bands, none left out");
  }

  /// Sorts on where the last picture of the same view stopped (dos Anjos 2017, Alg. 2).
  void refine(Frame& frame, const View& view) {
    auto timing = frame.timers.scope("sort and mix");
    notes_.push_back(std::to_string(strokes_.count()) + " strokes");
    const bool is_sorted = lists_.sort_some(view, strokes_, look_.relief, parameters_.sort_steps);
    steps_ += parameters_.sort_steps;
    if (!is_sorted) notes_.push_back(unsorted_note);
    if (is_sorted || steps_ >= parameters_.min_sorted)
      finish(frame, view, is_sorted);
    else
      copy(blurred_, frame.target, view);  // the lists begin behind what was mixed
  }

  /// The picture so far: sums to a surface, lit.
  void finish(Frame& frame, const View& view, bool is_final) {
    if (!finish_)
      finish_ = ScreenPass("techniques/strokes/finish_paint.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
    gl::ensure(albedo_, "albedo", GL_RGBA32F, view.width(), view.height());
    view.bind();
    const StrokeLists::Sums& sums = lists_.sums();
    set_even_light(frame, finish_);
    finish_.run({&sums.color, &sums.normal, &sums.rest},
                {&albedo_, &frame.target.depth, &frame.target.normal});
    if (parameters_.underpainting && is_final) underpaint(frame, view);
    shade(frame, view);
  }

  void set_even_light(const Frame& frame, ScreenPass& pass) {
    const Phong& phong = frame.settings.phong;
    const bool even = frame.settings.shading == Shading::lit && !lit(frame);
    pass.set("even_light", even ? vec2(phong.ambient.value(), phong.diffuse.value()) : vec2(1, 0));
  }

  void underpaint(Frame& frame, const View& view) {
    auto timing = frame.timers.scope("underpaint");
    const int width = view.width(), height = view.height();
    if (!underpaint_)
      underpaint_ = ScreenPass("techniques/strokes/underpaint.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
    gl::ensure(under_albedo_, "underpainted albedo", GL_RGBA32F, width, height);
    gl::ensure(under_depth_, "underpainted depth", GL_R32F, width, height);
    gl::ensure(under_normal_, "underpainted normals", GL_RGBA32F, width, height);
    const float stroke_width =
        0.01f * look_.length_percent * float(view.picture_height()) / std::max(look_.aspect, 1.0f);
    underpaint_.set("reach", std::clamp(int(std::lround(stroke_width)), 3, 12));
    underpaint_.set("spacing", frame.cloud.median_spacing());
    view.bind();
    for (bool teeth : {false, true}) {
      underpaint_.set("teeth", teeth);
      underpaint_.run({&albedo_, &frame.target.depth, &frame.target.normal},
                      {&under_albedo_, &under_depth_, &under_normal_});
      std::swap(albedo_, under_albedo_);
      std::swap(frame.target.depth, under_depth_);
      std::swap(frame.target.normal, under_normal_);
    }
  }

  void shade(Frame& frame, const View& view) {
    // Strokes have a length on the picture, whatever was measured there.
    if (reach_.limits()) {
      if (!has_evidence_)
        evidence_.find(frame.cloud, frame.camera, frame.cloud.prepared().cloud.origin, reach_, frame.timers);
      has_evidence_ = true;
      evidence_.apply(albedo_, frame.target.depth, frame.target.normal);
    }
    auto timing = frame.timers.scope("shade");
    RenderSettings settings = frame.settings;
    settings.phong.specular.user = parameters_.gloss;
    if (settings.shading == Shading::lit && !lit(frame))
      settings.shading = Shading::albedo;  // set_even_light
    shade_.run(view, settings, frame.light, frame.cloud.prepared().cloud.origin,
               {albedo_, frame.target.depth, frame.target.normal}, frame.target.color);
    if (frame.settings.shading == Shading::lit && (look_.medium != Medium::paint || look_.canvas > 0))
      put_on_ground(frame, view);
  }

  void put_on_ground(Frame& frame, const View& view) {
    if (!medium_) medium_ = ScreenPass("techniques/strokes/medium.glsl", {GL_RGBA32F});
    gl::ensure(on_ground_, "painting on its ground", GL_RGBA32F, view.width(), view.height());
    medium_.set("medium", int(look_.medium) - int(Medium::paint)).set("canvas", look_.canvas);
    medium_.set("scale", float(view.picture_height()) / 720).set("ground", frame.settings.background);
    view.bind();
    medium_.run({&frame.target.color, &frame.target.depth}, {&on_ground_});
    std::swap(frame.target.color, on_ground_);
  }

  /// Z-buffer, and the weighted blur of the moving picture (dos Anjos 2017, Sec. 3.3).
  void draw_nearest(Frame& frame, const View& view, bool blur) {
    const int width = view.width(), height = view.height();
    {
      auto timing = frame.timers.scope("nearest strokes");
      gl::ensure(nearest_, "nearest fragment", GL_RG32UI, width, height);
      gl::ensure(nearest_depth_, "nearest depth", GL_DEPTH_COMPONENT32F, width, height);
      nearest_.clear_uint(no_fragment);
      gl::Program& program = nearest_program_[int(parameters_.stroke_order)];
      if (!program) {
        gl::Defines defines{"STROKE_NEAREST"};
        if (parameters_.stroke_order == StrokeOrder::fragment) defines.push_back("FRAGMENT_ORDER");
        program =
            gl::Program::raster("techniques/strokes/stroke.vert", "techniques/strokes/stroke.frag", defines);
      }
      view.bind();
      gl::Framebuffer framebuffer({&nearest_}, &nearest_depth_);
      framebuffer.bind();
      gl::State{.depth = gl::State::Depth::test_and_write}.apply();
      gl::clear_depth(framebuffer);
      strokes_.draw(program, brush_, 0.5f);
    }
    if (!finish_nearest_)
      finish_nearest_ = ScreenPass("techniques/strokes/finish_paint.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F},
                                   {"PAINT_NEAREST"});
    nearest_.bind(binding::input + 1);
    show_nearest(frame, view, finish_nearest_, blur);
  }

  /// The same blurred picture from the lists, which spares drawing the strokes once more.
  void show_listed(Frame& frame, const View& view) {
    if (!finish_listed_)
      finish_listed_ = ScreenPass("techniques/strokes/finish_paint.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F},
                                  {"PAINT_LISTED"});
    lists_.bind_lists();
    show_nearest(frame, view, finish_listed_, true);
  }

  void show_nearest(Frame& frame, const View& view, ScreenPass& finish_pass, bool blur) {
    {
      auto timing = frame.timers.scope("nearest to paint");
      gl::ensure(albedo_, "albedo", GL_RGBA32F, view.width(), view.height());
      finish_pass.set("relief", look_.relief);
      set_even_light(frame, finish_pass);
      strokes_.records().bind(binding::input);
      view.bind();
      finish_pass.run({}, {&albedo_, &frame.target.depth, &frame.target.normal});
    }
    if (blur && parameters_.blur_radius > 0) soften(frame, view);
    shade(frame, view);
  }

  void soften(Frame& frame, const View& view) {
    auto timing = frame.timers.scope("blur");
    if (!blur_) blur_ = ScreenPass("techniques/strokes/blur.glsl", {GL_RGBA32F, GL_RGBA32F});
    gl::ensure(blurred_albedo_, "blurred albedo", GL_RGBA32F, view.width(), view.height());
    gl::ensure(blurred_normal_, "blurred normals", GL_RGBA32F, view.width(), view.height());
    // Within half a stroke in depth two strokes may be of one surface.
    const float reach = std::max(0.005f * look_.length_percent * float(view.picture_height()), 2.0f);
    blur_.set("sigma", parameters_.blur_radius).set("reach", reach);
    blur_.set("direction", ivec2(1, 0));
    blur_.run({&albedo_, &frame.target.normal, &frame.target.depth}, {&blurred_albedo_, &blurred_normal_});
    blur_.set("direction", ivec2(0, 1));
    blur_.run({&blurred_albedo_, &blurred_normal_, &frame.target.depth}, {&albedo_, &frame.target.normal});
  }

  /// What a half-refined picture depends on.
  struct State {
    std::uint64_t serial;
    int width, height;
    dmat4 clip;
    Parameters parameters;
    RenderSettings settings;
    bool operator==(const State&) const = default;
  };
  State state_of(const Frame& frame) const {
    return {frame.cloud.look_serial(),
            frame.camera.width,
            frame.camera.height,
            frame.camera.projection_matrix() * frame.camera.view(dvec3(0)),
            parameters_,
            frame.settings};
  }
  static void copy(const Target& from, Target& to, const View& view) {
    const ivec2 size(view.width(), view.height());
    gl::ensure(to.color, "kept picture", GL_RGBA32F, size.x, size.y);
    gl::ensure(to.depth, "kept depth", GL_R32F, size.x, size.y);
    gl::ensure(to.normal, "kept normals", GL_RGBA32F, size.x, size.y);
    for (const auto texture : {&Target::color, &Target::depth, &Target::normal})
      gl::copy(from.*texture, ivec2(0), to.*texture, ivec2(0), size);
  }
  void remember(const Frame& frame) {
    state_ = state_of(frame);
    steps_ = 0;
    refining_ = true;
  }
  bool same_frame(const Frame& frame) const { return state_ == state_of(frame); }

  Parameters parameters_;
  Look look_;
  BrushPicture brush_;
  StrokeData data_;
  StrokeSet strokes_;
  StrokeLists lists_;
  gl::Program nearest_program_[2];
  gl::Texture albedo_, nearest_, nearest_depth_, blurred_albedo_, blurred_normal_;
  ScreenPass finish_, finish_nearest_, finish_listed_, blur_, underpaint_, medium_;
  gl::Texture under_albedo_, under_depth_, under_normal_, on_ground_;
  Derived<std::uint64_t, bool> own_colors_;
  ScreenSpacings spacings_;
  Evidence evidence_;
  bool has_evidence_ = false;  ///< of the picture that is refined
  EvidenceReach reach_;
  Shade shade_;
  std::vector<std::string> notes_;
  bool refining_ = false;
  Target blurred_;  ///< what is shown until enough is sorted
  int steps_ = 0;
  std::optional<State> state_;
};

}  // namespace

TechniqueInfo strokes_technique() {
  return {"strokes", "a painting: brush strokes along the surface",
          [] { return std::unique_ptr<Technique>(new Strokes); }};
}

}  // namespace sfumato
