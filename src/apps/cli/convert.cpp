// sfumato convert: between the formats that can be written, several files into one, and only the points
// wanted.
#include "commands.h"
#include "common_options.h"
#include "console.h"
#include "core/error.h"
#include "input_options.h"
#include "io/file_names.h"
#include "io/io.h"

namespace sfumato::cli {
namespace {

std::string written_extensions() {
  std::string list;
  for (const io::FormatInfo& format : io::formats())
    if (format.can_write) list += (list.empty() ? "" : " ") + format.extensions;
  return list;
}

}  // namespace

int convert_command(const Words& words) {
  std::string output;
  Words inputs;
  InputOptions input("none");
  CommonOptions common;
  CommandLine line(
      "sfumato convert",
      "Converts point clouds; order and every attribute are kept. Several inputs become one cloud, whose "
      "scalar `file` tells them apart.");
  line.positionals("IN", inputs, "point clouds, folders or patterns; - is standard input");
  line.text("-o,--output", output, "OUT", "the file to write: " + written_extensions());
  common.declare(line);
  input.declare(line);
  line.usage("sfumato convert IN... -o OUT");
  if (!line.parse(words)) return 0;
  common.apply();
  if (inputs.empty() || output.empty())
    throw Error(ErrorCode::usage,
                std::string(inputs.empty() ? "no input given" : "no output given: add -o OUT") +
                    "; usage: sfumato convert IN... -o OUT");
  input.check();
  if (output.ends_with(".copc.laz"))
    throw Error(ErrorCode::usage, "-o " + output + ": levels are built by sfumato build IN... -o " + output +
                                      "; convert writes a .laz without .copc");
  if (!io::can_write(output))
    throw Error(ErrorCode::usage, "-o " + output + ": clouds are written as " + written_extensions());

  inputs = scene::expand_inputs(inputs);
  io::FileNames names;
  for (const std::string& file : inputs)
    if (file != "-") names.input("the input", file);
  names.output("-o", output);
  Console console(common);
  input.scene.read.every_attribute = true;
  const scene::Scene scene = scene::read_scene(inputs, input.scene, console);
  for (const std::string& note : scene.notes) console.say("sfumato: " + note);
  for (const std::string& part : scene.damage) console.complain("sfumato: " + part + "; it is left out");
  if (scene.points_missing > 0)
    console.complain("sfumato: " + missing_points(scene.points_missing, scene.points_read));
  if (const std::string note = unused_columns(scene, input.scene); !note.empty())
    console.say("sfumato: " + note);
  for (const std::string& note : io::write(output, scene.cloud, console).notes)
    console.say("sfumato: " + output + ": " + note);
  if (scene.cloud.up != UpAxis::pos_z && !output.ends_with(".ply"))
    console.say("sfumato: " + output + ": files of this format are taken as +Z up, this cloud is " +
                to_string(scene.cloud.up) + " up: render it with --up " + to_string(scene.cloud.up));
  const std::string of =
      scene.cloud.size() == scene.points_read ? "" : " of " + std::to_string(scene.points_read);
  console.say("wrote " + output + " (" + std::to_string(scene.cloud.size()) + of + " points)");
  return scene.damage.empty() ? 0 : int(ErrorCode::partial);
}

}  // namespace sfumato::cli
