// The public header block and the variable length records of a LAS, LAZ or COPC file (LAS 1.0 to 1.4),
// checked before anything is allocated on their word or handed to LASzip.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"
#include "io/las_file.h"

namespace sfumato::io::las {

/// A variable length record (ordinary or extended) of one of the kinds we use.
struct Vlr {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::uint64_t byte = 0;  ///< of the payload in the file
  std::vector<std::uint8_t> data;
};

struct Header {
  int version_minor = 0;
  std::uint16_t global_encoding = 0;
  std::uint64_t point_data = 0;  ///< byte of the first point (LAZ: of the chunk table's address)
  int format = 0;                ///< point data record format, 0 to 10
  bool compressed = false;
  std::uint16_t record_length = 0;
  std::uint64_t count = 0;  ///< points
  dvec3 scale{1}, offset{0};
  std::vector<Vlr> vlrs;
  std::uint64_t sample_byte = 0, sample_size = 0;  ///< payload of the record named below; 0: there is none

  const Vlr* vlr(std::string_view user_id, std::uint16_t record_id) const;
  bool is_copc() const { return compressed && vlr("copc", 1) != nullptr; }
};

/// The extended record that `sfumato build` adds (copc/record_sample.h).
inline constexpr const char* sample_user_id = "sfumato";
inline constexpr std::uint16_t sample_record_id = 1;

/// Bytes before the payload of a variable length record.
inline constexpr std::uint64_t vlr_header_size = 54;

/// Coordinates beyond this are no place on or near the earth, and their differences no longer fit a float.
inline constexpr double largest_coordinate = 1e15;

/// Least record length of point formats 0 to 10.
inline constexpr std::array<std::uint16_t, 11> min_record_length{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Reads and checks header and records. Throws Error(bad_input) with byte, found, expected, what to do.
Header read_header(const InputFile& file);

/// "EPSG:n", "EPSG:n+m" (compound), WKT, or a citation; empty when the file has none.
std::string read_crs(const Header& header);

/// A record to be written: user id LASF_Projection.
struct CrsRecord {
  std::uint16_t record_id = 0;
  std::vector<std::uint8_t> data;
};
/// The records that `read_crs` turns into `crs` again. `is_wkt` tells the header's WKT bit.
std::vector<CrsRecord> crs_records(const std::string& crs, bool& is_wkt);

}  // namespace sfumato::io::las
