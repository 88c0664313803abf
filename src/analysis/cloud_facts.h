// What is known of a cloud that lies in parts, as on the ranks of a cluster or in tiles: the facts of its
// parts merge to those of the whole, in any order and grouping, bit for bit, so that all who merge them agree
// on every threshold.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "analysis/neighbors.h"
#include "core/point_cloud.h"

namespace sfumato::analysis {

/// Of a scalar's numbers, without NaN.
struct ScalarFacts {
  std::uint64_t count = 0;
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  bool operator==(const ScalarFacts&) const = default;
};

/// Of all its points: what adds up, and the ends of what has an order. And a random sample: the points with
/// the smallest hashes (E. Cohen, H. Kaplan, "Summarizing data using bottom-k sketches", PODC 2007), which
/// are the same whatever part a point lies in. Points that are alike in everything are one in it.
///
/// A share that is read off the sample, as where a quantile lies, is off by no more than e for all values at
/// once but with a chance of 2 exp(-2 n e^2) (P. Massart, 1990): for its 65,536 points, by 1 % but for four
/// times in a million; its 2 % and 98 % by .2 % (three standard errors).
struct CloudFacts {
  static constexpr std::size_t most_sampled = 65'536;
  struct Point {
    std::uint64_t hash = 0;  ///< of all the rest
    dvec3 place{0};          ///< world
    vec3 normal{0};
    Rgba8 color = no_color;
    float radius = 0;
    std::vector<double> values;  ///< in the order of `scalars`; NaN: it has none
    bool operator==(const Point& other) const { return hash == other.hash && place == other.place; }
    bool operator<(const Point& other) const;
  };

  /// Places with the smallest hashes, each once: what is measured around places is measured around the first
  /// of them. Their hashes are of nothing else, so that no colour decides about a shape.
  static constexpr std::size_t most_places = 8'192;
  struct Place {
    std::uint64_t hash = 0;
    dvec3 place{0};  ///< world
    bool operator==(const Place&) const = default;
    bool operator<(const Place& other) const;
  };

  std::uint64_t points = 0, with_color = 0, with_normal = 0, with_radius = 0;
  dvec3 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};
  std::map<std::string, ScalarFacts> scalars;
  std::map<int, std::uint64_t> classes;
  std::vector<Point> sample;  ///< by hash
  std::vector<Place> places;  ///< by hash
  bool operator==(const CloudFacts&) const = default;
};

CloudFacts facts_of(const PointCloud& cloud, std::size_t most_sampled = CloudFacts::most_sampled);
/// `most_sampled`: that of both.
void merge(CloudFacts& into, const CloudFacts& of, std::size_t most_sampled = CloudFacts::most_sampled);
/// CloudFacts::places.
std::vector<CloudFacts::Place> places_in(const PointCloud& cloud);
/// The sample as a cloud. What is measured on it (the up axis, quantiles, the subject of a view) is the same
/// for all.
PointCloud sample_of(const CloudFacts& facts);

/// The nearest points of some places. Of two parts, they are the nearest of both: no part needs to know what
/// lies beyond its border.
struct Neighborhoods {
  std::vector<dvec3> places;                ///< world
  std::vector<std::vector<dvec3>> nearest;  ///< of each: points of different places, from near to far
  bool operator==(const Neighborhoods&) const = default;
};

/// Places by their hashes are in an order at random, whatever that of the points was.
std::uint64_t hash_of(const dvec3& place);
/// Records of points likewise.
std::uint64_t hash_of(std::span<const std::uint8_t> record);
/// Whether a place is in a random sample of about `most_sampled` of so many points, whichever part it is in.
bool is_sampled(const dvec3& place, std::uint64_t points);
/// Of places by hash the first.
std::vector<dvec3> first_places(const std::vector<CloudFacts::Place>& places, std::size_t count);
/// `tree`: over points relative to `origin`. `count`: how many a place has, itself included.
Neighborhoods neighborhoods_of(const NeighborTree& tree, const dvec3& origin, std::vector<dvec3> places,
                               std::size_t count);
/// Of the same places.
void merge(Neighborhoods& into, const Neighborhoods& of, std::size_t count);

/// As measure_spacing, of these places; from nine points each on.
float spacing_of(const Neighborhoods& around);
/// As plane_residual: the median of the standard deviations from the plane through all points of a place.
float residual_of(const Neighborhoods& around);

}  // namespace sfumato::analysis
