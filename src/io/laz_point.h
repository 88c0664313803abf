// LASzip's point structure to and from packed point records.
#pragma once

#include <laszip/laszip_api.h>

#include <cstddef>
#include <cstdint>

namespace sfumato::io::las {

/// Writes `point` as a record of point format `format` and `record_length` bytes, extra bytes included.
void pack_point(const laszip_point_struct& point, int format, std::size_t record_length,
                std::uint8_t* record);
/// The inverse; `point.extra_bytes` has room for `point.num_extra_bytes`.
void unpack_point(const std::uint8_t* record, int format, laszip_point_struct& point);

}  // namespace sfumato::io::las
