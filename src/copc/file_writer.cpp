// COPC 1.0: a LAZ 1.4 file whose first record says where the octree is; the octree lies in an extended record
// behind the points, as pages of {key, byte, size, count}.
#include "copc/file_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "io/laz_encode.h"

namespace sfumato::copc {
namespace {

using io::las::put;

constexpr std::size_t header_size = 375, vlr_head = 54, evlr_head = 60, info_size = 160, entry_size = 32;
constexpr std::size_t longest_vlr = 65535;
// Hierarchies beyond this many nodes are split into pages of so many levels, so that a reader of a part needs
// few.
constexpr std::size_t single_page = 4096;
constexpr int page_levels = 4;

struct Entry {
  Key key;
  std::uint64_t byte = 0;
  std::int32_t size = 0, count = 0;  ///< a count of -1 leads to a page
};

void put_entry(std::vector<std::uint8_t>& bytes, const Entry& entry) {
  std::uint8_t b[entry_size];
  put(b, entry.key.level);
  put(b + 4, entry.key.x), put(b + 8, entry.key.y), put(b + 12, entry.key.z);
  put(b + 16, entry.byte);
  put(b + 24, entry.size), put(b + 28, entry.count);
  bytes.insert(bytes.end(), b, b + entry_size);
}

/// Pages, the ones further down first; `at` is where the next one lies.
class Pages {
 public:
  Pages(const std::map<Key, Entry>& nodes, std::uint64_t byte)
      : nodes_(nodes), at_(byte), is_split_(nodes.size() > single_page) {}
  std::vector<std::uint8_t> bytes;

  /// Writes the page that begins at `root` and returns the entry that leads to it.
  Entry write(const Key& root) {
    std::vector<std::uint8_t> page;
    collect(root, root.level + page_levels, page);
    const Entry entry{root, at_, std::int32_t(page.size()), -1};
    at_ += page.size();
    bytes.insert(bytes.end(), page.begin(), page.end());
    return entry;
  }

 private:
  void collect(const Key& key, int end_level, std::vector<std::uint8_t>& page) {
    put_entry(page, nodes_.at(key));
    for (unsigned octant = 0; octant < 8; ++octant) {
      const Key child = key.child(octant);
      if (!nodes_.contains(child)) continue;
      if (is_split_ && child.level >= end_level && has_children(child))
        put_entry(page, write(child));
      else
        collect(child, end_level, page);
    }
  }
  bool has_children(const Key& key) const {
    for (unsigned octant = 0; octant < 8; ++octant)
      if (nodes_.contains(key.child(octant))) return true;
    return false;
  }

  const std::map<Key, Entry>& nodes_;
  std::uint64_t at_;
  bool is_split_;
};

}  // namespace

struct FileWriter::Record {
  std::string user_id;
  std::uint16_t record_id;
  std::vector<std::uint8_t> data;
};

FileWriter::FileWriter(const std::filesystem::path& file, const Schema& schema)
    : schema_(schema), writer_(file) {
  if (schema.extra_bytes.size() > longest_vlr)
    throw Error(ErrorCode::usage, file.string() +
                                      ": the description of the extra attributes is longer than 65535 bytes; "
                                      "build fewer files at once");
  const std::vector<std::uint8_t> placeholder = head({}, std::vector<std::uint8_t>(info_size), 0, 0);
  point_data_ = placeholder.size();
  write(placeholder);
  write(std::vector<std::uint8_t>(8));  // where the chunk table is
}

std::vector<FileWriter::Record> FileWriter::records(std::span<const std::uint8_t> info) const {
  std::vector<Record> all{
      {"copc", 1, {info.begin(), info.end()}},
      {"laszip encoded", 22204, io::las::laszip_record(schema_.format, schema_.record_length)}};
  if (!schema_.extra_bytes.empty()) all.push_back({"LASF_Spec", 4, schema_.extra_bytes});
  for (const io::las::Vlr& vlr : schema_.crs)
    if (vlr.data.size() <= longest_vlr) all.push_back({vlr.user_id, vlr.record_id, vlr.data});
  return all;
}

void FileWriter::append(const EncodedNode& node) {
  levels_ = std::max(levels_, node.key.level + 1);
  nodes_.push_back({node.key, writer_.tell(), std::uint32_t(node.bytes.size()), node.count});
  chunks_.push_back({writer_.tell(), node.bytes.size(), 0, node.count});
  write(node.bytes);
}

std::vector<std::uint8_t> FileWriter::head(const Summary& summary, std::span<const std::uint8_t> info,
                                           std::uint64_t first_evlr, std::uint32_t evlrs) const {
  const std::vector<Record> vlrs = records(info);
  std::vector<std::uint8_t> bytes(header_size);
  std::uint8_t* b = bytes.data();
  std::memcpy(b, "LASF", 4);
  put(b + 6, schema_.global_encoding);
  b[24] = 1, b[25] = 4;
  std::memcpy(b + 26, "conversion", 10);
  std::memcpy(b + 58, "sfumato", 7);
  put<std::uint16_t>(b + 90, 1), put<std::uint16_t>(b + 92, 1970);  // the same points give the same bytes
  put<std::uint16_t>(b + 94, header_size);
  put(b + 100, std::uint32_t(vlrs.size()));
  b[104] = std::uint8_t(schema_.format | 0x80);
  put(b + 105, schema_.record_length);
  for (int axis = 0; axis < 3; ++axis) {
    const double a = schema_.scale[axis] * summary.low[std::size_t(axis)] + schema_.offset[axis];
    const double c = schema_.scale[axis] * summary.high[std::size_t(axis)] + schema_.offset[axis];
    put(b + 131 + 8 * axis, schema_.scale[axis]);
    put(b + 155 + 8 * axis, schema_.offset[axis]);
    put(b + 179 + 16 * axis, c);
    put(b + 187 + 16 * axis, a);
  }
  put(b + 235, first_evlr);
  put(b + 243, evlrs);
  put(b + 247, summary.points);
  std::memcpy(b + 255, summary.by_return.data(), 120);
  for (const Record& vlr : vlrs) {
    std::uint8_t head[vlr_head] = {};
    std::memcpy(head + 2, vlr.user_id.data(), std::min<std::size_t>(vlr.user_id.size(), 16));
    put(head + 18, vlr.record_id);
    put(head + 20, std::uint16_t(vlr.data.size()));
    bytes.insert(bytes.end(), head, head + vlr_head);
    bytes.insert(bytes.end(), vlr.data.begin(), vlr.data.end());
  }
  put(bytes.data() + 96, std::uint32_t(bytes.size()));
  return bytes;
}

std::vector<std::uint8_t> FileWriter::hierarchy(std::uint64_t byte, std::uint64_t& root_at,
                                                std::uint64_t& root_size) const {
  std::map<Key, Entry> nodes;
  nodes[Key{}] = {};
  for (const Node& node : nodes_) {
    nodes[node.key] = {node.key, node.byte, std::int32_t(node.size), std::int32_t(node.count)};
    // Nodes whose points all went further up stay, as the way to their children.
    for (Key up = node.key; up.level > 0 && nodes.try_emplace(up.parent(), Entry{up.parent()}).second;)
      up = up.parent();
  }
  Pages pages(nodes, byte);
  const Entry root = pages.write(Key{});
  root_at = root.byte;
  root_size = std::uint64_t(root.size);
  return std::move(pages.bytes);
}

void FileWriter::write_evlr(const char* user_id, std::uint16_t record_id,
                            std::span<const std::uint8_t> data) {
  std::uint8_t head[evlr_head] = {};
  std::memcpy(head + 2, user_id, std::min<std::size_t>(std::strlen(user_id), 16));
  put(head + 18, record_id);
  put(head + 20, std::uint64_t(data.size()));
  write(head);
  write(data);
}

std::uint64_t FileWriter::finish(const Cube& cube, const Summary& summary) {
  const std::uint64_t table_at = writer_.tell();
  write(io::las::chunk_table(chunks_));
  const std::uint64_t first_evlr = writer_.tell();
  std::uint64_t root_at = 0, root_size = 0;
  write_evlr("copc", 1000, hierarchy(first_evlr + evlr_head, root_at, root_size));
  std::uint32_t evlrs = 1;
  for (const io::las::Vlr& vlr : schema_.crs) {
    if (vlr.data.size() <= longest_vlr) continue;
    write_evlr(vlr.user_id.c_str(), vlr.record_id, vlr.data);
    ++evlrs;
  }
  if (sample_.count > 0) {
    std::vector<std::uint8_t> data(sample_head);
    put(data.data(), sample_version), put(data.data() + 4, sample_.count);
    put(data.data() + 8, std::uint64_t(summary.points));
    data.insert(data.end(), sample_.bytes.begin(), sample_.bytes.end());
    write_evlr(io::las::sample_user_id, io::las::sample_record_id, data);
    ++evlrs;
  }
  const std::uint64_t size = writer_.tell();

  std::vector<std::uint8_t> info(info_size);
  const dvec3 center = cube.center();
  const bool has_time = summary.first_time <= summary.last_time;
  const double numbers[5] = {center.x, center.y, center.z, 0.5 * cube.size, cube.size / grid_size};
  const double times[2] = {has_time ? summary.first_time : 0, has_time ? summary.last_time : 0};
  std::memcpy(info.data(), numbers, sizeof numbers);
  put(info.data() + 40, root_at), put(info.data() + 48, root_size);
  std::memcpy(info.data() + 56, times, sizeof times);
  const std::vector<std::uint8_t> bytes = head(summary, info, first_evlr, evlrs);
  writer_.seek(0);
  write(bytes);
  write({reinterpret_cast<const std::uint8_t*>(&table_at), 8});
  writer_.commit();
  return size;
}

}  // namespace sfumato::copc
