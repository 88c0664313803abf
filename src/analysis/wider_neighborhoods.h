// Neighbourhoods that are wider in some parts of a cloud than in others.
#pragma once

#include "analysis/neighbors.h"

namespace sfumato::analysis {

/// As `for_each_neighborhood` without it, but with `wide_k` neighbours where `is_wide` says so of the first
/// or the last point of a leaf.
void for_each_neighborhood(const NeighborTree& tree, int k, int wide_k,
                           const std::function<bool(std::uint32_t)>& is_wide, const VisitNeighborhood& visit,
                           std::string_view text, Progress& progress);

}  // namespace sfumato::analysis
