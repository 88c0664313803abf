// One point record that holds what the records of several files hold, and the way from theirs to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "io/las_fields.h"

namespace sfumato::copc {

/// How the points of the output are stored.
struct Schema {
  int format = 6;  ///< LAS point format, 6 to 8
  std::uint16_t record_length = 30;
  std::uint16_t file_length = 30;  ///< of it what the files bring; computed fields follow
  std::uint16_t normal_byte = 0, uncertainty_byte = 0;  ///< of computed fields; 0: there is none
  bool computes() const { return normal_byte || uncertainty_byte; }
  dvec3 scale{0.001}, offset{0};
  std::uint16_t global_encoding = 0;
  std::vector<std::uint8_t> extra_bytes;  ///< payload of the record LASF_Spec 4; empty when there are none
  std::vector<io::las::Vlr> crs;          ///< LASF_Projection
  bool is_verbatim = true;                ///< the extra bytes of every file are these, byte for byte
  std::vector<io::las::Field>
      fields;                      ///< otherwise: those of all files, as they call them, at their new bytes
  std::vector<std::string> notes;  ///< what the files do not agree on
};

/// `headers`: of the files, in their order; `names` go into notes; `box` holds every point. The scaling of
/// the files is kept where they agree on it, to the bit.
Schema choose_schema(const std::vector<io::las::Header>& headers, const std::vector<std::string>& names,
                     const Bounds& box);

/// From the records of one file to those of the schema.
class RecordMap {
 public:
  /// `color_bits`: of the source where they are brought to the schema's 16; 0 makes its 0 0 0 white, as
  /// points without a colour are drawn beside others. Otherwise colours are copied as they are.
  RecordMap(const io::las::Header& source, const Schema& schema, std::optional<int> color_bits = {});
  /// `out` has room for one record.
  void convert(const std::uint8_t* record, std::uint8_t* out) const;
  /// Whether coordinates stay on their places; else they move by at most half a step.
  bool is_exact() const { return is_exact_; }

 private:
  struct Copy {
    std::size_t from, to, size;
  };
  struct Filling {
    std::size_t to;
    std::vector<std::uint8_t> bytes;
  };

  int source_format_, format_;
  std::size_t record_length_;
  dvec3 source_scale_, source_offset_, scale_, offset_;
  bool is_shifted_ = false, is_exact_ = true;
  std::int64_t shift_[3] = {0, 0, 0};
  std::vector<Copy> copies_;
  std::vector<Filling> fillings_;
  std::optional<int> color_bits_;
};

}  // namespace sfumato::copc
