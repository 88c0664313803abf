// sfumato convert: between the formats that can be written, several files into one, and only the points
// wanted; with shadow factors, and distances to another cloud, where they are asked for.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/distances.h"

#include "commands.h"
#include "common_options.h"
#include "console.h"
#include "core/counted.h"
#include "core/error.h"
#include "input_options.h"
#include "io/file_names.h"
#include "io/io.h"
#include "parameters.h"
#include "session/pose.h"
#include "session/shadow_factors.h"

namespace sfumato::cli {
namespace {

std::string written_extensions() {
  std::string list;
  for (const io::FormatInfo& format : io::formats())
    if (format.can_write) list += (list.empty() ? "" : " ") + format.extensions;
  return list;
}

/// The light whose shadows are written with the points: the parameters of rendering, by their names.
class ShadowOptions {
 public:
  ShadowOptions() { settings_.describe(parameters_); }

  void declare(CommandLine& line) {
    line.group("Shadow factors: the scalar `shadow`, 0 dark to 1 lit, for pictures with --shadows stored");
    line.text("--shadows", wanted_, "off|hard|soft (off)", "how much of the light each point sees");
    for (const char* name : {"light", "light_size", "light_samples", "shadow_distance"}) {
      const Param& param = *parameters_.find(name);
      declare_parameter(line, param, "--" + with_dashes(name), false, [this, name](const std::string& text) {
        parameters_.find(name)->set(text);
        last_of_light_ = "--" + with_dashes(name);
      });
    }
  }

  /// Throws Error(usage) for what can be wrong before a file is opened.
  void check() {
    if (wanted_ == "stored")
      throw Error(ErrorCode::usage, "--shadows stored is of rendering: say which to find, hard or soft");
    parameters_.find("shadows")->set(wanted_);
    Light::parse(settings_.light_text);
    if (!is_asked() && !last_of_light_.empty())
      throw Error(ErrorCode::usage, last_of_light_ + " is of shadows: add --shadows soft, or hard");
  }

  bool is_asked() const { return settings_.shadows != Shadows::off; }

  /// Gives the points the scalar `shadow` and says of which light.
  void add(scene::Scene& scene, const std::optional<UpAxis>& up, gl::Context& context, Console& console) {
    if (Light::parse(settings_.light_text).is_of_camera()) {
      const UpAxis as_read = scene.cloud.up;  // a guess is of no concern to what is written
      const Pose pose = stand_upright(scene, up);
      fix_light(settings_, first_view(pose, 1280, 720), scene.cloud.up);
      scene.cloud.up = as_read;
    }
    std::vector<float> factors = shadow_factors(context, scene.cloud, settings_, console);
    scene.cloud.set_scalar({"shadow", 0, std::move(factors), StoredType::float32});
    console.say("shadow: " + wanted_ + ", the light is " + settings_.light_text +
                "; draw it with --shadows stored --light " + settings_.light_text);
  }

 private:
  RenderSettings settings_;
  ParamList parameters_;
  std::string wanted_ = "off", last_of_light_;
};

/// The cloud from which the points have moved.
class DistanceOptions {
 public:
  void declare(CommandLine& line) {
    line.group("Change: the scalar `distance`, scene units, for pictures with --color-by distance");
    line.text("--distance-to", reference_, "FILE",
              "from each point to the nearest of this cloud, of an earlier survey");
    line.handler("--distance-scale", "D",
                 "instead signed along normals (M3C2), each of the points in a ball of diameter D, between "
                 "the means of both clouds in a cylinder of diameter D; positive: in front of FILE",
                 false,
                 [this](const std::string& text) { scale_ = parse_positive("--distance-scale", text); });
  }

  void check(io::FileNames& names) const {
    if (scale_ && !is_asked()) throw Error(ErrorCode::usage, "--distance-scale is of --distance-to FILE");
    if (is_asked()) names.input("--distance-to", reference_);
  }

  bool is_asked() const { return !reference_.empty(); }

  void add(scene::Scene& scene, Console& console) const {
    scene::SceneOptions whole;
    whole.keep_degrees = true;
    const scene::Scene other = scene::read_scene(scene::expand_inputs({reference_}), whole, console);
    for (const std::string& part : other.damage) console.complain("sfumato: " + part);
    for (const PointCloud* cloud : {&std::as_const(scene.cloud), &other.cloud})
      if (const auto metres = scene::local_metres_of(*cloud); metres && !metres->geocentric)
        throw Error(ErrorCode::usage,
                    "--distance-to: x and y are degrees; bring both clouds into metres first");
    if (!scene.cloud.crs.empty() && !other.cloud.crs.empty() && scene.cloud.crs != other.cloud.crs)
      console.say("sfumato: --distance-to: " + reference_ +
                  " has another coordinate system; numbers are compared");
    std::vector<float> distances =
        scale_ ? analysis::signed_distances(scene.cloud, other.cloud, *scale_, console)
               : analysis::nearest_distances(scene.cloud, other.cloud, console);
    double sum = 0, squares = 0;
    std::size_t count = 0;
    for (const float value : distances)
      if (std::isfinite(value)) sum += double(value), squares += double(value) * double(value), ++count;
    const double mean = count ? sum / double(count) : 0;
    console.say(fmt::format(
        "distance: {} {}: mean {:.4g}, standard deviation {:.4g}{}",
        scale_ ? fmt::format("along normals within {:.4g} to", *scale_) : "to the nearest of", reference_,
        mean, count ? std::sqrt(std::max(0.0, squares / double(count) - mean * mean)) : 0,
        count < distances.size() ? fmt::format("; {} without one", counted(distances.size() - count, "point"))
                                 : std::string()));
    scene.cloud.set_scalar({"distance", 0, std::move(distances), StoredType::float32});
  }

 private:
  std::string reference_;
  std::optional<double> scale_;
};

/// Of files that were moved, what may depend on where they were and stays as it was.
void tell_what_stays(const scene::Scene& scene, const std::vector<scene::SceneFile>& placed,
                     Console& console) {
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (!placed[i].transform) continue;
    if (!scene.files[i].crs.empty() && scene.cloud.crs == scene.files[i].crs)
      console.say("sfumato: " + placed[i].name +
                  ": its coordinate system is kept, which holds only where --transform stays within it");
    const auto& attributes = scene.files[i].attributes;
    if (std::any_of(attributes.begin(), attributes.end(), [](const auto& a) { return a.name == "rot_0"; }))
      console.say("sfumato: " + placed[i].name +
                  ": centres and normals are moved; rot_*, scale_* and f_rest_* of Gaussian splats are not");
  }
}

}  // namespace

int convert_command(const Words& words) {
  std::string output;
  Words inputs;
  Request request;
  request.hide_classes.clear(), request.vertices = true;
  CommonOptions common;
  CommandLine line(
      "sfumato convert",
      "Converts point clouds; order and every attribute are kept. Several inputs become one cloud, whose "
      "scalar `file` tells them apart.");
  line.positionals("IN", inputs, "point clouds, folders or patterns; - is standard input");
  line.text("-o,--output", output, "OUT", "the file to write: " + written_extensions());
  ShadowOptions shadows;
  common.declare(line);
  line.group("Points");
  for (const char* name : {"crop", "crop-relative", "show-classes", "hide-classes", "filter", "max-points",
                           "columns", "strict", "up", "transform"}) {
    const Option& option = *find_option(name);
    const std::string help = option.name() == "hide-classes"
                                 ? "classification codes left out, and withheld points (none)"
                                 : option.help;
    declare_option(line, request, option, help);
  }
  DistanceOptions distances;
  distances.declare(line);
  shadows.declare(line);
  line.usage("sfumato convert IN... -o OUT");
  if (!line.parse(words)) return 0;
  common.apply();
  if (inputs.empty() || output.empty())
    throw Error(ErrorCode::usage,
                std::string(inputs.empty() ? "no input given" : "no output given: add -o OUT") +
                    "; usage: sfumato convert IN... -o OUT");
  scene::SceneOptions wanted = request.scene_options();
  shadows.check();
  if (output.ends_with(".copc.laz"))
    throw Error(ErrorCode::usage, "-o " + output + ": levels are built by sfumato build IN... -o " + output +
                                      "; convert writes a .laz without .copc");
  if (!io::can_write(output))
    throw Error(ErrorCode::usage, "-o " + output + ": clouds are written as " + written_extensions());

  inputs = scene::expand_inputs(inputs);
  const std::vector<scene::SceneFile> placed = placed_files(inputs, request.transforms);
  io::FileNames names;
  for (const std::string& file : inputs)
    if (file != "-") names.input("the input", file);
  distances.check(names);
  names.output("-o", output);
  // Without OpenGL that should not cost the time of reading a large scan.
  std::unique_ptr<gl::Context> context;
  if (shadows.is_asked()) context = gl::Context::create_headless();
  Console console(common);
  wanted.read.every_attribute = wanted.keep_degrees = true;
  scene::Scene scene = scene::read_scene(placed, wanted, console);
  for (const std::string& note : scene.notes) console.say("sfumato: " + note);
  for (const io::ReadReport& file : scene.files)
    for (const std::string& note : file.digits) console.say("sfumato: " + file.file.string() + ": " + note);
  for (const std::string& part : scene.damage) console.complain("sfumato: " + part);
  if (scene.points_missing > 0)
    console.complain("sfumato: " + missing_points(scene.points_missing, scene.points_read));
  if (const std::string note = unused_columns(scene.files, wanted.read); !note.empty())
    console.say("sfumato: " + note);
  tell_what_stays(scene, placed, console);
  if (distances.is_asked()) distances.add(scene, console);
  if (context) shadows.add(scene, wanted.up, *context, console);
  for (const std::string& note : io::write(output, scene.cloud, console).notes)
    console.say("sfumato: " + output + ": " + note);
  // What rendering will find: the custom of the old format says less than the shape.
  const UpAxis up = scene.cloud.up == UpAxis::pos_z || scene.cloud.up_is_known
                        ? scene.cloud.up
                        : stand_upright(scene, {}).upright.up;
  if (up != UpAxis::pos_z && !output.ends_with(".ply"))
    console.say("sfumato: " + output + ": files of this format are taken as +Z up, this cloud is " +
                to_string(up) + " up: render it with --up " + to_string(up));
  console.say("wrote " + output + " (" + counted_of(scene.cloud.size(), scene.points_read, "point") + ")");
  return scene.damage.empty() ? 0 : int(ErrorCode::partial);
}

}  // namespace sfumato::cli
