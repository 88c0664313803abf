// What a view shows of the points of one part of a cloud, before anything looks at more than one pixel: of
// several parts, drawn by different processes, it merges to that of the whole.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/image.h"

namespace sfumato {

struct VisiblePoints {
  static constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();
  /// Of the nearest point of each pixel: eye depth as the bits of a float, number among all points of the
  /// cloud, linear colour, and world normal with shadow factor, of which there may be none (all 0 0 0 1).
  Image<std::uint32_t> depth_bits, number;
  Image<vec4> colors, normals;
  Image<float> depth() const;  ///< +inf where nothing
  /// Where it lies in eye space, for techniques that look around it; else empty.
  static constexpr vec4 nowhere{0, 0, -3e38f, 0};
  Image<vec4> places{};

  /// Of discs, in two rounds (passes/splat_surface.h); else empty. First, the nearest hit of each pixel along
  /// its ray, +inf where none, and where points one pixel large are in a wider view (passes/evidence.h):
  /// `nothing`, or less.
  Image<float> nearest{};
  Image<std::uint32_t> vouching{};
  /// Then, of what counts as one surface with that hit: weighted colours and weight, weighted normals and
  /// distances.
  Image<vec4> color_sum{}, normal_sum{};

  /// Of bins along the ray, in the round after that of hits (techniques/denoise): their weights, which add
  /// up, by pixel and number.
  struct Bin {
    std::uint32_t pixel = 0, number = 0, weight = 0;
  };
  std::vector<Bin> bins{};
  std::uint64_t bins_serial = 0;  ///< names them, as `serial` does; 0: nobody has added that round
  /// And in a third round, of what is in the bin that those of all parts choose: sums, whole numbers, modulo
  /// 2^32.
  using BinSums = std::array<std::uint32_t, 8>;
  Image<BinSums> bin_sums{};
  std::uint64_t outliers = 0;  ///< points of the parts that are left out; said in one of the rounds

  /// Numbers that points have, where what is automatic is a share or a median of all (techniques/soft): of
  /// each kind those of a random sample of the whole (analysis::is_sampled), ascending, and, where it
  /// matters, how many points have one and between what all of them lie. Each round adds its kinds.
  struct Values {
    std::vector<float> sample;
    std::uint64_t count = 0;
    float least = std::numeric_limits<float>::infinity(), most = -std::numeric_limits<float>::infinity();
  };
  std::vector<Values> values{};
  /// Points that are seen through, of which a pixel shows any number: those that may be in view, by number
  /// and then by place, which is relative to the origin of the whole.
  struct SeenThrough {
    std::uint32_t number = 0;
    vec3 place{0}, normal{0};
    float radius = 0, field = 0;
    Rgba8 color;
    bool operator<(const SeenThrough& other) const;
  };
  std::vector<SeenThrough> seen_through{};

  /// Of surfaces one behind the other, in a round each (techniques/layers): the points of the rounds before,
  /// from front to back. Those of all parts: nobody merges them again.
  std::vector<VisiblePoints> in_front{};
  /// Adds what the next round of the same parts knows: points lie behind those of the rounds before.
  void add_round(VisiblePoints next);
  /// Names what `add_round` left here and in front: nothing but copies has the same. It goes to `in_front`
  /// with its points. 0: of no round.
  std::uint64_t serial = 0;
};

/// Of each pixel the nearer point; at one depth that of the lower number; the nearer hit, and the sum of
/// sums. Associative and commutative, bit for bit, but for the rounding of sums. Of one size and round.
void merge(VisiblePoints& into, const VisiblePoints& of);

}  // namespace sfumato
