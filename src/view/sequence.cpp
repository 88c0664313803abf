#include "view/sequence.h"

#include <algorithm>

namespace sfumato::view {

const std::vector<scene::SceneFile>& Sequence::frames() const {
  static const std::vector<scene::SceneFile> none;
  return open_ ? files_ : none;
}

bool Sequence::holds(const std::vector<std::string>& opened) const {
  return opened.size() == 1 && std::any_of(files_.begin(), files_.end(), [&](const scene::SceneFile& each) {
           return each.name == opened.front();
         });
}

void Sequence::follow(const std::vector<std::string>& opened) {
  open_.reset();
  if (!holds(opened)) return;
  open_ = shown_;
  if (files_[shown_].name != opened.front())
    open_ = std::size_t(std::find_if(files_.begin(), files_.end(),
                                     [&](const auto& each) { return each.name == opened.front(); }) -
                        files_.begin());
}

void Sequence::set_stands(bool stands, double now_ms) {
  if (!stands)
    stood_ms_.reset();
  else if (!stood_ms_)
    stood_ms_ = now_ms;
}

std::optional<double> Sequence::due_ms() const {
  if (!playing() || !stood_ms_) return std::nullopt;
  // A frame that stands is shown for a moment, else fast ones would never be seen whole.
  return std::max(since_ms_ + 1000 / frames_per_second, *stood_ms_ + 60);
}

}  // namespace sfumato::view
