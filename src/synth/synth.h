// Synthetic scans with known truth: sample a scene like a scanner would, and ask the same scene what is
// really there.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"
#include "core/param.h"
#include "core/progress.h"
#include "synth/scene.h"

namespace sfumato::synth {

enum class NoiseModel { none, poisson, tof, structured_light };

/// What the command line offers for `synth`. Lengths in scene units (metres in `courtyard`, `room` and
/// `forest`).
struct SampleOptions {
  int points = 1'000'000;
  int seed = 1;
  Sampling sampling = Sampling::automatic;
  float sigma = 0;  ///< Gaussian: along the normal (area) or the ray (devices)
  NoiseModel noise = NoiseModel::none;
  float noise_level = 1;
  int outliers = 0;         ///< points added, uniform in the scene's box
  float flying_pixels = 0;  ///< share of returns at depth edges that land in between
  float missing = 0;        ///< share of returns lost at random
  int views = 0;            ///< 0: all devices of the scene
  Auto<float> angular_step_deg;
  Auto<int> view_width;
  std::vector<float> scanner_position;
  Auto<bool> normals;
  void describe(ParamList& p);
};

/// A scan of the scene: normals, sRGB colours, scalars `intensity`, `classification` (analytic scenes),
/// `scanner` (devices), `amplitude` (cameras), `return_number` and `number_of_returns` (airborne), `outlier`
/// (when asked for), the scene's piece scalar. By area exactly `points` points plus outliers; from devices
/// about as many, each device an organised Grid, and from the air in the order of the pulses. Equal options
/// give equal bytes on any number of threads. Throws Error(usage) for options that do not go together.
PointCloud sample(const Scene& scene, const SampleOptions& options, Progress& progress = no_progress());

/// About one point per `block_px` x `block_px` pixels of each camera: a ray through a random place of every
/// block, without noise. Points come row by row, camera by camera; a block that sees nothing gives no point.
PointCloud sample_by_camera(const Scene& scene, const std::vector<Camera>& cameras, int block_px,
                            int seed = 1);

/// What a perfect renderer shows, through the pixel centres.
struct Truth {
  Image<float> depth;            ///< along the view axis, scene units; infinity where nothing
  Image<vec3> normal;            ///< world, facing the camera; 0 where nothing
  Image<vec3> color;             ///< linear albedo; 0 where nothing
  Image<std::uint8_t> class_id;  ///< ASPRS; 0 where nothing
};
/// Near and far planes of the camera are not applied.
Truth truth(const Scene& scene, const Camera& camera, Progress& progress = no_progress());

}  // namespace sfumato::synth
