// sfumato synth: synthetic scans with known truth.
#include "synth/synth.h"

#include <filesystem>

#include "commands.h"
#include "console.h"
#include "core/counted.h"
#include "core/param.h"
#include "io/camera_json.h"
#include "io/file_names.h"
#include "io/io.h"
#include "io/npy.h"
#include "parameters.h"
#include "synth/scene.h"

namespace sfumato::cli {
namespace {

void write_truth(const synth::Scene& scene, const std::string& folder, const Camera& camera,
                 Console& console) {
  const synth::Truth truth = synth::truth(scene, camera, console);
  const std::filesystem::path out(folder);
  io::write_npy(out / "depth.npy", truth.depth);
  io::write_npy(out / "normal.npy", truth.normal);
  io::write_npy(out / "color.npy", truth.color);
  io::write_npy(out / "class.npy", truth.class_id);
  io::write_camera(out / "camera.json", camera);
  console.say("wrote " + folder + ": depth.npy normal.npy color.npy class.npy camera.json");
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::io, "--truth " + folder + ": cannot make the folder (" + error.message() +
                                   "); name one that can be written to");
}

std::string scene_list() { return join(synth::scene_names(), ", ") + ", mesh"; }

}  // namespace

int synth_command(const Words& words) {
  std::string scene_name, output;
  std::optional<std::string> input, truth_folder, camera_file;
  bool quiet = false;
  synth::SampleOptions options;
  ParamList parameters;
  options.describe(parameters);

  CommandLine line("sfumato synth",
                   "Samples a synthetic scene like a scanner would. Scenes: " + scene_list() + ".");
  line.positional("SCENE", scene_name, scene_list());
  line.text("-o,--output", output, "FILE", "the scan to write: .las .laz .ply");
  line.text("--input", input, "FILE.ply|obj", "the mesh to sample (scene mesh)");
  line.text("--truth", truth_folder, "DIR", "write what a perfect renderer shows from --camera");
  line.text("--camera", camera_file, "C.json", "camera of --truth");
  line.flag("--quiet", quiet, "no progress");
  line.group("Sampling");
  for (Param& param : parameters.all())
    declare_parameter(line, param, "--" + with_dashes(param.name), false,
                      [&param](const std::string& text) { param.set(text); });
  if (!line.parse(words)) return 0;
  if (scene_name.empty() || (output.empty() && !truth_folder))
    throw Error(ErrorCode::usage, "usage: sfumato synth SCENE -o FILE; scenes: " + scene_list());
  if (input.has_value() != (scene_name == "mesh"))
    throw Error(ErrorCode::usage, "--input FILE.ply|obj goes with the scene mesh, and mesh needs it");
  if (truth_folder && !camera_file) throw Error(ErrorCode::usage, "--truth needs --camera C.json");

  io::FileNames names;
  if (input) names.input("--input", *input);
  if (camera_file) names.input("--camera", *camera_file);
  if (truth_folder) make_folder(*truth_folder);
  if (!output.empty()) names.output("-o", output);
  if (truth_folder)
    for (const char* name : {"depth.npy", "normal.npy", "color.npy", "class.npy", "camera.json"})
      names.output("--truth", std::filesystem::path(*truth_folder) / name);
  Console console(quiet);
  const std::optional<Camera> camera =
      camera_file ? std::optional(io::read_camera(*camera_file)) : std::nullopt;
  const synth::Scene scene =
      input ? synth::make_mesh_scene(io::read_mesh(*input, console)) : synth::make_scene(scene_name);
  if (!output.empty()) {
    const PointCloud cloud = synth::sample(scene, options, console);
    io::write(output, cloud, console);
    console.say("wrote " + output + " (" + counted(cloud.size(), "point") + ")");
  }
  if (truth_folder) write_truth(scene, *truth_folder, *camera, console);
  return 0;
}

}  // namespace sfumato::cli
