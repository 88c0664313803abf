#include "io/vpc.h"

#include <algorithm>

#include "io/bounded_json.h"
#include "io/byte_source.h"
#include "io/format.h"
#include "io/tiles.h"

namespace sfumato::io {

bool is_vpc_name(const std::filesystem::path& file) {
  const std::string& name = file.native();
  return name.substr(0, is_remote(file) ? name.find_first_of("?#") : name.npos).ends_with(".vpc");
}

std::vector<std::filesystem::path> vpc_files(const std::filesystem::path& path) {
  const nlohmann::ordered_json list = load_json(path);
  std::vector<std::filesystem::path> files;
  if (!list.is_object() || !list.contains("features") || !list["features"].is_array())
    bad_input(path, "JSON", "found no list of features; a .vpc is a STAC FeatureCollection");
  for (const auto& feature : list["features"]) {
    if (!feature.is_object() || !feature.contains("assets") || !feature["assets"].is_object()) continue;
    for (const auto& [name, asset] : feature["assets"].items()) {
      if (!asset.is_object() || !asset.contains("href") || !asset["href"].is_string()) continue;
      auto href = asset["href"].get<std::string>();
      if (!has_cloud_name(href.substr(0, href.find_first_of("?#")))) continue;  // a thumbnail
      if (href.starts_with("./")) href.erase(0, 2);
      if (is_remote(href))
        files.emplace_back(href);
      else if (is_remote(path) && href.starts_with('/'))
        bad_input(path, "JSON", "found '" + href.substr(0, 60) + "', a file of another machine");
      else
        files.push_back(beside(path, href));
    }
  }
  if (files.empty()) bad_input(path, "JSON", "found no file of points in its features");
  return files;
}

bool is_vpc(std::string_view head) { return begins_as_object_with(head, {"FeatureCollection"}); }

ReadResult read_vpc(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  ReadResult all;
  ReadReport& report = all.report;
  for (const std::filesystem::path& file : vpc_files(path)) {
    if (is_vpc_name(file)) bad_input(path, "JSON", "found a list in a list; name its files");
    ReadResult one = read(file, options, progress);
    const bool is_first = all.cloud.empty();
    append(all.cloud, one.cloud);
    report.bounds_min = is_first ? one.report.bounds_min : glm::min(report.bounds_min, one.report.bounds_min);
    report.bounds_max = is_first ? one.report.bounds_max : glm::max(report.bounds_max, one.report.bounds_max);
    report.points += one.report.points, report.points_finite += one.report.points_finite;
    report.points_dropped += one.report.points_dropped, report.points_missing += one.report.points_missing;
    if (report.crs.empty()) report.crs = all.cloud.crs = one.report.crs;
    for (const std::string& line : one.report.damage) report.damage.push_back(line);
    for (const std::string& note : one.report.notes)
      if (std::find(report.notes.begin(), report.notes.end(), note) == report.notes.end())
        report.notes.push_back(note);
  }
  return all;
}

}  // namespace sfumato::io
