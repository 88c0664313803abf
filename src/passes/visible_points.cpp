#include "passes/visible_points.h"

#include <bit>
#include <utility>

#include "core/error.h"

namespace sfumato {

Image<float> VisiblePoints::depth() const {
  Image<float> depth(depth_bits.width(), depth_bits.height(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (depth_bits.data()[i] != nothing) depth.data()[i] = std::bit_cast<float>(depth_bits.data()[i]);
  return depth;
}

void merge(VisiblePoints& into, const VisiblePoints& of) {
  if (into.depth_bits.width() != of.depth_bits.width() || into.depth_bits.height() != of.depth_bits.height())
    throw Error(ErrorCode::usage, "parts of different sizes cannot be merged: draw them with one camera");
  const vec4 none(0, 0, 0, 1);
  if (into.normals.empty() && !of.normals.empty())
    into.normals = Image<vec4>(into.depth_bits.width(), into.depth_bits.height(), none);
  for (std::size_t i = 0; i < into.depth_bits.size(); ++i) {
    // Positive floats sort as their bits do.
    const std::pair own(into.depth_bits.data()[i], into.number.data()[i]),
        other(of.depth_bits.data()[i], of.number.data()[i]);
    if (!(other < own)) continue;
    into.depth_bits.data()[i] = other.first, into.number.data()[i] = other.second;
    into.colors.data()[i] = of.colors.data()[i];
    if (!into.normals.empty()) into.normals.data()[i] = of.normals.empty() ? none : of.normals.data()[i];
  }
}

}  // namespace sfumato
