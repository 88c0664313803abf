// Where the points of a build wait, sorted into the cells of a level.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <unordered_map>
#include <vector>

#include "copc/octree.h"
#include "copc/spool.h"

namespace sfumato::copc {

// Of the memory: bins that wait, neighbours of bins.
inline constexpr double share_of_bins = 0.25, share_of_halos = 0.1;
// A cell keeps what lies within this share of its width around it as neighbours for attributes. Of
// points_per_bin on a surface, 512 lie side by side: 24 neighbours reach three of them, and ten are kept. Of
// the stored uncertainty, smoothed over seven, what is farther than ten counts little.
inline constexpr double halo_share = 0.02;
inline constexpr std::uint64_t points_per_bin = 1 << 18;

/// The cells of one level below `region`, with their points and, for attributes, with what lies around
/// them.
struct Bins {
  Bins(const Key& of, int at, const std::filesystem::path& purpose, std::uint64_t memory, bool has_halos)
      : region(of),
        level(at),
        points(purpose.parent_path(), purpose, std::uint64_t(share_of_bins * double(memory))) {
    if (has_halos)
      halos.emplace(purpose.parent_path(), purpose, std::uint64_t(share_of_halos * double(memory)));
  }
  Key region;
  int level;
  Spool points;
  std::optional<Spool> halos;
};

/// Records put where they belong before they go to the spool, a block at a time.
class Sorter {
 public:
  Sorter(Bins& bins, const Locator& locator, std::size_t length)
      : bins_(bins), locator_(locator), length_(length), record_(length) {}
  std::uint8_t* next() { return record_.data(); }
  /// `is_neighbor`: it lies outside of the region and is put around cells of it alone.
  void put(bool is_neighbor = false) {
    const Place place = locator_(record_.data());
    const Key key = place.node(bins_.level);
    if (!is_neighbor) {
      if (!last_ || key != last_key_) last_ = &held_[key], last_key_ = key;
      last_->insert(last_->end(), record_.begin(), record_.end());
    }
    if (bins_.halos) put_around(place, key);
  }
  void flush() {
    for (const auto& [key, bytes] : held_) bins_.points.append(key, bytes);
    for (const auto& [key, bytes] : around_) bins_.halos->append(key, bytes);
    held_.clear();
    around_.clear();
    last_ = nullptr;
  }

 private:
  /// To every cell that the place is near to, over faces, edges and corners.
  void put_around(const Place& place, const Key& key) {
    const int shift = 32 - bins_.level;
    const auto width = std::uint64_t{1} << shift;
    const auto margin = std::uint64_t(halo_share * double(width));
    int step[3];
    const std::uint32_t at[3] = {place.x, place.y, place.z};
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t within = at[axis] & (width - 1);
      step[axis] = within < margin ? -1 : within >= width - margin ? 1 : 0;
    }
    for (int which = 1; which < 8; ++which) {
      std::int64_t to[3] = {key.x, key.y, key.z};
      bool is_cell = true;
      for (int axis = 0; axis < 3; ++axis) {
        if (!(which >> axis & 1)) continue;
        to[axis] += step[axis];
        is_cell = is_cell && step[axis] != 0;
      }
      const int up = bins_.level - bins_.region.level;
      if (!is_cell || to[0] >> up != bins_.region.x || to[1] >> up != bins_.region.y ||
          to[2] >> up != bins_.region.z)
        continue;
      std::vector<std::uint8_t>& bytes =
          around_[Key{bins_.level, std::uint32_t(to[0]), std::uint32_t(to[1]), std::uint32_t(to[2])}];
      bytes.insert(bytes.end(), record_.begin(), record_.end());
    }
  }

  Bins& bins_;
  const Locator& locator_;
  std::size_t length_;
  std::vector<std::uint8_t> record_;
  std::unordered_map<Key, std::vector<std::uint8_t>, KeyHash> held_, around_;
  std::vector<std::uint8_t>* last_ = nullptr;
  Key last_key_;
};

}  // namespace sfumato::copc
