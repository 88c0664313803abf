// What a build computes of the points at their full density and stores as extra bytes, so that a coarse level
// carries what is known of the surface that it stands for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "copc/schema.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::copc {

/// Adds fields for `wanted` (normal: nx, ny, nz in steps of 1e-4; uncertainty: analysis::stored_uncertainty,
/// a byte in steps of 0.004) behind the extra bytes of `schema`, but for those that the files bring
/// themselves, of which a note tells. Throws Error(usage) where a record has no room for them.
void add_computed_fields(Schema& schema, Attributes wanted);

/// Computes the fields for `records`, which lie next to `halo`: records that count as neighbours and nothing
/// else. 24 neighbours each, as everywhere (analysis::PrepareOptions).
void compute_fields(const Schema& schema, std::span<std::uint8_t> records, std::span<const std::uint8_t> halo,
                    Progress& progress);

}  // namespace sfumato::copc
