// Which picture to draw next so that motion looks live and rest looks right: coarser pixels and a sample of
// the points while something moves, the whole picture once it rests. It knows times only from what it is
// told.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

namespace sfumato::view {

/// How a picture is drawn.
struct Quality {
  bool whole_cloud = true;  ///< else the sample
  int divisor = 1;          ///< pixels of the view a pixel of the picture, along each axis
  bool fast = false;        ///< by Technique::in_motion, where fewer pixels and points are not enough
  bool stand_in = false;    ///< by `stand_in_technique`, where the technique itself is far too slow to move
  bool operator==(const Quality&) const = default;
};

class Refinement {
 public:
  static constexpr double wanted_ms = 60;  ///< of a picture in motion: 15 a second and some room
  static constexpr double rest_ms = 160;   ///< without a change, until the whole picture begins
  /// From the best to the fastest.
  static constexpr std::array<Quality, 9> ladder{{{true, 1, false, false},
                                                  {true, 2, false, false},
                                                  {false, 1, false, false},
                                                  {false, 2, false, false},
                                                  {false, 3, false, false},
                                                  {false, 4, false, false},
                                                  {false, 4, true, false},
                                                  {false, 2, false, true},
                                                  {false, 4, false, true}}};

  /// The view or a setting changed at `now_ms`: pictures asked for before it are stale.
  void changed(double now_ms);
  /// Other points, another technique: what was measured for it counts, and nothing else.
  void set_subject(const std::string& key) { key_ = key; }
  /// Forgets all times: the points or the picture's size changed.
  void forget() { known_.clear(); }
  /// The whole cloud is not there yet: only the sample can be drawn.
  void set_whole_ready(bool ready) { whole_ready_ = ready; }

  bool moving(double now_ms) const { return now_ms - last_change_ms_ < rest_ms; }
  /// What to draw now: nothing when all is drawn, or while waiting for the rest. Call `begun` with it when it
  /// is asked for.
  std::optional<Quality> next(double now_ms) const;
  void begun(const Quality& quality, double now_ms);
  /// It took so long.
  void done(const Quality& quality, double took_ms);
  /// The picture that was begun could not be drawn: no other is asked for before the next change.
  void failed();
  /// It was cancelled for a newer one.
  void cancel() { begun_.reset(); }
  /// The picture on the screen is the whole one.
  bool settled() const { return shown_ && *shown_ == ladder[0] && shown_change_ == change_; }
  /// Milliseconds until `next` can say something else; nothing: not before a change.
  std::optional<double> wait_ms(double now_ms) const;

 private:
  static constexpr double hopeless_ms = 250;  ///< a picture at the coarsest: then another technique stands in
  static constexpr double new_motion_ms = 1000;  ///< of rest before it
  static constexpr double try_again_ms = 5000;   ///< between trials of a technique that another stands in for

  struct Times {
    std::array<double, ladder.size()> ms{};  ///< 0: not known
    std::array<bool, ladder.size()> is_warm{};
    int rung = 3;  ///< in motion
  };
  static constexpr int coarsest_own = 6;
  int rung() const;

  std::map<std::string, Times> known_;
  std::string key_;
  double last_change_ms_ = -1e9, tried_ms_ = -1e9;
  unsigned long change_ = 1, shown_change_ = 0, begun_change_ = 0, failed_change_ = 0;
  std::optional<Quality> shown_, begun_;
  bool whole_ready_ = false, begun_in_motion_ = false;
};

}  // namespace sfumato::view
