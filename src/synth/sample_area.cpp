// Sampling uniformly by area, in random order, and by the blocks of a camera's picture.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "synth/columns.h"
#include "synth/device.h"
#include "synth/parallel.h"

namespace sfumato::synth {
namespace {

bool analytic(const Scene& scene) { return !scene.primitives.empty(); }

}  // namespace

Sample surface_sample(const Scene& scene, std::uint32_t surface, const SurfacePoint& point) {
  Sample s;
  s.point = point;
  s.surface = surface;
  s.color = scene.surface_albedo(surface, point);
  s.alpha = scene.surface_alpha(surface);
  s.class_id = scene.surface_class(surface);
  s.reflectance = luminance(s.color);
  return s;
}

PointCloud sample_area(const Scene& scene, const SampleOptions& options, Progress& progress) {
  std::vector<double> up_to(scene.surface_count());
  double total = 0;
  for (std::size_t i = 0; i < up_to.size(); ++i) up_to[i] = total += scene.surface_area(i);

  const std::size_t outliers = std::size_t(options.outliers), count = std::size_t(options.points) + outliers;
  const bool has_devices = !scene.scanners.empty() || !scene.cameras.empty() || !scene.flight_lines.empty();
  Columns columns;
  columns.normals = options.normals.value();
  columns.intensity = has_devices;
  columns.classes = analytic(scene) && scene.piece_scalar.empty();
  columns.piece = scene.piece_scalar;
  columns.outlier = outliers > 0;
  PointCloud cloud;
  ColumnWriter writer(cloud, columns);
  writer.resize(count);
  const std::uint64_t seed = std::uint64_t(options.seed);

  parallel_blocks(count, 16384, progress, "sampling", [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Outliers are spread evenly through the order; exactly `outliers` of them.
      const std::size_t before = i * outliers / count;
      if ((i + 1) * outliers / count > before) {
        Random random(seed, Stream::outlier, before);
        writer.write(i, make_outlier(scene.box, random));
        continue;
      }
      Random random(seed, Stream::area, i - before);
      const double pick = random.uniform() * total;
      const std::size_t surface =
          scene.equal_counts
              ? (i - before) % up_to.size()
              : std::min(std::size_t(std::upper_bound(up_to.begin(), up_to.end(), pick) - up_to.begin()),
                         up_to.size() - 1);
      Sample s = surface_sample(scene, std::uint32_t(surface), scene.sample_surface(surface, random));
      if (options.sigma > 0) s.point.position += options.sigma * random.gaussian() * s.point.normal;
      writer.write(i, s);
    }
  });
  return cloud;
}

PointCloud sample_by_camera(const Scene& scene, const std::vector<Camera>& cameras, int block_px, int seed) {
  if (block_px < 1)
    throw Error(ErrorCode::usage, "synth: block_px is " + std::to_string(block_px) + "; give 1 or more");
  std::vector<Sample> found;
  for (std::size_t view = 0; view < cameras.size(); ++view) {
    const Camera& camera = cameras[view];
    const CameraRays rays(camera);
    const std::size_t columns = std::size_t((camera.width + block_px - 1) / block_px);
    const std::size_t rows = std::size_t((camera.height + block_px - 1) / block_px);
    std::vector<std::optional<Hit>> hits(columns * rows);
    parallel_blocks(hits.size(), 4096, no_progress(), "sampling", [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Random random(std::uint64_t(seed), Stream::camera, view << 40 | i);
        const double x = (double(i % columns) + random.uniform()) * block_px;
        const double y = (double(i / columns) + random.uniform()) * block_px;
        // Blocks may stick out of the picture; what they would see there is not part of it.
        if (x < camera.width && y < camera.height) hits[i] = scene.intersect(rays.through(x, y));
        if (hits[i] && glm::dot(hits[i]->normal, rays.through(x, y).direction) > 0) hits[i]->normal *= -1.0;
      }
    });
    for (const auto& hit : hits) {
      if (!hit) continue;
      found.push_back(surface_sample(scene, hit->surface, *hit));
      found.back().scanner = std::uint8_t(view);
    }
  }
  Columns columns;
  columns.classes = analytic(scene) && scene.piece_scalar.empty();
  columns.piece = scene.piece_scalar;
  columns.scanner = true;
  PointCloud cloud;
  ColumnWriter writer(cloud, columns);
  writer.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) writer.write(i, found[i]);
  cloud.up = scene.up;
  for (const Camera& camera : cameras) cloud.scanners.push_back(camera.position);
  return cloud;
}

}  // namespace sfumato::synth
