#include "view/key_frames.h"

#include <algorithm>
#include <cmath>
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
  // `interpolate` takes a number of frames; the share of the way is one of so many that none is missed on a
  // screen.
  constexpr int steps = 4096;
  const double share = std::clamp(seconds / duration_s(), 0.0, 1.0);
  const double place = share * double(keys_.size() - 1);
  const std::size_t k = std::min(std::size_t(place), keys_.size() - 2);
  // Only the four keys around decide; the ends of the path are repeated, as `interpolate` does.
  std::vector<Camera> around;
  for (int i = -1; i <= 2; ++i) {
    const std::ptrdiff_t j =
        std::clamp<std::ptrdiff_t>(std::ptrdiff_t(k) + i, 0, std::ptrdiff_t(keys_.size()) - 1);
    around.push_back(keys_[std::size_t(j)].to_camera(1280, 720));
  }
  const std::vector<Camera> fine = interpolate(around, 3 * steps + 1);
  const int step = int(std::lround((place - double(k)) * steps));
  ViewCamera camera = ViewCamera::from(fine[std::size_t(steps + step)]);
  camera.orthographic = keys_[k].orthographic;
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
