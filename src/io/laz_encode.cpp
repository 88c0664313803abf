// LASzip's interface cannot end a chunk where we want. So each chunk is a file of its own in memory, of one
// chunk, out of which its bytes are cut; they are those that LASzip would have written in place.
#include "io/laz_encode.h"

#include <algorithm>
#include <array>
#include <ostream>
#include <streambuf>

#include "core/error.h"
#include "io/laz_models.h"
#include "io/laz_point.h"

namespace sfumato::io::las {
namespace {

constexpr std::size_t pointer_size = 8;  // of the place of the chunk table, before the first chunk

/// A stream into memory that can go back, as LASzip does to write where its chunk table lies.
class MemoryBuffer : public std::streambuf {
 public:
  std::vector<std::uint8_t> bytes;

 protected:
  int_type overflow(int_type byte) override {
    if (traits_type::eq_int_type(byte, traits_type::eof())) return traits_type::not_eof(byte);
    const char c = traits_type::to_char_type(byte);
    return xsputn(&c, 1) == 1 ? byte : traits_type::eof();
  }
  std::streamsize xsputn(const char* from, std::streamsize count) override {
    if (at_ + std::size_t(count) > bytes.size()) bytes.resize(at_ + std::size_t(count));
    std::memcpy(bytes.data() + at_, from, std::size_t(count));
    at_ += std::size_t(count);
    return count;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::end ? off_type(bytes.size())
                                                       : off_type(at_);
    return seekpos(pos_type(base + offset), std::ios_base::out);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode) override {
    if (off_type(position) < 0 || off_type(position) > off_type(bytes.size())) return pos_type(off_type(-1));
    at_ = std::size_t(off_type(position));
    return position;
  }

 private:
  std::size_t at_ = 0;
};

class Laszip {
 public:
  Laszip() {
    if (laszip_create(&handle_) != 0)
      throw Error(ErrorCode::out_of_memory, "LASzip cannot be started: no memory");
  }
  ~Laszip() { laszip_destroy(handle_); }
  Laszip(const Laszip&) = delete;
  Laszip& operator=(const Laszip&) = delete;
  operator laszip_POINTER() const { return handle_; }
  void check(laszip_I32 result) const {
    if (result == 0) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(handle_, &message);
    std::string text = message && *message ? message : "LASzip does not say why";
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw Error(ErrorCode::io, "points cannot be compressed (" + text + ")");
  }

 private:
  laszip_POINTER handle_ = nullptr;
};

// FastAC's encoder, the inverse of the decoder in laz_table.cpp.
class ArithmeticEncoder {
 public:
  std::vector<std::uint8_t> bytes;

  void bit(BitModel& model, bool value) {
    const std::uint32_t split = model.zero_probability() * (length_ >> bit_shift);
    if (value)
      add(split), length_ -= split;
    else
      length_ = split;
    renormalize();
    model.count(value);
  }

  void symbol(SymbolModel& model, std::uint32_t value) {
    const std::uint32_t whole = length_;
    length_ >>= symbol_shift;
    const std::uint32_t low = model.distribution(value) * length_;
    add(low);
    length_ = (value + 1 < model.size() ? model.distribution(value + 1) * length_ : whole) - low;
    renormalize();
    model.count(value);
  }

  void bits(int count, std::uint32_t value) {
    if (count > 19) {
      bits(16, value & 0xFFFFu);
      value >>= 16;
      count -= 16;
    }
    length_ >>= count;
    add(value * length_);
    renormalize();
  }

  /// Writes what decides the last symbols, and the zeros that a decoder reads ahead.
  void finish() {
    const bool is_wide = length_ > 2 * min_length;
    add(is_wide ? min_length : min_length >> 1);
    length_ = is_wide ? min_length >> 1 : min_length >> 9;
    renormalize();
    bytes.insert(bytes.end(), is_wide ? 3 : 2, 0);
  }

 private:
  void add(std::uint32_t amount) {
    const std::uint32_t before = base_;
    base_ += amount;
    if (base_ >= before) return;
    std::size_t at = bytes.size();  // the carry runs through bytes already written
    while (at > 0 && bytes[--at] == 0xFF) bytes[at] = 0;
    ++bytes[at];
  }
  void renormalize() {
    while (length_ < min_length) {
      bytes.push_back(std::uint8_t(base_ >> 24));
      base_ <<= 8;
      length_ <<= 8;
    }
  }

  std::uint32_t base_ = 0, length_ = 0xFFFFFFFFu;
};

// The inverse of IntegerDecoder in laz_table.cpp.
class IntegerEncoder {
 public:
  explicit IntegerEncoder(ArithmeticEncoder& encoder) : encoder_(encoder) {
    for (int bits = 1; bits <= 32; ++bits) correctors_.emplace_back(1u << std::min(bits, high_bits));
  }
  void encode(std::uint32_t prediction, std::uint32_t value, int context) {
    const auto corrector = std::int64_t(std::int32_t(value - prediction));
    // k: the least for which the corrector lies in [-(2^k - 1), 2^k].
    std::uint64_t magnitude = std::uint64_t(corrector <= 0 ? -corrector : corrector - 1);
    int k = 0;
    for (; magnitude; magnitude >>= 1) ++k;
    encoder_.symbol(sizes_[std::size_t(context)], std::uint32_t(k));
    if (k == 0) return encoder_.bit(single_, corrector != 0);
    if (k >= 32) return;
    const auto c = std::uint32_t(corrector < 0 ? corrector + (std::int64_t{1} << k) - 1 : corrector - 1);
    SymbolModel& model = correctors_[std::size_t(k - 1)];
    if (k <= high_bits) return encoder_.symbol(model, c);
    encoder_.symbol(model, c >> (k - high_bits));
    encoder_.bits(k - high_bits, c & ((1u << (k - high_bits)) - 1));
  }

 private:
  static constexpr int high_bits = 8;

  ArithmeticEncoder& encoder_;
  std::array<SymbolModel, 2> sizes_{SymbolModel(33), SymbolModel(33)};
  BitModel single_;
  std::vector<SymbolModel> correctors_;
};

}  // namespace

std::vector<std::uint8_t> laszip_record(int format, std::uint16_t record_length) {
  struct Item {
    std::uint16_t type, size;
  };
  std::vector<Item> items{{10, 30}};
  if (format == 7) items.push_back({11, 6});
  if (format == 8) items.push_back({12, 8});
  if (const int extra = record_length - min_record_length[std::size_t(format)]; extra > 0)
    items.push_back({14, std::uint16_t(extra)});
  std::vector<std::uint8_t> record(34 + 6 * items.size());
  std::uint8_t* b = record.data();
  put<std::uint16_t>(b, 3);  // layered chunks, arithmetic coder 0, by the version of LASzip that brought them
  b[4] = 3, b[5] = 4, put<std::uint16_t>(b + 6, 3);
  put<std::uint32_t>(b + 12, variable_chunks);
  put<std::int64_t>(b + 16, -1);
  put<std::int64_t>(b + 24, -1);
  put(b + 32, std::uint16_t(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::uint16_t words[3] = {items[i].type, items[i].size, 3};
    std::memcpy(b + 34 + 6 * i, words, sizeof words);
  }
  return record;
}

std::vector<std::uint8_t> encode_chunk(int format, std::uint16_t record_length,
                                       std::span<const std::uint8_t> records) {
  const std::size_t count = records.size() / record_length;
  MemoryBuffer buffer;
  buffer.bytes.reserve(records.size() / 2 + 4096);
  std::ostream stream(&buffer);
  Laszip laszip;
  laszip_header_struct header{};
  header.version_major = 1;
  header.version_minor = 4;
  header.header_size = header.offset_to_point_data = 375;
  header.point_data_format = std::uint8_t(format);
  header.point_data_record_length = record_length;
  header.extended_number_of_point_records = count;
  header.x_scale_factor = header.y_scale_factor = header.z_scale_factor = 1;
  laszip.check(laszip_set_header(laszip, &header));
  laszip.check(laszip_set_chunk_size(laszip, laszip_U32(count)));
  laszip.check(laszip_request_native_extension(laszip, 1));
  laszip.check(laszip_open_writer_stream(laszip, stream, 1, 1));
  laszip_point_struct* point = nullptr;
  laszip.check(laszip_get_point_pointer(laszip, &point));
  for (std::size_t i = 0; i < count; ++i) {
    unpack_point(records.data() + i * record_length, format, *point);
    laszip.check(laszip_write_point(laszip));
  }
  laszip.check(laszip_close_writer(laszip));
  const std::uint64_t table =
      buffer.bytes.size() < pointer_size ? 0 : get<std::uint64_t>(buffer.bytes.data());
  if (table <= pointer_size || table > buffer.bytes.size())
    throw Error(ErrorCode::io, "points cannot be compressed (LASzip wrote no chunk)");
  buffer.bytes.resize(table);
  buffer.bytes.erase(buffer.bytes.begin(), buffer.bytes.begin() + pointer_size);
  return std::move(buffer.bytes);
}

std::vector<std::uint8_t> chunk_table(std::span<const LazChunk> chunks) {
  ArithmeticEncoder encoder;
  IntegerEncoder integers(encoder);
  std::uint32_t count = 0, size = 0;
  for (const LazChunk& chunk : chunks) {
    integers.encode(count, chunk.count, 0);
    integers.encode(size, std::uint32_t(chunk.size), 1);
    count = chunk.count, size = std::uint32_t(chunk.size);
  }
  if (!chunks.empty()) encoder.finish();
  std::vector<std::uint8_t> table(8 + encoder.bytes.size());  // version 0, then the number
  put(table.data() + 4, std::uint32_t(chunks.size()));
  std::copy(encoder.bytes.begin(), encoder.bytes.end(), table.begin() + 8);
  return table;
}

}  // namespace sfumato::io::las
