// Work that the user stops, at any question that it asks. How long it goes on is measured by bench/stretches.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <string>

#include "core/progress.h"

namespace sfumato::testing {

/// Somebody who wants to stop from the question `at` on, of all threads.
class StopsAt final : public Progress {
 public:
  explicit StopsAt(long at) : at_(at) {}
  void update(double, std::string_view) override {}
  bool cancelled() const override { return ++asked_ >= at_; }
  long asked() const { return asked_; }

 private:
  long at_;
  mutable std::atomic<long> asked_ = 0;
};

/// Does `work(progress)` once to its end, which asks at least `least` times whether to go on, and then stops
/// it at `moments` of the questions: each time it throws Cancelled.
template <class Work>
void expect_stops(const std::string& what, long least, int moments, Work&& work) {
  StopsAt never(1L << 60);
  work(never);
  EXPECT_GE(never.asked(), least) << what;
  std::printf("%-12s asks %ld times\n", what.c_str(), never.asked());
  for (int k = 0; k < moments; ++k) {
    StopsAt progress(1 + (2 * k + 1) * never.asked() / (2 * moments));
    try {
      work(progress);
      // Threads share the work in other ways each time.
      EXPECT_FALSE(progress.cancelled()) << what << " went on, moment " << k;
    } catch (const Cancelled&) {
    }
  }
}

}  // namespace sfumato::testing
