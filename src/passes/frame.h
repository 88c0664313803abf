// What a technique gets to render: cloud, camera, light, target, timers. A plain struct, no singletons.
#pragma once

#include <span>

#include "core/camera.h"
#include "core/progress.h"
#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/gpu_cloud.h"
#include "passes/light.h"
#include "passes/visible_points.h"

namespace sfumato {

/// What a technique draws into; all of the camera's size, top row first.
struct Target {
  gl::Texture color;   ///< RGBA32F, linear, premultiplied by coverage
  gl::Texture depth;   ///< R32F, eye depth along the view axis in scene units, +inf where nothing
  gl::Texture normal;  ///< RGBA32F: world normal facing the camera, 0 where none; w = shadow factor
  Target() = default;
  Target(int width, int height);
};

struct Frame {
  GpuCloud& cloud;
  const Camera& camera;  ///< near and far already fitted to the cloud
  const RenderSettings& settings;
  Light light;  ///< settings.light_text, parsed
  Target& target;
  bool wants_normal;  ///< the caller reads target.normal; else it may stay undefined
  gl::Timers& timers;
  Progress& progress;
  /// What is automatic and depends on the view is found over these whole pictures, fitted to the cloud like
  /// `camera`: the one that `camera` is of, or all that are put together with it (the faces of a panorama).
  std::span<const Camera> views = {};
  /// The opaque items of the scene, of the target's size, for techniques that let some of it through
  /// (Technique::transparency): they blend over it and show nothing that lies behind it. Null: there is
  /// nothing.
  const Target* behind = nullptr;
  /// Of a cloud of which this is a part (Technique::merges): not null, the technique stops when it knows what
  /// each pixel shows, and hands it out here.
  VisiblePoints* visible = nullptr;
  /// It goes on from what the pixels of all parts show, to the next round or to the picture; null: from its
  /// own.
  const VisiblePoints* merged = nullptr;
};

}  // namespace sfumato
