// The chunk table is coded with LASzip's arithmetic coder (A. Said, "Introduction to arithmetic coding -
// theory and practice", HP Labs 2004, FastAC; M. Isenburg, LASzip): read here, with bounds, because LASzip
// itself allocates and indexes on its word.
#include "io/laz_table.h"

#include <algorithm>
#include <array>

#include "io/laz_models.h"

namespace sfumato::io::las {
namespace {

// Reads past the end give zeros and set `is_overrun`.
class ArithmeticDecoder {
 public:
  explicit ArithmeticDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next_byte();
  }
  bool is_overrun() const { return is_overrun_; }

  bool bit(BitModel& model) {
    const std::uint32_t split = model.zero_probability() * (length_ >> bit_shift);
    const bool result = value_ >= split;
    if (result)
      value_ -= split, length_ -= split;
    else
      length_ = split;
    renormalize();
    model.count(result);
    return result;
  }

  std::uint32_t symbol(SymbolModel& model) {
    std::uint32_t low = 0, high = model.size(), start = 0, end = length_;
    length_ >>= symbol_shift;
    for (std::uint32_t middle = high >> 1; middle != low; middle = (low + high) >> 1) {
      const std::uint32_t at = length_ * model.distribution(middle);
      if (at > value_)
        high = middle, end = at;
      else
        low = middle, start = at;
    }
    value_ -= start;
    length_ = end - start;
    renormalize();
    model.count(low);
    return low;
  }

  std::uint32_t bits(int count) {
    if (count > 19) {
      const std::uint32_t low = bits(16);
      return bits(count - 16) << 16 | low;
    }
    length_ >>= count;
    const std::uint32_t result = length_ ? value_ / length_ : 0;
    value_ -= length_ * result;
    renormalize();
    return result;
  }

 private:
  std::uint32_t next_byte() {
    if (at_ < bytes_.size()) return bytes_[at_++];
    is_overrun_ = true;
    return 0;
  }
  void renormalize() {
    // A length of 0 comes from damaged input only; it must not shift for ever.
    if (length_ == 0) length_ = min_length, is_overrun_ = true;
    while (length_ < min_length) {
      value_ = value_ << 8 | next_byte();
      length_ <<= 8;
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::uint32_t value_ = 0, length_ = 0xFFFFFFFFu;
  bool is_overrun_ = false;
};

// LASzip's IntegerCompressor for 32-bit values, two contexts and 8 high bits: the difference to a prediction,
// as its number of bits and the bits themselves.
class IntegerDecoder {
 public:
  explicit IntegerDecoder(ArithmeticDecoder& decoder) : decoder_(decoder) {
    for (int bits = 1; bits <= 32; ++bits) correctors_.emplace_back(1u << std::min(bits, high_bits));
  }
  std::uint32_t decode(std::uint32_t prediction, int context) {
    return prediction + correction(sizes_[context]);
  }

 private:
  static constexpr int high_bits = 8;

  std::uint32_t correction(SymbolModel& sizes) {
    const int k = int(decoder_.symbol(sizes));
    if (k == 0) return decoder_.bit(single_) ? 1 : 0;
    if (k >= 32) return 0x80000000u;
    std::uint32_t c = decoder_.symbol(correctors_[std::size_t(k - 1)]);
    if (k > high_bits) c = c << (k - high_bits) | decoder_.bits(k - high_bits);
    return c >= 1u << (k - 1) ? c + 1 : c - ((1u << k) - 1);
  }

  ArithmeticDecoder& decoder_;
  std::array<SymbolModel, 2> sizes_{SymbolModel(33), SymbolModel(33)};
  BitModel single_;
  std::vector<SymbolModel> correctors_;
};

std::uint64_t first_chunk(const Header& header) { return header.point_data + 8; }

// Byte of the table; 0 when the writer never came to write it.
std::uint64_t table_byte(const InputFile& file, const Header& header) {
  std::uint8_t bytes[8];
  file.read(header.point_data, bytes, sizeof bytes);
  std::uint64_t byte = get<std::uint64_t>(bytes);
  if (byte == ~std::uint64_t{0} && file.size() >= first_chunk(header) + 8) {
    // Written to a stream that could not go back: the address is the last thing in the file.
    file.read(file.size() - 8, bytes, sizeof bytes);
    byte = get<std::uint64_t>(bytes);
  }
  return byte >= first_chunk(header) && byte <= file.size() - 8 ? byte : 0;
}

}  // namespace

std::optional<std::vector<LazChunk>> read_chunk_table(const InputFile& file, const Header& header,
                                                      const LazLayout& layout, std::string& reason) {
  auto missing = [&](const std::string& why) {
    reason = why;
    return std::nullopt;
  };
  if (!layout.is_chunked) return missing("this file of an old LASzip has no chunks");
  const std::uint64_t table = table_byte(file, header);
  if (table == 0) return missing("the chunk table is missing");
  std::uint8_t head[8];
  file.read(table, head, sizeof head);
  const std::uint32_t version = get<std::uint32_t>(head), count = get<std::uint32_t>(head + 4);
  const std::uint64_t data = table - first_chunk(header);
  const bool is_variable = layout.chunk_size == variable_chunks;
  const std::uint64_t fixed = is_variable ? 0 : (header.count + layout.chunk_size - 1) / layout.chunk_size;
  // A chunk is at least one point as it is; this bounds what is allocated below.
  if (version != 0 || count > data / layout.record_length || (!is_variable && count != fixed))
    return missing("the chunk table does not fit the file");

  // Each entry takes at most some 10 bytes; what lies behind (extended records) is not wanted.
  const std::uint64_t room = std::min<std::uint64_t>(file.size() - table - 8, 64 + 16ull * count);
  std::vector<std::uint8_t> bytes(room);
  file.read(table + 8, bytes.data(), room);
  ArithmeticDecoder decoder(bytes);
  IntegerDecoder integers(decoder);
  std::vector<LazChunk> chunks;
  std::uint64_t byte = first_chunk(header), first = 0;
  std::uint32_t points = 0, size = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (is_variable)
      points = integers.decode(points, 0);
    else
      points = std::uint32_t(std::min<std::uint64_t>(layout.chunk_size, header.count - first));
    size = integers.decode(size, 1);
    if (decoder.is_overrun() || points > largest_chunk || points > header.count - first ||
        size > table - byte || (points > 0 && size < layout.record_length))
      return missing("the chunk table is damaged");
    if (points > 0) chunks.push_back({byte, size, first, points});
    byte += size;
    first += points;
  }
  if (first != header.count) return missing("the chunk table names fewer points than the header");
  return chunks;
}

std::vector<LazChunk> walk_layered_chunks(const InputFile& file, const Header& header,
                                          const LazLayout& layout) {
  std::vector<LazChunk> chunks;
  std::vector<std::uint8_t> head(std::size_t(layout.record_length) + 4 + 4 * layout.layers);
  std::uint64_t byte = first_chunk(header), first = 0;
  while (first < header.count) {
    file.read(byte, head.data(), head.size());
    std::uint32_t count = 0;
    const std::uint64_t size = layered_chunk_size(layout, head, file.size() - byte, count);
    if (size == 0 || count == 0 || count > largest_chunk || count > header.count - first)
      file.fail(byte, "found a chunk of " + std::to_string(count) +
                          " points that does not fit the file, expected " +
                          std::to_string(header.count - first) +
                          " more points; the file is truncated or damaged");
    chunks.push_back({byte, size, first, count});
    byte += size;
    first += count;
  }
  return chunks;
}

}  // namespace sfumato::io::las
