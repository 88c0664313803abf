// An airborne laser scanner: pulses from flight lines, several returns each.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "synth/columns.h"
#include "synth/device.h"
#include "synth/parallel.h"

namespace sfumato::synth {
namespace {

constexpr std::size_t most_returns = 5;  // what the receiver tells apart of one pulse
constexpr double leaf_stops = 0.5;  // of the pulses that meet a leaf: its footprint is wider than most leaves

bool is_vegetation(std::uint8_t class_id) {
  return class_id == class_low_vegetation || class_id == class_high_vegetation;
}

/// Pulse number `i`: through a random place of the plot, in the plane across its flight line.
Ray pulse(const Scene& scene, Random& random, std::size_t i) {
  const FlightLine& line = scene.flight_lines[i % scene.flight_lines.size()];
  dvec3 target;
  for (int axis = 0; axis < 2; ++axis)
    target[axis] = random.uniform(scene.box.min[axis], scene.box.max[axis]);
  target.z = scene.box.min.z;
  const dvec3 along = glm::normalize(line.to - line.from);
  const dvec3 from =
      line.from +
      std::clamp(glm::dot(target - line.from, along), 0.0, glm::length(line.to - line.from)) * along;
  return {from, glm::normalize(target - from)};
}

/// Adds what pulse number `i` brings back.
void shoot_pulse(const Scene& scene, const SampleOptions& options, std::size_t i,
                 std::vector<Sample>& found) {
  // What stops the pulse does not depend on how well its range is measured.
  Random random(std::uint64_t(options.seed), Stream::pulse, i);
  Random error(std::uint64_t(options.seed), Stream::range, i);
  const Ray ray = pulse(scene, random, i);
  const std::size_t first = found.size();
  for (const Hit& hit : scene.intersect_all(ray)) {
    Sample s = surface_sample(scene, hit.surface, hit);
    if (glm::dot(s.point.normal, ray.direction) > 0) s.point.normal = -s.point.normal;
    s.reflectance *= -glm::dot(s.point.normal, ray.direction);
    const double range = hit.t + (options.sigma > 0 ? options.sigma * error.gaussian() : 0);
    s.point.position = ray.origin + range * ray.direction;
    const bool lost = random.uniform() < options.missing;
    const bool stops = !is_vegetation(s.class_id) || random.uniform() < leaf_stops;
    if (!lost) found.push_back(s);
    if (stops || found.size() == first + most_returns) break;
  }
  for (std::size_t k = first; k < found.size(); ++k) {
    found[k].return_number = std::uint8_t(k - first + 1);
    found[k].number_of_returns = std::uint8_t(found.size() - first);
  }
}

/// What `pulses` pulses bring back, in blocks in the order of the pulses.
std::vector<std::vector<Sample>> shoot_all(const Scene& scene, const SampleOptions& options,
                                           std::size_t pulses, Progress& progress) {
  const std::size_t block = 4096;
  std::vector<std::vector<Sample>> found((pulses + block - 1) / block);
  parallel_blocks(pulses, block, progress, "scanning", [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) shoot_pulse(scene, options, i, found[begin / block]);
  });
  return found;
}

std::size_t count(const std::vector<std::vector<Sample>>& blocks) {
  std::size_t total = 0;
  for (const auto& samples : blocks) total += samples.size();
  return total;
}

}  // namespace

PointCloud sample_airborne(const Scene& scene, const SampleOptions& options, Progress& progress) {
  if (scene.flight_lines.empty())
    throw Error(ErrorCode::usage, "synth " + scene.name +
                                      ": nothing flies over this scene; use --sampling "
                                      "area, or the scene forest");
  if (options.noise != NoiseModel::none || options.flying_pixels > 0)
    throw Error(ErrorCode::usage, "synth " + scene.name +
                                      ": noise and flying_pixels are errors of scanners and cameras on the "
                                      "ground; use sigma, missing and outliers");
  // As many pulses as bring about `points` returns back: a look at some says how many each brings.
  const std::size_t looked_at = 20'000;
  const double each =
      std::max(1e-3, double(count(shoot_all(scene, options, looked_at, progress))) / double(looked_at));
  const auto blocks = shoot_all(scene, options, std::size_t(std::ceil(options.points / each)), progress);
  const std::size_t total = count(blocks), outliers = std::size_t(options.outliers);

  Columns columns;
  columns.normals = options.normals.value();
  columns.returns = true;
  columns.outlier = outliers > 0;
  PointCloud cloud;
  ColumnWriter writer(cloud, columns);
  writer.resize(total + outliers);
  std::size_t next = 0;
  for (const auto& samples : blocks)
    for (const Sample& s : samples) writer.write(next++, s);
  for (std::size_t i = 0; i < outliers; ++i) {
    Random random(std::uint64_t(options.seed), Stream::outlier, i);
    writer.write(next++, make_outlier(scene.box, random));
  }
  return cloud;
}

}  // namespace sfumato::synth
