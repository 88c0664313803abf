#include "view/refinement.h"

#include <algorithm>

namespace sfumato::view {
namespace {

int rung_of(const Quality& quality) {
  return int(std::find(Refinement::ladder.begin(), Refinement::ladder.end(), quality) -
             Refinement::ladder.begin());
}

}  // namespace

void Refinement::changed(double now_ms) {
  // What was hopeless while something else kept the machine busy is tried again, once, when the next motion
  // begins.
  if (const auto found = known_.find(key_);
      found != known_.end() && now_ms - last_change_ms_ > new_motion_ms) {
    Times& times = found->second;
    if (times.rung > coarsest_own && now_ms - tried_ms_ > try_again_ms) {
      times.rung = coarsest_own, times.ms[coarsest_own] = 0;
      tried_ms_ = now_ms;
    }
  }
  last_change_ms_ = now_ms;
  ++change_;
}

int Refinement::rung() const {
  const auto found = known_.find(key_);
  int at = found == known_.end() ? Times{}.rung : found->second.rung;
  if (!whole_ready_) at = std::max(at, 2);
  return at;
}

std::optional<Quality> Refinement::next(double now_ms) const {
  // A picture at rest makes room for what is newer; one in motion is shown first, else a fast hand would see
  // none.
  if (begun_ && (begun_change_ == change_ || begun_in_motion_)) return std::nullopt;
  const bool stale = shown_change_ != change_ && failed_change_ != change_;
  if (stale && (moving(now_ms) || !whole_ready_)) return ladder[std::size_t(rung())];
  if (moving(now_ms) || !whole_ready_) return std::nullopt;
  if (settled() || failed_change_ == change_) return std::nullopt;
  return ladder[0];
}

void Refinement::begun(const Quality& quality, double now_ms) {
  begun_ = quality;
  begun_in_motion_ = moving(now_ms) || !whole_ready_;
  begun_change_ = change_;
}

void Refinement::done(const Quality& quality, double took_ms) {
  begun_.reset();
  shown_ = quality;
  shown_change_ = begun_change_;
  const std::size_t at = std::size_t(rung_of(quality));
  if (at >= ladder.size()) return;
  Times& times = known_[key_];
  if (!times.is_warm[at]) {  // compiled shaders and filled buffers: says nothing of the next one
    times.is_warm[at] = true;
    return;
  }
  double& ms = times.ms[at];
  ms = ms == 0 ? took_ms : 0.6 * ms + 0.4 * took_ms;
  if (at == 0) {  // at rest, or in motion where it is fast enough
    if (ms < wanted_ms)
      times.rung = 0;
    else if (times.rung == 0 || (times.ms[1] == 0 && 0.4 * ms < wanted_ms))
      times.rung = 1;
    return;
  }
  if (int(at) != rung()) return;
  if (ms > wanted_ms) {
    if (at + 1 == ladder.size() || (int(at) == coarsest_own && ms < hopeless_ms)) return;
    times.rung = int(at) + 1;
    // Less than by its pixels a picture does not get faster: rungs that cannot be enough are passed over.
    while (at >= 2 && times.rung < 5 &&
           ms * double(quality.divisor * quality.divisor) >
               wanted_ms * double(ladder[std::size_t(times.rung)].divisor) *
                   double(ladder[std::size_t(times.rung)].divisor))
      ++times.rung;
  } else if (ms < 0.4 * wanted_ms && at > 2 && int(at) != coarsest_own + 1) {
    // Up only where it is not known to be too slow: no swinging between two rungs.
    const double above = times.ms[at - 1];
    if (above == 0 || above < 0.8 * wanted_ms) times.rung = int(at) - 1;
  }
}

void Refinement::failed() {
  begun_.reset();
  failed_change_ = begun_change_;
}

std::optional<double> Refinement::wait_ms(double now_ms) const {
  if (begun_ || settled()) return std::nullopt;
  if (next(now_ms)) return 0.0;
  if (whole_ready_ && failed_change_ != change_) return std::max(0.0, last_change_ms_ + rest_ms - now_ms);
  return std::nullopt;
}

}  // namespace sfumato::view
