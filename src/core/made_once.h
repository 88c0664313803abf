// A value that the first who asks for it makes, on whatever thread; others wait for it, and copies share it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace sfumato {

template <class T>
class MadeOnce {
 public:
  /// `make` may throw: the next one makes it then.
  template <class Make>
  T get(Make&& make) const {
    const std::lock_guard lock(state_->mutex);
    if (!state_->value) state_->value = std::forward<Make>(make)();
    return *state_->value;
  }
  bool is_made() const {
    const std::lock_guard lock(state_->mutex);
    return state_->value.has_value();
  }

 private:
  struct State {
    std::mutex mutex;
    std::optional<T> value;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace sfumato
