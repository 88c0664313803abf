// The normals that `analysis` computes against those of the surfaces that were sampled: `make eval-normals`.
//
//   eval_normals [--data FOLDER] [--scene TEXT]
//
// Scenes are sampled by area at random. Noise is Gaussian along the normal; "sheets" are two scans that do
// not meet: half of the points are moved by so much.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/io.h"
#include "options.h"
#include "synth/synth.h"

using namespace sfumato;

namespace {

/// Degrees between computed normals and the truth, sorted. `noise`, `apart`: spacings.
std::vector<double> errors_of(const synth::Scene& scene, int points, double noise, double apart) {
  double area = 0;
  for (std::size_t s = 0; s < scene.surface_count(); ++s) area += scene.surface_area(s);
  const double spacing = std::sqrt(area / points);
  synth::SampleOptions options;
  options.points = points;
  options.seed = 11;
  options.sampling = synth::Sampling::area;
  options.sigma = float(noise * spacing);
  options.normals.user = true;
  PointCloud cloud = synth::sample(scene, options);
  for (int axis = 0; axis < 3; ++axis) {
    ScalarField field{std::string("truth_") + "xyz" [axis], 0, {}, StoredType::float32};
    for (const vec3& normal : cloud.normals) field.values.push_back(normal[axis]);
    cloud.set_scalar(std::move(field));
  }
  cloud.normals.clear();
  std::mt19937 random(3);
  for (vec3& position : cloud.positions)
    if (random() & 1) position += float(apart * spacing) * glm::normalize(vec3(1, 2, 3));
  const PreparedCloud prepared =
      analysis::prepare(std::move(cloud), Attribute::normal | Attribute::radius, {});
  std::vector<double> errors;
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const vec3 truth(prepared.cloud.scalar("truth_x")->value(i), prepared.cloud.scalar("truth_y")->value(i),
                     prepared.cloud.scalar("truth_z")->value(i));
    const double cosine = std::abs(glm::dot(truth, prepared.cloud.normals[i]));
    errors.push_back(glm::degrees(std::acos(std::min(cosine, 1.0))));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

void row(const std::string& name, const synth::Scene& scene, int points) {
  std::printf("| %s, %dk |", name.c_str(), points / 1000);
  const auto print = [&](double noise, double apart) {
    const std::vector<double> errors = errors_of(scene, points, noise, apart);
    const auto quantile = [&](double q) { return errors[std::size_t(q * double(errors.size() - 1))]; };
    const auto wrong = errors.end() - std::lower_bound(errors.begin(), errors.end(), 30.0);
    std::printf(" %.1f %.1f %.1f %% |", quantile(0.5), quantile(0.9),
                100.0 * double(wrong) / double(errors.size()));
    std::fflush(stdout);
  };
  for (double noise : {0.0, 0.3, 1.0, 2.0}) print(noise, 0);
  for (double apart : {1.0, 2.0, 4.0}) print(0.1, apart);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  std::string data = "../shared/data", wanted;
  bench::Options options;
  options.value("data", data).value("scene", wanted);
  if (!options.parse(argc, argv).empty()) throw Error(ErrorCode::usage, "unexpected words");
  std::printf(
      "Degrees off, median and nine tenths, and more than 30.\n\n"
      "| scene, points | no noise | 0.3 spacings | 1 | 2 | sheets 1 apart | 2 | 4 "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const char* name : {"plane", "spheres", "tori", "room", "courtyard", "forest"})
    if (std::string(name).find(wanted) != std::string::npos)
      for (int points : {20'000, 300'000}) row(name, synth::make_scene(name), points);
  for (const char* name : {"dragon_vrip_res2.ply", "armadillo.obj"})
    if (std::string(name).find(wanted) != std::string::npos)
      for (int points : {20'000, 300'000})
        row(name, synth::make_mesh_scene(io::read_mesh(data + "/" + name)), points);
} catch (const Error& error) {
  std::fprintf(stderr, "eval_normals: %s\n", error.what());
  return 1;
}
