// The steps of evidence.glsl by the processor, where OpenGL is software: distances from those of the pixels
// beside, a whole row at a time, so that far reaches cost little. The same bytes.
#pragma once

#include "core/image.h"
#include "passes/evidence.h"

namespace sfumato {

/// 255 where a pixel may be covered, else 0. `depth_bits`: of points, 0xffffffff where there is none, in a
/// view with a band of `band` px around these `width` x `height` ones.
Image<std::uint8_t> evidence_by_rows(const Image<std::uint32_t>& depth_bits, int band, int width, int height,
                                     const EvidenceReach& reach);

}  // namespace sfumato
