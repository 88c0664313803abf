// What surfaces look like: cheap procedural patterns, so that pictures of synthetic scans have the variety of
// real ones and the truth can still be evaluated anywhere.
#pragma once

#include <cstdint>

#include "synth/shapes.h"

namespace sfumato::synth {

enum class Pattern {
  plain,
  checker,
  bricks,
  ashlar,
  plaster,
  paving,
  roof_tiles,
  wood,
  grass,
  leaf,
  marble,
  cloth
};

struct Material {
  Pattern pattern = Pattern::plain;
  vec3 color{0.5f};        ///< linear albedo
  vec3 second{0.3f};       ///< linear albedo of joints, veins, the other squares ...
  double size = 0.3;       ///< scene units: a brick's length, a square's side, a vein's distance
  double contrast = 0.15;  ///< relative variation from piece to piece and of the mottling
  double dirt_height = 0;  ///< scene units: darker towards z = 0 below this height (rain splash, moss)
  std::uint8_t alpha = 255;
};

/// Linear albedo, each channel in [0.003, 0.97]. `primitive` varies pieces that share a material (leaves).
vec3 albedo(const Material& material, const SurfacePoint& point, std::uint32_t primitive);

double luminance(vec3 linear);  ///< Rec. 709
/// Rounded to 8 bits per channel.
Rgba8 to_srgb(vec3 linear, std::uint8_t alpha = 255);
/// Linear colour of a triple of sRGB values 0..255, as colour pickers show it.
vec3 from_srgb(int r, int g, int b);

}  // namespace sfumato::synth
