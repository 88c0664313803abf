// Scenes seen and sampled so that the truth is known: one point per block of pixels on what the camera sees,
// and about as many on what it does not see.
#pragma once

#include <algorithm>
#include <sstream>

#include "reference/gl_fixture.h"
#include "synth/synth.h"

namespace sfumato::testing {

inline Camera scene_camera(const std::string& name, int width, int height) {
  Camera camera = front_camera(width, height);
  if (name == "spheres") camera.position = {-3.2, -4.6, 2.6}, camera.target = {0, 0, 0.7};
  if (name == "tori") camera.position = {0.6, -2.9, 2.0}, camera.target = {0, 0, 0};
  const synth::Scene scene = synth::make_scene(name);
  if (name == "room" || name == "courtyard")
    camera = (scene.held_out ? *scene.held_out : scene.cameras.at(0)).resized(width, height);
  camera.fit_depth_range(scene.box);
  return camera;
}

inline Camera turned(const Camera& camera, double angle, double rise) {
  Camera other = camera;
  const dvec3 from = camera.position - camera.target;
  other.position = camera.target + dvec3(std::cos(angle) * from.x - std::sin(angle) * from.y,
                                         std::sin(angle) * from.x + std::cos(angle) * from.y, from.z + rise);
  return other;
}

/// Truth along the ray of a world position: depth there, and the position's own depth. False when outside.
inline bool seen_at(const Camera& camera, const Image<float>& depth, const dvec3& world, double& own,
                    double& seen) {
  const dvec3 eye(camera.view() * glm::dvec4(world, 1));
  const Intrinsics k = camera.intrinsics();
  own = -eye.z;
  if (own <= 0) return false;
  const double x = k.fx * eye.x / own + k.cx, y = -k.fy * eye.y / own + k.cy;
  if (x < 0 || y < 0 || x >= depth.width() || y >= depth.height()) return false;
  seen = depth.at(int(x), int(y));
  return true;
}

inline PointCloud scene_cloud(const std::string& name, const Camera& camera, int block) {
  const synth::Scene scene = synth::make_scene(name);
  PointCloud cloud = synth::sample_by_camera(scene, {camera}, block, 1);
  std::vector<Camera> others;
  if (scene.cameras.size() > 2) {
    for (const Camera& other : scene.cameras) others.push_back(other.resized(camera.width, camera.height));
  } else {
    for (double angle : {1.2, 2.4, 3.6, 4.8}) others.push_back(turned(camera, angle, angle > 3 ? -3 : 1));
  }
  const PointCloud around = synth::sample_by_camera(scene, others, block, 2);
  const Image<float> depth = synth::truth(scene, camera).depth;
  std::vector<std::uint32_t> unseen;
  for (std::size_t i = 0; i < around.size(); ++i) {
    double own = 0, seen = 0;
    if (!seen_at(camera, depth, around.world(i), own, seen) || own > seen * 1.01)
      unseen.push_back(std::uint32_t(i));
  }
  append(cloud, select(around, unseen));
  cloud.source_index.clear();
  return cloud;
}

/// Shares of the truth's pixels unless said otherwise. A spacing is block pixels at the truth's depth.
struct Deviation {
  double filled = 0, deeper = 0, nearer = 0;
  double background_per_outline = 0;  ///< filled background pixels / length of the outline, px
  double median_depth_spacings = 0, median_normal_deg = 0;
};
inline std::string to_string(const Deviation& d) {
  std::ostringstream text;
  text << "filled " << 100 * d.filled << " %, deeper " << 100 * d.deeper << " %, nearer " << 100 * d.nearer
       << " %, background " << d.background_per_outline << " px of outline, depth " << d.median_depth_spacings
       << " spacings, normals " << d.median_normal_deg << " deg";
  return text.str();
}

inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

inline Deviation deviation(const synth::Truth& truth, const RenderOutput& out, const Camera& camera,
                           int block) {
  const int w = camera.width, h = camera.height;
  std::size_t seen = 0, filled = 0, deeper = 0, nearer = 0, spilled = 0, outline = 0;
  std::vector<double> depth_errors, normal_errors;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float expected = truth.depth.at(x, y), actual = out.depth.at(x, y);
      if (std::isinf(expected)) {
        spilled += !std::isinf(actual);
        continue;
      }
      ++seen;
      bool edge = false, outer = false;
      for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx) {
          const int nx = x + dx, ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= w || ny >= h) continue;
          const bool sky = std::isinf(truth.depth.at(nx, ny));
          if (sky && std::abs(dx) + std::abs(dy) == 1) outer = true;
          // An edge: a jump of depth or a fold within reach of the patch a normal is taken from.
          if (sky || std::abs(truth.depth.at(nx, ny) - expected) > 0.1 * expected ||
              glm::dot(truth.normal.at(nx, ny), truth.normal.at(x, y)) < 0.8f)
            edge = true;
        }
      outline += outer;
      if (std::isinf(actual)) continue;
      ++filled;
      const double spacing = block * expected / camera.pixels_per_unit();
      const double error = actual - expected;
      deeper += error > 5 * spacing;
      nearer += error < -5 * spacing;
      depth_errors.push_back(std::abs(error) / spacing);
      if (!edge)
        normal_errors.push_back(glm::degrees(
            std::acos(std::clamp(double(glm::dot(out.normal.at(x, y), truth.normal.at(x, y))), -1.0, 1.0))));
    }
  Deviation d;
  d.filled = double(filled) / double(seen);
  d.deeper = double(deeper) / double(seen);
  d.nearer = double(nearer) / double(seen);
  d.background_per_outline = outline ? double(spilled) / double(outline) : 0;
  d.median_depth_spacings = median(depth_errors);
  d.median_normal_deg = median(normal_errors);
  return d;
}

inline Deviation deviation_from_truth(const std::string& name, const Camera& camera, int block,
                                      gl::Context& context) {
  Renderer renderer(context);
  auto technique = find_technique("surface").create();
  show(renderer, scene_cloud(name, camera, block), {});
  RenderSettings settings;
  settings.transparent = true;
  const RenderOutput out = renderer.render(*technique, camera, settings, all_outputs());
  return deviation(synth::truth(synth::make_scene(name), camera), out, camera, block);
}

}  // namespace sfumato::testing
