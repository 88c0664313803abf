// The octree of a COPC file: where points lie in it, which of them a node shows, and the nodes of one part of
// it.
//
// A node of more than `leaf_limit` points below it is divided; the others are leaves and hold their points.
// From the leaves up, a node takes from its children one point of each cell of a grid of 128^3: the one
// nearest to the cell's centre, unless the point taken in a neighbouring cell is nearer than half a cell. So
// each level is an even subset of the one below, every point is in one node, and neither order nor threads
// decide which.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "copc/record_sample.h"
#include "copc/schema.h"
#include "copc/spool.h"
#include "core/progress.h"

namespace sfumato::copc {

inline constexpr std::uint32_t leaf_limit = 1 << 16;
inline constexpr int grid_bits = 7, grid_size = 1 << grid_bits;  ///< cells of a node along an axis
/// Nodes of this level are leaves: their grid has the steps of `Place`.
inline constexpr int deepest_level = 32 - grid_bits;

struct Cube {
  dvec3 min{0};
  double size = 1;
  /// Around `box`; no smaller than 128 steps, so that the distance between points is never 0.
  static Cube around(const Bounds& box, const dvec3& step);
  dvec3 center() const { return min + 0.5 * size; }
};

/// A place in the cube, in 2^32 steps along each axis.
struct Place {
  std::uint32_t x, y, z;
  bool operator==(const Place&) const = default;
  Key node(int level) const {
    const auto shifted = [level](std::uint32_t v) { return std::uint32_t(std::uint64_t{v} >> (32 - level)); };
    return {level, shifted(x), shifted(y), shifted(z)};
  }
};

class Locator {
 public:
  Locator(const Schema& schema, const Cube& cube);
  Place operator()(const std::uint8_t* record) const;

 private:
  dvec3 factor_, shift_;
};

/// What is stored beside the points: by header and info, and the sample.
struct Summary {
  std::array<std::int32_t, 3> low{}, high{};
  std::array<std::uint64_t, 15> by_return{};
  double first_time = std::numeric_limits<double>::infinity(), last_time = -first_time;
  std::uint64_t points = 0;
  RecordSample sample;

  void add(std::span<const std::uint8_t> record);
  void add(const Summary& other);
};

struct EncodedNode {
  Key key;
  std::uint32_t count = 0;
  std::vector<std::uint8_t> bytes;  ///< a LASzip chunk
};

/// Some points of the tree, and the nodes made of them. One thread uses it.
class NodeMaker {
 public:
  /// `average_colors`: a point that moves up takes the mean colour of the points in its cell.
  NodeMaker(const Schema& schema, const Locator& locator, Progress& progress, bool average_colors = false);

  /// Adds records and returns their numbers.
  std::vector<std::uint32_t> add(std::span<const std::uint8_t> records);
  void take(std::vector<std::uint8_t>&& records);  ///< of an empty maker: all points at once
  std::size_t size() const { return places_.size(); }

  /// Makes all nodes below `root`, which all points lie in, and returns the points of the root itself.
  std::vector<std::uint32_t> build(const Key& root);
  /// The points that `parent` takes; what is left of its children becomes nodes.
  std::vector<std::uint32_t> join(const Key& parent, std::array<std::vector<std::uint32_t>, 8>& children);
  /// Makes the node of these points; nothing when there are none.
  void encode(const Key& key, std::span<const std::uint32_t> points);
  /// The records one behind the other.
  std::vector<std::uint8_t> records_of(std::span<const std::uint32_t> points) const;

  std::vector<EncodedNode> nodes;
  Summary summary;

 private:
  struct Candidate {
    double distance;
    std::uint32_t cell, point;
  };

  const std::uint8_t* record(std::uint32_t i) const { return records_.data() + std::size_t(i) * length_; }
  std::vector<std::uint32_t> build(const Key& node, std::vector<std::uint32_t>&& points);
  void mark_chosen(const Key& parent, const std::array<std::vector<std::uint32_t>, 8>& children);
  bool is_crowded(const Candidate& candidate, int shift) const;
  void average_colors(const std::array<std::vector<std::uint32_t>, 8>& children, int shift);
  std::vector<std::uint32_t> in_order(std::span<const std::uint32_t> points) const;

  const Schema& schema_;
  Locator locator_;
  Progress& progress_;
  std::size_t length_;
  bool is_averaging_;
  std::vector<std::uint8_t> records_;
  std::vector<Place> places_;
  std::vector<char> is_chosen_;
  std::vector<std::uint32_t> grid_;  ///< by cell: 1 + the number of its candidate
  std::vector<Candidate> candidates_;
};

}  // namespace sfumato::copc
