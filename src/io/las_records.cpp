#include "io/las_records.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/copc_hierarchy.h"
#include "io/laz_table.h"

namespace sfumato::io::las {
namespace {

constexpr std::size_t block_size = 1 << 16, block_bytes = 8 << 20;
constexpr std::uint64_t bounds_byte = 179;  // max x, min x, max y, min y, max z, min z

void number_chunks(std::vector<LazChunk>& chunks) {
  for (std::size_t i = 0; i < chunks.size(); ++i) chunks[i].number = std::uint32_t(i);
}

}  // namespace

std::optional<Bounds> header_bounds(const InputFile& file) {
  std::uint8_t bytes[48];
  file.read(bounds_byte, bytes, sizeof bytes);
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    box.max[axis] = get<double>(bytes + 16 * axis);
    box.min[axis] = get<double>(bytes + 16 * axis + 8);
    if (!(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]) && box.min[axis] <= box.max[axis]))
      return std::nullopt;
  }
  return box;
}

std::size_t records_at_a_time(std::size_t record_length) {
  return std::clamp<std::size_t>(block_bytes / record_length, 1, block_size);
}

LazChunks find_chunks(const InputFile& file, const Header& header) {
  LazChunks found{read_laz_layout(file, header)};
  if (header.count == 0) return found;
  if (header.is_copc()) {
    found.chunks = read_copc_nodes(file, header, found.layout);
    const std::uint64_t points =
        found.chunks.empty() ? 0 : found.chunks.back().first + found.chunks.back().count;
    if (points != header.count)
      file.fail(247, "found " + std::to_string(header.count) + " points in the header, expected the " +
                         std::to_string(points) + " of the octree; the file is truncated or damaged");
    return found;
  }
  std::string reason;
  if (auto chunks = read_chunk_table(file, header, found.layout, reason)) {
    found.chunks = std::move(*chunks);
    number_chunks(found.chunks);
    return found;
  }
  found.note = reason + "; the points were found without it";
  if (found.layout.is_layered) {
    found.chunks = walk_layered_chunks(file, header, found.layout);
    number_chunks(found.chunks);
    return found;
  }
  // Without a chunk table the chunks of point formats 0 to 5 can only be found by decoding one after the
  // other.
  if (found.layout.is_chunked && found.layout.chunk_size == variable_chunks)
    file.fail(header.point_data,
              "found no chunk table, expected one in a file of chunks of varying size; "
              "the file is truncated or damaged, fetch it again");
  const std::uint64_t byte = header.point_data + (found.layout.is_chunked ? 8 : 0);
  found.chunks = {{byte, file.size() - std::min(byte, file.size()), 0, std::uint32_t(header.count)}};
  found.is_run = true;
  return found;
}

RecordFile::RecordFile(const std::filesystem::path& path) : path_(path) {
  const InputFile file(path);
  header_ = read_header(file);
  bounds_ = header_bounds(file);
  if (header_.compressed) {
    chunks_ = find_chunks(file, header_);
    for (const LazChunk& chunk : chunks_.chunks) parts_.push_back({chunk.first, chunk.count});
    return;
  }
  const std::size_t block = records_at_a_time(header_.record_length);
  for (std::uint64_t first = 0; first < header_.count; first += block)
    parts_.push_back({first, std::min<std::uint64_t>(block, header_.count - first)});
}

void RecordFile::read(
    std::size_t part,
    const std::function<void(std::uint64_t, const std::uint8_t*, std::size_t)>& sink) const {
  const InputFile file(path_);
  const auto [first, total] = parts_[part];
  if (header_.compressed) {
    LazDecoder decoder(file, chunks_.layout, chunks_.chunks[part], chunks_.is_run);
    std::uint64_t done = 0;
    for (std::span<std::uint8_t> records; !(records = decoder.next()).empty();) {
      const std::size_t count = records.size() / header_.record_length;
      sink(first + done, records.data(), count);
      done += count;
    }
    return;
  }
  const std::size_t length = header_.record_length, block = records_at_a_time(length);
  std::vector<std::uint8_t> records(std::min<std::uint64_t>(block, total) * length);
  for (std::uint64_t done = 0; done < total;) {
    const std::size_t count = std::min<std::uint64_t>(block, total - done);
    file.read(header_.point_data + (first + done) * length, records.data(), count * length);
    sink(first + done, records.data(), count);
    done += count;
  }
}

}  // namespace sfumato::io::las
