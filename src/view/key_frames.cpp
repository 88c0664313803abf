#include "view/key_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/atomic_writer.h"
#include "io/camera_json.h"

namespace sfumato::view {

void KeyFrames::remove(std::size_t i) {
  if (i < keys_.size()) keys_.erase(keys_.begin() + std::ptrdiff_t(i));
}

void KeyFrames::replace(std::size_t i, const ViewCamera& camera) {
  if (i < keys_.size()) keys_[i] = camera;
}

void KeyFrames::move(std::size_t from, std::size_t to) {
  if (from >= keys_.size() || to >= keys_.size()) return;
  const ViewCamera key = keys_[from];
  keys_.erase(keys_.begin() + std::ptrdiff_t(from));
  keys_.insert(keys_.begin() + std::ptrdiff_t(to), key);
}

ViewCamera KeyFrames::at(double seconds) const {
  if (keys_.size() < 2) return keys_.front();
  const double place = std::clamp(seconds / duration_s(), 0.0, 1.0) * double(keys_.size() - 1);
  std::vector<Camera> cameras;
  for (const ViewCamera& key : keys_) cameras.push_back(key.to_camera(1280, 720));
  ViewCamera camera = ViewCamera::from(interpolated(cameras, place));
  camera.orthographic = keys_[std::min(std::size_t(place), keys_.size() - 2)].orthographic;
  return camera;
}

std::string KeyFrames::json(int width, int height) const {
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (const ViewCamera& key : keys_)
    cameras.push_back(nlohmann::ordered_json::parse(io::camera_to_json(key.to_camera(width, height))));
  return nlohmann::ordered_json{{"cameras", cameras}}.dump(2) + "\n";
}

void KeyFrames::save(const std::filesystem::path& file, int width, int height) const {
  io::AtomicWriter writer(file);
  writer.write(json(width, height));
  writer.commit();
}

void KeyFrames::load(const std::filesystem::path& file) {
  std::vector<ViewCamera> keys;
  for (const Camera& camera : io::read_camera_path(file).cameras) keys.push_back(ViewCamera::from(camera));
  keys_ = std::move(keys);
}

}  // namespace sfumato::view
