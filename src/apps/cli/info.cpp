// sfumato info: what a file holds.
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/prepare.h"
#include "batch.h"
#include "commands.h"
#include "common_options.h"
#include "console.h"
#include "copc/tree.h"
#include "core/classes.h"
#include "core/counted.h"
#include "core/units.h"
#include "help_text.h"
#include "input_options.h"
#include "report.h"
#include "scene/scene.h"

namespace sfumato::cli {
namespace {

/// Fifteen digits: 848935.2, not 848935.2000000001.
std::string coordinate(double value) { return fmt::format("{:.15g}", value); }

/// Ten digits, more where the number has more in front of its point: times of 1e18.
std::string statistic(double value) {
  constexpr double largest_whole = 1e20;
  if (std::abs(value) < 1e10) return fmt::format("{:.10g}", value);
  return std::abs(value) < largest_whole ? fmt::format("{:.{}f}", value, value == std::floor(value) ? 0 : 3)
                                         : fmt::format("{:.17g}", value);
}

/// WKT broken at its commas between brackets, two levels deep.
std::string break_wkt(const std::string& crs, int indent) {
  if (crs.size() < 60 || crs.find('[') == std::string::npos) return crs;
  std::string text;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < crs.size(); ++i) {
    const char c = crs[i];
    if (c == '\n' || c == '\r') continue;
    quoted = c == '"' ? !quoted : quoted;
    depth += quoted ? 0 : c == '[' ? 1 : c == ']' ? -1 : 0;
    text += c;
    if (c == ',' && !quoted && depth <= 2 && i + 1 < crs.size() &&
        std::isalpha(static_cast<unsigned char>(crs[i + 1])))
      text += "\n" + std::string(std::size_t(indent + 2 * depth), ' ');
  }
  return text;
}

std::string info_text(const io::ReadReport& r, std::optional<double> spacing,
                      const std::vector<ClassShare>& classes = {}) {
  std::string text;
  auto row = [&](const char* key, const std::string& value) {
    text += fmt::format("{:<16}{}\n", key, value);
  };
  auto point = [](const dvec3& v) {
    return coordinate(v.x) + ", " + coordinate(v.y) + ", " + coordinate(v.z);
  };
  const dvec3 size = r.bounds_max - r.bounds_min;
  row("file", r.file.string());
  row("format", r.format);
  row("points", std::to_string(r.points));
  row("points_finite", std::to_string(r.points_finite));
  row("points_dropped", std::to_string(r.points_dropped));
  if (r.points_missing > 0) row("points_missing", std::to_string(r.points_missing) + " in damaged parts");
  row("bounds_min", r.points_finite ? point(r.bounds_min) : "-");
  row("bounds_max", r.points_finite ? point(r.bounds_max) : "-");
  row("extent", r.points_finite ? fmt::format("{:.6g} x {:.6g} x {:.6g}", size.x, size.y, size.z) : "-");
  row("crs", r.crs.empty() ? "-" : break_wkt(r.crs, 16));
  row("median_spacing", r.points_finite && spacing ? fmt::format("{:.6g}", *spacing) : "-");
  row("density",
      r.points_finite && spacing && *spacing > 0
          ? fmt::format("{:.4g} points/{}2", 1 / (*spacing * *spacing), horizontal_unit(r.crs).symbol)
          : "-");
  for (const ClassShare& each : classes)
    text += fmt::format("  class {:<6}{:>12}  {}\n", each.id, thousands(each.points), class_name(each.id));
  text += fmt::format("{:<24}{:>16}{:>16}{:>16}\n", "attributes", "min", "max", "mean");
  for (const io::AttributeStats& a : r.attributes)
    text += fmt::format("  {:<22} {:>15} {:>15} {:>15}\n", a.name, statistic(a.min), statistic(a.max),
                        statistic(a.mean));
  return text;
}

std::string table_row(const io::ReadReport& r, std::optional<double> spacing) {
  const dvec3 size = r.bounds_max - r.bounds_min;
  return fmt::format("{:<10}{:>14}  {:<30}{:>12}  {}\n", r.format, thousands(r.points),
                     r.points_finite ? fmt::format("{:.5g} x {:.5g} x {:.5g}", size.x, size.y, size.z) : "-",
                     r.points_finite && spacing ? fmt::format("{:.4g}", *spacing) : "-", r.file.string());
}

std::string tree_text(const copc::Tree& tree) {
  // The table of attributes needs the points: names stand in its place.
  std::string text = info_text(report_of(tree), std::nullopt);
  text.erase(text.rfind("attributes"));
  text += fmt::format("{:<8}{:>10}{:>16}{:>16}\n", "levels", "nodes", "points", "spacing");
  for (const copc::LevelFacts& level : levels_of(tree))
    text +=
        fmt::format("  {:<6}{:>10}{:>16}{:>16.6g}\n", level.level, level.nodes, level.points, level.spacing);
  return text +
         fmt::format("{:<16}{}\n", "attributes",
                     wrap(join(tree.attributes) + " (--stats reads their values)", terminal_width(), 16));
}

}  // namespace

int info_command(const Words& words) {
  Words files;
  bool json = false, stats = false, is_partial = false;
  std::optional<std::string> columns;
  CommonOptions common;
  scene::SceneOptions options;
  CommandLine line("sfumato info", "Prints what a point cloud file holds; several files give a table.");
  line.positionals("FILE", files, "point clouds, folders or patterns; - is standard input");
  line.flag("--json", json, "machine-readable");
  line.flag("--stats", stats,
            "read all points of COPC, EPT and Potree too, for ranges of attributes and the spacing");
  line.flag("--strict", options.read.strict,
            "refuse partly damaged files instead of skipping the damaged parts");
  line.text("--columns", columns, "x,y,z,...",
            "names of the columns of text files, .npy rows and .bin floats, instead of a guess");
  common.declare(line);
  if (!line.parse(words)) return 0;
  common.apply();
  if (files.empty()) throw Error(ErrorCode::usage, "info needs a file: sfumato info FILE... [--json]");

  Console console(common);
  if (columns) options.read.columns = split(*columns, ',');
  files = scene::expand_inputs(files);
  const bool several = files.size() > 1;
  Batch batch(several, console);
  std::string text;
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < files.size(); ++i)
    batch.run(files[i], [&] {
      console.set_step("file", i, files.size());
      if (!stats && files[i] != "-" && copc::is_tree(files[i])) {
        const copc::Tree tree = copc::read_tree(files[i]);
        if (json)
          list.push_back(nlohmann::ordered_json::parse(tree_json(tree)));
        else
          text += several ? table_row(report_of(tree), std::nullopt) : tree_text(tree);
        return;
      }
      io::ReadResult result = scene::read_file(files[i], options.read, console);
      for (const auto* notes : {&result.report.notes, &result.report.digits})
        for (const std::string& note : *notes) console.say("sfumato: " + files[i] + ": " + note);
      for (const std::string& part : result.report.damage)
        console.complain("sfumato: " + part + io::is_left_out);
      is_partial |= !result.report.damage.empty();
      if (const std::string note = unused_columns({&result.report, 1}, options.read); !note.empty())
        console.say("sfumato: " + files[i] + ": " + note);
      double spacing = 0;
      std::vector<ClassShare> classes;
      if (const ScalarField* field = result.cloud.scalar("classification")) classes = count_classes(*field);
      if (!result.cloud.empty())
        spacing = analysis::prepare(std::move(result.cloud), {}, {}, console).median_spacing;
      if (json)
        list.push_back(nlohmann::ordered_json::parse(info_json(result.report, spacing, classes)));
      else
        text += several ? table_row(result.report, spacing) : info_text(result.report, spacing, classes);
    });
  if (json)
    print((several ? list : list.at(0)).dump(2) + "\n");
  else
    print((several ? fmt::format("{:<10}{:>14}  {:<30}{:>12}  {}\n", "format", "points", "extent", "spacing",
                                 "file")
                   : "") +
          text);
  const int code = batch.exit_code();
  return code == 0 && is_partial ? int(ErrorCode::partial) : code;
}

}  // namespace sfumato::cli
