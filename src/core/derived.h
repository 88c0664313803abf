// What follows from something under a key, made when it is asked for and kept while the key stays the same.
// Keys are values with ==: no text of a number, which rounds, and no stamp that somebody has to set.
#pragma once

#include <optional>
#include <utility>

namespace sfumato {

template <class Key, class T>
class Derived {
 public:
  /// `make` may throw: nothing is kept then.
  template <class Make>
  T& at(const Key& key, Make&& make) {
    if (!(key_ == key)) {
      key_.reset();
      value_ = std::forward<Make>(make)();
      key_ = key;
    }
    return value_;
  }
  /// Whether it is there.
  bool has(const Key& key) const { return key_ == key; }
  /// What was made last; as it is by default before.
  T& value() { return value_; }
  const T& value() const { return value_; }
  void forget() { key_.reset(), value_ = T(); }

 private:
  std::optional<Key> key_;
  T value_{};
};

}  // namespace sfumato
