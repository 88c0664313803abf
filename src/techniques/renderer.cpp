#include "techniques/renderer.h"

#include <chrono>

#include "core/error.h"
#include "passes/finish.h"
#include "passes/ground.h"
#include "passes/screen_pass.h"
#include "passes/shadows.h"

namespace sfumato {
namespace {

/// What is drawn, and how, for each of the samples of a picture.
struct Shot {
  Technique& technique;
  const RenderSettings& settings;
  gl::Timers& timers;
  Progress& progress;
  bool with_edl, with_smooth_outlines;
  bool wants_normal = false;
  bool may_finish = false;   ///< nobody reads the target: the technique may write the finished picture itself
  bool is_finished = false;  ///< it did
};

/// The base-2 radical inverse.
double van_der_corput(unsigned i) {
  double value = 0;
  for (double digit = 0.5; i > 0; i >>= 1, digit *= 0.5) value += digit * (i & 1);
  return value;
}

/// The camera seen through another place of its pixels: one in each row and column of a grid over the pixel (for four
/// samples the rotated grid), their mean the centre where `samples` is a power of two.
Camera jittered(const Camera& camera, int sample, int samples) {
  const double x = (sample + 0.5) / samples - 0.5;
  const double inverse = van_der_corput(unsigned(sample));
  const double y = (inverse < 0.5 ? inverse : inverse - 1) + 0.5 / samples;  // half a turn: no two on a diagonal
  Camera out = camera;
  Intrinsics inside = camera.intrinsics();
  inside.cx += x;
  inside.cy += y;
  out.custom_intrinsics = inside;
  return out;
}

/// What depth is resolved for: everything within a hundred diagonals of most points, so that one stray point a billion
/// times farther out costs nobody else.
Bounds depth_bounds(const PointCloud& cloud) {
  const Bounds all = bounds(cloud), most = robust_bounds(cloud);
  const double reach = 100 * most.diagonal();
  if (reach == 0) return all;  // most points in one place have no size to measure by
  return {glm::max(all.min, most.min - reach), glm::min(all.max, most.max + reach)};
}

}  // namespace

struct Renderer::State {
  gl::Context& context;
  PreparedCloud prepared;
  std::optional<Room> room;
  Bounds depth_bounds;
  std::unique_ptr<GpuCloud> cloud;
  Attributes uploaded;
  Target target;
  gl::Texture finish_scratch, ground_factor, rgba8, linear;
  EyeDomeLighting edl;
  ShadowMaps shadows;
  GroundPlane ground;
  SmoothOutlines outlines;
  Finish finish;
  ScreenPass add_sample;
  gl::Texture sum, averaged;
  explicit State(gl::Context& c) : context(c) {}

  /// One picture through pixel centres (of a camera that may be jittered) into `target`.
  void draw(Shot& shot, const Camera& camera);
  /// Adds the target's colour, a share of the whole.
  void average(int sample, int samples, gl::Timers& timers);
};

void Renderer::State::average(int sample, int samples, gl::Timers& timers) {
  auto timing = timers.scope("average");
  for (gl::Texture* each : {&sum, &averaged})
    gl::ensure(*each, "samples", GL_RGBA32F, target.color.width(), target.color.height());
  if (!add_sample) add_sample = ScreenPass("techniques/add_sample.glsl", {GL_RGBA32F});
  add_sample.set("share", 1.0f / float(samples)).set("is_first", sample == 0);
  add_sample.run({&sum, &target.color}, {&averaged});
  if (sample + 1 < samples) std::swap(sum, averaged);
}

void Renderer::State::draw(Shot& shot, const Camera& camera) {
  const RenderSettings& settings = shot.settings;
  const View view(camera, prepared.cloud.origin);
  const bool has_shadows = settings.shadows != Shadows::off && !cloud->prepared().cloud.empty();
  Light light = Light::parse(settings.light_text);
  Ground ground_plane;
  if (has_shadows) {
    // The shadows of a headlight are hidden behind what casts them: let it shine over the left shoulder.
    if (light.kind == Light::Kind::headlight) light = key_light(camera, prepared.cloud.up);
    shot.technique.cast(*cloud, shot.progress);
    const bool on_ground = settings.ground;
    if (on_ground) {
      ground_plane = ground_below(prepared.cloud);
      gl::ensure(ground_factor, "ground shadow", GL_R32F, camera.width, camera.height);
    }
    shadows.update(*cloud, settings, light, shot.timers, shot.progress, on_ground ? &view : nullptr, ground_plane,
                   on_ground ? &ground_factor : nullptr);
  } else {
    shadows.clear(*cloud);
  }

  Frame frame{*cloud, camera, settings, light, target, shot.wants_normal, shot.timers, shot.progress};
  const bool is_followed = shot.with_edl || shot.with_smooth_outlines || (has_shadows && settings.ground);
  if (shot.may_finish && !is_followed) frame.finished = &rgba8;
  while (!shot.technique.render(frame)) shot.progress.check();
  shot.is_finished = frame.is_finished;

  if (has_shadows && settings.ground) {
    auto timing = shot.timers.scope("ground");
    gl::ensure(finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    ground.run(view, ground_plane, prepared.cloud.origin, target.color, target.depth, ground_factor, finish_scratch);
    std::swap(finish_scratch, target.color);
  }
  if (shot.with_edl) {
    auto timing = shot.timers.scope("eye-dome lighting");
    gl::ensure(finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    this->edl.run(view, settings, target.color, target.depth, finish_scratch);
    std::swap(finish_scratch, target.color);
  }
  if (shot.with_smooth_outlines) {
    auto timing = shot.timers.scope("smooth outlines");
    gl::ensure(finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    outlines.run(view, target.color, target.depth, finish_scratch);
    std::swap(finish_scratch, target.color);
  }
}

Renderer::Renderer(gl::Context& context) : state_(std::make_unique<State>(context)) {}
Renderer::~Renderer() = default;

void Renderer::set_cloud(PreparedCloud cloud, std::vector<Rgba8> colors, std::uint32_t max_chunk_points) {
  state_->cloud.reset();
  state_->room.reset();
  state_->prepared = std::move(cloud);
  state_->depth_bounds = depth_bounds(state_->prepared.cloud);
  state_->cloud = std::make_unique<GpuCloud>(state_->prepared, std::move(colors), max_chunk_points);
  state_->uploaded = state_->prepared.available;
}

void Renderer::set_room(std::optional<Room> room) { state_->room = std::move(room); }

void Renderer::set_colors(std::vector<Rgba8> colors) { state_->cloud->set_colors(std::move(colors)); }

const std::vector<Rgba8>& Renderer::colors() const { return state_->cloud->colors(); }

PreparedCloud& Renderer::prepared() { return state_->prepared; }
const PreparedCloud& Renderer::prepared() const { return state_->prepared; }

RenderOutput Renderer::render(Technique& technique, const Camera& asked, const RenderSettings& settings,
                              const RenderWants& wants, Progress& progress) {
  State& s = *state_;
  if (!technique.shows(settings.shading))
    throw Error(ErrorCode::usage, "this technique cannot show that shading: occlusion and hidden belong to surface, weight "
                                  "to denoise; use that technique, or another shading");
  if (!(s.uploaded == s.prepared.available)) {
    s.cloud->attributes_changed();
    s.uploaded = s.prepared.available;
  }
  s.cloud->show_to(technique.needs());
  Camera camera = asked;
  std::vector<vec4> cut;
  if (s.room)
    for (const glm::dvec4& wall : walls_before(*s.room, camera))
      cut.push_back(vec4(dvec3(wall), wall.w + glm::dot(dvec3(wall), s.prepared.cloud.origin)));
  s.cloud->set_cut(std::move(cut));
  // Who looks at a stray point gets its depth as well.
  const Bounds all = s.cloud->bounds();
  const dvec3 target = glm::clamp(camera.target, all.min, all.max);
  camera.fit_depth_range({glm::min(s.depth_bounds.min, target), glm::max(s.depth_bounds.max, target)});
  if (!s.target.color || s.target.color.width() != camera.width || s.target.color.height() != camera.height)
    s.target = Target(camera.width, camera.height);

  RenderOutput out;
  gl::Timers timers(wants.timings);
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  const bool plain = settings.shading != Shading::lit && settings.shading != Shading::albedo;
  Auto<bool> edl = settings.edl;
  const bool with_edl = edl.resolve(technique.wants_edl()) && !plain;
  const int samples = std::max(1, settings.samples);
  if (wants.color) gl::ensure(s.rgba8, "finished picture", GL_RGBA8, camera.width, camera.height);

  // `auto` was resolved by those who ask for a finished picture: a frame in motion stays as it is.
  Shot shot{technique, settings, timers, progress, with_edl, settings.smooth_outlines.value() && !plain};
  if (samples == 1) {
    shot.wants_normal = wants.normal;
    shot.may_finish = wants.color && !wants.color_linear && !wants.depth && !wants.normal;
    s.draw(shot, camera);
  } else {
    for (int i = 0; i < samples; ++i) {
      s.draw(shot, jittered(camera, i, samples));
      s.average(i, samples, timers);
    }
    // Depths and normals are those of pixel centres.
    if (wants.depth || wants.normal) {
      shot.wants_normal = wants.normal;
      s.draw(shot, camera);
    }
  }
  const gl::Texture& color = samples == 1 ? s.target.color : s.averaged;
  if (wants.color && !shot.is_finished) {
    auto timing = timers.scope("finish");
    s.finish.run(settings, color, s.rgba8);
  }
  glFinish();
  out.total_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  for (auto& [name, ms] : timers.results()) out.timings.push_back({name, ms});

  if (wants.color) out.rgba8 = s.rgba8.download<Rgba8>();
  if (wants.color_linear) {
    gl::ensure(s.linear, "linear picture", GL_RGBA32F, camera.width, camera.height);
    s.finish.run_linear(settings, color, s.linear);
    out.color_linear = s.linear.download<vec4>();
  }
  if (wants.depth) out.depth = s.target.depth.download<float>();
  if (wants.normal) out.normal = s.target.normal.download<vec3>();
  out.points_drawn = s.cloud->cull(View(camera, s.prepared.cloud.origin));
  out.notes = technique.notes();
  return out;
}

}  // namespace sfumato
