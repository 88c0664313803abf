// The rival of dos Anjos 2017, Figure 6: a picture painted over with strokes that know nothing of the points
// behind it. After P. Litwinowicz, "Processing images and video for an impressionist effect", 1997: strokes
// on a jittered grid of the screen, along the edges of the picture, ended where the colour changes, in random
// order.
#pragma once

#include "core/image.h"

namespace sfumato::bench {

struct ImageStrokes {
  float length_px = 24, width_px = 7;
  float colour_limit = 40;  ///< 8-bit levels by which a stroke may leave the colour of its centre
  float noise_deg = 12;
};

/// Opaque in, opaque out. Grid, order and noise belong to the screen and stay the same from frame to frame.
Image<Rgba8> paint_over(const Image<Rgba8>& picture, const ImageStrokes& settings);

}  // namespace sfumato::bench
