#include "techniques/renderer.h"

#include <chrono>

#include "passes/finish.h"

namespace sfumato {

struct Renderer::State {
  gl::Context& context;
  PreparedCloud prepared;
  std::unique_ptr<GpuCloud> cloud;
  Attributes uploaded;
  Target target;
  gl::Texture finish_scratch, rgba8, linear;
  EyeDomeLighting edl;
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
  if (!(s.uploaded == s.prepared.available)) {
    s.cloud->attributes_changed();
    s.uploaded = s.prepared.available;
  }
  Camera camera = asked;
  camera.fit_depth_range(s.cloud->bounds());
  if (!s.target.color || s.target.color.width() != camera.width || s.target.color.height() != camera.height)
    s.target = Target(camera.width, camera.height);

  RenderOutput out;
  gl::Timers timers(wants.timings);
  const View view(camera, s.prepared.cloud.origin);
  glFinish();
  const auto start = std::chrono::steady_clock::now();

  Frame frame{*s.cloud, camera, settings, Light::parse(settings.light_text), s.target, wants.normal, timers,
              progress};
  while (!technique.render(frame)) progress.check();

  Auto<bool> edl = settings.edl;
  const bool plain = settings.shading == Shading::normals || settings.shading == Shading::depth;
  if (edl.resolve(technique.wants_edl()) && !plain) {
    auto timing = timers.scope("eye-dome lighting");
    gl::ensure(s.finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    s.edl.run(view, settings, s.target.color, s.target.depth, s.finish_scratch);
    std::swap(s.finish_scratch, s.target.color);
  }
  if (wants.color) {
    auto timing = timers.scope("finish");
    gl::ensure(s.rgba8, "finished picture", GL_RGBA8, camera.width, camera.height);
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
