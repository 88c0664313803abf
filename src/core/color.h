// Colours as people write them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/image.h"

namespace sfumato {

/// sRGB 0..1 of "steelblue", "#468", "#4682b4" or "0.27,0.51,0.71"; nothing when it is none of these.
std::optional<vec3> parse_color(std::string_view text);
/// The known name nearest to a misspelt one; empty when nothing is near.
std::string nearest_color(std::string_view name);
Rgba8 to_rgba8(const vec3& srgb);
/// "#4682b4"
std::string hex_of(const Rgba8& color);
/// Linear values of the codes of an sRGB channel, 0..1.
const std::array<float, 256>& linear_of_srgb_codes();
/// That of one.
inline float linear_from_srgb(std::uint8_t channel) { return linear_of_srgb_codes()[channel]; }
/// Luma (Rec. 709) of an sRGB colour, 0 to 255.
double luma(const Rgba8& color);

/// The n-th of a few colours that are told apart, also by people who see few colours (Okabe and Ito 2008);
/// from the ninth on, others.
Rgba8 swatch_color(std::size_t n);

}  // namespace sfumato
