// The dimensions of a LAS point record as a table, so that reader and writer share one description of each
// point format and of the extra bytes behind it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "io/columns.h"
#include "io/las_header.h"

namespace sfumato::io::las {

/// One dimension: where its bits are in the record, and what they mean (value = raw * scale + offset).
struct Field {
  std::string name;
  StoredType type = StoredType::uint8;
  std::uint16_t byte = 0;
  std::uint8_t shift = 0, bits = 0;  ///< of a bit field inside a uint8; bits = 0: the whole value
  double scale = 1, offset = 0;
  bool optional = false;          ///< left out of cloud and report when it is zero in every point
  bool is_extra = false;          ///< lies in the extra bytes
  std::optional<double> no_data;  ///< of extra bytes: the stored number that stands for no value

  bool is_color() const { return !is_extra && (name == "red" || name == "green" || name == "blue"); }
  /// Whether the cloud lacks it where it is zero in every point.
  bool is_left_out_as_zero() const {
    return optional || (!is_extra && (name == "user_data" || name == "point_source_id"));
  }
  bool is_scaled() const { return scale != 1 || offset != 0; }
  /// Whether a float may fail to hold the value, so that the remainder goes into a field of its own.
  bool needs_residual() const;
};

/// The standard dimensions of a point format (0 to 10) in the order of reports. Coordinates (bytes 0 to 11)
/// and wave packets are not among them.
std::vector<Field> standard_fields(int format);
bool has_gps_time(int format);
bool has_color(int format);

/// The dimensions in the extra bytes: those the extra bytes records (all of them, in file order) describe,
/// then undescribed bytes one by one, at most 16. Notes say what was left out.
std::vector<Field> extra_fields(const Header& header, std::vector<std::string>& notes);

/// More undescribed bytes of a point are left out.
inline constexpr std::size_t most_undescribed_fields = 16;
/// A record of extra bytes holds a descriptor for each field.
inline constexpr std::size_t descriptor_size = 192;
std::string descriptor_name(const std::uint8_t* descriptor);
/// How many bytes of a point the descriptor covers; one of no type says so itself, one of an unknown type 0.
std::size_t described_length(const std::uint8_t* descriptor);

/// The extra bytes record (192 bytes a field) that describes `fields`.
std::vector<std::uint8_t> extra_bytes_record(const std::vector<Field>& fields);

/// Scalars that hold what the float of another scalar, or the 8 bits of a colour, cannot: added to the value
/// on writing, so that LAS to LAS loses nothing.
inline const std::string residual_suffix = "_residual";
inline const std::string rgb_low_name = "rgb_low_bytes";  ///< red << 16 | green << 8 | blue

}  // namespace sfumato::io::las
