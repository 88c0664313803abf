#include "session/voxels.h"

#include <algorithm>

namespace sfumato {
namespace {

constexpr double most = 1 << 20;  // voxels to each side: 21 bits

}  // namespace

void Voxels::add(const dvec3& point) {
  const dvec3 at = glm::floor((point - corner_) / edge_) + most;
  if (!(glm::all(glm::greaterThanEqual(at, dvec3(0))) && glm::all(glm::lessThan(at, dvec3(2 * most)))))
    return;
  keys_.push_back(std::uint64_t(at.x) << 42 | std::uint64_t(at.y) << 21 | std::uint64_t(at.z));
}

std::vector<dvec3> Voxels::holding(std::size_t least) {
  std::sort(keys_.begin(), keys_.end());
  std::vector<dvec3> middles;
  for (std::size_t first = 0, last; first < keys_.size(); first = last) {
    for (last = first; last < keys_.size() && keys_[last] == keys_[first];) ++last;
    if (last - first < least) continue;
    const std::uint64_t key = keys_[first];
    middles.push_back(dvec3(double(key >> 42), double(key >> 21 & 0x1fffff), double(key & 0x1fffff)) - most +
                      0.5);
  }
  return middles;
}

}  // namespace sfumato
