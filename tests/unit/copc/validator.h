// An independent look at a COPC file: parses the bytes itself by the COPC 1.0 specification, reads the points
// through LASzip's own reader as the ordinary LAZ file that a COPC is, and takes nothing from src/.
#pragma once

#include <laszip/laszip_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace sfumato::test {

/// A point as LASzip gives it: every dimension of formats 6 to 8 and the extra bytes, as bytes that compare.
using RawPoint = std::string;

inline RawPoint raw(const laszip_point_struct& p) {
  RawPoint text;
  const auto add = [&](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(p.X), add(p.Y), add(p.Z), add(p.intensity), add(p.user_data), add(p.point_source_ID), add(p.gps_time);
  const std::uint8_t small[9] = {
      p.extended_return_number,        p.extended_number_of_returns, p.extended_classification,
      p.extended_classification_flags, p.extended_scanner_channel,   p.scan_direction_flag,
      p.edge_of_flight_line,           p.extended_point_type,        0};
  add(small), add(p.extended_scan_angle), add(p.rgb);
  text.append(reinterpret_cast<const char*>(p.extra_bytes), std::size_t(std::max(0, int(p.num_extra_bytes))));
  return text;
}

/// Every point of a LAS or LAZ file of format 6 to 8, as LASzip reads it.
inline std::vector<RawPoint> raw_points(const std::filesystem::path& file) {
  laszip_POINTER laszip = nullptr;
  laszip_BOOL compressed = 0;
  laszip_point_struct* point = nullptr;
  std::vector<RawPoint> points;
  laszip_create(&laszip);
  laszip_I64 count = 0;
  if (laszip_open_reader(laszip, file.c_str(), &compressed) == 0) {
    laszip_get_point_pointer(laszip, &point);
    laszip_header_struct* header = nullptr;
    laszip_get_header_pointer(laszip, &header);
    count = laszip_I64(
        std::max<laszip_U64>(header->number_of_point_records, header->extended_number_of_point_records));
  }
  for (laszip_I64 i = 0; i < count && laszip_read_point(laszip) == 0; ++i) points.push_back(raw(*point));
  laszip_close_reader(laszip);
  laszip_destroy(laszip);
  return points;
}

struct CopcNode {
  std::array<std::int32_t, 4> key{};  ///< level, x, y, z
  std::uint64_t byte = 0;
  std::int32_t size = 0, count = 0;
  std::size_t first = 0;  ///< of its points in file order
};

class CopcFile {
 public:
  std::vector<std::string> faults;            ///< what the specification forbids, one line each
  std::vector<CopcNode> nodes;                ///< those with points, in file order
  std::vector<std::array<double, 3>> places;  ///< in file order
  std::vector<RawPoint> points;
  double center[3] = {}, half_size = 0, spacing = 0;
  std::uint64_t count = 0;
  int format = 0, pages = 0;
  /// What the header and the info record say of the points is what they are.
  bool bounds_are_exact = true, returns_are_exact = true, times_are_exact = true;

  /// `slack`: how far points may lie beside their nodes; some writers round coordinates after sorting.
  explicit CopcFile(const std::filesystem::path& file, double slack = 0)
      : name_(file.string()), slack_(slack) {
    std::ifstream stream(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
    if (!header()) return;
    hierarchy();
    read_points();
    places_in_nodes();
  }

  /// The least distance of two points of a node, in spacings of its level, over all nodes that have children.
  double least_distance_of_inner_nodes() const {
    double least = 1e300;
    for (const CopcNode& node : nodes) {
      if (!has_children(node.key)) continue;
      const double step = spacing / std::ldexp(1.0, node.key[0]);
      std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> cells;
      for (std::size_t i = node.first; i < node.first + std::size_t(node.count); ++i) {
        std::array<std::int64_t, 3> cell;
        for (std::size_t k = 0; k < 3; ++k)
          cell[k] = std::int64_t(std::floor((places[i][k] - center[k] + half_size) / step));
        for (std::int64_t dx = -1; dx <= 1; ++dx)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dz = -1; dz <= 1; ++dz)
              if (const auto near = cells.find({cell[0] + dx, cell[1] + dy, cell[2] + dz});
                  near != cells.end())
                for (std::size_t j : near->second)
                  least = std::min(least, std::hypot(places[i][0] - places[j][0], places[i][1] - places[j][1],
                                                     places[i][2] - places[j][2]) /
                                              step);
        cells[cell].push_back(i);
      }
    }
    return least;
  }

 private:
  template <class T>
  T at(std::uint64_t byte) const {
    T value{};
    if (byte <= bytes_.size() && sizeof value <= bytes_.size() - byte)
      std::memcpy(&value, bytes_.data() + byte, sizeof value);
    return value;
  }
  bool require(bool is_fine, const std::string& what) {
    if (!is_fine && faults.size() < 20) faults.push_back(what);
    return is_fine;
  }
  bool has_children(const std::array<std::int32_t, 4>& k) const {
    for (int octant = 0; octant < 8; ++octant)
      if (entries_.contains(
              {k[0] + 1, 2 * k[1] + (octant & 1), 2 * k[2] + (octant >> 1 & 1), 2 * k[3] + (octant >> 2)}))
        return true;
    return false;
  }

  bool header() {
    if (!require(bytes_.size() > 589 && std::memcmp(bytes_.data(), "LASF", 4) == 0, "no LAS header"))
      return false;
    require(at<std::uint8_t>(24) == 1 && at<std::uint8_t>(25) == 4, "not LAS 1.4");
    require(at<std::uint16_t>(94) == 375, "a header that is not 375 bytes long");
    format = at<std::uint8_t>(104) & 0x3f;
    require((at<std::uint8_t>(104) & 0x80) != 0, "not marked as compressed");
    require(format >= 6 && format <= 8, "a point format that COPC does not allow");
    require(std::memcmp(bytes_.data() + 377, "copc\0\0\0\0\0\0\0\0\0\0\0\0", 16) == 0 &&
                at<std::uint16_t>(393) == 1 && at<std::uint16_t>(395) == 160,
            "the first record is not copc 1 of 160 bytes");
    for (int i = 0; i < 11; ++i)
      require(at<std::uint64_t>(429 + 72 + 8 * std::uint64_t(i)) == 0, "reserved bytes are not zero");
    for (std::uint64_t k = 0; k < 3; ++k) center[k] = at<double>(429 + 8 * k);
    half_size = at<double>(453), spacing = at<double>(461);
    require(std::isfinite(half_size) && half_size > 0 && std::isfinite(spacing) && spacing > 0,
            "an impossible cube or spacing");
    count = at<std::uint64_t>(247);
    points_at_ = at<std::uint32_t>(96);
    // Records between the header and the points, one of them LASzip's with chunks of varying size.
    std::uint64_t byte = 375;
    bool has_laszip = false;
    for (std::uint32_t i = 0; i < at<std::uint32_t>(100); ++i) {
      const auto length = at<std::uint16_t>(byte + 20);
      if (at<std::uint16_t>(byte + 18) == 22204) {
        has_laszip = true;
        const auto chunk = at<std::uint32_t>(byte + 54 + 12);
        require(chunk == 0xFFFFFFFFu || chunk == 0, "chunks of a fixed size");
      }
      byte += 54u + length;
    }
    require(has_laszip, "no LASzip record");
    require(byte == points_at_, "the points do not begin behind the records");
    table_at_ = at<std::uint64_t>(points_at_);
    require(table_at_ > points_at_ && table_at_ < bytes_.size(), "no chunk table");
    // Extended records up to the end of the file, one of them the hierarchy.
    byte = at<std::uint64_t>(235);
    for (std::uint32_t i = 0; i < at<std::uint32_t>(243); ++i) {
      const auto length = at<std::uint64_t>(byte + 20);
      if (!require(byte >= table_at_ && length <= bytes_.size() && byte + 60 + length <= bytes_.size(),
                   "an extended record outside"))
        break;
      if (std::memcmp(bytes_.data() + byte + 2, "copc\0", 5) == 0 && at<std::uint16_t>(byte + 18) == 1000)
        hierarchy_at_ = byte + 60, hierarchy_end_ = byte + 60 + length;
      byte += 60 + length;
    }
    require(byte == bytes_.size(), "bytes behind the last record");
    return require(hierarchy_at_ > 0, "no hierarchy");
  }

  void hierarchy() {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> todo{
        {at<std::uint64_t>(469), at<std::uint64_t>(477)}};
    std::vector<std::array<std::int32_t, 4>> roots{{0, 0, 0, 0}};
    std::uint64_t paged = 0;
    while (!todo.empty()) {
      const auto [byte, size] = todo.back();
      const auto root = roots.back();
      todo.pop_back(), roots.pop_back();
      if (!require(byte >= hierarchy_at_ && byte + size <= hierarchy_end_ && size > 0 && size % 32 == 0,
                   "a page outside the hierarchy") ||
          !require((paged += size) <= hierarchy_end_ - hierarchy_at_, "pages that are used twice"))
        return;
      ++pages;
      bool has_root = false;
      for (std::uint64_t e = byte; e < byte + size; e += 32) {
        CopcNode node;
        for (std::size_t k = 0; k < 4; ++k) node.key[k] = at<std::int32_t>(e + 4 * k);
        node.byte = at<std::uint64_t>(e + 16), node.size = at<std::int32_t>(e + 24),
        node.count = at<std::int32_t>(e + 28);
        require(node.key[0] >= 0 && node.key[0] < 31, "an impossible level");
        for (std::size_t k = 1; k < 4; ++k)
          require(node.key[k] >= 0 && node.key[k] < std::int64_t{1} << node.key[0],
                  "a node outside its level");
        if (node.count == -1) {
          todo.emplace_back(node.byte, std::uint64_t(node.size));
          roots.push_back(node.key);
          continue;
        }
        has_root |= node.key == root;
        require(node.count >= 0, "a negative count");
        require(entries_.emplace(node.key, node.count).second, "a node twice");
        if (node.count > 0)
          nodes.push_back(node);
        else
          require(node.size == 0 && node.byte == 0, "an empty node with bytes");
      }
      require(has_root, "a page without the node that leads to it");
    }
    require(paged == hierarchy_end_ - hierarchy_at_, "bytes of the hierarchy that no page uses");
    for (const auto& [key, n] : entries_)
      if (key[0] > 0)
        require(entries_.contains({key[0] - 1, key[1] / 2, key[2] / 2, key[3] / 2}),
                "a node without its parent");
    std::sort(nodes.begin(), nodes.end(),
              [](const CopcNode& a, const CopcNode& b) { return a.byte < b.byte; });
    std::uint64_t next = points_at_ + 8, sum = 0;
    for (CopcNode& node : nodes) {
      require(node.byte == next, "chunks with gaps between them or one in the other");
      next = node.byte + std::uint64_t(node.size);
      node.first = sum;
      sum += std::uint64_t(node.count);
    }
    require(next == table_at_, "the chunk table does not lie behind the last chunk");
    require(sum == count,
            "nodes hold " + std::to_string(sum) + " points, the header says " + std::to_string(count));
  }

  void read_points() {
    laszip_POINTER laszip = nullptr;
    laszip_BOOL compressed = 0;
    laszip_point_struct* p = nullptr;
    laszip_header_struct* h = nullptr;
    laszip_create(&laszip);
    if (require(laszip_open_reader(laszip, name_.c_str(), &compressed) == 0, "LASzip cannot open it")) {
      laszip_get_point_pointer(laszip, &p);
      laszip_get_header_pointer(laszip, &h);
      std::array<double, 3> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
      std::array<std::uint64_t, 15> returns{};
      double first_time = 1e300, last_time = -1e300;
      for (std::uint64_t i = 0; i < count; ++i) {
        if (!require(laszip_read_point(laszip) == 0, "LASzip cannot read point " + std::to_string(i))) break;
        const std::array<double, 3> place{h->x_scale_factor * p->X + h->x_offset,
                                          h->y_scale_factor * p->Y + h->y_offset,
                                          h->z_scale_factor * p->Z + h->z_offset};
        for (std::size_t k = 0; k < 3; ++k)
          low[k] = std::min(low[k], place[k]), high[k] = std::max(high[k], place[k]);
        if (p->extended_return_number > 0) ++returns[p->extended_return_number - 1u];
        first_time = std::min(first_time, p->gps_time), last_time = std::max(last_time, p->gps_time);
        places.push_back(place);
        points.push_back(raw(*p));
      }
      laszip_close_reader(laszip);
      const double claimed[6] = {h->min_x, h->max_x, h->min_y, h->max_y, h->min_z, h->max_z};
      for (std::size_t k = 0; k < 3 && !places.empty(); ++k) {
        // One rounding of a coordinate is allowed: writers compute it in other orders.
        const double rounding = 1e-12 * std::max(1.0, std::abs(low[k]) + std::abs(high[k]));
        bounds_are_exact &= std::abs(claimed[2 * k] - low[k]) <= rounding &&
                            std::abs(claimed[2 * k + 1] - high[k]) <= rounding;
      }
      for (std::size_t k = 0; k < 15; ++k)
        returns_are_exact &= returns[k] == h->extended_number_of_points_by_return[k];
      times_are_exact = places.empty() || (at<double>(485) == first_time && at<double>(493) == last_time);
    }
    laszip_destroy(laszip);
  }

  void places_in_nodes() {
    if (places.size() != count) return;
    for (const CopcNode& node : nodes) {
      const double size = 2 * half_size / std::ldexp(1.0, node.key[0]);
      for (std::size_t k = 0; k < 3; ++k) {
        const double low = center[k] - half_size + node.key[k + 1] * size, high = low + size;
        // Where a border falls on a coordinate, roundings of doubles decide: a few of the largest number
        // involved.
        const double rounding = slack_ + 1e-14 * (std::abs(center[k]) + half_size) * 8;
        for (std::size_t i = node.first; i < node.first + std::size_t(node.count); ++i)
          if (!require(places[i][k] >= low - rounding && places[i][k] <= high + rounding,
                       "a point outside its node"))
            return;
      }
    }
  }

  std::string name_;
  double slack_;
  std::vector<char> bytes_;
  std::uint64_t points_at_ = 0, table_at_ = 0, hierarchy_at_ = 0, hierarchy_end_ = 0;
  std::map<std::array<std::int32_t, 4>, std::int32_t> entries_;
};

}  // namespace sfumato::test
