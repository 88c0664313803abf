// How long work goes on after the user has stopped it, by the clock of the processor: other programs do not
// matter.
#pragma once

#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "core/progress.h"

namespace sfumato::testing {

/// Seconds of the processor that all threads of this process took.
inline double processor_seconds() {
  struct timespec time {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// Somebody who wants to stop at a moment of that clock.
class StopsAt final : public Progress {
 public:
  explicit StopsAt(double moment) : moment_(moment) {}
  void update(double, std::string_view) override {}
  bool cancelled() const override { return processor_seconds() >= moment_; }

 private:
  double moment_;
};

/// What users are promised, in seconds.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double patience = 4;  // and twenty times as slow
#else
constexpr double patience = 0.2;
#endif

/// Does `work(progress)` once to its end and then stops it at `moments` moments of its whole length: each
/// time it throws Cancelled within `patience`. Once it may be late, for what the operating system did at that
/// moment.
template <class Work>
void expect_stops_in_time(const std::string& what, int moments, Work&& work) {
  const double start = processor_seconds();
  work(no_progress());
  const double whole = processor_seconds() - start;
  double longest = 0, second = 0;
  int stopped = 0;
  for (int k = 0; k < moments; ++k) {
    const double moment = processor_seconds() + whole * (k + 0.5) / moments;
    StopsAt progress(moment);
    try {
      work(progress);
    } catch (const Cancelled&) {
      ++stopped;
    }
    const double late = processor_seconds() - moment;
    second = std::max(second, std::min(longest, late));
    longest = std::max(longest, late);
  }
  EXPECT_LT(second, patience) << what << " takes " << whole << " s";
  // Runs differ in length, the first is the slowest: later moments may lie behind the end.
  EXPECT_GE(stopped, 1) << what;
  std::printf("%-12s %6.2f s; stops within %.0f ms, once %.0f ms\n", what.c_str(), whole, 1e3 * second,
              1e3 * longest);
}

}  // namespace sfumato::testing
