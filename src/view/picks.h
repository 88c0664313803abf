// Points that were picked, and the profile along the line of them.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "view/picking.h"
#include "view/profile.h"

namespace sfumato::view {

class Picks {
 public:
  const std::vector<Picked>& points() const { return points_; }  ///< newest last
  /// The places of the points, in their order.
  std::vector<dvec3> line() const {
    std::vector<dvec3> line;
    for (const Picked& each : points_) line.push_back(each.world);
    return line;
  }
  void clear() { points_.clear(); }
  const std::shared_ptr<const Profile>& profile() const { return profile_; }  ///< null: none
  void close_profile() { profile_.reset(); }

 private:
  friend class ViewModel;  // which asks for points and profiles, the newest of each
  void add(Picked point) {
    if (!is_line_ && points_.size() > 2) points_.clear();  // after a line begins the next one
    points_.push_back(std::move(point));
    if (!is_line_ && points_.size() > 2) points_.erase(points_.begin());
  }

  std::vector<Picked> points_;
  std::shared_ptr<const Profile> profile_;
  std::uint64_t asked_point_ = 0, asked_profile_ = 0;
  bool is_line_ = false;  ///< of any number of points; else the last two remain
};

}  // namespace sfumato::view
