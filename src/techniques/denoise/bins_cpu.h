// The visits of all hits by the processor, where OpenGL is software (weights.glsl, attributes.glsl): the same
// table and, but for a rounding, the same sums.
#pragma once

#include <cstdint>
#include <vector>

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
struct SumMemory {
  std::uint32_t* sums;  ///< all 0 before
  int stride;           ///< a pixel
};

/// Adds what is in the chosen bins (BinTable::choice). `options`: of the table.
void add_attributes(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const Image<float>& nearest_t, const Image<vec4>& choice, const BinOptions& options,
                    const SumMemory& into);

/// Of bins of all parts, by pixel and number: what lies so far behind that it cannot be chosen is left out.
BinCounts add_bins(const std::vector<VisiblePoints::Bin>& bins, const BinOptions& options,
                   const BinMemory& into);

}  // namespace sfumato::denoise
