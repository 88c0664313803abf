// Files that are shown one at a time, seen from one camera.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace sfumato::view {

class Sequence {
 public:
  explicit Sequence(std::vector<scene::SceneFile> files) : files_(std::move(files)) {}

  /// Empty: what is open is no frame of it.
  const std::vector<scene::SceneFile>& frames() const;
  /// Of `frames`, the one that is open.
  std::size_t frame() const { return open_.value_or(0); }
  /// Shows the next frame as soon as the present one stands, and `frames_per_second` allow.
  void play(bool on) { is_playing_ = on; }
  bool playing() const { return is_playing_ && !frames().empty(); }
  double frames_per_second = 5;

 private:
  friend class ViewModel;  // which opens what is shown
  bool holds(const std::vector<std::string>& opened) const;
  /// These files are open, from now on.
  void follow(const std::vector<std::string>& opened);
  void show(std::size_t i, double now_ms) { open_ = shown_ = i, since_ms_ = now_ms; }
  /// The whole picture of the frame is on the screen, or not.
  void set_stands(bool stands, double now_ms);
  /// When the next frame is; nothing: not before the present one stands.
  std::optional<double> due_ms() const;

  std::vector<scene::SceneFile> files_;
  std::optional<std::size_t> open_;
  std::size_t shown_ = 0;  ///< the last that `show` was called for: a sequence may have a file twice
  bool is_playing_ = false;
  double since_ms_ = 0;
  std::optional<double> stood_ms_;  ///< since then it stands
};

}  // namespace sfumato::view
