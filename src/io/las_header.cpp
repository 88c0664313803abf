#include "io/las_header.h"

#include <algorithm>
#include <cmath>

namespace sfumato::io::las {
namespace {

constexpr std::uint64_t evlr_header_size = 60;

std::string fixed_text(const std::uint8_t* bytes, std::size_t size) {
  const auto* end = std::find(bytes, bytes + size, std::uint8_t{0});
  return {bytes, end};
}

bool is_used(const std::string& user_id, std::uint16_t record_id) {
  if (user_id == "LASF_Projection") return true;
  if (user_id == "LASF_Spec") return record_id == 4;
  if (user_id == "liblas") return record_id == 2112;
  if (user_id == "laszip encoded") return record_id == 22204;
  return user_id == "copc" && record_id == 1;
}

void read_vlrs(const InputFile& file, Header& header, std::uint64_t header_size, std::uint32_t count) {
  std::uint64_t byte = header_size;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint8_t head[vlr_header_size];
    if (byte + vlr_header_size > header.point_data)
      file.fail(byte, "found the points' start inside variable length record " + std::to_string(i + 1) +
                          " of " + std::to_string(count) +
                          ", expected it behind them; the header is damaged");
    file.read(byte, head, sizeof head);
    const std::uint16_t length = get<std::uint16_t>(head + 20);
    byte += vlr_header_size;
    if (byte + length > header.point_data)
      file.fail(byte, "found a variable length record of " + std::to_string(length) +
                          " bytes, expected at most " + std::to_string(header.point_data - byte) +
                          " before the points; the header is damaged");
    Vlr vlr{fixed_text(head + 2, 16), get<std::uint16_t>(head + 18), byte, {}};
    if (is_used(vlr.user_id, vlr.record_id)) {
      vlr.data.resize(length);
      file.read(byte, vlr.data.data(), length);
      header.vlrs.push_back(std::move(vlr));
    }
    byte += length;
  }
}

// Extended records lie behind the points: damage there costs the record, not the cloud.
void read_evlrs(const InputFile& file, Header& header, std::uint64_t byte, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint8_t head[evlr_header_size];
    if (byte < header.point_data || byte > file.size() || file.size() - byte < evlr_header_size) return;
    file.read(byte, head, sizeof head);
    const std::uint64_t length = get<std::uint64_t>(head + 20);
    byte += evlr_header_size;
    if (length > file.size() - byte) return;
    Vlr vlr{fixed_text(head + 2, 16), get<std::uint16_t>(head + 18), byte, {}};
    if (vlr.user_id != "copc" && vlr.user_id != "laszip encoded" && is_used(vlr.user_id, vlr.record_id)) {
      vlr.data.resize(length);
      file.read(byte, vlr.data.data(), length);
      header.vlrs.push_back(std::move(vlr));
    } else if (vlr.user_id == sample_user_id && vlr.record_id == sample_record_id) {
      header.sample_byte = byte, header.sample_size = length;
    }
    byte += length;
  }
}

void check_scaling(const InputFile& file, const Header& header) {
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = header.scale[axis], offset = header.offset[axis];
    if (!std::isfinite(scale) || scale == 0)
      file.fail(131 + 8 * std::uint64_t(axis),
                "found a coordinate scale of " + std::to_string(scale) +
                    ", expected a finite number other than 0; the header is damaged");
    if (!(std::abs(scale) * 2147483648.0 + std::abs(offset) < largest_coordinate))
      file.fail(155 + 8 * std::uint64_t(axis),
                "found a coordinate offset of " + std::to_string(offset) + " and scale " +
                    std::to_string(scale) + ", expected coordinates below 1e15; the header is damaged");
  }
}

}  // namespace

const Vlr* Header::vlr(std::string_view user_id, std::uint16_t record_id) const {
  for (const Vlr& record : vlrs)
    if (record.record_id == record_id && record.user_id == user_id) return &record;
  return nullptr;
}

Header read_header(const InputFile& file) {
  std::array<std::uint8_t, 375> bytes{};
  if (file.size() < 227)
    file.fail(file.size(),
              "the file ends here, expected a LAS header of at least 227 bytes; fetch the file again");
  const std::uint64_t held = std::min<std::uint64_t>(file.size(), bytes.size());
  file.read(0, bytes.data(), held);
  const std::uint8_t* b = bytes.data();
  if (std::memcmp(b, "LASF", 4) != 0) file.fail(0, "found no LASF, expected a LAS, LAZ or COPC file");

  Header header;
  header.global_encoding = get<std::uint16_t>(b + 6);
  header.version_minor = b[25];
  if (b[24] != 1 || b[25] > 4)
    file.fail(24, "found LAS version " + std::to_string(b[24]) + "." + std::to_string(b[25]) +
                      ", expected 1.0 to 1.4; convert the file to LAS 1.4");
  const std::uint64_t header_size = get<std::uint16_t>(b + 94);
  const std::uint64_t least = header.version_minor == 4 ? 375 : header.version_minor == 3 ? 235 : 227;
  header.point_data = get<std::uint32_t>(b + 96);
  if (header_size < least || header_size > file.size())
    file.fail(94, "found a header size of " + std::to_string(header_size) + ", expected " +
                      std::to_string(least) + " to the file's " + std::to_string(file.size()) +
                      " bytes; the file is truncated or damaged");
  if (header.point_data < header_size || header.point_data > file.size())
    file.fail(96, "found the points at byte " + std::to_string(header.point_data) + ", expected " +
                      std::to_string(header_size) + " to " + std::to_string(file.size()) +
                      "; the file is truncated or damaged");

  header.compressed = (b[104] & 0x80) != 0;  // LASzip marks its files in the format's highest bit
  header.format = b[104] & 0x7f;
  if (header.format > 10)
    file.fail(104, "found point format " + std::to_string(header.format) +
                       ", expected 0 to 10; the header is damaged");
  header.record_length = get<std::uint16_t>(b + 105);
  if (header.record_length < min_record_length[std::size_t(header.format)])
    file.fail(105, "found a record length of " + std::to_string(header.record_length) +
                       ", expected at least " +
                       std::to_string(min_record_length[std::size_t(header.format)]) + " for point format " +
                       std::to_string(header.format) + "; the header is damaged");
  for (int axis = 0; axis < 3; ++axis) {
    header.scale[axis] = get<double>(b + 131 + 8 * axis);
    header.offset[axis] = get<double>(b + 155 + 8 * axis);
  }
  check_scaling(file, header);

  header.count = get<std::uint32_t>(b + 107);
  if (header.version_minor == 4 && get<std::uint64_t>(b + 247) != 0)
    header.count = get<std::uint64_t>(b + 247);
  const std::uint64_t room = file.size() - header.point_data;
  if (!header.compressed && header.count > room / header.record_length)
    file.fail(107, "found " + std::to_string(header.count) + " points of " +
                       std::to_string(header.record_length) + " bytes, expected at most the " +
                       std::to_string(room / header.record_length) +
                       " that the file holds; the file is truncated, fetch it again");
  // The decoder and the cloud count points in 32 bits.
  if (header.count > 0xFFFFFFFFull)
    file.fail(247, "found " + std::to_string(header.count) + " points, expected at most 4294967295; " +
                       "the header is damaged or the file must be tiled");

  read_vlrs(file, header, header_size, get<std::uint32_t>(b + 100));
  if (header.version_minor == 4)
    read_evlrs(file, header, get<std::uint64_t>(b + 235), get<std::uint32_t>(b + 243));
  return header;
}

}  // namespace sfumato::io::las
