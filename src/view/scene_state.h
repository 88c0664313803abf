// The scene of a view model: which one is asked for, how far it is read, and what the render clients have of
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "view/loader.h"

namespace sfumato::view {

class SceneState {
 public:
  /// Without its clouds, which the render clients have; null before the first sample.
  const Loaded* loaded() const { return loaded_ ? &*loaded_ : nullptr; }
  UpAxis up() const { return loaded_ ? loaded_->pose.upright.up : UpAxis::pos_z; }
  std::string crs() const { return loaded_ ? loaded_->crs : ""; }
  /// Its files are read, or prepared to be drawn.
  bool loading() const { return load_state_ == LoadState::reading || load_state_ == LoadState::preparing; }
  /// The whole cloud can be drawn.
  bool is_ready() const { return whole_.is_ready && !loading(); }
  /// Of what is loaded or loading; nothing: it was refused, and is to be loaded again.
  const std::optional<SceneKey>& key() const { return key_; }
  const std::string& reason() const { return reason_; }  ///< why a technique was chosen; empty: none was
  std::size_t left_out() const { return left_out_; }     ///< points beyond those that one place holds

 private:
  friend class ViewModel;  // which reads it and has it rendered
  enum class LoadState {
    idle,
    reading,
    preparing,  ///< to be drawn: the render client of the whole cloud
    refused,    ///< by that render client
    unreadable  ///< what is shown is not what is asked for
  };
  /// What files with levels are read for.
  struct SeenView {
    ViewCamera camera;
    int width = 0, height = 0;
    bool has_shadows = false;
    bool operator==(const SeenView&) const = default;
  };
  /// What a render client has of it.
  struct Part {
    std::uint64_t id = 0;
    bool is_ready = false, is_refused = false;
  };
  /// Sliders that decide which points there are rest so long before the points are selected anew.
  static constexpr double rest_ms = 250;

  /// Only a sample of the files is there: they are being read, or could not be.
  bool has_sample_only() const { return loaded_ && loaded_->is_sample; }
  bool follows_view() const { return loaded_ && loaded_->follows_view; }
  /// Of files with levels: what other views show can be read.
  bool may_follow_view() const {
    return follows_view() && !loading() && load_state_ != LoadState::unreadable;
  }
  bool can_draw() const { return sample_.is_ready || (sample_.is_refused && whole_.is_ready); }
  void want(SceneKey key, double now_ms) {
    if (key != wanted_key_) wanted_key_ = std::move(key), wanted_since_ms_ = now_ms;
  }
  /// When what is wanted is to be read; nothing: it has been.
  std::optional<double> due_ms() const {
    if (is_to_read_anew_) return 0;
    if (wanted_key_ == key_) return std::nullopt;
    return wanted_since_ms_ + rest_ms;
  }

  LoadState load_state_ = LoadState::idle;
  std::optional<SceneKey> key_;
  SceneKey wanted_key_;
  double wanted_since_ms_ = -1e9;
  bool is_to_read_anew_ = false;  ///< although the request is the same: the files on the disk may not be
  std::uint64_t load_id_ = 0;
  std::optional<Loaded> loaded_;
  std::shared_ptr<const Loaded> known_, kept_;  ///< by another view model: about to be taken; taken
  std::optional<ViewCamera> sample_camera_;     ///< what a sample was framed by
  std::optional<SeenView> read_view_;           ///< what the points are for that are here or being read
  bool is_reading_view_ = false;
  Part sample_, whole_;
  std::string reason_;
  std::size_t left_out_ = 0;
};

}  // namespace sfumato::view
