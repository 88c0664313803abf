// Undo and redo of a value: every state that somebody could want back.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sfumato::view {

template <class State>
class History {
 public:
  explicit History(State first, std::size_t most = 200) : states_{std::move(first)}, most_(most) {}

  /// `state` follows a change of the kind `what`. Changes of one kind within a second are one step: a slider
  /// that is dragged is undone at once.
  void record(const State& state, const std::string& what, double now_ms) {
    if (state == states_[at_]) return;
    const bool same = what == what_ && now_ms - when_ms_ < 1000 && at_ > 0 && at_ + 1 == states_.size();
    what_ = what, when_ms_ = now_ms;
    if (same) {
      states_[at_] = state;
      return;
    }
    states_.resize(at_ + 1);
    states_.push_back(state);
    if (states_.size() > most_) states_.erase(states_.begin());
    at_ = states_.size() - 1;
  }
  /// What is found out of states after their time, such as the camera once the files are read: no step of its
  /// own. `edit` is called of every state.
  template <class Edit>
  void amend(const Edit& edit) {
    for (State& each : states_) edit(each);
  }
  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < states_.size(); }
  /// The state before the last change; the present one when there is none.
  const State& undo() {
    if (can_undo()) --at_;
    what_.clear();
    return states_[at_];
  }
  const State& redo() {
    if (can_redo()) ++at_;
    what_.clear();
    return states_[at_];
  }

 private:
  std::vector<State> states_;
  std::size_t most_, at_ = 0;
  std::string what_;
  double when_ms_ = -1e9;
};

}  // namespace sfumato::view
