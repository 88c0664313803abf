#include "sfumato/renderer.h"

#include "analysis/prepare.h"
#include "core/error.h"
#include "techniques/renderer.h"

namespace sfumato {

struct HeadlessRenderer::State {
  std::unique_ptr<gl::Context> context = gl::Context::create_headless();
  Renderer renderer{*context};
  bool has_cloud = false;
  Bounds box;
  UpAxis up = UpAxis::pos_z;
};

HeadlessRenderer::HeadlessRenderer() : state_(std::make_unique<State>()) {}
HeadlessRenderer::~HeadlessRenderer() = default;

void HeadlessRenderer::set_cloud(PointCloud cloud, const ColorSettings& coloring, Progress& progress) {
  if (cloud.empty()) throw Error(ErrorCode::bad_input, "the cloud has no points to render");
  state_->box = robust_bounds(cloud);
  state_->up = cloud.up;
  Attributes needs;
  if (coloring.color_by == "normal") needs = needs | Attribute::normal;
  PreparedCloud prepared = analysis::prepare(std::move(cloud), needs, {}, progress);
  std::vector<Rgba8> colors = color_points(prepared.cloud, coloring).colors;
  state_->renderer.set_cloud(std::move(prepared), std::move(colors));
  state_->has_cloud = true;
}

Camera HeadlessRenderer::first_view(int width, int height) const {
  return frame(state_->box, state_->up, width, height, glm::radians(-45.0), glm::radians(30.0));
}

Pictures HeadlessRenderer::render(const std::string& name, const Camera& camera, const Parameters& parameters,
                                  std::optional<vec3> background, Progress& progress) {
  if (!state_->has_cloud) throw Error(ErrorCode::usage, "nothing to render: call set_cloud first");
  const std::unique_ptr<Technique> technique = find_technique(name).create();
  RenderSettings settings;
  settings.transparent = !background;
  settings.background = background.value_or(vec3(1));
  ParamList own, shared;
  technique->describe(own);
  settings.describe(shared);
  for (const auto& [key, value] : parameters) {
    Param* param = own.find(key) ? own.find(key) : shared.find(key);
    if (!param) {
      std::vector<std::string> names;
      for (const ParamList* list : {&own, &shared})
        for (const Param& each : list->all()) names.push_back(each.name);
      const std::string near = nearest_word(key, names);
      throw Error(ErrorCode::usage, "the technique " + name + " has no parameter '" + key + "'" +
                                        (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    param->set(value);
  }
  settings.edl.resolve(technique->wants_edl());
  settings.smooth_outlines.resolve(settings.samples == 1 && !technique->has_soft_edges());
  analysis::complete(state_->renderer.prepared(), technique->needs(), {}, progress);
  RenderWants wants;
  wants.color_linear = wants.depth = wants.normal = true;
  RenderOutput out = state_->renderer.render(*technique, camera, settings, wants, progress);
  return {std::move(out.rgba8), std::move(out.color_linear), std::move(out.depth), std::move(out.normal)};
}

std::vector<std::string> HeadlessRenderer::techniques() {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : all_techniques()) names.push_back(info.name);
  return names;
}

}  // namespace sfumato
