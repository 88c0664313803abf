// What a perfect renderer shows.
#include <limits>

#include "synth/device.h"
#include "synth/parallel.h"

namespace sfumato::synth {

Truth truth(const Scene& scene, const Camera& camera, Progress& progress) {
  const int width = camera.width, height = camera.height;
  Truth image{Image<float>(width, height, std::numeric_limits<float>::infinity()), Image<vec3>(width, height),
              Image<vec3>(width, height), Image<std::uint8_t>(width, height)};
  const CameraRays rays(camera);
  parallel_blocks(image.depth.size(), 4096, progress, "ray casting", [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Ray ray =
          rays.through(double(i % std::size_t(width)) + 0.5, double(i / std::size_t(width)) + 0.5);
      const auto hit = scene.intersect(ray);
      if (!hit) continue;
      image.depth.data()[i] = float(hit->t * glm::dot(ray.direction, rays.direction()));
      image.normal.data()[i] = vec3(glm::dot(hit->normal, ray.direction) > 0 ? -hit->normal : hit->normal);
      image.color.data()[i] = scene.surface_albedo(hit->surface, *hit);
      image.class_id.data()[i] = scene.surface_class(hit->surface);
    }
  });
  return image;
}

}  // namespace sfumato::synth
