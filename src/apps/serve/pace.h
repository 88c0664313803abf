// How many pictures a connection carries, and how good they may be: from how long each took to be confirmed.
// Times come from the caller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace sfumato::serve {

class Pace {
 public:
  static constexpr double wanted_ms = 100;  ///< that a picture in motion may take until it is confirmed
  static constexpr int least_quality = 30, most_quality = 90;

  /// Another picture would not queue behind others.
  bool may_send() const { return waiting_.size() < 2; }
  void sent(std::uint64_t id, std::size_t bytes, bool in_motion, double now_ms);
  /// The page has shown it, and so all before it.
  void confirmed(std::uint64_t id, double now_ms);

  double latency_ms() const { return latency_ms_; }      ///< the shortest way there and back; 0: not known
  double bytes_per_ms() const { return bytes_per_ms_; }  ///< smoothed; 0: not known
  int quality() const { return quality_; }               ///< of a JPEG in motion
  int shrink() const { return shrink_; }                 ///< pixels of the picture a pixel that is sent
  /// Whether so many bytes would make a hand wait.
  bool is_slow_for(std::size_t bytes) const {
    return bytes_per_ms_ > 0 && double(bytes) / bytes_per_ms_ > 4 * wanted_ms;
  }

 private:
  struct Sent {
    std::uint64_t id;
    std::size_t bytes;
    bool in_motion;
    double when_ms;
  };
  void adapt(double took_ms);

  std::deque<Sent> waiting_;
  double latency_ms_ = 0, bytes_per_ms_ = 0, confirmed_ms_ = 0;
  int quality_ = 75, shrink_ = 1;
};

}  // namespace sfumato::serve
