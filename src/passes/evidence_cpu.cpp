#include "passes/evidence_cpu.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/wide.h"

namespace sfumato {
namespace {

/// Squared distances, px. No sum of two within the reach comes near to `nowhere`.
using Distances = Image<std::uint16_t>;
constexpr std::uint16_t nowhere = 40000;
static_assert(2 * EvidenceReach::most * EvidenceReach::most < nowhere);
static_assert(nowhere + EvidenceReach::most * EvidenceReach::most <= 65535);

/// Along a row to the nearest pixel of those with `is_goal(x)`, no farther than `reach`.
template <class IsGoal>
void along_row(std::uint16_t* out, int width, int reach, const IsGoal& is_goal) {
  int since = reach + 1;
  for (int x = 0; x < width; ++x) {
    since = is_goal(x) ? 0 : std::min(since + 1, reach + 1);
    out[x] = std::uint16_t(since);
  }
  since = reach + 1;
  for (int x = width - 1; x >= 0; --x) {
    since = std::min(since + 1, int(out[x]));
    out[x] = since > reach ? nowhere : std::uint16_t(since * since);
  }
}

SFUMATO_WIDE void lower(std::uint16_t* least, const std::uint16_t* row, int width, std::uint16_t farther) {
  for (int x = 0; x < width; ++x) {
    const auto distance2 = std::uint16_t(row[x] + farther);
    least[x] = distance2 < least[x] ? distance2 : least[x];
  }
}

/// To the nearest goal, of pixels [first, first + width) of row y, from the distances along all rows.
void across_rows(const Distances& along, int first, int y, int width, int reach, std::uint16_t* least) {
  std::fill_n(least, width, nowhere);
  for (int k = -reach; k <= reach; ++k)
    if (y + k >= 0 && y + k < along.height())
      lower(least, along.row(y + k) + first, width, std::uint16_t(k * k));
}

}  // namespace

Image<std::uint8_t> evidence_by_rows(const Image<std::uint32_t>& depth_bits, int band, int width, int height,
                                     const EvidenceReach& reach) {
  const int columns = depth_bits.width(), rows = depth_bits.height(), between = int(reach.between);
  const float between2 = reach.between * reach.between, beside2 = reach.beside * reach.beside;
  const float open = reach.between - reach.beside;
  Distances along(columns, rows), distance2(columns, rows);
  tbb::parallel_for(0, rows, [&](int y) {
    along_row(&along.at(0, y), columns, between, [&](int x) { return depth_bits.at(x, y) != 0xffffffffu; });
  });
  tbb::parallel_for(0, rows, [&](int y) { across_rows(along, 0, y, columns, between, &distance2.at(0, y)); });
  // From here on to the centres of empty discs.
  tbb::parallel_for(0, rows, [&](int y) {
    along_row(&along.at(0, y), columns, between, [&](int x) { return float(distance2.at(x, y)) > between2; });
  });
  Image<std::uint8_t> mask(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    std::vector<std::uint16_t> to_open(static_cast<std::size_t>(width));
    across_rows(along, band, y + band, width, int(open), to_open.data());
    for (int x = 0; x < width; ++x) {
      const float own2 = distance2.at(x + band, y + band);
      const bool vouched =
          own2 <= beside2 || (own2 <= between2 && float(to_open[std::size_t(x)]) > open * open);
      mask.at(x, y) = vouched ? 255 : 0;
    }
  });
  return mask;
}

}  // namespace sfumato
