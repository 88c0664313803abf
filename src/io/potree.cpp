// Potree 2 octrees (Schütz et al. 2020): metadata.json, hierarchy.bin and octree.bin.
#include <algorithm>
#include <cstring>
#include <deque>
#include <memory>
#include <set>

#include "io/bounded_json.h"
#include "io/file.h"
#include "io/format.h"
#include "io/number_at.h"
#include "io/tiles.h"

namespace sfumato::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t node_size = 22;
constexpr std::uint8_t proxy = 2;

struct PotreeAttribute {
  std::size_t offset = 0, size = 0;
  bool is_position = false, is_color = false;
};

struct Potree {
  std::filesystem::path path;
  TileLayout layout;
  std::vector<PotreeAttribute> attributes;
  bool is_brotli = false;
  std::uint64_t first_page = 0;
  std::string crs;
  dvec3 cube_min{0};
  double cube_size = 0, spacing = 0;
};

std::string potree_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

Potree read_metadata(const std::filesystem::path& path) {
  const Json json = load_json(path);
  const auto refuse = [&](const std::string& what) { bad_input(path, "JSON", what + "; convert it again"); };
  const auto three_of = [&](const Json& in, const char* key, double(&out)[3]) {
    if (!in.contains(key) || !in[key].is_array() || in[key].size() != 3)
      refuse(std::string("found no '") + key + "' of three numbers");
    for (std::size_t k = 0; k < 3; ++k) {
      if (!in[key][k].is_number()) refuse(std::string("found no '") + key + "' of three numbers");
      out[k] = in[key][k].get<double>();
    }
  };
  static const std::pair<const char*, StoredType> types[] = {
      {"int8", StoredType::int8},     {"uint8", StoredType::uint8},   {"int16", StoredType::int16},
      {"uint16", StoredType::uint16}, {"int32", StoredType::int32},   {"uint32", StoredType::uint32},
      {"int64", StoredType::int64},   {"uint64", StoredType::uint64}, {"float", StoredType::float32},
      {"double", StoredType::float64}};
  Potree potree{path};
  double scale[3], shift[3];
  three_of(json, "scale", scale), three_of(json, "offset", shift);
  double low[3], high[3];
  if (json.contains("boundingBox") && json["boundingBox"].is_object()) {
    const Json& box = json["boundingBox"];
    three_of(box, "min", low), three_of(box, "max", high);
    for (int k = 0; k < 3; ++k) {
      potree.cube_min[k] = low[k];
      potree.cube_size = std::max(potree.cube_size, high[k] - low[k]);
    }
  }
  if (const Json spacing = json.value("spacing", Json()); spacing.is_number())
    potree.spacing = spacing.get<double>();
  const std::string encoding = json.value("encoding", std::string("DEFAULT"));
  potree.is_brotli = encoding == "BROTLI";
  if (!potree.is_brotli && encoding != "DEFAULT" && encoding != "UNCOMPRESSED")
    refuse("found points encoded by '" + encoding.substr(0, 40) + "', expected DEFAULT or BROTLI");
  if (!json.contains("attributes") || !json["attributes"].is_array() || json["attributes"].size() > 256)
    refuse("found no list of attributes");
  for (const Json& one : json["attributes"]) {
    const bool is_whole = one.is_object() && one.contains("name") && one["name"].is_string() &&
                          one.contains("type") && one["type"].is_string();
    if (!is_whole) refuse("found an attribute without name or type");
    const auto name = one["name"].get<std::string>();
    const auto kind = one["type"].get<std::string>();
    const auto type =
        std::find_if(std::begin(types), std::end(types), [&](const auto& t) { return kind == t.first; });
    const Json count = one.value("numElements", Json(1));
    if (type == std::end(types) || !count.is_number_unsigned() || count.get<std::uint64_t>() < 1 ||
        count.get<std::uint64_t>() > 16)
      refuse("found the attribute '" + name.substr(0, 40) + "' of an unknown type");
    PotreeAttribute attribute{potree.layout.record, count.get<std::size_t>() * size_of(type->second)};
    attribute.is_position = name == "position" || name == "POSITION_CARTESIAN";
    attribute.is_color = name == "rgb" || name == "rgba" || name == "RGB" || name == "RGBA";
    const bool is_normal = name == "NORMAL" || name == "normal";
    static const char *const places[] = {"x", "y", "z"}, *const colors[] = {"red", "green", "blue", "alpha"},
                             *const normals[] = {"nx", "ny", "nz"};
    for (std::size_t k = 0; k < count.get<std::size_t>(); ++k) {
      TileField field{potree_name(name), type->second, potree.layout.record};
      if (attribute.is_position && k < 3)
        field.name = places[k], field.scale = scale[k], field.shift = shift[k];
      else if (attribute.is_color && k < 4)
        field.name = colors[k];
      else if (is_normal && k < 3)
        field.name = normals[k];
      else if (count.get<std::size_t>() > 1)
        field.name += "_" + std::to_string(k);
      potree.layout.fields.push_back(field);
      potree.layout.record += size_of(type->second);
    }
    potree.attributes.push_back(attribute);
  }
  if (potree.layout.record == 0) refuse("found no attribute");
  const Json page = json.contains("hierarchy") && json["hierarchy"].is_object()
                        ? json["hierarchy"].value("firstChunkSize", Json())
                        : Json();
  if (!page.is_number_unsigned()) refuse("found no size of the hierarchy");
  potree.first_page = page.get<std::uint64_t>();
  if (json.contains("projection") && json["projection"].is_string())
    potree.crs = json["projection"].get<std::string>();
  return potree;
}

/// The child's number has a bit for each axis, x the highest.
std::array<std::uint32_t, 3> cell_of(const Tile& node, int child) {
  return {node.cell[0] << 1 | std::uint32_t(child >> 2 & 1),
          node.cell[1] << 1 | std::uint32_t(child >> 1 & 1), node.cell[2] << 1 | std::uint32_t(child & 1)};
}

/// Nodes breadth first by pages; the first of a page replaces the proxy that leads to it.
std::vector<Tile> nodes_of(const Potree& potree, Progress& progress) {
  struct Page {
    std::uint64_t byte, size;
    Tile root;
  };
  const File file(beside(potree.path, "hierarchy.bin"));
  const auto refuse = [&](std::uint64_t byte, const std::string& what) {
    bad_input(file.path(), "byte " + std::to_string(byte),
              what + "; the hierarchy is damaged, convert it again");
  };
  std::vector<Tile> tiles;
  std::deque<Page> pages{{0, potree.first_page, {0, 0, "r"}}};
  std::set<std::uint64_t> seen;
  while (!pages.empty()) {
    progress.check();
    const Page page = pages.front();
    pages.pop_front();
    if (!seen.insert(page.byte).second) refuse(page.byte, "found a page that leads back to itself");
    if (page.size == 0 || page.size % node_size != 0 || page.byte > file.size() ||
        page.size > file.size() - page.byte)
      refuse(page.byte, "found a page of " + std::to_string(page.size) +
                            " bytes, expected a multiple of 22 inside the file");
    std::vector<std::byte> bytes(std::size_t(page.size));
    file.read(page.byte, bytes);
    std::vector<Tile> nodes{page.root};
    for (std::size_t i = 0; i * node_size < bytes.size(); ++i) {
      const std::byte* at = bytes.data() + i * node_size;
      if (i >= nodes.size()) refuse(page.byte + i * node_size, "found a node without a parent");
      Tile node = nodes[i];
      const auto type = number_at<std::uint8_t>(at), children = number_at<std::uint8_t>(at + 1);
      node.points = number_at<std::uint32_t>(at + 2);
      node.byte = number_at<std::uint64_t>(at + 6), node.size = number_at<std::uint64_t>(at + 14);
      if (type == proxy) {
        pages.push_back({node.byte, node.size, node});
        continue;
      }
      if (node.size == 0) node.points = 0;  // as some builders leave them
      if (node.points > 0) tiles.push_back(node);
      for (int child = 0; child < 8; ++child)
        if (children >> child & 1 && node.level < 30)
          nodes.push_back({node.level + 1, 0, node.name + char('0' + child), 0, 0, cell_of(node, child)});
    }
  }
  return tiles;
}

/// Every third bit, from `bits`.
std::uint32_t every_third(std::uint64_t bits, int count) {
  std::uint32_t value = 0;
  for (int k = 0; k < count; ++k) value |= std::uint32_t(bits >> (3 * k) & 1) << k;
  return value;
}

/// BROTLI keeps an attribute behind the other: positions and colours with their bits interleaved, as two
/// numbers of 64 bits, high and low, and one.
std::vector<std::byte> interleave(const Potree& potree, const std::vector<std::byte>& apart,
                                  std::size_t points) {
  std::vector<std::byte> records(points * potree.layout.record);
  std::size_t from = 0;
  for (const PotreeAttribute& attribute : potree.attributes)
    for (std::size_t i = 0; i < points; ++i) {
      std::byte* to = records.data() + i * potree.layout.record + attribute.offset;
      if (attribute.is_position) {
        const auto high = number_at<std::uint64_t>(apart.data() + from),
                   low = number_at<std::uint64_t>(apart.data() + from + 8);
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t value = every_third(low >> k, 16) | every_third(high >> k, 16) << 16;
          std::memcpy(to + 4 * k, &value, 4);
        }
        from += 16;
      } else if (attribute.is_color) {
        const auto bits = number_at<std::uint64_t>(apart.data() + from);
        for (int k = 0; k < 3; ++k) {
          const auto value = std::uint16_t(every_third(bits >> k, 16));
          std::memcpy(to + 2 * k, &value, 2);
        }
        from += 8;
      } else {
        std::memcpy(to, apart.data() + from, attribute.size);
        from += attribute.size;
      }
    }
  return records;
}

}  // namespace

bool is_potree(std::string_view head) { return begins_as_object_with(head, {"hierarchy", "firstChunkSize"}); }

TiledScan open_potree(const std::filesystem::path& path, Progress& progress) {
  const auto shared = std::make_shared<const Potree>(read_metadata(path));
  const Potree& potree = *shared;
  std::size_t packed_record = potree.layout.record;
  for (const PotreeAttribute& attribute : potree.attributes) {
    if (!potree.is_brotli || !(attribute.is_position || attribute.is_color)) continue;
    if (attribute.size != (attribute.is_position ? 12u : 6u))
      bad_input(path, "JSON", "found packed positions or colours of another size than 12 and 6 bytes");
    packed_record += attribute.is_position ? 4 : 2;
  }
  TiledScan scan;
  scan.format = "potree";
  scan.cube_min = potree.cube_min, scan.cube_size = potree.cube_size, scan.spacing = potree.spacing;
  scan.bounds = {potree.cube_min, potree.cube_min + potree.cube_size};
  scan.crs = potree.crs, scan.record = potree.layout.record, scan.attributes = names_of(potree.layout);
  scan.tiles = nodes_of(potree, progress);
  if (scan.tiles.empty()) bad_input(path, "hierarchy", "found no node with points; convert it again");
  const auto file = std::make_shared<const File>(beside(path, "octree.bin"));
  const auto load = [=](const Tile& tile) {
    if (tile.byte > file->size() || tile.size > file->size() - tile.byte ||
        tile.points > most_tile_bytes / packed_record)
      bad_input(file->path(), "byte " + std::to_string(tile.byte),
                "found a node of " + std::to_string(tile.size) +
                    " bytes, expected it inside the file; the file is cut short, fetch it again");
    std::vector<std::byte> bytes(std::size_t(tile.size));
    file->read(tile.byte, bytes);
    if (!shared->is_brotli) return bytes;
    return interleave(*shared, unpack_brotli(file->path(), bytes, std::size_t(tile.points) * packed_record),
                      std::size_t(tile.points));
  };
  scan.read = [=](const std::vector<Tile>& tiles, Progress& watch, TileChoices* choices) {
    ReadResult result = read_tiles(path, shared->layout, tiles, load, watch, choices);
    if (!shared->crs.empty()) result.cloud.crs = result.report.crs = shared->crs;
    return result;
  };
  return scan;
}

ReadResult read_potree(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  return read_tiled(path, open_potree(path, progress), options, progress);
}

}  // namespace sfumato::io
