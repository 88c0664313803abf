// How large points are on the screen, for shaders and for loops of the processor.
#pragma once

#include <algorithm>

namespace sfumato {

enum class SizeMode { adaptive, pixels, world };

/// The size of a point on the screen: a round disc of this diameter, at least 1 px and at most `most_px`.
struct Footprint {
  SizeMode mode = SizeMode::pixels;
  float size = 1;  ///< adaptive: factor on the spacing; pixels: px; world: scene units
  /// Adaptive: sparse ends of a scan are not drawn as balls of this many median spacings and more. Not of
  /// dots, which know.
  float largest_medians = 4;
  /// Discs wider than this grow with the fourth root of what they would be; 0: no. Points that far apart are
  /// no surface any more to whoever looks, and discs that close it would hide what shape there is. px
  float wide_px = 0;
  /// Adaptive: the cloud's field holds spacing (in spacing_unit()) and share of a surface of every point
  /// (analysis/dots.h). Where there is none, points are this share of the size that would close it, within
  /// these limits, px; 0: no such field.
  float dot_share = 0, least_dot_px = 1, most_dot_px = 1;
  /// Adaptive, without dots: the cloud's field holds the spacing of every point, scene units, in place of
  /// that of its batch.
  bool spacing_is_field = false;
  /// Points that are farther apart than this, px, and than usual are smaller by the root of how much farther,
  /// to `least_dot_px`: what is sparse recedes behind what is measured well.
  float sparse_px = 0;
  /// Points with a normal are discs in its plane instead of facing the camera, at least as large as a pixel.
  bool oriented = false;
  float most_px = 64;   ///< px; see largest_footprint
  float single_px = 0;  ///< what is narrower is the one pixel that it falls into, whatever its normal; px
};

/// Diameter of the largest point of a picture so many pixels high, px: a picture looks the same in every
/// size.
inline float largest_footprint(int picture_height) {
  return std::max(64.0f, 64.0f / 720 * float(picture_height));
}

/// Only points that stop this share of the light (GpuCloud::set_casters): `from` <= share < `below`.
struct CasterRange {
  float from = 0, below = 2;
};

}  // namespace sfumato
