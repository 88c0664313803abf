#include "io/laz_chunk.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "io/decoder_pool.h"
#include "io/las_records.h"
#include "io/laz_raw.h"

namespace sfumato::io::las {
namespace {

// Parts of the "laszip encoded" record (22204): compressor at 0, coder at 2, chunk size at 12, number of
// items at 32, then items of {type, size, version} from 34 on.
constexpr std::size_t layout_head = 34, item_size = 6;
enum Compressor : std::uint16_t { pointwise = 1, pointwise_chunked = 2, layered_chunked = 3 };

struct Item {
  std::uint16_t type, size;
};

// The items LASzip writes for a point format; the extra bytes come last.
std::vector<Item> expected_items(const Header& header) {
  constexpr std::uint16_t byte = 0, point10 = 6, gps11 = 7, rgb12 = 8, wave13 = 9, point14 = 10, rgb14 = 11,
                          rgbnir14 = 12, wave14 = 13, byte14 = 14;
  static const std::vector<Item> items[11] = {{{point10, 20}},
                                              {{point10, 20}, {gps11, 8}},
                                              {{point10, 20}, {rgb12, 6}},
                                              {{point10, 20}, {gps11, 8}, {rgb12, 6}},
                                              {{point10, 20}, {gps11, 8}, {wave13, 29}},
                                              {{point10, 20}, {gps11, 8}, {rgb12, 6}, {wave13, 29}},
                                              {{point14, 30}},
                                              {{point14, 30}, {rgb14, 6}},
                                              {{point14, 30}, {rgbnir14, 8}},
                                              {{point14, 30}, {wave14, 29}},
                                              {{point14, 30}, {rgbnir14, 8}, {wave14, 29}}};
  std::vector<Item> expected = items[header.format];
  const auto extra = std::uint16_t(header.record_length - min_record_length[std::size_t(header.format)]);
  if (extra) expected.push_back({header.format >= 6 ? byte14 : byte, extra});
  return expected;
}

std::uint32_t layer_count(const Header& header) {
  // Nine layers of the point, then one for colour, one for near infrared, one for the wave packet, one a
  // byte.
  const int format = header.format;
  return 9u + (format == 7) + 2u * (format == 8 || format == 10) + (format >= 9) +
         (header.record_length - min_record_length[std::size_t(format)]);
}

// What stands before the chunk in a LAS 1.4 file that holds it alone: header, the LASzip record, and the
// address of a chunk table equal to its own place, which LASzip takes as "no table, read on".
std::vector<std::uint8_t> chunk_head(const LazLayout& layout, std::uint32_t count, std::uint32_t chunk_size) {
  constexpr std::uint32_t header_size = 375, vlr_header = 54;
  const std::uint32_t points = header_size + vlr_header + std::uint32_t(layout.vlr.size());
  std::vector<std::uint8_t> bytes(points + (layout.is_chunked ? 8 : 0));
  std::uint8_t* b = bytes.data();
  std::memcpy(b, "LASF", 4);
  b[24] = 1;
  b[25] = 4;
  put<std::uint16_t>(b + 94, header_size);
  put<std::uint32_t>(b + 96, points);
  put<std::uint32_t>(b + 100, 1);
  b[104] = std::uint8_t(layout.format | 0x80);
  put<std::uint16_t>(b + 105, layout.record_length);
  if (layout.format < 6) put<std::uint32_t>(b + 107, count);
  for (int axis = 0; axis < 3; ++axis) put<double>(b + 131 + 8 * axis, 1.0);
  put<std::uint64_t>(b + 247, count);
  std::uint8_t* vlr = b + header_size;
  std::memcpy(vlr + 2, "laszip encoded", 14);
  put<std::uint16_t>(vlr + 18, 22204);
  put<std::uint16_t>(vlr + 20, std::uint16_t(layout.vlr.size()));
  std::memcpy(vlr + vlr_header, layout.vlr.data(), layout.vlr.size());
  put<std::uint32_t>(vlr + vlr_header + 12, chunk_size);
  if (layout.is_chunked) put<std::uint64_t>(b + points, points);
  return bytes;
}

// The arithmetic decoder starts with the four bytes at the head of a stream and indexes its tables with them:
// all ones is the one value that an encoder never writes and that leads outside.
bool is_decodable(const std::uint8_t* stream) { return get<std::uint32_t>(stream) != 0xFFFFFFFFu; }

}  // namespace

LazLayout read_laz_layout(const InputFile& file, const Header& header) {
  const Vlr* record = header.vlr("laszip encoded", 22204);
  if (!record)
    file.fail(100, "found no LASzip record, expected one before compressed points; the header is damaged");
  auto require = [&](bool is_fine, std::uint64_t at, const std::string& what) {
    if (!is_fine) file.fail(record->byte + at, what + "; the LASzip record is damaged or of a newer LASzip");
  };
  require(record->data.size() >= layout_head, 0,
          "found a LASzip record of " + std::to_string(record->data.size()) + " bytes, expected at least 34");
  const std::uint8_t* b = record->data.data();
  const std::vector<Item> items = expected_items(header);
  LazLayout layout;
  layout.format = header.format;
  layout.record_length = header.record_length;
  const auto compressor = get<std::uint16_t>(b);
  layout.is_chunked = compressor != pointwise;
  layout.is_layered = compressor == layered_chunked;
  require(
      header.format >= 6 ? layout.is_layered : (compressor == pointwise || compressor == pointwise_chunked),
      0,
      "found compressor " + std::to_string(compressor) + " for point format " +
          std::to_string(header.format) + ", expected " + (header.format >= 6 ? "3" : "1 or 2"));
  require(get<std::uint16_t>(b + 2) == 0, 2,
          "found entropy coder " + std::to_string(get<std::uint16_t>(b + 2)) + ", expected 0");
  layout.chunk_size = get<std::uint32_t>(b + 12);
  if (layout.chunk_size == 0) layout.chunk_size = variable_chunks;  // so written by some COPC software
  require(!layout.is_chunked || layout.chunk_size == variable_chunks || layout.chunk_size <= largest_chunk,
          12,
          "found chunks of " + std::to_string(layout.chunk_size) + " points, expected at most " +
              std::to_string(largest_chunk));
  const auto count = get<std::uint16_t>(b + 32);
  require(count == items.size() && record->data.size() >= layout_head + item_size * items.size(), 32,
          "found " + std::to_string(count) + " items, expected " + std::to_string(items.size()) +
              " for point format " + std::to_string(header.format));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::size_t at = layout_head + item_size * i;
    const auto type = get<std::uint16_t>(b + at), size = get<std::uint16_t>(b + at + 2),
               version = get<std::uint16_t>(b + at + 4);
    require(type == items[i].type && size == items[i].size, at,
            "found item " + std::to_string(type) + " of " + std::to_string(size) + " bytes, expected item " +
                std::to_string(items[i].type) + " of " + std::to_string(items[i].size));
    require(layout.is_layered ? version == 3 || version == 4 : version == 1 || version == 2, at + 4,
            "found item version " + std::to_string(version) + ", expected " +
                (layout.is_layered ? "3" : "1 or 2"));
  }
  if (layout.is_layered) layout.layers = layer_count(header);
  layout.vlr.assign(b, b + layout_head + item_size * items.size());
  return layout;
}

std::uint64_t layered_chunk_size(const LazLayout& layout, std::span<const std::uint8_t> bytes,
                                 std::uint64_t available, std::uint32_t& count) {
  const std::uint64_t head = std::uint64_t(layout.record_length) + 4 + 4ull * layout.layers;
  if (bytes.size() < head || available < head) return 0;
  count = get<std::uint32_t>(bytes.data() + layout.record_length);
  std::uint64_t size = head;
  for (std::uint32_t i = 0; i < layout.layers; ++i)
    size += get<std::uint32_t>(bytes.data() + layout.record_length + 4 + 4 * i);
  return size <= available ? size : 0;
}

// Of memory that LASzip takes beside the chunk: some MB.
constexpr std::uint64_t decoder_memory_limit = 192 << 20;

std::string name_of(const LazChunk& chunk) {
  if (chunk.level < 0) return "chunk " + std::to_string(chunk.number);
  std::string name = "node " + std::to_string(chunk.level);
  for (const std::int32_t place : {chunk.x, chunk.y, chunk.z}) name += "-" + std::to_string(place);
  return name;
}

struct LazDecoder::State {
  const InputFile& file;
  LazLayout layout;
  LazChunk chunk;
  Progress& progress;
  std::size_t block_points = 0;
  std::uint64_t decoded = 0;
  std::optional<DecoderJob> job;
  // Where there are no decoder processes.
  std::vector<std::uint8_t> bytes, records;
  std::unique_ptr<LazRawDecoder> here;

  [[noreturn]] void fail(const std::string& what) const {
    file.fail(chunk.byte, "found " + what + " in the compressed points from point " +
                              std::to_string(chunk.first + decoded) + " on (" + name_of(chunk) + ", points " +
                              std::to_string(chunk.first) + " to " +
                              std::to_string(chunk.first + chunk.count - 1) +
                              "); the file is truncated or damaged");
  }

  // Heads of the streams inside the chunk, where LASzip trusts what it reads.
  void check_chunk(const std::uint8_t* data) const {
    if (!layout.is_layered) {
      if (chunk.size < layout.record_length || (chunk.count > 1 && chunk.size < layout.record_length + 4u))
        fail("too few bytes");
      if (chunk.count > 1 && !is_decodable(data + layout.record_length)) fail("an impossible stream");
      return;
    }
    std::uint32_t count = 0;
    const std::uint64_t size = layered_chunk_size(layout, {data, std::size_t(chunk.size)}, chunk.size, count);
    if (size == 0) fail("layers larger than their chunk");
    if (count != (chunk.held ? chunk.held : chunk.count))
      fail(std::to_string(count) + " points where " + std::to_string(chunk.count) + " were expected");
    const std::uint8_t* sizes = data + layout.record_length + 4;
    const std::uint8_t* layer = sizes + 4 * layout.layers;
    for (std::uint32_t i = 0; i < layout.layers; ++i) {
      const std::uint32_t bytes_in_layer = get<std::uint32_t>(sizes + 4 * i);
      if (bytes_in_layer > 0 && (bytes_in_layer < 4 || !is_decodable(layer))) fail("an impossible layer");
      layer += bytes_in_layer;
    }
  }
};

LazDecoder::LazDecoder(const InputFile& file, const LazLayout& layout, const LazChunk& chunk, bool is_run,
                       Progress& progress)
    : state_(new State{file, layout, chunk, progress}) {
  State& s = *state_;
  s.block_points = std::min<std::size_t>(records_at_a_time(layout.record_length), chunk.count);
  if (chunk.byte > file.size() || chunk.size > file.size() - chunk.byte)
    file.fail(chunk.byte, "found a chunk of " + std::to_string(chunk.size) +
                              " bytes, expected it to end before the " + "file's " +
                              std::to_string(file.size()) + "; the file is truncated or damaged");
  if (chunk.count == 0) return;
  const std::vector<std::uint8_t> head =
      chunk_head(layout, chunk.count, is_run ? layout.chunk_size : std::max(1u, chunk.count));
  const std::size_t size = head.size() + chunk.size, block_size = s.block_points * layout.record_length;
  std::span<std::uint8_t> input;
  if (why_no_decoders().empty()) {
    s.job.emplace();
    input = s.job->make_room(size, block_size);
  } else {
    s.bytes.resize(size);
    input = s.bytes;
  }
  std::copy(head.begin(), head.end(), input.begin());
  file.read(chunk.byte, input.data() + head.size(), chunk.size);
  s.check_chunk(input.data() + head.size());
  try {
    if (!s.job) {
      s.records.resize(block_size);
      s.here = std::make_unique<LazRawDecoder>(input, layout.format, layout.record_length);
      return;
    }
    DecodeJob job;
    job.format = std::uint32_t(layout.format), job.record_length = layout.record_length;
    job.block_points = std::uint32_t(s.block_points), job.points = chunk.count;
    job.input_size = size;
    s.job->begin(job, decoder_memory_limit);
  } catch (const LazFault& fault) {
    s.fail(fault.what());
  } catch (const DecodeFault& fault) {
    s.fail(fault.what());
  }
}

LazDecoder::~LazDecoder() {
  if (state_->job && state_->decoded == state_->chunk.count) state_->job->done();
}

std::span<std::uint8_t> LazDecoder::next() {
  State& s = *state_;
  const std::size_t count = std::min<std::uint64_t>(s.block_points, s.chunk.count - s.decoded);
  if (count == 0) return {};
  std::span<std::uint8_t> records;
  try {
    if (s.job) {
      records = s.job->next(count, s.layout.record_length, s.progress);
      if (records.size() != count * s.layout.record_length) s.fail("too few points");
    } else {
      records = std::span(s.records).first(count * s.layout.record_length);
      s.here->decode(records.data(), count);
    }
  } catch (const LazFault& fault) {
    s.fail(fault.what());
  } catch (const DecodeFault& fault) {
    s.fail(fault.what());
  }
  s.decoded += count;
  return records;
}

}  // namespace sfumato::io::las
