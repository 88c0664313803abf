// What the tests of strokes paint with.
#pragma once

#include "reference/gl_fixture.h"
#include "reference/splat_oracle.h"

namespace sfumato::testing {

/// A technique and a cloud, rendered step by step.
struct StrokeScene {
  std::unique_ptr<Technique> technique = find_technique("strokes").create();
  PreparedCloud prepared;
  std::unique_ptr<GpuCloud> gpu;
  RenderSettings settings;
  Camera camera = front_camera(112, 80);
  Target target{112, 80};
  gl::Timers timers{false};

  explicit StrokeScene(PointCloud cloud)
      : prepared(analysis::prepare(std::move(cloud), technique->needs(), {})) {
    gpu = std::make_unique<GpuCloud>(prepared, colors_of(prepared.cloud));
    camera.fit_depth_range(gpu->bounds());
    settings.shading = Shading::albedo;
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique, name, value); }
  bool step() {
    Frame frame{*gpu, camera, settings, Light{}, target, true, timers, no_progress()};
    frame.views = {&camera, 1};
    return technique->render(frame);
  }
  Image<vec4> picture() const { return target.color.download<vec4>(); }
};

inline PointCloud two_spheres() {
  PointCloud cloud = sphere_cloud(5000, 0.8f, vec3(-0.2f, 0, 0));
  append(cloud, sphere_cloud(3000, 0.5f, vec3(0.5f, -0.8f, 0.2f)));
  return cloud;
}

}  // namespace sfumato::testing
