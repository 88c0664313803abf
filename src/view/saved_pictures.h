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
#include "view/render_client.h"
#include "view/view_request.h"

namespace sfumato::view {

struct SavedPicture {
  Picture picture;
  std::vector<std::string> words;  ///< the command without -o
  Furniture furniture = {};
  UpAxis up = UpAxis::pos_z;
  std::string crs = {};
  std::optional<Note> cutaway = {};
};

class SavedPictures {
 public:
  /// Those that are finished, each once.
  std::vector<SavedPicture> take() { return std::exchange(finished_, {}); }
  /// More are to come.
  bool pending() const { return !after_loading_.empty() || !of_view_.empty() || !rendering_.empty(); }

 private:
  friend class ViewModel;  // which reads files and has them rendered
  struct Order {
    int width = 0, height = 0;
    ViewRequest request;
  };
  /// The points that they wait for do not come.
  void drop_waiting() { after_loading_.clear(), of_view_.clear(); }
  /// False: it is none of those that are being rendered.
  bool finish(Picture& picture) {
    const auto it = std::find_if(rendering_.begin(), rendering_.end(),
                                 [&](const auto& each) { return each.first == picture.id; });
    if (it == rendering_.end()) return false;
    it->second.picture = std::move(picture);
    finished_.push_back(std::move(it->second));
    rendering_.erase(it);
    return true;
  }
  void drop_rendering(std::uint64_t id) {
    std::erase_if(rendering_, [&](const auto& each) { return each.first == id; });
  }

  std::vector<Order> after_loading_;  ///< until the files are read
  std::deque<Order> of_view_;         ///< of files with levels: until the points of their views are
  std::vector<std::pair<std::uint64_t, SavedPicture>>
      rendering_;  ///< by the render client, by the id of the picture
  std::vector<SavedPicture> finished_;
};

}  // namespace sfumato::view
