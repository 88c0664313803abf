#include "copc/tree.h"

#include <algorithm>
#include <cmath>

#include "analysis/morton.h"
#include "io/byte_source.h"
#include "io/copc_hierarchy.h"
#include "io/las_fields.h"
#include "io/las_records.h"

namespace sfumato::copc {

Bounds Tree::box(const Key& key) const {
  const double size = std::ldexp(cube.size, -key.level);
  Bounds cell;
  cell.min = cube.min + size * dvec3(key.x, key.y, key.z);
  cell.max = cell.min + size;
  // Roundings may put a point a little outside either box: nothing that a pixel shows.
  cell.min = glm::clamp(cell.min, bounds.min, bounds.max);
  cell.max = glm::clamp(cell.max, bounds.min, bounds.max);
  return cell;
}

std::vector<LevelFacts> levels_of(const Tree& tree) {
  std::vector<LevelFacts> levels;
  for (const TreeNode& node : tree.nodes) {
    while (int(levels.size()) <= node.key.level)
      levels.push_back({int(levels.size()), 0, 0, tree.spacing_of(int(levels.size()))});
    LevelFacts& level = levels[std::size_t(node.key.level)];
    ++level.nodes;
    level.points += node.points;
  }
  return levels;
}

bool is_tree(const std::filesystem::path& file) {
  if (io::is_standard_input(file)) return false;  // which can be read once only
  try {
    const std::string head = io::File(file).read_text(0, 4096);
    return io::is_copc(head) || io::is_tiled(head);
  } catch (const Error&) {
    if (io::is_remote(file)) throw;  // another try would have to wait as long
    return false;
  }
}

namespace {

Tree tree_of_tiles(const std::filesystem::path& path, Progress& progress) {
  const auto scan = std::make_shared<const io::TiledScan>(io::open_tiled(path, progress));
  if (!(scan->cube_size > 0) || !(scan->spacing > 0) || !std::isfinite(scan->cube_size + scan->spacing))
    throw Error(ErrorCode::bad_input, path.string() +
                                          ": JSON: found no bounds or spacing of the octree above 0, "
                                          "expected both; convert it again");
  Tree tree;
  tree.file = path, tree.format = scan->format;
  tree.cube = {scan->cube_min, scan->cube_size}, tree.spacing = scan->spacing, tree.bounds = scan->bounds;
  tree.crs = scan->crs, tree.attributes = scan->attributes;
  for (const io::Tile& tile : scan->tiles) {
    tree.nodes.push_back({{tile.level, tile.cell[0], tile.cell[1], tile.cell[2]}, tile.points});
    tree.points += tile.points;
  }
  tree.tiled = scan;
  return tree;
}

/// A record that says what no `build` writes is none.
std::optional<io::las::LazChunk> find_sample(const io::las::InputFile& file, const io::las::Header& header) {
  std::uint8_t head[sample_head];
  if (header.sample_size < sizeof head + header.record_length) return std::nullopt;
  file.read(header.sample_byte, head, sizeof head);
  const auto count = io::las::get<std::uint32_t>(head + 4);
  if (io::las::get<std::uint32_t>(head) != sample_version || count == 0 || count > RecordSample::most ||
      io::las::get<std::uint64_t>(head + 8) != header.count)
    return std::nullopt;
  constexpr std::uint64_t overhead = 65'536;  // of a chunk beside its points
  if (header.sample_size > sizeof head + 2 * std::uint64_t(count) * header.record_length + overhead)
    return std::nullopt;
  return io::las::LazChunk{header.sample_byte + sizeof head, header.sample_size - sizeof head, 0, count};
}

}  // namespace

Tree read_tree(const std::filesystem::path& path, Progress& progress) {
  if (io::is_tiled(io::File(path).read_text(0, 4096))) return tree_of_tiles(path, progress);
  const io::las::InputFile file(path);
  const io::las::Header header = io::las::read_header(file);
  const io::las::LazLayout layout = io::las::read_laz_layout(file, header);
  const io::las::Vlr* info = header.vlr("copc", 1);
  if (!info)
    file.fail(375, "found no COPC record, expected one behind the header; build one with sfumato build");
  Tree tree;
  tree.file = path;
  tree.points = header.count;
  for (const io::las::CopcNode& node : io::las::read_copc_tree(file, header, layout))
    tree.nodes.push_back({{node.level, std::uint32_t(node.x), std::uint32_t(node.y), std::uint32_t(node.z)},
                          node.chunk.count,
                          node.chunk});
  std::uint64_t held = 0;
  for (const TreeNode& node : tree.nodes) held += node.points;
  if (held != header.count)
    file.fail(247, "found " + std::to_string(header.count) + " points in the header, expected the " +
                       std::to_string(held) + " of the octree; the file is truncated or damaged");
  // The record's size was checked with the hierarchy.
  dvec3 center;
  for (int axis = 0; axis < 3; ++axis) center[axis] = io::las::get<double>(info->data.data() + 8 * axis);
  const auto half_size = io::las::get<double>(info->data.data() + 24);
  tree.spacing = io::las::get<double>(info->data.data() + 32);
  const bool is_cube =
      std::isfinite(center.x + center.y + center.z) && std::isfinite(half_size) && half_size > 0;
  if (!is_cube || !(tree.spacing > 0) || !std::isfinite(tree.spacing))
    file.fail(info->byte, "found an octree of half size " + std::to_string(half_size) + " and spacing " +
                              std::to_string(tree.spacing) +
                              ", expected numbers above 0; the file is damaged");
  tree.cube = {center - half_size, 2 * half_size};
  const io::las::RecordFile records(path);
  tree.bounds = records.bounds().value_or(Bounds{tree.cube.min, tree.cube.min + tree.cube.size});
  tree.crs = io::las::read_crs(header);
  tree.sample = find_sample(file, header);
  std::vector<std::string> notes;
  for (const auto& fields : {io::las::standard_fields(header.format), io::las::extra_fields(header, notes)})
    for (const io::las::Field& field : fields)
      if (!field.optional) tree.attributes.push_back(field.name);
  return tree;
}

TreeChoices choices_of(const Tree& tree, Progress& progress) {
  TreeChoices choices;
  if (tree.tiled)
    choices.of_tiles = io::choices_of(tree.file, *tree.tiled, progress);
  else
    choices.of_las = io::las::whole_file(tree.file, progress);
  return choices;
}

std::vector<std::size_t> part_of(const Tree& tree, const std::vector<std::size_t>& nodes,
                                 const io::Part& part) {
  std::uint64_t total = 0, before = 0;
  for (const std::size_t i : nodes) total += tree.nodes[i].points;
  std::vector<std::size_t> own;
  for (const std::size_t i : nodes) {
    if (part.holds(before, tree.nodes[i].points, total)) own.push_back(i);
    before += tree.nodes[i].points;
  }
  return own;
}

io::ReadResult read_nodes(const Tree& tree, const std::vector<std::size_t>& nodes, Progress& progress,
                          const io::KeptChunks& kept, const TreeChoices* choices) {
  std::vector<std::size_t> in_order = nodes;
  std::sort(in_order.begin(), in_order.end());
  if (tree.tiled) {
    std::vector<io::Tile> tiles;
    for (std::size_t i : in_order) tiles.push_back(tree.tiled->tiles[i]);
    io::TileChoices of_tiles;
    if (choices) of_tiles = choices->of_tiles;
    return tree.tiled->read(tiles, progress, choices ? &of_tiles : nullptr);
  }
  std::vector<io::las::LazChunk> chunks;
  for (std::size_t i : in_order) chunks.push_back(tree.nodes[i].chunk);
  return io::read_las_chunks(tree.file, chunks, progress, kept, choices ? &choices->of_las : nullptr);
}

std::optional<io::ReadResult> read_sample(const Tree& tree, Progress& progress, const io::KeptChunks& kept) {
  if (!tree.sample) return std::nullopt;
  io::ReadResult result = io::read_las_chunks(tree.file, {*tree.sample}, progress, kept);
  if (!result.report.damage.empty() || result.cloud.empty()) return std::nullopt;
  analysis::reorder(result.cloud, analysis::morton_order(result.cloud));
  result.cloud.source_index.clear();  // of the record, not of the file
  return result;
}

}  // namespace sfumato::copc
