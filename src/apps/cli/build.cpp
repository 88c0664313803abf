// sfumato build: files of any size to one COPC file with levels of detail.
#include "copc/build.h"

#include <fmt/format.h>

#include <chrono>

#include "commands.h"
#include "common_options.h"
#include "console.h"
#include "core/counted.h"
#include "core/error.h"
#include "io/atomic_writer.h"
#include "io/file_names.h"
#include "scene/scene.h"

namespace sfumato::cli {
namespace {

constexpr const char* usage = "sfumato build IN... -o OUT.copc.laz";

Attributes parse_attributes(const std::string& text) {
  Attributes wanted;
  for (const std::string& word : split(text, ',')) {
    if (word == "normal")
      wanted = wanted | Attribute::normal;
    else if (word == "uncertainty")
      wanted = wanted | Attribute::uncertainty;
    else
      throw Error(ErrorCode::usage,
                  "--attributes: '" + word + "' cannot be stored; write normal, uncertainty or both");
  }
  return wanted;
}

}  // namespace

int build_command(const Words& words) {
  std::string output, memory = "4G";
  std::optional<std::string> box, max_points, attributes;
  Words inputs;
  copc::BuildOptions options;
  CommonOptions common;
  CommandLine line(
      "sfumato build",
      "Builds one COPC file (Cloud Optimized Point Cloud 1.0, a LAZ with levels of detail) of files of any "
      "size. Every attribute and the coordinate system are kept; LAS, LAZ and COPC are read in parts, other "
      "formats a file at a time. Temporary files are written beside the output.");
  line.positionals("IN", inputs, "point clouds, folders or patterns");
  line.text("-o,--output", output, "OUT.copc.laz", "the file to write");
  line.text("--memory", memory, "BYTES", "memory that the build may take, at least 256M (4G)");
  line.text("--max-points", max_points, "N",
            "an even subset of so many points, the same one every time (1e6, 250k, 2M)");
  line.text("--box", box, "X0,Y0,Z0,X1,Y1,Z1", "only the points in this box, world coordinates");
  line.text(
      "--attributes", attributes, "normal,uncertainty",
      "compute these of all points and store them, so that coarse levels carry what holds of the whole");
  line.flag("--average-colors", options.average_colors,
            "points of coarse levels get the mean colour around them");
  common.declare(line);
  line.usage(usage);
  if (!line.parse(words)) return 0;
  common.apply();
  if (inputs.empty() || output.empty())
    throw Error(ErrorCode::usage,
                std::string(inputs.empty() ? "no input given" : "no output given: add -o OUT.copc.laz") +
                    "; usage: " + usage);
  if (!output.ends_with(".copc.laz") || io::is_standard_output(output))
    throw Error(ErrorCode::usage, "-o " + output + ": build writes COPC: name a file that ends in .copc.laz");
  options.memory = std::uint64_t(parse_whole("--memory", memory, long(copc::least_memory)));
  if (max_points) options.max_points = std::uint64_t(parse_whole("--max-points", *max_points, 1));
  if (box) options.box = parse_box("--box", *box);
  if (attributes) options.attributes = parse_attributes(*attributes);

  inputs = scene::expand_inputs(inputs);
  io::FileNames names;
  for (const std::string& file : inputs) {
    if (file == "-")
      throw Error(ErrorCode::usage,
                  "-: build reads files in parts, and standard input has none; name a file");
    names.input("the input", file);
  }
  names.output("-o", output);
  Console console(common);
  const auto began = std::chrono::steady_clock::now();
  const copc::BuildReport report = copc::build({inputs.begin(), inputs.end()}, output, options, console);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  for (const std::string& note : report.notes) console.say("sfumato: " + note);
  console.say(fmt::format("wrote {} ({}, {} in {}, {:.3g} MB)", output,
                          counted_of(report.points, report.points_read, "point"),
                          counted(report.nodes, "node"), counted(std::uint64_t(report.levels), "level"),
                          double(report.bytes) / 1e6));
  console.tell(fmt::format("spacing {:.6g} at the root; {:.1f} s, {:.2f} million points a second",
                           report.spacing, seconds, double(report.points_read) / 1e6 / seconds));
  return 0;
}

}  // namespace sfumato::cli
