// sfumato info: what a file holds.
#include <fmt/format.h>

#include "analysis/prepare.h"
#include "commands.h"
#include "console.h"
#include "io/io.h"
#include "report.h"

namespace sfumato::cli {
namespace {

std::string info_text(const io::ReadReport& r, double spacing) {
  std::string text;
  auto row = [&](const char* key, const std::string& value) {
    text += fmt::format("{:<16}{}\n", key, value);
  };
  auto point = [](const dvec3& v) { return fmt::format("{}, {}, {}", v.x, v.y, v.z); };
  row("file", r.file.string());
  row("format", r.format);
  row("points", std::to_string(r.points));
  row("points_finite", std::to_string(r.points_finite));
  row("points_dropped", std::to_string(r.points_dropped));
  row("bounds_min", r.points_finite ? point(r.bounds_min) : "-");
  row("bounds_max", r.points_finite ? point(r.bounds_max) : "-");
  row("crs", r.crs.empty() ? "-" : r.crs);
  row("median_spacing", r.points_finite ? fmt::format("{:.6g}", spacing) : "-");
  text += fmt::format("{:<24}{:>16}{:>16}{:>16}\n", "attributes", "min", "max", "mean");
  for (const io::AttributeStats& a : r.attributes)
    text += fmt::format("  {:<22}{:>16.10g}{:>16.10g}{:>16.10g}\n", a.name, a.min, a.max, a.mean);
  return text;
}

}  // namespace

int info_command(const Words& words) {
  std::string file;
  bool json = false, quiet = false;
  std::optional<std::string> columns;
  CommandLine line("sfumato info", "Prints what a point cloud file holds.");
  line.positional("FILE", file, "a point cloud");
  line.flag("--json", json, "machine-readable");
  line.text("--columns", columns, "x,y,z,...", "text files: names of the columns, instead of the guess");
  line.flag("--quiet", quiet, "no progress, no notes");
  if (!line.parse(words)) return 0;
  if (file.empty()) throw Error(ErrorCode::usage, "info needs a file: sfumato info FILE [--json]");

  Console console(quiet);
  io::ReadOptions options;
  if (columns) options.columns = split(*columns, ',');
  io::ReadResult result = io::read(file, options, console);
  for (const std::string& note : result.report.notes) console.say("sfumato: " + file + ": " + note);
  double spacing = 0;
  if (!result.cloud.empty())
    spacing = analysis::prepare(std::move(result.cloud), {}, {}, console).median_spacing;
  print(json ? info_json(result.report, spacing) : info_text(result.report, spacing));
  return 0;
}

}  // namespace sfumato::cli
