// How much of a picture a painting of it keeps: edges, structure, colours, closed surfaces. Nothing here
// knows how strokes are made; both pictures come with the coverage of their pixels.
#pragma once

#include "core/image.h"

namespace sfumato::bench {

/// A picture before its background: sRGB with straight alpha.
struct Likeness {
  double gradients =
      0;  ///< correlation of the gradients of lightness, inside what both cover: 1 = the same edges
  double structure = 0;  ///< mean structural similarity of lightness (Wang et al. 2004, K1 = 0.01, K2 = 0.03)
  double color = 0;      ///< mean distance of colours, 8-bit levels, RGB, after the blur
  double lightness = 0;  ///< mean of painting minus picture: repainted darker or lighter, 8-bit levels
  std::size_t specks = 0;  ///< pixels (and below: groups of them) without paint where the picture is closed
                           ///< for 3 px around, and something was measured there
  std::size_t speck_groups = 0;
  double overshoot = 0;  ///< pixels painted beyond what the picture covers, a share of those it covers
};

/// `measured`: a picture of the points alone. Discs of `picture` reach over the end of what was scanned, by a
/// few pixels into every scanner's shadow, where an open painting has no fault: specks count where points lie
/// no more than 10 px apart. `sigma`: of the Gaussian that both pictures go through, px; half the width of a
/// stroke.
Likeness likeness(const Image<Rgba8>& painting, const Image<Rgba8>& picture, const Image<Rgba8>& measured,
                  float sigma);

}  // namespace sfumato::bench
