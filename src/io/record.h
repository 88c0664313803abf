// Records of points as writers need them: which numbers a cloud has, and the type that holds each of them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::io {

/// The value at the end of the record, as that type.
void put_as(std::vector<std::byte>& record, StoredType type, double value);

/// One number of every point.
struct OutColumn {
  enum class Kind { position, attribute, scalar };
  std::string name;
  StoredType type = StoredType::float32;
  Kind kind = Kind::scalar;
  std::size_t index = 0;  ///< of the axis, of the component, of the scalar in `cloud.scalars`
  double (*number)(const PointCloud& cloud, std::size_t i, std::size_t index) = nullptr;

  double value(const PointCloud& cloud, std::size_t i) const { return number(cloud, i, index); }
  /// Whether it is that component of a typed attribute; a scalar may have its name.
  bool is(std::string_view component) const { return kind == Kind::attribute && name == component; }
  /// The shortest decimals that give this number back.
  void print(const PointCloud& cloud, std::size_t i, std::string& text) const;
};

/// Everything a cloud has: x y z, normals, colours (alpha where it says something), radius, scalars.
std::vector<OutColumn> columns_to_write(const PointCloud& cloud);

/// The shortest decimals of `origin + local` from which the same local float comes back.
void print_sum(double origin, float local, std::string& text);

}  // namespace sfumato::io
