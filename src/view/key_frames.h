// A camera path that is made by hand: key views, one after the other, at equal times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "view/navigator.h"

namespace sfumato::view {

class KeyFrames {
 public:
  const std::vector<ViewCamera>& keys() const { return keys_; }
  void add(const ViewCamera& camera) { keys_.push_back(camera); }
  void remove(std::size_t i);
  void replace(std::size_t i, const ViewCamera& camera);
  /// Key `from` takes the place of key `to`.
  void move(std::size_t from, std::size_t to);
  void clear() { keys_.clear(); }
  bool empty() const { return keys_.empty(); }

  /// Seconds from the first key to the last.
  double duration_s() const { return keys_.size() < 2 ? 0 : double(keys_.size() - 1) * seconds_per_key; }
  /// The camera at a time, clamped to the path: the one that `--path FILE --frames N` shows at that share of
  /// its frames. Needs a key.
  ViewCamera at(double seconds) const;
  /// As `--path` reads it: {"cameras": [...]}.
  std::string json(int width, int height) const;
  /// Throws Error(io).
  void save(const std::filesystem::path& file, int width, int height) const;
  /// Throws Error(bad_input) naming file and key.
  void load(const std::filesystem::path& file);

  double seconds_per_key = 2;

 private:
  std::vector<ViewCamera> keys_;
};

}  // namespace sfumato::view
