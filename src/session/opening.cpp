#include "session/opening.h"

#include "core/error.h"
#include "session/standpoint.h"

namespace sfumato {

Opening::Opening(const Request& request, std::vector<scene::SceneFile> files, Progress& progress)
    : request_(request) {
  const scene::SceneOptions options = request.scene_options();
  leveled_ = scene::LeveledScene::open(files, options, request.memory);
  if (leveled_ && request.vertical_exaggeration() != 1)
    throw Error(
        ErrorCode::usage,
        "--vertical-exaggeration needs all points in memory, and files are larger: raise --memory or crop");
  if (leveled_ && !request.output_index.empty())
    throw Error(ErrorCode::usage,
                "--output-index needs all points in memory, and files are larger: raise --memory or crop");
  scene_ = leveled_ ? leveled_->overview(progress) : scene::read_scene(files, options, progress);
  progress.check();
  pose_ = stand_upright(scene_, options.up, !request.whole, request.vertical_exaggeration(), progress);
  progress.check();
  if (!request.furniture.unit.empty()) pose_.unit = unit_named(request.furniture.unit);
  if (request.panorama && !request.view.position && !request.view.start) place_ = place_inside(scene_.cloud);
  request_.points.metres = scene_.metres;
}

void Opening::keep_nodes() {
  if (leveled_ && !leveled_->keeps_nodes())
    leveled_->keep_nodes(std::make_shared<io::ChunkCache>(request_.memory / scene::share_of_kept_nodes));
}

Camera Opening::camera() const {
  Camera camera = view_of(pose_, request_.view);
  if (!place_) return camera;
  const dvec3 direction = camera.direction();
  camera.position = *place_;
  camera.target = camera.position + direction;
  return camera;
}

bool Opening::holds(std::span<const Camera> cameras, bool has_shadows) const {
  return !leveled_ || leveled_->select(copc::views_of(cameras, request_.panorama), has_shadows).is_complete();
}

scene::Scene Opening::read(std::span<const Camera> cameras, bool has_shadows, Progress& progress) const {
  scene::Scene scene = leveled_->read(copc::views_of(cameras, request_.panorama), has_shadows, progress);
  scene.cloud.up = pose_.upright.up;
  return scene;
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
