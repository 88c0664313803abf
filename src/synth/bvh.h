// A bounding volume hierarchy over boxes with ids; what the ids mean is the caller's business.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "synth/shapes.h"

namespace sfumato::synth {

class Bvh {
 public:
  Bvh() = default;
  /// Item i has box boxes[i]. Splits at the median along the longest side; equal input gives an equal tree.
  explicit Bvh(const std::vector<Bounds>& boxes);

  /// Calls `visit(item)` for every item whose box the ray meets between `t_min` and `t_max`, the nearer child
  /// first. `visit` may lower `t_max`, which prunes what lies beyond.
  template <class Visit>
  void traverse(const Ray& ray, double t_min, const double& t_max, Visit&& visit) const;

 private:
  struct Node {
    dvec3 min{0}, max{0};
    std::uint32_t first = 0;  ///< leaf: first item; inner: left child, the right one follows it
    std::uint32_t count = 0;  ///< 0: inner node
  };
  void split(std::uint32_t node, std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

template <class Visit>
void Bvh::traverse(const Ray& ray, double t_min, const double& t_max, Visit&& visit) const {
  if (nodes_.empty()) return;
  const dvec3 inverse = 1.0 / ray.direction;
  constexpr double miss = std::numeric_limits<double>::infinity();
  const auto entry = [&](const Node& node) {
    double near = t_min, far = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      double t0 = (node.min[axis] - ray.origin[axis]) * inverse[axis];
      double t1 = (node.max[axis] - ray.origin[axis]) * inverse[axis];
      if (t0 > t1) std::swap(t0, t1);
      // Written so that NaN (a ray inside a face of the box) leaves the interval as it is.
      near = t0 > near ? t0 : near;
      far = t1 < far ? t1 : far;
    }
    return near <= far ? near : miss;
  };
  std::uint32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (entry(node) == miss) continue;
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) visit(items_[node.first + i]);
      continue;
    }
    const double left = entry(nodes_[node.first]), right = entry(nodes_[node.first + 1]);
    const std::uint32_t near = left <= right ? node.first : node.first + 1;
    if (std::max(left, right) != miss) stack[depth++] = node.first + node.first + 1 - near;
    if (std::min(left, right) != miss) stack[depth++] = near;
  }
}

}  // namespace sfumato::synth
