#include "synth/bvh.h"

#include <algorithm>
#include <numeric>

namespace sfumato::synth {

Bvh::Bvh(const std::vector<Bounds>& boxes) : items_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(items_.begin(), items_.end(), 0u);
  nodes_.reserve(2 * boxes.size());
  nodes_.emplace_back();
  split(0, 0, std::uint32_t(boxes.size()), boxes);
}

void Bvh::split(std::uint32_t node, std::uint32_t first, std::uint32_t count,
                const std::vector<Bounds>& boxes) {
  dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo, center_lo = lo, center_hi = hi;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Bounds& box = boxes[items_[i]];
    lo = glm::min(lo, box.min), hi = glm::max(hi, box.max);
    center_lo = glm::min(center_lo, box.center()), center_hi = glm::max(center_hi, box.center());
  }
  // Flat boxes get a little thickness, so that rounding cannot lose a ray that meets them.
  const dvec3 pad = 1e-9 * (hi - lo + dvec3(glm::length(hi - lo)));
  nodes_[node].min = lo - pad;
  nodes_[node].max = hi + pad;
  const dvec3 extent = center_hi - center_lo;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  if (count <= 3) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  const std::uint32_t half = count / 2;
  const auto begin = items_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double ca = boxes[a].center()[axis], cb = boxes[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  });
  const std::uint32_t left = std::uint32_t(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = left;
  split(left, first, half, boxes);
  split(left + 1, first + half, count - half, boxes);
}

}  // namespace sfumato::synth
