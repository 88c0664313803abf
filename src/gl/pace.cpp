#include "gl/pace.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "gl/context.h"

namespace sfumato::gl {

std::uint64_t Stretches::take(std::uint64_t work, std::uint64_t count, double units, double most_units) {
  const Cost& cost = costs_[work];
  const double piece_ms = cost.ms_per_unit * units, all_ms = piece_ms * double(count);
  double fit = double(count);
  if (most_units > 0) {
    fit = std::floor((most_units - planned_units_) / units);
  } else if (planned_ms_ + all_ms > target_ms) {
    // Dear work has stretches to itself, so that they tell what it costs; all about equally long.
    // The first run of a program compiles it: one piece.
    const double most = std::max(std::floor(target_ms / piece_ms), 1.0);
    fit = is_empty() ? std::ceil(double(count) / std::ceil(double(count) / most)) : 0;
    if (fit > 1 && cost.measured == 0) fit = 1;
  }
  if (is_empty()) fit = std::max(fit, 1.0);
  if (fit < 1) return 0;
  const std::uint64_t n = fit < double(count) ? std::uint64_t(fit) : count;
  if (std::find(parts_.begin(), parts_.end(), work) == parts_.end()) parts_.push_back(work);
  planned_ms_ += piece_ms * double(n);
  planned_units_ += double(n) * units;
  return n;
}

void Stretches::end(double ms) {
  // Waiting itself takes some hundredths of a millisecond.
  constexpr double least_ms = 1, most_growth = 8, most_fall = 10;
  constexpr int first_times = 4;
  const double ratio = std::clamp(ms / std::max(planned_ms_, 1e-9), 1 / most_fall, most_growth);
  for (const std::uint64_t work : parts_) {
    Cost& cost = costs_[work];
    const int times = cost.measured++;
    if (times == 0 || (ratio > 1 && ms < least_ms)) continue;
    // Dearer at once, cheaper by and by: a stretch too long is what must not be.
    cost.ms_per_unit *= ratio > 1 || times < first_times ? ratio : 0.75 + 0.25 * ratio;
  }
  forget();
}

Pace::Pace(Progress& progress) : pacing_(current_pacing()), before_(nullptr) {
  if (&progress == &no_progress()) pacing_ = nullptr;  // nobody can cancel it
  if (!pacing_) return;
  before_ = std::exchange(pacing_->progress, &progress);
  pacing_->stretches.forget();
}

Pace::~Pace() {
  if (!pacing_) return;
  pacing_->progress = before_;
  pacing_->stretches.forget();
}

bool has_slices() {
  const Pacing* pacing = current_pacing();
  return pacing && pacing->progress && limits().software;
}

std::uint64_t take_work(std::uint64_t work, std::uint64_t count, double units) {
  Pacing* pacing = current_pacing();
  if (!pacing || !pacing->progress) return count;
  if (!limits().software) {
    pacing->progress->check();
    return count;
  }
  if (pacing->stretches.is_empty()) pacing->began = std::chrono::steady_clock::now();
  return pacing->stretches.take(work, count, units, double(preferences().slice_units));
}

void end_stretch() {
  Pacing* pacing = current_pacing();
  if (!pacing || !pacing->progress) return;
  if (limits().software && !pacing->stretches.is_empty()) {
    glFinish();
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - pacing->began;
    pacing->stretches.end(ms.count());
  }
  pacing->progress->check();
}

std::uint64_t spread_step(std::uint64_t count) {
  if (count < 3) return 1;
  std::uint64_t step = std::uint64_t(0.618 * double(count));
  while (std::gcd(step, count) > 1) ++step;
  return step;
}

Progress& lent_progress() {
  Pacing* pacing = current_pacing();
  return pacing && pacing->progress ? *pacing->progress : no_progress();
}

}  // namespace sfumato::gl
