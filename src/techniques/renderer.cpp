#include "techniques/renderer.h"

#include <chrono>

#include "core/error.h"
#include "passes/finish.h"
#include "passes/ground.h"
#include "passes/shadows.h"

namespace sfumato {

struct Renderer::State {
  gl::Context& context;
  PreparedCloud prepared;
  std::unique_ptr<GpuCloud> cloud;
  Attributes uploaded;
  Target target;
  gl::Texture finish_scratch, ground_factor, rgba8, linear;
  EyeDomeLighting edl;
  ShadowMaps shadows;
  GroundPlane ground;
  Finish finish;
  explicit State(gl::Context& c) : context(c) {}
};

Renderer::Renderer(gl::Context& context) : state_(std::make_unique<State>(context)) {}
Renderer::~Renderer() = default;

void Renderer::set_cloud(PreparedCloud cloud, std::vector<Rgba8> colors, std::uint32_t max_chunk_points) {
  state_->cloud.reset();
  state_->prepared = std::move(cloud);
  state_->cloud = std::make_unique<GpuCloud>(state_->prepared, std::move(colors), max_chunk_points);
  state_->uploaded = state_->prepared.available;
}

void Renderer::set_colors(std::vector<Rgba8> colors) { state_->cloud->set_colors(std::move(colors)); }

PreparedCloud& Renderer::prepared() { return state_->prepared; }

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
  camera.fit_depth_range(s.cloud->bounds());
  if (!s.target.color || s.target.color.width() != camera.width || s.target.color.height() != camera.height)
    s.target = Target(camera.width, camera.height);

  RenderOutput out;
  gl::Timers timers(wants.timings);
  const View view(camera, s.prepared.cloud.origin);
  glFinish();
  const auto start = std::chrono::steady_clock::now();

  const bool has_shadows = settings.shadows != Shadows::off && !s.cloud->prepared().cloud.empty();
  Light light = Light::parse(settings.light_text);
  Ground ground;
  if (has_shadows) {
    // The shadows of a headlight are hidden behind what casts them: let it shine over the left shoulder.
    if (light.kind == Light::Kind::headlight) light = key_light(camera, s.prepared.cloud.up);
    technique.cast(*s.cloud, progress);
    const bool on_ground = settings.ground;
    if (on_ground) {
      ground = ground_below(s.prepared.cloud);
      gl::ensure(s.ground_factor, "ground shadow", GL_R32F, camera.width, camera.height);
    }
    s.shadows.update(*s.cloud, settings, light, timers, progress, on_ground ? &view : nullptr, ground,
                     on_ground ? &s.ground_factor : nullptr);
  } else {
    s.shadows.clear(*s.cloud);
  }

  Auto<bool> edl = settings.edl;
  const bool plain = settings.shading != Shading::lit && settings.shading != Shading::albedo;
  const bool with_edl = edl.resolve(technique.wants_edl()) && !plain;
  const bool reads_target = wants.color_linear || wants.depth || wants.normal || (has_shadows && settings.ground);
  if (wants.color) gl::ensure(s.rgba8, "finished picture", GL_RGBA8, camera.width, camera.height);

  Frame frame{*s.cloud, camera, settings, light, s.target, wants.normal, timers, progress};
  if (wants.color && !with_edl && !reads_target) frame.finished = &s.rgba8;
  while (!technique.render(frame)) progress.check();

  if (has_shadows && settings.ground) {
    auto timing = timers.scope("ground");
    gl::ensure(s.finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    s.ground.run(view, ground, s.prepared.cloud.origin, s.target.color, s.target.depth, s.ground_factor,
                 s.finish_scratch);
    std::swap(s.finish_scratch, s.target.color);
  }

  if (with_edl) {
    auto timing = timers.scope("eye-dome lighting");
    gl::ensure(s.finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    s.edl.run(view, settings, s.target.color, s.target.depth, s.finish_scratch);
    std::swap(s.finish_scratch, s.target.color);
  }
  if (wants.color && !frame.is_finished) {
    auto timing = timers.scope("finish");
    s.finish.run(settings, s.target.color, s.rgba8);
  }
  glFinish();
  out.total_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  for (auto& [name, ms] : timers.results()) out.timings.push_back({name, ms});

  if (wants.color) out.rgba8 = s.rgba8.download<Rgba8>();
  if (wants.color_linear) {
    gl::ensure(s.linear, "linear picture", GL_RGBA32F, camera.width, camera.height);
    s.finish.run_linear(settings, s.target.color, s.linear);
    out.color_linear = s.linear.download<vec4>();
  }
  if (wants.depth) out.depth = s.target.depth.download<float>();
  if (wants.normal) out.normal = s.target.normal.download<vec3>();
  out.points_drawn = s.cloud->cull(view);
  out.notes = technique.notes();
  return out;
}

}  // namespace sfumato
