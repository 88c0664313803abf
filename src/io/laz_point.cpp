#include "io/laz_point.h"

#include "io/las_fields.h"

namespace sfumato::io::las {
namespace {

struct Tail {
  int gps_time, rgb, channels, wave;  ///< byte of each part, -1 when absent; channels of colour
};

Tail tail_of(int format) {
  static constexpr Tail tails[11] = {{-1, -1, 0, -1}, {20, -1, 0, -1}, {-1, 20, 3, -1}, {20, 28, 3, -1},
                                     {20, -1, 0, 28}, {20, 28, 3, 34}, {22, -1, 0, -1}, {22, 30, 3, -1},
                                     {22, 30, 4, -1}, {22, -1, 0, 30}, {22, 30, 4, 38}};
  return tails[format];
}

constexpr std::size_t wave_size = 29;

}  // namespace

void pack_point(const laszip_point_struct& p, int format, std::size_t record_length, std::uint8_t* record) {
  put(record, p.X);
  put(record + 4, p.Y);
  put(record + 8, p.Z);
  put(record + 12, p.intensity);
  if (format >= 6) {
    record[14] = std::uint8_t(p.extended_return_number | p.extended_number_of_returns << 4);
    record[15] = std::uint8_t(p.extended_classification_flags | p.extended_scanner_channel << 4 |
                              p.scan_direction_flag << 6 | p.edge_of_flight_line << 7);
    record[16] = p.extended_classification;
    record[17] = p.user_data;
    put(record + 18, p.extended_scan_angle);
    put(record + 20, p.point_source_ID);
  } else {
    record[14] = std::uint8_t(p.return_number | p.number_of_returns << 3 | p.scan_direction_flag << 6 |
                              p.edge_of_flight_line << 7);
    record[15] =
        std::uint8_t(p.classification | p.synthetic_flag << 5 | p.keypoint_flag << 6 | p.withheld_flag << 7);
    put(record + 16, p.scan_angle_rank);
    record[17] = p.user_data;
    put(record + 18, p.point_source_ID);
  }
  const Tail tail = tail_of(format);
  if (tail.gps_time >= 0) put(record + tail.gps_time, p.gps_time);
  if (tail.rgb >= 0) std::memcpy(record + tail.rgb, p.rgb, 2 * std::size_t(tail.channels));
  if (tail.wave >= 0) std::memcpy(record + tail.wave, p.wave_packet, wave_size);
  const std::size_t standard = min_record_length[std::size_t(format)];
  const std::size_t extra = p.extra_bytes ? std::size_t(p.num_extra_bytes) : 0;
  if (extra > 0 && extra == record_length - standard) std::memcpy(record + standard, p.extra_bytes, extra);
}

void unpack_point(const std::uint8_t* record, int format, laszip_point_struct& p) {
  p.X = get<std::int32_t>(record);
  p.Y = get<std::int32_t>(record + 4);
  p.Z = get<std::int32_t>(record + 8);
  p.intensity = get<std::uint16_t>(record + 12);
  if (format >= 6) {
    p.extended_point_type = 1;
    p.extended_return_number = record[14] & 15;
    p.extended_number_of_returns = std::uint8_t(record[14] >> 4);
    p.extended_classification_flags = record[15] & 15;
    p.extended_scanner_channel = (record[15] >> 4) & 3;
    p.scan_direction_flag = (record[15] >> 6) & 1;
    p.edge_of_flight_line = std::uint8_t(record[15] >> 7);
    p.extended_classification = record[16];
    p.user_data = record[17];
    p.extended_scan_angle = get<std::int16_t>(record + 18);
    p.point_source_ID = get<std::uint16_t>(record + 20);
    // LASzip keeps the old fields beside the extended ones and wants them to agree.
    p.return_number = std::uint8_t((record[14] & 15) > 7 ? 7 : record[14] & 7);
    p.number_of_returns = std::uint8_t((record[14] >> 4) > 7 ? 7 : record[14] >> 4);
    p.classification = record[16] < 32 ? record[16] & 31 : 0;
    p.synthetic_flag = record[15] & 1;
    p.keypoint_flag = (record[15] >> 1) & 1;
    p.withheld_flag = (record[15] >> 2) & 1;
  } else {
    p.return_number = record[14] & 7;
    p.number_of_returns = (record[14] >> 3) & 7;
    p.scan_direction_flag = (record[14] >> 6) & 1;
    p.edge_of_flight_line = std::uint8_t(record[14] >> 7);
    p.classification = record[15] & 31;
    p.synthetic_flag = (record[15] >> 5) & 1;
    p.keypoint_flag = (record[15] >> 6) & 1;
    p.withheld_flag = std::uint8_t(record[15] >> 7);
    p.scan_angle_rank = get<std::int8_t>(record + 16);
    p.user_data = record[17];
    p.point_source_ID = get<std::uint16_t>(record + 18);
  }
  const Tail tail = tail_of(format);
  if (tail.gps_time >= 0) p.gps_time = get<double>(record + tail.gps_time);
  if (tail.rgb >= 0) std::memcpy(p.rgb, record + tail.rgb, 2 * std::size_t(tail.channels));
  if (tail.wave >= 0) std::memcpy(p.wave_packet, record + tail.wave, wave_size);
  const std::size_t standard = min_record_length[std::size_t(format)];
  if (p.extra_bytes && p.num_extra_bytes > 0)
    std::memcpy(p.extra_bytes, record + standard, std::size_t(p.num_extra_bytes));
}

}  // namespace sfumato::io::las
