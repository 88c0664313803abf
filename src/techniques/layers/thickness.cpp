#include "techniques/layers/thickness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "analysis/local_noise.h"
#include "analysis/spacing.h"

namespace sfumato::layers {
namespace {

std::vector<float> spacings_of(const PreparedCloud& prepared, Progress& progress) {
  const std::vector<vec3>& positions = prepared.cloud.positions;
  if (prepared.whole) return analysis::spacings_at(positions, prepared.whole->spacing, progress);
  std::vector<float> spacings(positions.size());
  tbb::parallel_for(std::size_t(0), prepared.batches.size(), [&](std::size_t b) {
    progress.check();
    const Batch& batch = prepared.batches[b];
    for (std::size_t i = batch.first; i < std::size_t(batch.first) + batch.count; ++i)
      spacings[i] = batch.spacing_at(positions[i]);
  });
  return spacings;
}

float thickness_of(const ThicknessRule& rule, float spacing, float noise) {
  return std::max(rule.spacings * spacing, rule.deviations * noise);
}

/// Where points of a picture lie, relative to the origin of their cloud, and which pixels they are in.
struct Seen {
  std::vector<vec3> positions;
  std::vector<std::size_t> pixels;
};
Seen seen_in(const Image<float>& depth, const Camera& camera, const dvec3& origin) {
  const Intrinsics k = camera.intrinsics();
  const dmat4 cloud_from_eye = camera.inverse_view(origin);
  Seen seen;
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const double at = double(depth.at(x, y));
      if (std::isinf(at)) continue;
      const double w = camera.orthographic() ? 1 : at;
      const glm::dvec4 eye((x + 0.5 - k.cx) / k.fx * w, -(y + 0.5 - k.cy) / k.fy * w, -at, 1);
      seen.positions.emplace_back(cloud_from_eye * eye);
      seen.pixels.push_back(std::size_t(y) * std::size_t(depth.width()) + std::size_t(x));
    }
  return seen;
}

}  // namespace

const PlacedNoise& Thickness::noise_of(const GpuCloud& cloud, Progress& progress) {
  const PreparedCloud& prepared = cloud.prepared();
  if (prepared.whole) return prepared.whole->placed_noise;
  return noise_.at(cloud.serial(), [&] { return analysis::placed_noise_of(prepared, progress); });
}

float Thickness::noise_in_spacings(const GpuCloud& cloud, Progress& progress) {
  return noise_of(cloud, progress).of_spacing;
}

const GpuCloud::Values& Thickness::of_points(const GpuCloud& cloud, const ThicknessRule& rule,
                                             Progress& progress) {
  return *values_.at({cloud.serial(), rule.spacings, rule.deviations}, [&] {
    const PreparedCloud& prepared = cloud.prepared();
    std::vector<float> values = spacings_of(prepared, progress);
    const std::vector<float> noise =
        rule.deviations > 0
            ? analysis::noise_near(prepared.cloud.positions, noise_of(cloud, progress), progress)
            : std::vector<float>(values.size(), 0);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = thickness_of(rule, values[i], noise[i]);
    return cloud.make_values("thickness", values);
  });
}

Image<float> Thickness::of_pixels(const GpuCloud& cloud, const ThicknessRule& rule, const Image<float>& depth,
                                  const Camera& camera, Progress& progress) const {
  const WholeCloud& whole = *cloud.prepared().whole;
  const Seen seen = seen_in(depth, camera, whole.origin);
  const std::vector<float> spacings = analysis::spacings_at(seen.positions, whole.spacing, progress),
                           noise = analysis::noise_near(seen.positions, whole.placed_noise, progress);
  Image<float> of_pixels(depth.width(), depth.height());
  for (std::size_t i = 0; i < seen.pixels.size(); ++i)
    of_pixels.data()[seen.pixels[i]] = thickness_of(rule, spacings[i], noise[i]);
  return of_pixels;
}

float least_thickness(const PreparedCloud& prepared, const ThicknessRule& rule) {
  const std::span<const Batch> batches =
      prepared.whole ? prepared.whole->spacing.stretches : prepared.batches;
  float least = INFINITY;
  for (const Batch& batch : batches) least = std::min(least, std::exp2(batch.least_log2_spacing));
  return std::isinf(least) ? 0 : rule.spacings * least;
}

}  // namespace sfumato::layers
