// sfumato publish FILE... -o FOLDER: pictures from all around, and a page that turns them without a server.
#include "publish.h"

#include <fmt/format.h>

#include "commands.h"
#include "core/counted.h"
#include "core/error.h"
#include "io/atomic_writer.h"
#include "render_request.h"

namespace sfumato::cli {
namespace {

constexpr int most_views = 360;

std::string box_text(const Bounds& box) {
  const dvec3 size = box.max - box.min;
  const double span = std::max({size.x, size.y, size.z});
  const int digits = span > 0 ? std::clamp(4 - int(std::floor(std::log10(span))), 0, 9) : 3;
  return fmt::format("{:.{}f}, {:.{}f}, {:.{}f} to {:.{}f}, {:.{}f}, {:.{}f}", box.min.x, digits, box.min.y,
                     digits, box.min.z, digits, box.max.x, digits, box.max.y, digits, box.max.z, digits);
}

}  // namespace

publish::Facts facts_to_publish(const RenderOptions& options, const Choice& choice,
                                const RenderReport& report, const std::string& command, const Drawn& drawn) {
  publish::Facts facts;
  const std::string first = stem_of(options.files.front());
  facts.title = !options.furniture.title.empty() ? options.furniture.title
                : options.files.size() == 1      ? first
                                            : fmt::format("{} and {} more", first, options.files.size() - 1);
  facts.command = command;
  facts.background = report.background;
  facts.unit = drawn.pose.unit;
  facts.up = drawn.pose.upright.up;
  facts.vertical_exaggeration = drawn.pose.vertical_exaggeration;
  facts.has_furniture = !options.furniture.empty();
  auto& rows = facts.rows;
  for (const io::ReadReport& file : drawn.files)
    rows.emplace_back("file", fmt::format("{} ({}, {})", file.file.filename().string(), file.format,
                                          counted(file.points, "point")));
  rows.emplace_back("points drawn", fmt::format("{}", report.points_rendered));
  if (report.points_hidden + report.points_left_out > 0)
    rows.emplace_back("points left out", fmt::format("{}", report.points_hidden + report.points_left_out));
  rows.emplace_back("extent", box_text(drawn.box));
  rows.emplace_back("unit", facts.unit.metres > 0
                                ? fmt::format("{} ({} m)", facts.unit.symbol, facts.unit.metres)
                                : facts.unit.symbol + " (the file names none; --unit m does)");
  rows.emplace_back("up axis", report.up);
  if (!drawn.crs.empty()) rows.emplace_back("reference system", drawn.crs.substr(0, 2000));
  rows.emplace_back("technique", choice.techniques.front()->name);
  for (const RenderReport::Draw& each : report.draw)
    rows.emplace_back("item", fmt::format("{} ({})", each.rule, counted(each.points, "point")));
  rows.emplace_back("coloured by", report.color_by);
  return facts;
}

int publish_command(const Words& words) {
  RenderRequest request(words, "sfumato publish",
                        "Writes a turntable of pictures as static files, for any browser.");
  RenderOptions& options = request.options;
  std::string views = "36", elevations;
  request.line.group("Publishing");
  request.line.text("--views", views, "N", "pictures per turn (36)");
  request.line.text("--elevations", elevations, "DEG,DEG...",
                    "camera elevations (that of the first view, and one 30 degrees from it)");
  request.line.usage("sfumato publish FILE... -o FOLDER [--views N] [-t TECHNIQUE]");
  request.line.footer(
      "Open FOLDER/index.html, or copy the folder to any web host: it needs no server program. It holds "
      "only pictures, of --resolution (1600x1200). docs/serve.md has more.");
  request.line.restate("output", "FOLDER",
                       "the folder to write: a new or an empty one, or one published before");
  request.exclude({"output-panels", "output-depth", "depth-unit", "output-index", "output-normal",
                   "output-camera", "world-file", "no-background", "path", "frames", "degrees", "sequence",
                   "each", "watch", "panorama", "quality"},
                  "publish, which shows one scene from all around");
  if (!request.parse(words)) return 0;
  const std::string folder = std::exchange(options.output, {});
  if (options.files.empty() && options.scene.empty())
    throw Error(ErrorCode::usage, "publish what? name a file: sfumato publish FILE... -o FOLDER");
  if (folder.empty() || io::is_standard_output(folder))
    throw Error(ErrorCode::usage, "publish writes a folder: add -o FOLDER");
  if (request.choice.count > 1)
    throw Error(ErrorCode::usage, "publish shows one technique: name one, or publish a folder for each");
  const long around = parse_whole("--views", views, 3);
  if (around > most_views) throw Error(ErrorCode::usage, fmt::format("--views: at most {}", most_views));
  std::vector<double> heights;
  for (const std::string& each : elevations.empty() ? Words() : split(elevations, ','))
    heights.push_back(parse_degrees("--elevations", each, -90, 90));
  if (!options.view.size && options.camera_file.empty() && !options.view.start)
    options.view.size = {1600, 1200};
  publish::Publication publication(folder, int(around), heights);
  options.publication = &publication;
  request.check();
  Words command = words;
  command.insert(command.begin(), {"sfumato", "publish"});
  return draw_pictures(request, quote(command));
}

}  // namespace sfumato::cli
