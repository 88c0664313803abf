#include "io/las_fields.h"

#include <algorithm>
#include <map>

namespace sfumato::io::las {
namespace {

constexpr std::size_t longest_name = 32;
// Files have a few; a record of 65535 bytes could name as many, each with an array of its own.
constexpr std::size_t most_extra_fields = 1024, most_notes = 16;
// Types of extra bytes 1 to 10 in the order of LAS 1.4 R15, table 24.
constexpr StoredType extra_types[] = {
    StoredType::uint8, StoredType::int8,   StoredType::uint16, StoredType::int16,   StoredType::uint32,
    StoredType::int32, StoredType::uint64, StoredType::int64,  StoredType::float32, StoredType::float64};

constexpr std::size_t no_data_byte = 40;

/// As the largest type of its kind; nothing that the field cannot hold stands for anything.
std::optional<double> no_data_of(const std::uint8_t* at, StoredType type) {
  const bool is_real = type == StoredType::float32 || type == StoredType::float64;
  const bool is_unsigned = type == StoredType::uint8 || type == StoredType::uint16 ||
                           type == StoredType::uint32 || type == StoredType::uint64;
  const double value = is_real       ? get<double>(at)
                       : is_unsigned ? double(get<std::uint64_t>(at))
                                     : double(get<std::int64_t>(at));
  double low = -1, high = 0;
  switch (type) {
    case StoredType::uint8: low = 0, high = 255; break;
    case StoredType::int8: low = -128, high = 127; break;
    case StoredType::uint16: low = 0, high = 65535; break;
    case StoredType::int16: low = -32768, high = 32767; break;
    case StoredType::uint32: low = 0, high = 4294967295.0; break;
    case StoredType::int32: low = -2147483648.0, high = 2147483647.0; break;
    case StoredType::uint64: low = 0, high = 0x1p63; break;
    case StoredType::int64: low = -0x1p62, high = 0x1p62; break;
    case StoredType::float32: low = -3.4e38, high = 3.4e38; break;
    case StoredType::float64: low = -1.7e308, high = 1.7e308; break;
  }
  return value >= low && value <= high ? std::optional(value) : std::nullopt;
}

void put_no_data(std::uint8_t* at, StoredType type, double value) {
  switch (type) {
    case StoredType::float32:
    case StoredType::float64: return put(at, value);
    case StoredType::uint8:
    case StoredType::uint16:
    case StoredType::uint32:
    case StoredType::uint64: return put(at, std::uint64_t(value));
    default: return put(at, std::int64_t(value));
  }
}

}  // namespace

bool Field::needs_residual() const {
  switch (type) {
    // Scaled or not, a float tells the numbers of 16 bits apart, and the writer knows the scale.
    case StoredType::uint8:
    case StoredType::int8:
    case StoredType::uint16:
    case StoredType::int16: return false;
    case StoredType::float32: return is_scaled();
    default: return true;
  }
}

bool has_gps_time(int format) { return format != 0 && format != 2; }
bool has_color(int format) {
  return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}

std::vector<Field> standard_fields(int format) {
  const bool extended = format >= 6;
  std::vector<Field> fields;
  auto add = [&](const char* name, StoredType type, int byte, bool optional = false) -> Field& {
    return fields.emplace_back(Field{name, type, std::uint16_t(byte), 0, 0, 1, 0, optional, false, {}});
  };
  auto add_bits = [&](const char* name, int byte, int shift, int bits, bool optional) {
    Field& field = add(name, StoredType::uint8, byte, optional);
    field.shift = std::uint8_t(shift);
    field.bits = std::uint8_t(bits);
  };
  if (has_color(format)) {
    const int byte = format == 2 ? 20 : extended ? 30 : 28;
    add("red", StoredType::uint16, byte);
    add("green", StoredType::uint16, byte + 2);
    add("blue", StoredType::uint16, byte + 4);
    if (format == 8 || format == 10) add("nir", StoredType::uint16, byte + 6);
  }
  add("intensity", StoredType::uint16, 12);
  if (extended)
    add("classification", StoredType::uint8, 16);
  else
    add_bits("classification", 15, 0, 5, false);
  add_bits("return_number", 14, 0, extended ? 4 : 3, false);
  add_bits("number_of_returns", 14, extended ? 4 : 3, extended ? 4 : 3, false);
  add("user_data", StoredType::uint8, 17);
  add("point_source_id", StoredType::uint16, extended ? 20 : 18);
  if (has_gps_time(format)) add("gps_time", StoredType::float64, extended ? 22 : 20);

  if (extended)
    add("scan_angle", StoredType::int16, 18, true).scale = 0.006;
  else
    add("scan_angle", StoredType::int8, 16, true);
  add_bits("scan_direction_flag", extended ? 15 : 14, 6, 1, true);
  add_bits("edge_of_flight_line", extended ? 15 : 14, 7, 1, true);
  const int flag_shift = extended ? 0 : 5;
  add_bits("synthetic", 15, flag_shift, 1, true);
  add_bits("key_point", 15, flag_shift + 1, 1, true);
  add_bits("withheld", 15, flag_shift + 2, 1, true);
  if (extended) {
    add_bits("overlap", 15, 3, 1, true);
    add_bits("scanner_channel", 15, 4, 2, true);
  }
  return fields;
}

std::vector<Field> extra_fields(const Header& header, std::vector<std::string>& notes) {
  std::vector<Field> fields;
  std::map<std::string, int>
      names;  // and how often each came: equal names are numbered without trying all numbers
  std::size_t byte = min_record_length[std::size_t(header.format)];
  auto add = [&](std::string name, StoredType type, double scale, double offset) {
    if (name.empty()) name = "extra";
    std::string unique = name;
    int& count = names[name];
    if (count++ > 0)
      for (unique = name + "_" + std::to_string(count); names.contains(unique);)
        unique = name + "_" + std::to_string(++count);
    names.emplace(unique, 1);
    fields.push_back({unique, type, std::uint16_t(byte), 0, 0, scale, offset, false, true, {}});
    byte += size_of(type);
  };
  for (const Vlr& vlr : header.vlrs) {
    if (vlr.user_id != "LASF_Spec" || vlr.record_id != 4) continue;
    for (std::size_t at = 0; at + descriptor_size <= vlr.data.size(); at += descriptor_size) {
      const std::uint8_t* d = vlr.data.data() + at;
      const int type = d[2], options = d[3];
      if (fields.size() >= most_extra_fields || notes.size() >= most_notes) {
        notes.push_back("extra bytes beyond the first " + std::to_string(fields.size()) +
                        " fields are left out");
        return fields;
      }
      if (type == 0 || type > 30) {  // undocumented bytes, as many as the options say
        byte += std::size_t(type == 0 ? options : 0);
        notes.push_back("extra bytes " + descriptor_name(d) + " have no documented type and are left out");
        continue;
      }
      const int parts = (type - 1) / 10 + 1;  // 11 to 20 and 21 to 30: pairs and triples, deprecated
      const StoredType stored = extra_types[(type - 1) % 10];
      if (byte + std::size_t(parts) * size_of(stored) > header.record_length) {
        notes.push_back("extra bytes " + descriptor_name(d) +
                        " lie outside the point record and are left out");
        return fields;
      }
      for (int k = 0; k < parts; ++k) {
        const double scale = (options & 8) ? get<double>(d + 112 + 8 * k) : 1;
        const double offset = (options & 16) ? get<double>(d + 136 + 8 * k) : 0;
        add(descriptor_name(d) + (parts > 1 ? "_" + std::to_string(k) : ""), stored, scale == 0 ? 1 : scale,
            offset);
        if (options & 1) fields.back().no_data = no_data_of(d + no_data_byte + 8 * k, stored);
      }
    }
  }
  if (byte < header.record_length && header.record_length - byte > most_undescribed_fields)
    notes.push_back(std::to_string(header.record_length - byte) +
                    " undescribed extra bytes a point are left out");
  else
    while (byte < header.record_length) add("extra", StoredType::uint8, 1, 0);
  return fields;
}

std::string descriptor_name(const std::uint8_t* descriptor) {
  const std::uint8_t* name = descriptor + 4;
  return {name, std::find(name, name + longest_name, std::uint8_t{0})};
}

std::size_t described_length(const std::uint8_t* descriptor) {
  const int type = descriptor[2];
  if (type == 0) return descriptor[3];
  return type > 30 ? 0 : std::size_t((type - 1) / 10 + 1) * size_of(extra_types[(type - 1) % 10]);
}

std::vector<std::uint8_t> extra_bytes_record(const std::vector<Field>& fields) {
  std::vector<std::uint8_t> record(fields.size() * descriptor_size);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    std::uint8_t* d = record.data() + i * descriptor_size;
    d[2] = std::uint8_t(1 + (std::find(std::begin(extra_types), std::end(extra_types), fields[i].type) -
                             std::begin(extra_types)));
    const std::size_t length = std::min(fields[i].name.size(), longest_name);
    std::memcpy(d + 4, fields[i].name.data(), length);
    if (fields[i].no_data) {
      d[3] = 1;
      put_no_data(d + no_data_byte, fields[i].type, *fields[i].no_data);
    }
    if (!fields[i].is_scaled()) continue;
    d[3] |= 8 | 16;  // scale and offset hold
    put(d + 112, fields[i].scale);
    put(d + 136, fields[i].offset);
  }
  return record;
}

}  // namespace sfumato::io::las
