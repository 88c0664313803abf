// The octree of a COPC file or of tiles (EPT, Potree 2), known from its header and hierarchy: what is where,
// before any point is read.
#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "copc/octree.h"
#include "io/io.h"
#include "io/las.h"
#include "io/tiles.h"

namespace sfumato::copc {

struct TreeNode {
  Key key;
  std::uint64_t points = 0;
  io::las::LazChunk chunk = {};  ///< of COPC; tiles have the numbers of their nodes
};

struct Tree {
  std::filesystem::path file;
  std::string format = "copc";
  std::uint64_t points = 0;
  Cube cube;
  double spacing = 0;           ///< of the root; each level halves it
  Bounds bounds;                ///< what the header says of the points
  std::vector<TreeNode> nodes;  ///< those with points, in file order
  std::string crs;
  std::vector<std::string> attributes;         ///< names, as the reader gives them
  std::optional<io::las::LazChunk> sample;     ///< RecordSample, where `build` stored one
  std::shared_ptr<const io::TiledScan> tiled;  ///< where it is no COPC file

  /// The part of the node's cell that can hold points, world.
  Bounds box(const Key& key) const;
  double spacing_of(int level) const { return std::ldexp(spacing, -level); }
};

struct LevelFacts {
  int level = 0;
  std::size_t nodes = 0;
  std::uint64_t points = 0;
  double spacing = 0;
};
/// From the root down.
std::vector<LevelFacts> levels_of(const Tree& tree);

/// Whether the file is COPC or describes tiles, by its first bytes. False when it cannot be opened, and for
/// standard input.
bool is_tree(const std::filesystem::path& file);

/// Reads header and hierarchy. Throws Error(bad_input) when they are damaged.
Tree read_tree(const std::filesystem::path& file, Progress& progress = no_progress());

/// What is decided of all nodes, for those who read some: their clouds agree, as of io::ReadOptions::part.
struct TreeChoices {
  io::las::WholeFile of_las;
  io::TileChoices of_tiles;
};
TreeChoices choices_of(const Tree& tree, Progress& progress = no_progress());

/// Those of the nodes that the part has, by their points.
std::vector<std::size_t> part_of(const Tree& tree, const std::vector<std::size_t>& nodes,
                                 const io::Part& part);

/// Reads the points of these nodes only (numbers in `tree.nodes`), in file order. Nodes that cannot be
/// decoded are left out: see the report. `choices`: else by what these nodes hold.
io::ReadResult read_nodes(const Tree& tree, const std::vector<std::size_t>& nodes,
                          Progress& progress = no_progress(), const io::KeptChunks& kept = {},
                          const TreeChoices* choices = nullptr);

/// `Tree::sample` along a Morton curve. Nothing where there is none, or where it is damaged.
std::optional<io::ReadResult> read_sample(const Tree& tree, Progress& progress = no_progress(),
                                          const io::KeptChunks& kept = {});

}  // namespace sfumato::copc
