// How a cloud is laid out as LAS point records.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "io/las_fields.h"

namespace sfumato::io::las {

/// Where the values of one field come from.
struct Source {
  Field field;
  const ScalarField* scalar = nullptr;
  const ScalarField* residual = nullptr;  ///< added to `scalar`
  /// Of a typed attribute instead: its component at a point.
  double (*number)(const PointCloud& cloud, std::size_t i, std::size_t component) = nullptr;
  std::size_t component = 0;
  double missing = std::numeric_limits<double>::quiet_NaN();  ///< written for what is no number

  double value(const PointCloud& cloud, std::size_t i) const;
};

struct WriteLayout {
  int format = 0;
  std::uint16_t record_length = 0;
  dvec3 scale{0.001}, offset{0};
  bool colors_shifted = false;
  int color_bits = 16;             ///< of the 16
  std::vector<Source> sources;     ///< fields that get values; the others stay zero
  std::vector<Field> extra;        ///< those of them in the extra bytes, in order
  std::vector<std::string> notes;  ///< what the user should know of the choice

  /// The coordinates of point `i` in steps of `scale` from `offset`.
  std::array<std::int32_t, 3> steps(const PointCloud& cloud, std::size_t i) const;
  /// Writes points [first, first + count) as packed records into zeroed memory.
  void pack(const PointCloud& cloud, std::size_t first, std::size_t count, std::uint8_t* records) const;
};

/// The cloud's own format and scaling where they hold its values; every scalar finds a place. A point that
/// lacks a standard dimension of whole numbers has 0 there, and one return. Throws Error(usage) when a record
/// would be longer than 65535 bytes, and when the coordinates do not fit: a step must be no coarser than a
/// thousandth of the cloud, or its shape would be gone, and our reader must take what we write.
WriteLayout choose_layout(const PointCloud& cloud);

}  // namespace sfumato::io::las
