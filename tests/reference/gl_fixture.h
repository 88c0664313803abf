// What every test with a GL context shares: one context per process, no high-severity driver messages.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "analysis/prepare.h"
#include "core/camera.h"
#include "gl/context.h"
#include "techniques/renderer.h"

namespace sfumato::testing {

/// The context of this process; llvmpipe is enough, so a missing driver is a failure and not a skip.
inline gl::Context& context() {
  static std::unique_ptr<gl::Context> instance = gl::Context::create_headless();
  return *instance;
}

/// Another preference of that context while this lives.
template <class T>
class WithPreference {
 public:
  WithPreference(T gl::Preferences::*which, T value)
      : place_(context().preferences().*which), before_(std::exchange(place_, value)) {}
  ~WithPreference() { place_ = before_; }
  WithPreference(const WithPreference&) = delete;
  WithPreference& operator=(const WithPreference&) = delete;

 private:
  T& place_;
  T before_;
};

class GlTest : public ::testing::Test {
 protected:
  void SetUp() override { context().take_messages(); }
  void TearDown() override {
    for (const std::string& message : context().take_messages()) ADD_FAILURE() << "GL: " << message;
  }

 private:
  const gl::Context::Use current_{context()};  // whatever a test before left current
};

/// Points spread evenly over a unit sphere (Fibonacci lattice) with outward normals and a smooth colour.
inline PointCloud sphere_cloud(std::size_t count, float radius = 1, vec3 center = vec3(0)) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * double(i) + 1) / double(count), angle = 2.399963229728653 * double(i);
    const double ring = std::sqrt(1 - z * z);
    const vec3 n(float(ring * std::cos(angle)), float(ring * std::sin(angle)), float(z));
    cloud.positions.push_back(center + radius * n);
    cloud.normals.push_back(n);
    auto code = [](float v) { return std::uint8_t(127.5f + 127.5f * v); };
    cloud.colors.push_back({code(n.x), code(n.y), code(n.z), 255});
  }
  return cloud;
}

/// A camera that looks at the origin from -Y, slightly above, at `distance`.
inline Camera front_camera(int width, int height, double distance = 4) {
  Camera camera;
  camera.position = {0, -distance, 0.3};
  camera.target = {0, 0, 0};
  camera.width = width;
  camera.height = height;
  return camera;
}

/// A camera that looks at the origin from `position`, z up.
inline Camera camera_at(dvec3 position, int width, int height, double fov_deg = 45) {
  Camera camera;
  camera.position = position;
  camera.target = {0, 0, 0};
  camera.fov_y = glm::radians(fov_deg);
  camera.width = width;
  camera.height = height;
  return camera;
}

/// An orthographic camera `height` above the origin that looks down on a square of `side` units and `pixels`
/// pixels.
inline Camera camera_above(double height, double side, int pixels) {
  Camera camera;
  camera.position = {0, 0, height};
  camera.up = {0, 1, 0};
  camera.projection = Projection::orthographic;
  camera.height_world = side;
  camera.width = camera.height = pixels;
  return camera;
}

inline std::vector<Rgba8> colors_of(const PointCloud& cloud, Rgba8 fallback = {180, 180, 180, 255}) {
  return cloud.colors.empty() ? std::vector<Rgba8>(cloud.size(), fallback) : cloud.colors;
}

/// Sorts and completes a cloud, uploads it.
inline void show(Renderer& renderer, PointCloud cloud, Attributes needs, std::uint32_t max_chunk_points = 0) {
  PreparedCloud prepared = analysis::prepare(std::move(cloud), needs, {});
  std::vector<Rgba8> colors = colors_of(prepared.cloud);
  renderer.set_cloud(std::move(prepared), std::move(colors), max_chunk_points);
}

inline RenderWants all_outputs() {
  RenderWants wants;
  wants.color_linear = wants.depth = wants.normal = true;
  return wants;
}

/// Parameters of a technique and the shared settings, ready to be set by name.
inline void set_parameter(Technique& technique, const std::string& name, const std::string& value) {
  ParamList params;
  technique.describe(params);
  Param* param = params.find(name);
  ASSERT_TRUE(param) << name;
  param->set(value);
}

}  // namespace sfumato::testing
