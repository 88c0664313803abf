// The first visit of all hits by the processor, where OpenGL is software (weights.glsl): the same table.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "techniques/denoise/bins.h"

namespace sfumato::denoise {

/// What it fills, all 0 before but for `first_bin`.
struct BinMemory {
  std::uint32_t* weights;
  std::uint32_t* keys;  ///< null: dense
  int slots;            ///< a pixel
  Image<std::uint32_t>& first_bin;
};

/// Stops at the first hit that finds no slot: then somebody makes a larger table.
BinCounts add_weights(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                      const Image<float>& nearest_t, const BinOptions& options, const BinMemory& into);

}  // namespace sfumato::denoise
