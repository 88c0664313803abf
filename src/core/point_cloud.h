// A cloud: points with named attributes, as a struct of arrays. A value.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/vec.h"

namespace sfumato {

/// How a scalar was stored in its file, so that a writer can store it the same way again.
enum class StoredType { uint8, int8, uint16, int16, uint32, int32, float32, float64, uint64, int64 };

/// The colour of a point that has none, in a cloud of which others have: white, and transparent, which tells
/// it from a white one. Black is a colour.
inline constexpr Rgba8 no_color{255, 255, 255, 0};

/// One number per point. The value of point i is `offset + values[i]`: the offset keeps large numbers
/// (GPS times) exact enough in float.
struct ScalarField {
  std::string name;
  double offset = 0;
  std::vector<float> values;
  StoredType type = StoredType::float32;
  double value(std::size_t i) const { return offset + double(values[i]); }
};

/// An organised scan inside the cloud: points [first, first + count) came from a width x height grid of
/// pixels or scan directions, seen from `viewpoint` (world). `PointCloud::grid_index` holds row * width +
/// column.
struct Grid {
  std::size_t first = 0, count = 0;
  std::uint32_t width = 0, height = 0;
  std::optional<dvec3> viewpoint;
};

/// A scalar that its LAS file held as whole numbers: value = number * scale + offset.
struct LasStep {
  std::string name;
  StoredType type = StoredType::int32;
  double scale = 1, offset = 0;
  std::optional<double> no_data;  ///< the number that stands for no value
};

/// Fixed-point description of LAS coordinates, kept so that LAS -> LAS/LAZ loses nothing.
struct LasScaling {
  dvec3 scale{0.001}, offset{0};  ///< a scale of 0: none, writers choose one
  int color_bits = 16;            ///< 8 or 12: the file held 0..255 or 0..4095 in its 16-bit fields
  bool colors_shifted =
      false;              ///< 16-bit colours were all v << 8 (else v * 257, or the scalar rgb_low_bytes)
  int point_format = -1;  ///< of the file, 0 to 10; -1 unknown
  std::uint16_t time_and_returns =
      0;                       ///< global encoding bits 0 (kind of GPS time) and 3 (synthetic returns)
  std::vector<LasStep> steps;  ///< of extra bytes
};

/// Axis that points away from the ground.
enum class UpAxis { pos_x, neg_x, pos_y, neg_y, pos_z, neg_z };
dvec3 up_vector(UpAxis up);
/// "+Z", "-y", "z" ... or nothing when it is not an axis.
std::optional<UpAxis> parse_up_axis(std::string_view text);
std::string to_string(UpAxis up);

/// How points came about, where the format of their file tells: as vertices of a model (OBJ), or
/// reconstructed from photographs (COLMAP).
enum class Provenance { unknown, model, photographs };

struct Bounds {
  dvec3 min{0}, max{0};
  dvec3 center() const { return 0.5 * (min + max); }
  dvec3 size() const { return max - min; }
  double diagonal() const { return glm::length(size()); }
  /// The bits of a corner's index choose between min (0) and max (1): x the lowest, z the highest.
  std::array<dvec3, 8> corners() const {
    std::array<dvec3, 8> all;
    for (int i = 0; i < 8; ++i) all[std::size_t(i)] = glm::mix(min, max, glm::bvec3(i & 1, i & 2, i & 4));
    return all;
  }
  bool operator==(const Bounds&) const = default;
};

struct PointCloud {
  dvec3 origin{0};              ///< world position of the local (0,0,0)
  std::vector<vec3> positions;  ///< relative to origin, always finite
  // The typed attributes; core/typed_attributes.h describes each.
  std::vector<vec3> normals;         ///< unit, or zero where unknown; empty when the cloud has none
  std::vector<Rgba8> colors;         ///< sRGB; empty when the cloud has none
  std::vector<float> radii;          ///< scene units; empty when the cloud has none
  std::vector<ScalarField> scalars;  ///< intensity, classification, uncertainty, any extra column of the file
  std::vector<std::uint32_t> source_index;  ///< place in the file; empty = identity (file order)
  std::vector<std::uint32_t> grid_index;    ///< place in its Grid; empty when nothing is organised
  std::vector<Grid> grids;
  /// World positions of scanners; scalar `scanner` picks one. NaN: the file does not say where it stood.
  std::vector<dvec3> scanners;
  UpAxis up = UpAxis::pos_z;
  bool up_is_known = false;  ///< else it is the custom of the format, or a guess
  Provenance provenance = Provenance::unknown;
  bool of_faces = false;  ///< all lie on the faces of a mesh, whose winding their normals follow
  std::string crs;        ///< coordinate reference system as text (WKT or "EPSG:n"), may be empty
  std::optional<LasScaling> las;

  std::size_t size() const { return positions.size(); }
  bool empty() const { return positions.empty(); }
  /// The user or the file says which way is up.
  void set_up(UpAxis axis) { up = axis, up_is_known = true; }
  dvec3 world(std::size_t i) const { return origin + dvec3(positions[i]); }
  const ScalarField* scalar(std::string_view name) const;
  ScalarField* scalar(std::string_view name);
  /// Adds or replaces the field of that name.
  ScalarField& set_scalar(ScalarField field);
};

/// World-space box of all points; zero-sized at the origin for an empty cloud.
Bounds bounds(const PointCloud& cloud);
/// World-space box between the `low` and `high` quantiles of each axis (default 2-98 %), so that a few
/// outliers do not decide the first view. Uses a sample of some 250,000 points at a fixed
/// stride, whose 2 % are 2 % of all within .1 % (three standard errors).
Bounds robust_bounds(const PointCloud& cloud, double low = 0.02, double high = 0.98);

/// The points named by `order` (indices into `cloud`), every attribute permuted alike. `source_index`
/// follows. Grids are kept only when the order keeps them contiguous, i.e. is ascending; otherwise use
/// `source_index`.
PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& order);
/// Appends `other`, moved to `cloud`'s origin (in double). Attributes that one side lacks are filled: normal
/// 0, radius 0, `no_color`, NaN scalar; colours that are all zero are lacking. Scanners of `other` come
/// behind those of `cloud`, and so do their numbers in the scalar `scanner`, which is there when either side
/// has scanners. Numbers of a file that says of none of its scanners where it stood stay as they are: the
/// others make room for them.
void append(PointCloud& cloud, const PointCloud& other);
/// Moves the points by an affine transform of the world; normals, radii, viewpoints and scanners follow, and
/// `up` to the nearest axis.
void transform(PointCloud& cloud, const dmat4& world_from_old);
/// Deterministic subsample of at most `max_points` points, in file order.
PointCloud subsample(const PointCloud& cloud, std::size_t max_points);

/// Triangles, for `synth mesh`.
struct Mesh {
  std::vector<vec3> positions;
  std::vector<Rgba8> colors;  ///< per vertex, or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace sfumato
