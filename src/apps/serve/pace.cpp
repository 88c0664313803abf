#include "pace.h"

#include <algorithm>

namespace sfumato::serve {

void Pace::sent(std::uint64_t id, std::size_t bytes, bool in_motion, double now_ms) {
  waiting_.push_back({id, bytes, in_motion, now_ms});
}

void Pace::confirmed(std::uint64_t id, double now_ms) {
  while (!waiting_.empty() && waiting_.front().id <= id) {
    const Sent one = waiting_.front();
    waiting_.pop_front();
    if (one.id != id) continue;
    const double whole = std::max(0.01, now_ms - one.when_ms);
    latency_ms_ = latency_ms_ == 0 ? whole : std::min(1.001 * latency_ms_, whole);
    // A picture that waited behind another began its way when that one had arrived. The latency counts as if
    // it were carrying: what is promised of a line is rather too little.
    const double took = std::max(0.01, now_ms - std::max(one.when_ms, confirmed_ms_));
    if (one.bytes >= 2000) {
      const double rate = double(one.bytes) / took;
      bytes_per_ms_ = bytes_per_ms_ == 0 ? rate : 0.8 * bytes_per_ms_ + 0.2 * rate;
    }
    confirmed_ms_ = now_ms;
    if (one.in_motion) adapt(took);
  }
}

void Pace::adapt(double took_ms) {
  if (took_ms > wanted_ms) {
    if (quality_ > least_quality)
      quality_ = std::max(least_quality, quality_ - 10);
    else
      shrink_ = std::min(4, shrink_ + 1);
  } else if (took_ms < 0.4 * wanted_ms) {
    if (shrink_ > 1)
      --shrink_;
    else
      quality_ = std::min(most_quality, quality_ + 5);
  }
}

}  // namespace sfumato::serve
