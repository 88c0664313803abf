#include "synth/synth.h"

#include "core/error.h"
#include "synth/device.h"

namespace sfumato::synth {

void SampleOptions::describe(ParamList& p) {
  p.add("points", points)
      .range(1, 1'000'000'000)
      .help("by area: exactly as many; from devices: about as many, through their resolution");
  p.add("seed", seed).help("random numbers; equal seeds give equal files");
  p.add("sampling", sampling, {"auto", "area", "scanners", "cameras", "airborne"})
      .help(
          "how points are taken: uniform by area, by terrestrial scanners, by RGB-D cameras or from the air");
  p.add("sigma", sigma)
      .at_least(0)
      .unit("scene units")
      .help("Gaussian noise along the normal (area) or the ray (devices, pulses)");
  p.add("noise", noise, {"none", "poisson", "tof", "structured_light"})
      .help("error of a device's depth z: grows with z^2, with falling amplitude, or by quantised disparity");
  p.add("noise_level", noise_level)
      .range(0, 100)
      .help("k of `noise`; with poisson sigma = k z^2 / 1000")
      .paper("Hashed, binned A-buffer, k of the Fireplace test");
  p.add("outliers", outliers)
      .at_least(0)
      .help("points added anywhere in the scene's box, marked in the scalar `outlier`");
  p.add("flying_pixels", flying_pixels)
      .range(0, 1)
      .help("share of a device's returns at depth edges that land in between");
  p.add("missing", missing).range(0, 1).help("share of a device's returns that are lost");
  p.add("views", views).at_least(0).help("use only the first devices of the scene; 0 uses all");
  p.add("angular_step_deg", angular_step_deg)
      .range(0.005, 10)
      .unit("degrees")
      .help("between a scanner's rays; auto follows `points`");
  p.add("view_width", view_width)
      .range(8, 8192)
      .unit("pixels")
      .help("of a camera's picture; auto follows `points`");
  p.add("scanner_position", scanner_position)
      .unit("scene units")
      .help("x,y,z of one or more scanners, in place of the scene's own");
  p.add("normals", normals).help("write the exact normals; auto: not for cameras, which have none");
}

PointCloud sample(const Scene& scene, const SampleOptions& asked, Progress& progress) {
  SampleOptions options = asked;
  if (options.sampling == Sampling::automatic)
    options.sampling = options.scanner_position.empty() ? scene.natural : Sampling::scanners;
  options.normals.resolve(options.sampling != Sampling::cameras);
  const auto finished = [&](PointCloud cloud) {
    cloud.set_up(scene.up);
    return cloud;
  };
  if (options.sampling == Sampling::airborne) return finished(sample_airborne(scene, options, progress));
  if (options.sampling != Sampling::area) return finished(sample_devices(scene, options, progress));
  if (options.noise != NoiseModel::none || options.flying_pixels > 0 || options.missing > 0)
    throw Error(ErrorCode::usage, "synth " + scene.name +
                                      ": noise, flying_pixels and missing are errors of a device; "
                                      "add --sampling scanners or cameras, or use sigma and outliers");
  return finished(sample_area(scene, options, progress));
}

}  // namespace sfumato::synth
