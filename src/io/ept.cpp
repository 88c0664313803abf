// Entwine Point Tiles 1.0 (and 0.0): ept.json, a hierarchy of counts, and a tile a node.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <set>

#include "io/bounded_json.h"
#include "io/file.h"
#include "io/format.h"
#include "io/tiles.h"

namespace sfumato::io {
namespace {

using Json = nlohmann::ordered_json;

/// "ReturnNumber", as PDAL writes it, is return_number here.
std::string plain_name(const std::string& name) {
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool is_upper = name[i] >= 'A' && name[i] <= 'Z';
    if (is_upper && i > 0 && !(name[i - 1] >= 'A' && name[i - 1] <= 'Z')) plain += '_';
    plain += is_upper ? char(name[i] - 'A' + 'a') : name[i];
  }
  return plain;
}

std::optional<StoredType> type_of(const std::string& kind, std::uint64_t size) {
  const auto of = [&](StoredType one, StoredType two, StoredType four, StoredType eight) {
    return size == 1   ? std::optional(one)
           : size == 2 ? std::optional(two)
           : size == 4 ? std::optional(four)
           : size == 8 ? std::optional(eight)
                       : std::nullopt;
  };
  if (kind == "unsigned")
    return of(StoredType::uint8, StoredType::uint16, StoredType::uint32, StoredType::uint64);
  if (kind == "signed") return of(StoredType::int8, StoredType::int16, StoredType::int32, StoredType::int64);
  if (kind == "float" && size >= 4)
    return size == 4   ? std::optional(StoredType::float32)
           : size == 8 ? std::optional(StoredType::float64)
                       : std::nullopt;
  return std::nullopt;
}

TileLayout layout_of(const std::filesystem::path& path, const Json& schema) {
  TileLayout layout;
  if (!schema.is_array() || schema.empty() || schema.size() > 256)
    bad_input(path, "schema", "found no list of dimensions; export it again");
  for (const Json& one : schema) {
    const auto number = [&](const char* key, double otherwise) {
      return one.contains(key) && one[key].is_number() ? one[key].get<double>() : otherwise;
    };
    if (!one.is_object() || !one.contains("name") || !one["name"].is_string() || !one.contains("type") ||
        !one["type"].is_string())
      bad_input(path, "schema", "found a dimension without name or type; export it again");
    const std::string name = one["name"].get<std::string>();
    const std::optional<StoredType> type =
        type_of(one["type"].get<std::string>(), std::uint64_t(number("size", 0)));
    if (!type) bad_input(path, "schema", "found '" + name + "' of an unknown type or size; export it again");
    layout.fields.push_back(
        {plain_name(name), *type, layout.record, number("scale", 1), number("offset", 0)});
    layout.record += size_of(*type);
  }
  return layout;
}

/// "2-0-1-3": level and cell.
std::optional<Tile> tile_of(const std::string& key) {
  std::uint32_t numbers[4] = {};
  const char *at = key.data(), *const end = at + key.size();
  for (int k = 0; k < 4; ++k) {
    const auto [next, error] = std::from_chars(at, end, numbers[k]);
    if (error != std::errc() || (k < 3 ? next == end || *next != '-' : next != end)) return std::nullopt;
    at = next + 1;
  }
  if (numbers[0] > 30) return std::nullopt;
  for (int k = 1; k < 4; ++k)
    if (numbers[k] >> numbers[0] != 0) return std::nullopt;
  return Tile{int(numbers[0]), 0, key, 0, 0, {numbers[1], numbers[2], numbers[3]}};
}

std::vector<Tile> tiles_of(const std::filesystem::path& path, Progress& progress) {
  std::vector<Tile> tiles;
  std::set<std::string> seen;
  std::deque<std::string> pages{"0-0-0-0"};
  std::set<std::string> seen_pages{pages.front()};
  while (!pages.empty()) {
    progress.check();
    const std::filesystem::path page = beside(path, "ept-hierarchy/" + pages.front() + ".json");
    const File file(page);
    const std::string text = file.read_text(0, std::min<std::uint64_t>(file.size(), most_tile_bytes));
    const nlohmann::json counts = nlohmann::json::parse(text, nullptr, false);
    if (!counts.is_object()) bad_input(page, "JSON", "found no counts of points by node; fetch it again");
    for (const auto& [key, value] : counts.items()) {
      std::optional<Tile> tile = tile_of(key);
      if (!tile || !value.is_number_integer() || value.get<std::int64_t>() < -1)
        bad_input(page, "JSON", "found '" + key.substr(0, 40) + "', expected counts as \"2-0-1-3\": 1000");
      const auto points = value.get<std::int64_t>();
      if (points == -1) {
        if (seen_pages.insert(key).second) pages.push_back(key);
      } else if (points > 0 && seen.insert(key).second) {
        tile->points = std::uint64_t(points);
        tiles.push_back(std::move(*tile));
      }
    }
    pages.pop_front();
  }
  return tiles;
}

/// Six numbers, the least three first; nothing where they are no box.
std::optional<Bounds> box_in(const Json& ept, const char* key) {
  if (!ept.contains(key) || !ept[key].is_array() || ept[key].size() != 6) return std::nullopt;
  Bounds box;
  for (int k = 0; k < 3; ++k) {
    const Json &low = ept[key][std::size_t(k)], &high = ept[key][std::size_t(k + 3)];
    if (!low.is_number() || !high.is_number()) return std::nullopt;
    box.min[k] = low.get<double>(), box.max[k] = high.get<double>();
    if (!std::isfinite(box.min[k]) || !std::isfinite(box.max[k]) || !(box.min[k] <= box.max[k]))
      return std::nullopt;
  }
  return box;
}

}  // namespace

bool is_ept(std::string_view head) { return begins_as_object_with(head, {"hierarchyType", "dataType"}); }

TiledScan open_ept(const std::filesystem::path& path, Progress& progress) {
  const Json ept = load_json(path);
  const auto text = [&](const Json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_string()
               ? object[key].get<std::string>()
               : std::string();
  };
  const std::string kind = text(ept, "dataType");
  const bool is_laz = kind == "laszip", is_packed = kind == "zstandard";
  if (!is_laz && !is_packed && kind != "binary")
    bad_input(path, "JSON",
              "found tiles of '" + kind.substr(0, 40) + "', expected laszip, binary or zstandard");
  if (!ept.contains("schema")) bad_input(path, "JSON", "found no schema; export it again");
  TiledScan scan;
  scan.format = "ept";
  const TileLayout layout = layout_of(path, ept["schema"]);
  scan.record = layout.record, scan.attributes = names_of(layout);
  if (const std::optional<Bounds> cube = box_in(ept, "bounds")) {
    constexpr double usual_span = 128;
    const Json span = ept.value("span", ept.value("ticks", Json(usual_span)));
    const dvec3 size = cube->size();
    scan.cube_min = cube->min, scan.cube_size = std::max({size.x, size.y, size.z});
    scan.spacing =
        scan.cube_size / (span.is_number() && span.get<double>() >= 1 ? span.get<double>() : usual_span);
    scan.bounds = box_in(ept, "boundsConforming").value_or(*cube);
  }
  scan.tiles = tiles_of(path, progress);
  if (scan.tiles.empty()) bad_input(path, "hierarchy", "found no node with points; fetch it again");
  scan.crs = ept.contains("srs") ? text(ept["srs"], "wkt") : "";
  const auto file_of = [=](const Tile& tile) {
    return beside(path, "ept-data/" + tile.name + (is_laz ? ".laz" : is_packed ? ".zst" : ".bin"));
  };
  scan.read = [=, crs = scan.crs](const std::vector<Tile>& tiles, Progress& watch, TileChoices* choices) {
    ReadResult result;
    if (is_laz) {
      std::vector<std::filesystem::path> files;
      for (const Tile& tile : tiles) files.push_back(file_of(tile));
      result = read_las_tiles(files, watch, choices);
    } else {
      result = read_tiles(
          path, layout, tiles,
          [&](const Tile& tile) {
            const std::uint64_t size = tile.points * layout.record;
            const File file(file_of(tile));
            if (tile.points > most_tile_bytes / layout.record || file.size() > most_tile_bytes)
              bad_input(file.path(), "size", "the tile is larger than 256 MB; the hierarchy is damaged");
            std::vector<std::byte> bytes(std::size_t(file.size()));
            file.read(0, bytes);
            return is_packed ? unpack_zstd(file.path(), bytes, std::size_t(size)) : bytes;
          },
          watch, choices);
    }
    if (!crs.empty()) result.cloud.crs = result.report.crs = crs;
    return result;
  };
  return scan;
}

ReadResult read_ept(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  return read_tiled(path, open_ept(path, progress), options, progress);
}

}  // namespace sfumato::io
