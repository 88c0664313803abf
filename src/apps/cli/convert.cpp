// sfumato convert: between the formats that can be written.
#include "commands.h"
#include "console.h"
#include "io/file_names.h"
#include "io/io.h"

namespace sfumato::cli {

int convert_command(const Words& words) {
  std::string input, output;
  bool quiet = false;
  std::optional<std::string> columns, max_points, up;
  CommandLine line("sfumato convert", "Converts a point cloud; order and every attribute are kept.");
  line.positional("IN", input, "a point cloud");
  line.text("-o,--output", output, "OUT", "the file to write: .las .laz .ply");
  line.text("--columns", columns, "x,y,z,...", "text files: names of the columns, instead of the guess");
  line.text("--max-points", max_points, "N", "keep a subsample, the same one every time");
  line.text("--up", up, "+Z|-Z|+Y|...", "axis that points up, where the file does not say");
  line.flag("--quiet", quiet, "no progress, no notes");
  if (!line.parse(words)) return 0;
  if (input.empty() || output.empty()) throw Error(ErrorCode::usage, "usage: sfumato convert IN -o OUT");

  Console console(quiet);
  io::ReadOptions options;
  if (columns) options.columns = split(*columns, ',');
  if (max_points) options.max_points = std::uint64_t(parse_whole("--max-points", *max_points, 1));
  const auto axis = up ? parse_up_axis(*up) : std::nullopt;
  if (up && !axis) throw Error(ErrorCode::usage, "--up: '" + *up + "' is not one of +X -X +Y -Y +Z -Z");
  io::FileNames names;
  names.input("the input", input);
  names.output("-o", output);
  io::ReadResult result = io::read(input, options, console);
  for (const std::string& note : result.report.notes) console.say("sfumato: " + input + ": " + note);
  if (axis) result.cloud.up = *axis;
  io::write(output, result.cloud, console);
  if (result.cloud.up != UpAxis::pos_z && !output.ends_with(".ply"))
    console.say("sfumato: " + output + ": LAS files are taken as +Z up, this cloud is " + to_string(result.cloud.up) +
                " up: render it with --up " + to_string(result.cloud.up));
  console.say("wrote " + output + " (" + std::to_string(result.cloud.size()) + " points)");
  return 0;
}

}  // namespace sfumato::cli
