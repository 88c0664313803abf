// A cloud ready for rendering: sorted along a Morton curve, cut into batches, with the attributes that were
// asked for.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/made_once.h"
#include "core/point_cloud.h"

namespace sfumato {

/// What a technique may need beyond positions. A bit set.
enum class Attribute : std::uint32_t {
  normal = 1,
  radius = 2,
  uncertainty = 4,
  cluster = 8,
  support = 16,
  surroundings = 32  ///< of a part of a cloud: PreparedCloud::surroundings
};

class Attributes {
 public:
  constexpr Attributes() = default;
  constexpr Attributes(Attribute a) : bits_(std::uint32_t(a)) {}
  constexpr bool has(Attribute a) const { return bits_ & std::uint32_t(a); }
  constexpr Attributes operator|(Attributes other) const { return from(bits_ | other.bits_); }
  constexpr Attributes without(Attributes other) const { return from(bits_ & ~other.bits_); }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr bool operator==(const Attributes&) const = default;

 private:
  static constexpr Attributes from(std::uint32_t bits) {
    Attributes a;
    a.bits_ = bits;
    return a;
  }
  std::uint32_t bits_ = 0;
};
constexpr Attributes operator|(Attribute a, Attribute b) { return Attributes(a) | Attributes(b); }
/// As reports name them.
inline std::vector<std::string> names_of(Attributes attributes) {
  std::vector<std::string> names;
  if (attributes.has(Attribute::normal)) names.push_back("normal");
  if (attributes.has(Attribute::radius)) names.push_back("radius");
  if (attributes.has(Attribute::uncertainty)) names.push_back("uncertainty");
  if (attributes.has(Attribute::cluster)) names.push_back("cluster");
  if (attributes.has(Attribute::support)) names.push_back("support");
  return names;
}

/// About 10,000 points that follow each other on the Morton curve: the unit of culling and level of detail.
struct Batch {
  std::uint32_t first = 0, count = 0;
  vec3 box_min{0}, box_max{0};  ///< relative to the cloud's origin
  float spacing = 0;            ///< median point spacing, scene units (same definition as median_spacing)
  /// The spacing at a place p, relative to the cloud's origin: 2^clamp(dot(xyz, p) + w, least, most), so that
  /// it does not jump where batches meet.
  vec4 log2_spacing{0};
  float least_log2_spacing = 0, most_log2_spacing = 0;

  Bounds box() const { return {dvec3(box_min), dvec3(box_max)}; }
  void set_even_spacing(float value) {
    spacing = value;
    least_log2_spacing = most_log2_spacing = std::log2(value);
    log2_spacing = vec4(0, 0, 0, least_log2_spacing);
  }
  float spacing_at(const vec3& place) const {
    const float value = glm::dot(vec3(log2_spacing), place) + log2_spacing.w;
    return std::exp2(glm::clamp(value, least_log2_spacing, most_log2_spacing));
  }
};

/// Values below which 2 % and 98 % of a field lie, so that a few outliers do not decide its range.
struct Quantiles {
  float q02 = 0, q98 = 0;
};

/// Which pixel of which organised view a point was. Grids do not survive sorting; this does, until nothing is
/// left that could be computed from it.
struct ViewPlaces {
  std::vector<Grid> grids;          ///< without `first` and `count`
  std::vector<std::uint32_t> grid;  ///< per point; grids.size() = none
  std::vector<std::uint32_t> cell;  ///< per point: row * width + column
};

/// How much of a cloud is surface, 0 to 1, and the dimension of what is there, 1 of lines, 2 of surfaces
/// (analysis/survey.h).
struct SurfaceShare {
  float surface = 1, dimension = 2;
};

/// Of points that are the pixels of depth pictures, whose neighbours are known without searching.
struct DepthPictures {
  /// The share of the points that neighbours beside and above or below continue as one surface, no steeper
  /// than 75 degrees to the line of sight.
  float surface_share = 1;
  /// Of one picture: where its sensor was, relative to the cloud's origin, and the standard deviation of a
  /// range over the range squared, as stereo and structured light have it (Khoshelham, Elberink 2012); of
  /// several pictures 0.
  vec3 sensor{0};
  float noise = 0;
};

/// In median radii: the largest disc, where they are limited. A scanner's points are denser on what it stands
/// beside than on the ground around it: of twice the median ground 4 m off was full of holes. Outliers are
/// smaller than this by themselves (analysis/attributes.cpp).
constexpr float largest_disc = 4;

/// Sizes of dots (analysis/dots.h), spacings in scene units, at places along the curve, relative to the
/// cloud's origin.
struct PlacedDots {
  std::vector<vec3> places;
  std::vector<vec2> dots;
};

/// How far points lie off their surfaces (analysis/local_noise.h), standard deviations in scene units, at
/// places along the curve, relative to the cloud's origin.
struct PlacedNoise {
  std::vector<vec3> places;
  std::vector<float> deviations;
  float of_spacing = 0;  ///< median of those over the spacing of the points there
};

/// How spacing varies along the curve over a box, relative to the cloud's origin: a place has that of the
/// stretch that its key lies in (analysis/spacing.h).
struct PlacedSpacing {
  vec3 box_min{0}, box_max{0};
  std::vector<std::uint64_t> begins;  ///< keys
  std::vector<Batch> stretches;       ///< of no points
};

/// What decides how points are drawn and follows from all points of a cloud of which only a part is here: the
/// same for every part (analysis/whole.h).
struct WholeCloud {
  dvec3 origin{0};  ///< of every part
  std::uint64_t points = 0;
  Bounds box, usual_box;  ///< world; usual: robust_bounds
  float median_spacing = 1, noise = 0;
  float residual = 0;                      ///< scene units: as analysis::plane_residual
  float median_radius = 0;                 ///< of Eq. 20, scene units; 0: there are too few points
  float large_radius = 0;                  ///< which 95 % of them do not exceed
  float usual_reach = 0, empty_reach = 0;  ///< scene units (analysis/isolation.h)
  bool is_rough = false;                   ///< computed normals are to be averaged (analysis/wide_normals.h)
  bool has_normals = false;                ///< which its files brought, and which are used
  PlacedDots dots;
  PlacedNoise placed_noise;
  PlacedSpacing spacing;
  PointCloud sample;
};

struct PreparedCloud {
  PointCloud cloud;  ///< Morton order, stable; `source_index` always filled
  std::vector<Batch> batches;
  float median_spacing = 0;  ///< side of the square per point, scene units: median of R_8 sqrt(pi/8)
  float median_radius = 0;   ///< scene units; 0 while there are no radii
  float radius_limit = 0;    ///< scene units: no disc on a surface needs more; 0: never measured
  /// Standard deviation of the points off the surfaces they lie on, scene units: of the positions
  /// (analysis/surface_noise.h), and what is more of those whose normals were computed.
  float surface_noise = 0, noise = 0;
  Quantiles uncertainty_range;  ///< of the scalar `uncertainty` as stored, i.e. without its offset
  Attributes available;         ///< attributes present, from the file or computed
  Attributes computed;          ///< those of them that were computed: only for techniques that ask for them
  std::vector<float>
      shrunk;  ///< of each radius of a point in clutter to what it would be on a surface; empty: all 1
  /// How far the neighbours of each point vouch for a disc, 1, where it is drawn as a dot otherwise, 0;
  /// empty: all 1. Negative where normals face outward: on thin sheets that were measured on both sides, and
  /// on faces of a mesh. From behind such a point fills no more than what the other side leaves open.
  std::vector<float> on_surface;
  /// How far each point lies among others, from 1 to 0, so that it is no outlier (analysis/isolation.h);
  /// empty: never measured.
  std::vector<float> support;
  int neighbors = 24;  ///< that computed attributes were measured from
  /// analysis::surface_share_of: places, pictures and attributes of the file decide, which copies share.
  MadeOnce<SurfaceShare> surface_share;
  std::optional<DepthPictures> pictures;  ///< which the cloud was when it was sorted
  /// What spacings are stored in as halves: the power of two near the median; any other rounds the same.
  float spacing_unit() const {
    return median_spacing > 0 ? std::exp2(std::round(std::log2(median_spacing))) : 1;
  }
  std::shared_ptr<const WholeCloud> whole;  ///< of which this is a part; null: this is all of it
  /// The points of a part among those of others around it (analysis/regions.h), prepared alike, for what is
  /// measured later; null: there are no others, or nobody asked for them.
  std::shared_ptr<const PreparedCloud> surroundings;
  std::vector<std::uint32_t> in_surroundings;  ///< place there of every point
  /// Of attributes, those that are not there: nothing surrounds the whole.
  Attributes lacking(Attributes needs) const {
    return (whole ? needs : needs.without(Attribute::surroundings)).without(available);
  }
  const PreparedCloud& with_surroundings() const { return surroundings ? *surroundings : *this; }
  /// Of values of `with_surroundings`, those of the points themselves.
  template <class T>
  std::vector<T> own_of(std::vector<T> values) const {
    if (!surroundings || values.empty()) return values;
    std::vector<T> own;
    own.reserve(in_surroundings.size());
    for (const std::uint32_t i : in_surroundings) own.push_back(values[i]);
    return own;
  }
  ViewPlaces views;  ///< empty unless normals or radii may still come from RGB-D views
};

}  // namespace sfumato
