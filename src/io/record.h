// Records of points as writers need them: which numbers a cloud has, and the type that holds each of them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::io {

/// The type that holds every value of the field: as stored in its file if that still does.
StoredType smallest_type(const ScalarField& field, std::size_t count);
/// World coordinates are exact as floats.
bool positions_fit_floats(const PointCloud& cloud);

template <class T>
void put(std::vector<std::byte>& record, T value);
/// The value at the end of the record, as that type.
void put_as(std::vector<std::byte>& record, StoredType type, double value);

/// One number of every point.
struct OutColumn {
  enum class Source { x, y, z, nx, ny, nz, red, green, blue, alpha, radius, scalar };
  std::string name;
  StoredType type = StoredType::float32;
  Source source = Source::scalar;
  std::size_t scalar = 0;  ///< which, of `cloud.scalars`

  double value(const PointCloud& cloud, std::size_t i) const;
  /// The shortest decimals that give this number back.
  void print(const PointCloud& cloud, std::size_t i, std::string& text) const;
};

/// Everything a cloud has: x y z, normals, colours (alpha where it says something), radius, scalars.
std::vector<OutColumn> columns_to_write(const PointCloud& cloud);

/// The shortest decimals of `origin + local` from which the same local float comes back.
void print_sum(double origin, float local, std::string& text);

}  // namespace sfumato::io
