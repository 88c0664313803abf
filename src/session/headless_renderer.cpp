#include "sfumato/renderer.h"

#include "core/error.h"
#include "session/session.h"

namespace sfumato {

struct HeadlessRenderer::State {
  std::unique_ptr<gl::Context> context = gl::Context::create_headless();
  Session session{*context};
  ~State() { forget_look(); }
  /// What a technique holds on the GPU goes where it was made.
  void forget_look() {
    const gl::Context::Use use(*context);
    look.reset();
  }
  std::unique_ptr<Look> look;  ///< of the last picture: another one of the same technique needs nothing made anew
};

HeadlessRenderer::HeadlessRenderer() : state_(std::make_unique<State>()) {}
HeadlessRenderer::~HeadlessRenderer() = default;

void HeadlessRenderer::set_cloud(PointCloud cloud, const ColorSettings& coloring, Progress& progress) {
  if (cloud.empty()) throw Error(ErrorCode::bad_input, "the cloud has no points to render");
  scene::Scene scene;
  scene.cloud = std::move(cloud);
  state_->forget_look();  // what it holds of the last cloud is of no use for this one
  // What the caller says is up is up.
  Pose pose = stand_upright(scene, "", scene.cloud.up);
  state_->session.set_scene(std::move(scene), std::move(pose), {{}, coloring, {}},
                            [](const Session::Suggest&) { return Attributes(); }, progress);
}

Camera HeadlessRenderer::first_view(int width, int height) const {
  return state_->session.first_view(width, height);
}

Pictures HeadlessRenderer::render(const std::string& name, const Camera& camera, const Parameters& parameters,
                                  std::optional<vec3> background, Progress& progress) {
  if (state_->session.empty()) throw Error(ErrorCode::usage, "nothing to render: call set_cloud first");
  std::unique_ptr<Look>& look = state_->look;
  if (look && look->name != name) state_->forget_look();
  if (!look) look = std::make_unique<Look>(name);
  look->reset();
  for (const auto& [key, value] : parameters) look->set(key, value);
  look->settings.transparent = !background;
  state_->session.set_background(background.value_or(vec3(1)));
  RenderWants wants;
  wants.color_linear = wants.depth = wants.normal = true;
  RenderOutput out = state_->session.render(*look, camera, wants, progress);
  return {std::move(out.rgba8), std::move(out.color_linear), std::move(out.depth), std::move(out.normal)};
}

std::vector<std::string> HeadlessRenderer::techniques() {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : all_techniques()) names.push_back(info.name);
  return names;
}

}  // namespace sfumato
