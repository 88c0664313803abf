#include "copc/octree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/interleave.h"
#include "io/laz_encode.h"

namespace sfumato::copc {
namespace {

constexpr double places = 4294967296.0;
// Points of one level are no nearer to each other than this share of a cell, within a node.
constexpr double least_distance = 0.5;
// Where points fill space instead of lying on surfaces a grid has two million cells. So many points of them,
// chosen without regard to place, still stand eight deep before each other, and a node stays quick to read.
constexpr std::size_t most_chosen = 1 << 17;
constexpr std::size_t gps_time_byte = 22, color_byte = 30;

// The bits of a place, interleaved, without the last eleven of each axis.
std::uint64_t morton(const Place& place) { return interleaved(place.x >> 11, place.y >> 11, place.z >> 11); }

// Bits whose order as whole numbers is that of the doubles.
std::uint64_t sortable(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bits >> 63 ? ~bits : bits | std::uint64_t{1} << 63;
}

// A number for each cell that has nothing to do with where it is; no two cells have the same.
std::uint32_t scrambled(std::uint32_t cell) {
  cell = (cell ^ cell >> 16) * 0x7FEB352Du;
  cell = (cell ^ cell >> 15) * 0x846CA68Bu;
  return cell ^ cell >> 16;
}

std::uint32_t cell_of(const Place& place, int shift) {
  const auto along = [shift](std::uint32_t v) { return v >> shift & (grid_size - 1); };
  return along(place.x) | along(place.y) << grid_bits | along(place.z) << 2 * grid_bits;
}

}  // namespace

Cube Cube::around(const Bounds& box, const dvec3& step) {
  const dvec3 extent = box.size();
  double size = std::max({extent.x, extent.y, extent.z, grid_size * std::max({step.x, step.y, step.z})});
  size *= 1 + 1e-9;  // roundings of the bounds stay inside
  return {box.center() - 0.5 * size, size};
}

Locator::Locator(const Schema& schema, const Cube& cube)
    : factor_(schema.scale * (places / cube.size)),
      shift_((schema.offset - cube.min) * (places / cube.size)) {}

Place Locator::operator()(const std::uint8_t* record) const {
  std::uint32_t at[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double place = io::las::get<std::int32_t>(record + 4 * axis) * factor_[axis] + shift_[axis];
    at[axis] = std::uint32_t(std::clamp(place, 0.0, places - 1));
  }
  return {at[0], at[1], at[2]};
}

void Summary::add(std::span<const std::uint8_t> bytes) {
  const std::uint8_t* record = bytes.data();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto steps = io::las::get<std::int32_t>(record + 4 * axis);
    low[axis] = points ? std::min(low[axis], steps) : steps;
    high[axis] = points ? std::max(high[axis], steps) : steps;
  }
  if (const int number = record[14] & 15; number > 0) ++by_return[std::size_t(number - 1)];
  if (const auto time = io::las::get<double>(record + gps_time_byte); std::isfinite(time)) {
    first_time = std::min(first_time, time);
    last_time = std::max(last_time, time);
  }
  ++points;
  sample.add(bytes);
}

void Summary::add(const Summary& other) {
  if (other.points == 0) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = points ? std::min(low[axis], other.low[axis]) : other.low[axis];
    high[axis] = points ? std::max(high[axis], other.high[axis]) : other.high[axis];
  }
  for (std::size_t i = 0; i < by_return.size(); ++i) by_return[i] += other.by_return[i];
  first_time = std::min(first_time, other.first_time);
  last_time = std::max(last_time, other.last_time);
  points += other.points;
  sample.add(other.sample);
}

NodeMaker::NodeMaker(const Schema& schema, const Locator& locator, Progress& progress, bool average_colors)
    : schema_(schema),
      locator_(locator),
      progress_(progress),
      length_(schema.record_length),
      is_averaging_(average_colors && schema.format >= 7) {}

std::vector<std::uint32_t> NodeMaker::add(std::span<const std::uint8_t> records) {
  std::vector<std::uint32_t> added(records.size() / length_);
  std::iota(added.begin(), added.end(), std::uint32_t(places_.size()));
  records_.insert(records_.end(), records.begin(), records.end());
  for (std::uint32_t i : added) places_.push_back(locator_(record(i)));
  is_chosen_.resize(places_.size(), 0);
  return added;
}

void NodeMaker::take(std::vector<std::uint8_t>&& records) {
  records_ = std::move(records);
  places_.resize(records_.size() / length_);
  for (std::uint32_t i = 0; i < places_.size(); ++i) places_[i] = locator_(record(i));
  is_chosen_.assign(places_.size(), 0);
}

std::vector<std::uint32_t> NodeMaker::build(const Key& root) {
  std::vector<std::uint32_t> all(places_.size());
  std::iota(all.begin(), all.end(), 0u);
  return build(root, std::move(all));
}

std::vector<std::uint32_t> NodeMaker::build(const Key& node, std::vector<std::uint32_t>&& points) {
  progress_.check();
  const auto is_in_one_place = [&] {
    return std::all_of(points.begin(), points.end(),
                       [&](std::uint32_t i) { return places_[i] == places_[points[0]]; });
  };
  if (points.size() <= leaf_limit || node.level >= deepest_level || is_in_one_place())
    return std::move(points);
  std::array<std::vector<std::uint32_t>, 8> children;
  const int shift = 31 - node.level;
  for (std::uint32_t i : points) {
    const Place& p = places_[i];
    children[(p.x >> shift & 1) | (p.y >> shift & 1) << 1 | (p.z >> shift & 1) << 2].push_back(i);
  }
  points = {};
  for (unsigned octant = 0; octant < 8; ++octant)
    if (!children[octant].empty()) children[octant] = build(node.child(octant), std::move(children[octant]));
  return join(node, children);
}

std::vector<std::uint32_t> NodeMaker::join(const Key& parent,
                                           std::array<std::vector<std::uint32_t>, 8>& children) {
  progress_.check();
  mark_chosen(parent, children);
  std::vector<std::uint32_t> chosen;
  for (unsigned octant = 0; octant < 8; ++octant) {
    std::vector<std::uint32_t>& points = children[octant];
    const auto rest =
        std::stable_partition(points.begin(), points.end(), [&](std::uint32_t i) { return is_chosen_[i]; });
    chosen.insert(chosen.end(), points.begin(), rest);
    points.erase(points.begin(), rest);
    encode(parent.child(octant), points);
    points = {};
  }
  for (std::uint32_t i : chosen) is_chosen_[i] = 0;
  return chosen;
}

void NodeMaker::mark_chosen(const Key& parent, const std::array<std::vector<std::uint32_t>, 8>& children) {
  const int shift = 32 - parent.level - grid_bits;
  const double width = std::ldexp(1.0, shift);
  grid_.resize(std::size_t{1} << 3 * grid_bits);
  candidates_.clear();
  const auto from_center = [&](std::uint32_t v) {
    return (double(v & (std::uint32_t(std::uint64_t{1} << shift) - 1)) + 0.5) / width - 0.5;
  };
  for (const std::vector<std::uint32_t>& points : children)
    for (std::uint32_t i : points) {
      const Place& place = places_[i];
      const double x = from_center(place.x), y = from_center(place.y), z = from_center(place.z);
      const double distance = x * x + y * y + z * z;
      std::uint32_t& cell = grid_[cell_of(place, shift)];
      if (cell == 0) {
        candidates_.push_back({distance, cell_of(place, shift), i});
        cell = std::uint32_t(candidates_.size());
        continue;
      }
      Candidate& best = candidates_[cell - 1];
      // Of two at the same distance the records decide, so that their order does not.
      if (distance < best.distance ||
          (distance == best.distance && std::memcmp(record(i), record(best.point), length_) < 0))
        best.distance = distance, best.point = i;
    }
  // Those nearest to their centres come first; they are a cell apart.
  std::vector<std::uint32_t> order(candidates_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Candidate &x = candidates_[a], &y = candidates_[b];
    return x.distance != y.distance ? x.distance < y.distance : x.cell < y.cell;
  });
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i : order) {
    if (is_crowded(candidates_[i], shift)) continue;
    is_chosen_[candidates_[i].point] = 1;
    chosen.push_back(i);
  }
  if (chosen.size() > most_chosen) {
    const auto rank = [&](std::uint32_t i) { return scrambled(candidates_[i].cell); };
    std::sort(chosen.begin(), chosen.end(),
              [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
    for (std::size_t i = most_chosen; i < chosen.size(); ++i) is_chosen_[candidates_[chosen[i]].point] = 0;
  }
  if (is_averaging_) average_colors(children, shift);
  for (const Candidate& candidate : candidates_) grid_[candidate.cell] = 0;
}

// Of what the level below shows in the cell: means of means, of much the same number of points each.
void NodeMaker::average_colors(const std::array<std::vector<std::uint32_t>, 8>& children, int shift) {
  struct Sum {
    std::uint64_t channel[3] = {0, 0, 0}, points = 0;
  };
  std::vector<Sum> sums(candidates_.size());
  for (const std::vector<std::uint32_t>& points : children)
    for (std::uint32_t i : points) {
      Sum& sum = sums[grid_[cell_of(places_[i], shift)] - 1];
      for (std::size_t k = 0; k < 3; ++k)
        sum.channel[k] += io::las::get<std::uint16_t>(record(i) + color_byte + 2 * k);
      ++sum.points;
    }
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (!is_chosen_[candidates_[c].point]) continue;
    std::uint8_t* color = records_.data() + std::size_t(candidates_[c].point) * length_ + color_byte;
    for (std::size_t k = 0; k < 3; ++k)
      io::las::put(color + 2 * k, std::uint16_t((sums[c].channel[k] + sums[c].points / 2) / sums[c].points));
  }
}

bool NodeMaker::is_crowded(const Candidate& candidate, int shift) const {
  const auto cell = [&](int axis) { return int(candidate.cell >> (grid_bits * axis) & (grid_size - 1)); };
  const Place& here = places_[candidate.point];
  const double reach = least_distance * std::ldexp(1.0, shift);
  for (int z = std::max(0, cell(2) - 1); z <= std::min(grid_size - 1, cell(2) + 1); ++z)
    for (int y = std::max(0, cell(1) - 1); y <= std::min(grid_size - 1, cell(1) + 1); ++y)
      for (int x = std::max(0, cell(0) - 1); x <= std::min(grid_size - 1, cell(0) + 1); ++x) {
        const std::uint32_t other = grid_[std::size_t(x | y << grid_bits | z << 2 * grid_bits)];
        if (other == 0 || !is_chosen_[candidates_[other - 1].point]) continue;
        const Place& there = places_[candidates_[other - 1].point];
        const double dx = double(here.x) - there.x, dy = double(here.y) - there.y,
                     dz = double(here.z) - there.z;
        if (dx * dx + dy * dy + dz * dz < reach * reach) return true;
      }
  return false;
}

// By time, which compresses best, else along a curve through space; what is left to decide the records do.
std::vector<std::uint32_t> NodeMaker::in_order(std::span<const std::uint32_t> points) const {
  const auto time = [&](std::uint32_t i) {
    return sortable(io::las::get<double>(record(i) + gps_time_byte));
  };
  const bool has_time =
      std::any_of(points.begin(), points.end(), [&](std::uint32_t i) { return time(i) != time(points[0]); });
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(points.size());
  for (std::uint32_t i : points) keys.emplace_back(has_time ? time(i) : morton(places_[i]), i);
  std::sort(keys.begin(), keys.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first
                              : std::memcmp(record(a.second), record(b.second), length_) < 0;
  });
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (const auto& [key, point] : keys) order.push_back(point);
  return order;
}

std::vector<std::uint8_t> NodeMaker::records_of(std::span<const std::uint32_t> points) const {
  std::vector<std::uint8_t> records(points.size() * length_);
  for (std::size_t i = 0; i < points.size(); ++i)
    std::memcpy(records.data() + i * length_, record(points[i]), length_);
  return records;
}

void NodeMaker::encode(const Key& key, std::span<const std::uint32_t> points) {
  if (points.empty()) return;
  if (points.size() > io::las::largest_chunk)
    throw Error(ErrorCode::bad_input,
                std::to_string(points.size()) + " points lie in nearly one place, and a node holds " +
                    std::to_string(io::las::largest_chunk) + "; leave them out or take --max-points");
  const std::vector<std::uint8_t> records = records_of(in_order(points));
  for (std::size_t at = 0; at < records.size(); at += length_) summary.add({records.data() + at, length_});
  nodes.push_back({key, std::uint32_t(points.size()),
                   io::las::encode_chunk(schema_.format, schema_.record_length, records)});
}

}  // namespace sfumato::copc
