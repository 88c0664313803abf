#include "session/opening.h"

#include "core/error.h"
#include "session/standpoint.h"

namespace sfumato {

Opening::Opening(const Request& request, const std::vector<scene::SceneFile>& files, Progress& progress)
    : request_(request) {
  const scene::SceneOptions options = request.scene_options();
  leveled_ = scene::LeveledScene::open(files, options, request.memory);
  scene_ = leveled_ ? read_overview({}, progress) : scene::read_scene(files, options, progress);
  find_pose(progress);
}

Opening::Opening(const Request& request, scene::LeveledScene files, Progress& progress,
                 std::optional<scene::Scene> all)
    : request_(request), leveled_(std::move(files)) {
  scene_ = read_overview(std::move(all), progress);
  find_pose(progress);
}

Opening::Opening(const Request& request, scene::LeveledScene files, Pose pose)
    : request_(request), leveled_(std::move(files)), pose_(std::move(pose)) {
  check_levels();
}

Opening::Opening(const Request& request, scene::Scene scene, Progress& progress)
    : request_(request), scene_(std::move(scene)) {
  find_pose(progress);
}

scene::Scene Opening::read_overview(std::optional<scene::Scene> all, Progress& progress) {
  check_levels();
  return leveled_->overview(progress, std::move(all));
}

void Opening::check_levels() const {
  for (const auto& [option, given] :
       {std::pair("vertical exaggeration", request_.vertical_exaggeration() != 1),
        {"an index picture", !request_.output_index.empty()}})
    if (given)
      throw Error(ErrorCode::usage, std::string(option) +
                                        " needs all points in memory, and files are larger: give more "
                                        "memory or crop");
}

void Opening::find_pose(Progress& progress) {
  progress.check();
  pose_ =
      stand_upright(scene_, request_.points.up, !request_.whole, request_.vertical_exaggeration(), progress);
  progress.check();
  if (!request_.furniture.unit.empty()) pose_.unit = unit_named(request_.furniture.unit);
  place_ = sfumato::place_inside(scene_.cloud);
  request_.points.metres = scene_.metres;
}

void Opening::keep_nodes() {
  if (leveled_ && !leveled_->keeps_nodes())
    leveled_->keep_nodes(std::make_shared<io::ChunkCache>(request_.memory / scene::share_of_kept_nodes));
}

Camera Opening::camera() const {
  Camera camera = view_of(pose_, request_.view);
  return request_.panorama && !request_.view.position && !request_.view.start ? inside(camera) : camera;
}

Camera Opening::inside(Camera camera) const {
  const dvec3 direction = camera.direction();
  camera.position = place_;
  camera.target = camera.position + direction;
  return camera;
}

bool Opening::holds(std::span<const Camera> cameras, bool has_shadows) const {
  return !leveled_ || leveled_->select(copc::views_of(cameras, request_.panorama), has_shadows).is_complete();
}

scene::Scene Opening::read(const copc::NodeSelection& nodes, Progress& progress) const {
  scene::Scene scene = leveled_->read(nodes, progress);
  scene.cloud.up = pose_.upright.up;
  return scene;
}

scene::Scene Opening::read(std::span<const Camera> cameras, bool has_shadows, Progress& progress) const {
  return read(leveled_->select(copc::views_of(cameras, request_.panorama), has_shadows), progress);
}

scene::Scene Opening::read_next(const std::vector<scene::SceneFile>& files, const Camera& camera,
                                bool has_shadows, Progress& progress) const {
  const scene::SceneOptions options = request_.scene_options();
  const auto leveled = scene::LeveledScene::open(files, options, request_.memory);
  scene::Scene scene =
      leveled ? leveled->read(copc::views_of({&camera, 1}, request_.panorama), has_shadows, progress)
              : scene::read_scene(files, options, progress);
  scene.cloud.up = pose_.upright.up;
  if (request_.vertical_exaggeration() != 1) exaggerate(scene.cloud, request_.vertical_exaggeration());
  return scene;
}

}  // namespace sfumato
