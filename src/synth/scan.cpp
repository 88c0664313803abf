// Simulated devices: terrestrial scanners with equal angular steps and RGB-D cameras, with their errors.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "synth/columns.h"
#include "synth/device.h"
#include "synth/parallel.h"

namespace sfumato::synth {
namespace {

constexpr double top_elevation = 0.5 * M_PI,
                 bottom_elevation = glm::radians(-70.0);  // the tripod hides the rest

/// Neighbouring rays whose ranges differ by more than this share see an edge.
constexpr double edge_share = 0.05;

struct Device {
  std::uint32_t width = 0, height = 0;
  dvec3 viewpoint{0};
  double step = 0;                 ///< radians between a scanner's rays; 0: a camera
  std::optional<CameraRays> rays;  ///< of a camera

  /// Through a place of the grid, cell centres at half integers.
  Ray through(double column, double row) const {
    if (rays) return rays->through(column, row);
    const double azimuth = -column * step, elevation = top_elevation - row * step;
    return {viewpoint,
            {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
             std::sin(elevation)}};
  }
  /// Share of a ray's length that its device measures as depth: 1 for ranges.
  double depth_factor(const Ray& ray) const { return rays ? glm::dot(ray.direction, rays->direction()) : 1; }
};

std::vector<Device> list_devices(const Scene& scene, const SampleOptions& options) {
  std::vector<Device> devices;
  if (options.sampling == Sampling::cameras) {
    for (const Camera& camera : scene.cameras) {
      Device device;
      device.viewpoint = camera.position;
      device.rays.emplace(camera);
      device.width = std::uint32_t(camera.width), device.height = std::uint32_t(camera.height);
      devices.push_back(device);
    }
  } else {
    std::vector<dvec3> positions = scene.scanners;
    if (!options.scanner_position.empty()) {
      positions.clear();
      if (options.scanner_position.size() % 3 != 0)
        throw Error(ErrorCode::usage, "synth: scanner_position has " +
                                          std::to_string(options.scanner_position.size()) +
                                          " numbers; give three (x,y,z) for each scanner");
      for (std::size_t i = 0; i < options.scanner_position.size(); i += 3)
        positions.emplace_back(options.scanner_position[i], options.scanner_position[i + 1],
                               options.scanner_position[i + 2]);
    }
    for (const dvec3& position : positions) {
      Device device;
      device.viewpoint = position;
      devices.push_back(device);
    }
  }
  if (devices.empty())
    throw Error(
        ErrorCode::usage,
        "synth " + scene.name + ": the scene has no " +
            (options.sampling == Sampling::cameras ? std::string("cameras") : std::string("scanners")) +
            "; use --sampling area, or place scanners with --scanner-position X,Y,Z");
  if (options.views > 0 && std::size_t(options.views) < devices.size())
    devices.resize(std::size_t(options.views));
  if (devices.size() > 255)
    throw Error(ErrorCode::usage, "synth: more than 255 devices; give fewer scanner positions");
  return devices;
}

void set_scanner_step(Device& device, double step) {
  // Whole numbers of columns around.
  device.width = std::uint32_t(std::max(4.0, std::round(2 * M_PI / step)));
  device.step = 2 * M_PI / device.width;
  device.height = std::uint32_t(std::ceil((top_elevation - bottom_elevation) / device.step));
}

/// Share of the rays that meet the scene, by a coarse look through all devices.
double hit_share(const Scene& scene, std::vector<Device> devices) {
  std::size_t hits = 0, rays = 0;
  for (Device& device : devices) {
    const std::uint32_t columns = 120, rows = 60;
    if (!device.rays) set_scanner_step(device, 2 * M_PI / columns);
    for (std::uint32_t i = 0; i < columns * rows; ++i, ++rays)
      hits += scene
                  .intersect(device.through((i % columns + 0.5) * device.width / columns,
                                            (i / columns + 0.5) * device.height / rows))
                  .has_value();
  }
  return std::max(double(hits) / double(rays), 1e-3);
}

void choose_resolution(const Scene& scene, SampleOptions& options, std::vector<Device>& devices) {
  const double rays = options.points / hit_share(scene, devices) /
                      (1 - std::min(0.99, double(options.missing))) / double(devices.size());
  if (options.sampling == Sampling::scanners) {
    const double step = std::sqrt(2 * M_PI * (top_elevation - bottom_elevation) / rays);
    options.angular_step_deg.resolve(float(glm::degrees(step)));
    for (Device& device : devices)
      set_scanner_step(device, glm::radians(double(options.angular_step_deg.value())));
    return;
  }
  const double aspect = double(devices[0].width) / devices[0].height;
  const int width = options.view_width.resolve(std::max(8, int(std::lround(std::sqrt(rays * aspect)))));
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const Camera camera = scene.cameras[i].resized(width, std::max(1, int(std::lround(width / aspect))));
    devices[i].width = std::uint32_t(camera.width), devices[i].height = std::uint32_t(camera.height);
    devices[i].rays.emplace(camera);
  }
}

/// A depth as the device measures it; nothing when too little light comes back.
std::optional<double> measure(const SampleOptions& options, double z, double amplitude, Random& random) {
  const double level = options.noise_level;
  if (options.sigma > 0) z += options.sigma * random.gaussian();
  switch (options.noise) {
    case NoiseModel::none: return z;
    case NoiseModel::poisson: return z + level * z * z / 1000 * random.gaussian();  // notes D.2, z in metres
    case NoiseModel::tof:
      // Phase noise grows as the amplitude falls (Lange, Seitz 2001): 0.5 mm at amplitude 1, a white wall at
      // 1 m.
      if (amplitude < 0.002) return std::nullopt;
      return z + level * 0.0005 / amplitude * random.gaussian();
    case NoiseModel::structured_light: {
      // disparity = focal length x baseline / z, of a 7.5 cm baseline and 525 px, noise 0.1 px, steps of 1/8
      // px (Khoshelham, Elberink 2012); noise and steps grow with the level.
      if (amplitude < 0.001) return std::nullopt;
      if (level <= 0) return z;
      const double scale = 525 * 0.075, step = level / 8;
      const double disparity = scale / z + 0.1 * level * random.gaussian(),
                   stepped = step * std::round(disparity / step);
      return stepped > 0 ? std::optional(scale / stepped) : std::nullopt;
    }
  }

  return z;
}

/// What the ray of cell `i` of device number `d` brings back.
std::optional<Sample> shoot(const Scene& scene, const SampleOptions& options, const Device& device,
                            std::size_t d, std::size_t i) {
  const double column = double(i % device.width) + 0.5, row = double(i / device.width) + 0.5;
  const Ray ray = device.through(column, row);
  const auto hit = scene.intersect(ray);
  if (!hit) return std::nullopt;
  Random random(std::uint64_t(options.seed), Stream::range, d << 40 | i);
  if (random.uniform() < options.missing) return std::nullopt;

  Sample s = surface_sample(scene, hit->surface, *hit);
  s.scanner = std::uint8_t(d);
  if (glm::dot(s.point.normal, ray.direction) > 0) s.point.normal = -s.point.normal;
  const double facing = -glm::dot(s.point.normal, ray.direction);
  s.amplitude = s.reflectance * facing / (hit->t * hit->t);
  s.reflectance *= facing;  // scanners give intensities corrected for distance

  double range = hit->t;
  if (options.flying_pixels > 0) {
    // The beam's rim, half a cell away: where it meets something else, the ranges may mix.
    Random beam(std::uint64_t(options.seed), Stream::beam, d << 40 | i);
    const double angle = beam.uniform(0, 2 * M_PI);
    const auto rim =
        scene.intersect(device.through(column + 0.5 * std::cos(angle), row + 0.5 * std::sin(angle)));
    if (rim && std::abs(rim->t - range) > edge_share * range && beam.uniform() < options.flying_pixels) {
      const double share = beam.uniform(0.1, 0.9);
      range += share * (rim->t - range);
      s.color = glm::mix(s.color, scene.surface_albedo(rim->surface, *rim), float(share));
      s.outlier = 2;
    }
  }
  const double factor = device.depth_factor(ray);
  const auto measured = measure(options, range * factor, s.amplitude, random);
  if (!measured || *measured <= 0) return std::nullopt;
  s.point.position = ray.origin + *measured / factor * ray.direction;
  return s;
}

}  // namespace

PointCloud sample_devices(const Scene& scene, const SampleOptions& asked, Progress& progress) {
  SampleOptions options = asked;
  std::vector<Device> devices = list_devices(scene, options);
  choose_resolution(scene, options, devices);

  Columns columns;
  columns.normals = options.normals.value();
  columns.classes = !scene.primitives.empty() && scene.piece_scalar.empty();
  columns.piece = scene.piece_scalar;
  columns.scanner = true;
  columns.amplitude = options.sampling == Sampling::cameras;
  columns.outlier = options.outliers > 0 || options.flying_pixels > 0;
  PointCloud cloud;
  ColumnWriter writer(cloud, columns);
  for (std::size_t d = 0; d < devices.size(); ++d) {
    const Device& device = devices[d];
    std::vector<std::optional<Sample>> returns(std::size_t(device.width) * device.height);
    parallel_blocks(returns.size(), 4096, progress, "scanning", [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) returns[i] = shoot(scene, options, device, d, i);
    });
    const std::size_t first = cloud.size();
    const std::size_t count = std::size_t(
        std::count_if(returns.begin(), returns.end(), [](const auto& one) { return one.has_value(); }));
    writer.resize(first + count);
    for (std::size_t i = 0; i < returns.size(); ++i) {
      if (!returns[i]) continue;
      writer.write(cloud.grid_index.size(), *returns[i]);
      cloud.grid_index.push_back(std::uint32_t(i));
    }
    cloud.grids.push_back({first, count, device.width, device.height, device.viewpoint});
    cloud.scanners.push_back(device.viewpoint);
  }

  const std::size_t first = cloud.size();  // outliers come behind the grids, of which they are no part
  writer.resize(first + std::size_t(options.outliers));
  cloud.grid_index.resize(cloud.size(), UINT32_MAX);
  for (std::size_t i = 0; i < std::size_t(options.outliers); ++i) {
    Random random(std::uint64_t(options.seed), Stream::outlier, i);
    Sample s = make_outlier(scene.box, random);
    s.scanner = std::uint8_t(i % devices.size());
    writer.write(first + i, s);
  }
  return cloud;
}

}  // namespace sfumato::synth
