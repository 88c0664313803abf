// The octree of a COPC 1.0 file: a list of LASzip chunks.
#pragma once

#include <vector>

#include "io/laz_chunk.h"

namespace sfumato::io::las {

struct CopcNode {
  std::int32_t level = 0, x = 0, y = 0, z = 0;
  LazChunk chunk;
};

/// As `read_copc_nodes`, and where they are in the octree.
std::vector<CopcNode> read_copc_tree(const InputFile& file, const Header& header, const LazLayout& layout);

/// The nodes that hold points, by their place in the file, so that their points come in the order of a linear
/// read. Throws Error(bad_input) for pages outside the file, cycles, duplicate or impossible nodes, and
/// counts beyond the header's.
std::vector<LazChunk> read_copc_nodes(const InputFile& file, const Header& header, const LazLayout& layout);

}  // namespace sfumato::io::las
