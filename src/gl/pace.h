// Where the work of a frame can be cancelled. On software GL a pass may take a second, and nobody can stop
// what was submitted: so passes are submitted in slices, and when a stretch of them has taken about
// `Stretches::target_ms`, the driver finishes it and a Progress is asked. On a GPU passes stay whole and
// Progress is asked between them, which costs nothing.
//
//   const gl::Pace pace(progress);                   // lent to the context for as long as it lives
//   gl::in_slices(program, count, units_each, [&](first, n) { ... submits pieces [first, first + n) ... });
//
// Program::dispatch, ScreenPass and SplatRaster do so themselves. Without a Pace nothing is sliced.
#pragma once

#include <chrono>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/progress.h"

namespace sfumato::gl {

/// How much work a stretch may hold, learned from how long the stretches before it took. Has no clock: who
/// uses it says how long they were.
class Stretches {
 public:
  /// A third of what anyone should wait (50 ms), as the next stretch may cost more than those before.
  static constexpr double target_ms = 16;
  /// What a unit (an invocation, a pixel) of unknown work is taken for, about the dearest there is.
  static constexpr double unknown_ms = 0.3e-3;

  /// How many of `count` pieces, of `units` each, belong to this stretch; 0: it is full. `work` says which
  /// units cost the same. `most_units` > 0: so many at most, whatever they cost.
  std::uint64_t take(std::uint64_t work, std::uint64_t count, double units, double most_units = 0);
  bool is_empty() const { return parts_.empty(); }
  /// It took so long, and the next begins.
  void end(double ms);
  /// The next begins, and nothing is learned.
  void forget() { parts_.clear(), planned_ms_ = planned_units_ = 0; }

 private:
  struct Cost {
    double ms_per_unit = unknown_ms;
    int measured = 0;  ///< times
  };
  std::unordered_map<std::uint64_t, Cost> costs_;
  std::vector<std::uint64_t> parts_;  ///< what is in this stretch
  double planned_ms_ = 0, planned_units_ = 0;
};

/// Of a context: what was learned outlives the frames.
struct Pacing {
  Stretches stretches;
  Progress* progress = nullptr;  ///< of the frame that is drawn; null between frames
  std::chrono::steady_clock::time_point began;
};
/// Of the context that is current on this thread; null without one.
Pacing* current_pacing();

/// Lends a Progress to the context that is current, while it lives; `no_progress()` lends nothing, for nobody
/// waits to be asked.
class Pace {
 public:
  explicit Pace(Progress& progress);
  ~Pace();
  Pace(const Pace&) = delete;
  Pace& operator=(const Pace&) = delete;

 private:
  Pacing* pacing_;
  Progress* before_;
};

/// Stretches::take of the context that is current; `count` where nothing is sliced.
std::uint64_t take_work(std::uint64_t work, std::uint64_t count, double units);
/// Whether the context cuts work into slices now: it is software GL, and a Progress was lent.
bool has_slices();
/// Ends a stretch: what was submitted is waited for. Throws Cancelled when the frame is not wanted any more.
void end_stretch();
/// The Progress that was lent, for work of the processor, also on other threads; else one that never stops.
Progress& lent_progress();

/// Piece k * spread_step(count) % count for every k is every piece once, and any run of them comes from all
/// over: dear pieces often lie side by side. The step nearest to the golden section without a common divisor.
std::uint64_t spread_step(std::uint64_t count);

/// `submit(first, n)` for as many pieces at a time as a stretch holds, in their order.
template <class Submit>
void in_slices(std::uint64_t work, std::uint64_t count, double units, Submit&& submit) {
  for (std::uint64_t first = 0; first < count;) {
    const std::uint64_t n = take_work(work, count - first, units);
    if (n > 0) submit(first, n);
    first += n;
    if (first < count) end_stretch();
  }
}

}  // namespace sfumato::gl
