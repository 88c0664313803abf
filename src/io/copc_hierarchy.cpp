#include "io/copc_hierarchy.h"

#include <algorithm>
#include <array>
#include <set>

namespace sfumato::io::las {
namespace {

constexpr std::uint64_t entry_size = 32, info_size = 160, root_page_field = 40;
constexpr std::int32_t deepest_level = 30;

using Key = std::array<std::int32_t, 4>;  // level, x, y, z

bool is_inside_level(const Key& key) {
  if (key[0] < 0 || key[0] > deepest_level) return false;
  const std::int64_t cells = std::int64_t{1} << key[0];
  return std::all_of(key.begin() + 1, key.end(), [&](std::int32_t k) { return k >= 0 && k < cells; });
}

struct Page {
  std::uint64_t byte, size;
};

}  // namespace

std::vector<CopcNode> read_copc_tree(const InputFile& file, const Header& header, const LazLayout& layout) {
  const Vlr& info = *header.vlr("copc", 1);
  if (info.data.size() < info_size)
    file.fail(info.byte, "found a COPC record of " + std::to_string(info.data.size()) +
                             " bytes, expected 160; the file is damaged");
  std::vector<Page> pages{{get<std::uint64_t>(info.data.data() + root_page_field),
                           get<std::uint64_t>(info.data.data() + root_page_field + 8)}};
  std::set<std::uint64_t> seen_pages;
  std::set<Key> seen_keys;
  std::vector<CopcNode> nodes;
  std::uint64_t points = 0, pages_size = 0;
  while (!pages.empty()) {
    const Page page = pages.back();
    pages.pop_back();
    pages_size += page.size;
    if (page.size == 0 || page.size % entry_size != 0 || page.byte > file.size() ||
        page.size > file.size() - page.byte || pages_size > file.size())
      file.fail(page.byte,
                "found a hierarchy page of " + std::to_string(page.size) +
                    " bytes, expected a multiple of 32 inside the file; the file is truncated or damaged");
    if (!seen_pages.insert(page.byte).second)
      file.fail(page.byte,
                "found a hierarchy page that leads back to itself, expected a tree; the file is damaged");
    std::vector<std::uint8_t> bytes(page.size);
    file.read(page.byte, bytes.data(), page.size);
    for (std::uint64_t at = 0; at < page.size; at += entry_size) {
      const std::uint8_t* b = bytes.data() + at;
      const Key key{get<std::int32_t>(b), get<std::int32_t>(b + 4), get<std::int32_t>(b + 8),
                    get<std::int32_t>(b + 12)};
      const auto byte = get<std::uint64_t>(b + 16);
      const auto size = get<std::int32_t>(b + 24), count = get<std::int32_t>(b + 28);
      auto require = [&](bool is_fine, const std::string& what) {
        if (!is_fine) file.fail(page.byte + at, "found " + what + " in the octree; the file is damaged");
      };
      require(is_inside_level(key), "a node outside its level");
      require(count >= -1 && size >= 0, "a negative count");
      if (count == -1) {
        pages.push_back({byte, std::uint64_t(size)});
        continue;
      }
      require(seen_keys.insert(key).second, "the same node twice");
      if (count == 0) continue;
      require(std::uint32_t(count) <= largest_chunk, "a node of " + std::to_string(count) + " points");
      require(size >= layout.record_length && byte >= header.point_data && byte <= file.size() &&
                  std::uint64_t(size) <= file.size() - byte,
              "a node outside the file's points");
      points += std::uint64_t(count);
      require(points <= header.count, "more points than the header's " + std::to_string(header.count));
      nodes.push_back({key[0], key[1], key[2], key[3], {byte, std::uint64_t(size), 0, std::uint32_t(count)}});
    }
  }
  std::sort(nodes.begin(), nodes.end(),
            [](const CopcNode& a, const CopcNode& b) { return a.chunk.byte < b.chunk.byte; });
  std::uint64_t first = 0, end = 0;
  for (CopcNode& one : nodes) {
    LazChunk& node = one.chunk;
    if (node.byte < end)
      file.fail(node.byte,
                "found two octree nodes that overlap, expected one behind the other; the file is damaged");
    end = node.byte + node.size;
    node.level = one.level, node.x = one.x, node.y = one.y, node.z = one.z;
    node.first = first;
    first += node.count;
  }
  return nodes;
}

std::vector<LazChunk> read_copc_nodes(const InputFile& file, const Header& header, const LazLayout& layout) {
  std::vector<LazChunk> chunks;
  for (const CopcNode& node : read_copc_tree(file, header, layout)) chunks.push_back(node.chunk);
  return chunks;
}

}  // namespace sfumato::io::las
