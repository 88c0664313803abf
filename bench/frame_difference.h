// How much a picture changes from frame to frame along a camera path: flicker, popping and swimming as
// numbers. A slow path is asked for, so that honest motion is small beside them. Used by benchmarks and
// tests.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "core/error.h"
#include "core/image.h"

namespace sfumato::bench {

/// In 8-bit sRGB levels (0..255), the largest channel of each pixel.
struct FrameDifference {
  std::size_t pairs = 0;
  double mean = 0;             ///< over all pixels of all pairs of consecutive frames
  double worst = 0;            ///< largest mean over the pixels of one pair
  std::size_t worst_pair = 0;  ///< 0 = first and second frame
};

class FrameDifferenceMeter {
 public:
  /// The next frame of the path; all of one size, or Error(usage).
  void add(const Image<Rgba8>& frame) {
    if (last_) {
      if (last_->width() != frame.width() || last_->height() != frame.height())
        throw Error(ErrorCode::usage, "frames of a path must have one size to be compared");
      double sum = 0;
      for (std::size_t i = 0; i < frame.size(); ++i) {
        const Rgba8 a = last_->data()[i], b = frame.data()[i];
        sum += std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
      }
      const double change = sum / double(std::max<std::size_t>(frame.size(), 1));
      if (change > result_.worst) {
        result_.worst = change;
        result_.worst_pair = result_.pairs;
      }
      total_ += change;
      result_.mean = total_ / double(++result_.pairs);
    }
    last_ = frame;
  }
  const FrameDifference& result() const { return result_; }

 private:
  std::optional<Image<Rgba8>> last_;
  FrameDifference result_;
  double total_ = 0;
};

}  // namespace sfumato::bench
