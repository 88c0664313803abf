// The mask of evidence.glsl and evidence_shape.comp by the processor, where OpenGL is software: the same
// bytes.
#pragma once

#include "core/image.h"
#include "passes/evidence.h"

namespace sfumato {

/// 255 where a pixel may be covered, else 0. `depth_bits`: of points, 0xffffffff where there is none, in a
/// view with a band of `band` px around these `width` x `height` ones.
Image<std::uint8_t> evidence_mask(const Image<std::uint32_t>& depth_bits, int band, int width, int height,
                                  const EvidenceReach& reach);
/// evidence_apply.glsl: empties the pixels that are 0 in `mask` and not empty.
void apply_evidence(const Image<std::uint8_t>& mask, Image<vec4>& albedo, Image<float>& depth,
                    Image<vec4>& normal);

}  // namespace sfumato
