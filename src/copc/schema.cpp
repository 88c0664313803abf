#include "copc/schema.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/color_depth.h"
#include "io/las_fields.h"

namespace sfumato::copc {
namespace {

using io::las::Field;
using io::las::get;
using io::las::Header;
using io::las::min_record_length;
using io::las::put;

constexpr double int32_reach = 2147483645.0;
constexpr std::size_t longest_record = 65535;

bool has_wave(int format) { return format == 4 || format == 5 || format >= 9; }
bool has_nir(int format) { return format == 8 || format == 10; }
std::size_t color_byte_of(int format) { return format == 2 ? 20 : format >= 6 ? 30 : 28; }

// Some files describe their extra bytes in several records.
std::vector<std::uint8_t> extra_record(const Header& header) {
  std::vector<std::uint8_t> all;
  for (const io::las::Vlr& vlr : header.vlrs)
    if (vlr.user_id == "LASF_Spec" && vlr.record_id == 4)
      all.insert(all.end(), vlr.data.begin(), vlr.data.end());
  return all;
}

std::size_t extra_length(const Header& header) {
  return header.record_length - min_record_length[std::size_t(header.format)];
}

bool are_extra_bytes_alike(const Header& a, const Header& b) {
  return extra_length(a) == extra_length(b) && extra_record(a) == extra_record(b);
}

bool is_same_field(const Field& a, const Field& b) {
  return a.name == b.name && a.type == b.type && a.scale == b.scale && a.offset == b.offset &&
         a.no_data == b.no_data;
}

// Every field of every file; of one name and different kinds the later ones are numbered.
std::vector<Field> union_of_fields(const std::vector<Header>& headers, const std::vector<std::string>& names,
                                   std::vector<std::string>& notes) {
  std::vector<Field> all;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    std::vector<std::string> own;
    for (const Field& field : io::las::extra_fields(headers[i], own))
      if (std::none_of(all.begin(), all.end(),
                       [&](const Field& other) { return is_same_field(field, other); }))
        all.push_back(field);
    for (const std::string& note : own) notes.push_back(names[i] + ": " + note);
  }
  return all;
}

std::string unique_name(const std::vector<Field>& fields, std::size_t i) {
  auto is_taken = [&](const std::string& name) {
    return std::any_of(fields.begin(), fields.begin() + std::ptrdiff_t(i),
                       [&](const Field& f) { return f.name == name; });
  };
  std::string name = fields[i].name.substr(0, 32);
  for (int k = 2; is_taken(name); ++k) name = fields[i].name.substr(0, 28) + "_" + std::to_string(k);
  return name;
}

// Of the fields as `union_of_fields` lists them.
void place_fields(std::vector<Field>& fields, int format) {
  std::size_t byte = min_record_length[std::size_t(format)];
  for (Field& field : fields) {
    if (byte + io::size_of(field.type) > longest_record)
      throw Error(ErrorCode::usage,
                  "the files have " + std::to_string(fields.size()) +
                      " different extra attributes, more than a record holds; build fewer files at once");
    field.byte = std::uint16_t(byte);
    byte += io::size_of(field.type);
  }
}

bool is_whole(double value) { return std::abs(value - std::round(value)) < 1e-6 && std::abs(value) < 1e15; }

void choose_scaling(const std::vector<Header>& headers, const Bounds& box, Schema& schema) {
  for (int axis = 0; axis < 3; ++axis) {
    double& scale = schema.scale[axis];
    double& offset = schema.offset[axis];
    scale = std::abs(headers[0].scale[axis]);
    offset = headers[0].offset[axis];
    for (const Header& header : headers) scale = std::min(scale, std::abs(header.scale[axis]));
    auto fits = [&] {
      return std::max(std::abs(box.min[axis] - offset), std::abs(box.max[axis] - offset)) <
             scale * int32_reach;
    };
    if (fits()) continue;
    offset += std::round((box.center()[axis] - offset) / scale) * scale;
    if (fits()) continue;
    const double finest = scale;
    scale = std::pow(10, std::ceil(std::log10(box.size()[axis] / 2 / (int32_reach - 2))));
    offset = std::round(box.center()[axis] / scale) * scale;
    const std::string name(1, "xyz"[axis]);
    schema.notes.push_back("the files reach so far that " + name + " is stored in steps of " +
                           std::to_string(scale) + " instead of " + std::to_string(finest));
  }
}

void choose_crs(const std::vector<Header>& headers, const std::vector<std::string>& names, Schema& schema) {
  std::string kept;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    const std::string crs = io::las::read_crs(headers[i]);
    if (crs.empty()) continue;
    if (kept.empty()) {
      kept = crs;
      for (const io::las::Vlr& vlr : headers[i].vlrs)
        if (vlr.user_id == "LASF_Projection" || vlr.user_id == "liblas") schema.crs.push_back(vlr);
      for (io::las::Vlr& vlr : schema.crs) vlr.user_id = "LASF_Projection";
    } else if (crs != kept) {
      schema.notes.push_back(names[i] +
                             ": its coordinate system is not that of the files before; the numbers are put "
                             "together as they are");
    }
  }
  // Point formats 6 to 10 go with WKT. GeoTIFF keys are kept as they are when that is all there is.
  const bool has_wkt = std::any_of(schema.crs.begin(), schema.crs.end(),
                                   [](const auto& vlr) { return vlr.record_id == 2112; });
  if (has_wkt) std::erase_if(schema.crs, [](const auto& vlr) { return vlr.record_id != 2112; });
  if (has_wkt || schema.crs.empty()) schema.global_encoding |= 16;
}

// Formats 0 to 5 in the first 30 bytes of formats 6 to 10.
void extend_record(const std::uint8_t* in, int format, std::uint8_t* out) {
  std::memcpy(out, in, 14);
  out[14] = std::uint8_t((in[14] & 7) | (in[14] >> 3 & 7) << 4);
  out[15] = std::uint8_t((in[15] >> 5 & 7) | (in[14] & 0xC0));
  out[16] = in[15] & 31;
  out[17] = in[17];
  // Whole degrees in steps of 0.006.
  put(out + 18, std::int16_t(std::lround(double(get<std::int8_t>(in + 16)) / 0.006)));
  std::memcpy(out + 20, in + 18, 2);
  if (io::las::has_gps_time(format))
    std::memcpy(out + 22, in + 20, 8);
  else
    std::memset(out + 22, 0, 8);
}

}  // namespace

Schema choose_schema(const std::vector<Header>& headers, const std::vector<std::string>& names,
                     const Bounds& box) {
  Schema schema;
  bool has_color = false, nir = false;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    const Header& header = headers[i];
    has_color |= io::las::has_color(header.format);
    nir |= has_nir(header.format);
    schema.is_verbatim &= are_extra_bytes_alike(header, headers[0]);
    if (has_wave(header.format)) schema.notes.push_back(names[i] + ": wave packets are left out");
    if ((header.global_encoding & 1) != (headers[0].global_encoding & 1))
      schema.notes.push_back(names[i] + ": its GPS times are of another kind than those of " + names[0] +
                             "; the numbers are put together as they are");
  }
  schema.format = nir ? 8 : has_color ? 7 : 6;
  schema.global_encoding = headers[0].global_encoding & (1 | 8);
  std::size_t extra = extra_length(headers[0]);
  if (schema.is_verbatim) {
    schema.extra_bytes = extra_record(headers[0]);
  } else {
    schema.fields = union_of_fields(headers, names, schema.notes);
    place_fields(schema.fields, schema.format);
    std::vector<Field> named = schema.fields;
    extra = 0;
    for (std::size_t i = 0; i < named.size(); ++i) {
      extra += io::size_of(named[i].type);
      named[i].name = unique_name(named, i);
    }
    schema.extra_bytes = io::las::extra_bytes_record(named);
  }
  if (min_record_length[std::size_t(schema.format)] + extra > longest_record)
    throw Error(ErrorCode::usage, names[0] + ": its " + std::to_string(extra) +
                                      " extra bytes a point leave no room; "
                                      "convert it to .ply");
  schema.record_length = std::uint16_t(min_record_length[std::size_t(schema.format)] + extra);
  schema.file_length = schema.record_length;
  choose_scaling(headers, box, schema);
  choose_crs(headers, names, schema);
  return schema;
}

RecordMap::RecordMap(const Header& source, const Schema& schema, std::optional<int> color_bits)
    : source_format_(source.format),
      format_(schema.format),
      record_length_(schema.record_length),
      source_scale_(source.scale),
      source_offset_(source.offset),
      scale_(schema.scale),
      offset_(schema.offset) {
  is_shifted_ = source.scale == schema.scale;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = (source.offset[axis] - schema.offset[axis]) / schema.scale[axis];
    // A flipped or finer axis is still on the steps when its own are a multiple of them.
    is_exact_ &= is_whole(steps) && is_whole(source.scale[axis] / schema.scale[axis]);
    is_shifted_ &= is_whole(steps);
    shift_[axis] = is_shifted_ ? std::llround(steps) : 0;
  }
  if (schema.format >= 7) color_bits_ = color_bits;
  const auto color = color_byte_of(source.format);
  if (schema.format >= 7 && io::las::has_color(source.format)) copies_.push_back({color, 30, 6});
  if (schema.format == 8 && has_nir(source.format)) copies_.push_back({36, 36, 2});
  const std::size_t from = min_record_length[std::size_t(source.format)],
                    to = min_record_length[std::size_t(schema.format)];
  if (schema.is_verbatim) {
    if (schema.file_length > to) copies_.push_back({from, to, schema.file_length - to});
    return;
  }
  std::vector<std::string> ignored;
  const std::vector<Field> own = io::las::extra_fields(source, ignored);
  for (const Field& field : schema.fields) {
    const std::size_t size = io::size_of(field.type);
    const auto found =
        std::find_if(own.begin(), own.end(), [&](const Field& f) { return is_same_field(f, field); });
    if (found != own.end()) {
      copies_.push_back({found->byte, field.byte, size});
    } else if (field.type == StoredType::float32 || field.type == StoredType::float64) {
      // What a file does not have is no number, where the type knows such.
      Filling filling{field.byte, std::vector<std::uint8_t>(size)};
      if (size == 4)
        put(filling.bytes.data(), std::numeric_limits<float>::quiet_NaN());
      else
        put(filling.bytes.data(), std::numeric_limits<double>::quiet_NaN());
      fillings_.push_back(std::move(filling));
    }
  }
}

void RecordMap::convert(const std::uint8_t* record, std::uint8_t* out) const {
  std::memset(out, 0, record_length_);
  if (source_format_ >= 6)
    std::memcpy(out, record, 30);
  else
    extend_record(record, source_format_, out);
  for (int axis = 0; axis < 3; ++axis) {
    const auto steps = get<std::int32_t>(record + 4 * axis);
    double placed =
        is_shifted_
            ? double(steps + shift_[axis])
            : std::round((steps * source_scale_[axis] + source_offset_[axis] - offset_[axis]) / scale_[axis]);
    placed = std::clamp(placed, -2147483648.0, 2147483647.0);
    put(out + 4 * axis, std::int32_t(placed));
  }
  for (const Copy& copy : copies_) std::memcpy(out + copy.to, record + copy.from, copy.size);
  if (color_bits_) {
    std::uint16_t rgb[3];
    std::memcpy(rgb, out + 30, sizeof rgb);
    const bool is_absent = *color_bits_ == 0 && rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0;
    for (std::uint16_t& value : rgb)
      value = is_absent ? 65535 : io::to_16_bits(value, *color_bits_ == 0 ? 16 : *color_bits_);
    std::memcpy(out + 30, rgb, sizeof rgb);
  }
  for (const Filling& filling : fillings_)
    std::memcpy(out + filling.to, filling.bytes.data(), filling.bytes.size());
}

}  // namespace sfumato::copc
