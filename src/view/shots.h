// Pictures that are asked for to be kept, until somebody takes them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/notes.h"
#include "view/painter.h"
#include "view/wishes.h"

namespace sfumato::view {

struct Shot {
  Picture picture;
  std::vector<std::string> words;  ///< the command without -o
  Furniture furniture = {};
  UpAxis up = UpAxis::pos_z;
  std::string crs = {};
  std::optional<Note> cutaway = {};
};

class Shots {
 public:
  /// Those that are finished, each once.
  std::vector<Shot> take() { return std::exchange(finished_, {}); }
  /// More are to come.
  bool pending() const { return !after_loading_.empty() || !of_view_.empty() || !painted_.empty(); }

 private:
  friend class Workbench;  // which reads files and has them painted
  struct Order {
    int width = 0, height = 0;
    Wishes wishes;
  };
  /// The points that they wait for do not come.
  void drop_waiting() { after_loading_.clear(), of_view_.clear(); }
  /// False: it is none of those that are painted.
  bool finish(Picture& picture) {
    const auto it = std::find_if(painted_.begin(), painted_.end(),
                                 [&](const auto& each) { return each.first == picture.id; });
    if (it == painted_.end()) return false;
    it->second.picture = std::move(picture);
    finished_.push_back(std::move(it->second));
    painted_.erase(it);
    return true;
  }
  void drop_painted(std::uint64_t id) {
    std::erase_if(painted_, [&](const auto& each) { return each.first == id; });
  }

  std::vector<Order> after_loading_;  ///< until the files are read
  std::deque<Order> of_view_;         ///< of files with levels: until the points of their views are
  std::vector<std::pair<std::uint64_t, Shot>> painted_;  ///< by the painter, by the id of the picture
  std::vector<Shot> finished_;
};

}  // namespace sfumato::view
