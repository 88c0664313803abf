// Robust ranges of scalar fields.
#pragma once

#include <span>

#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// The value below which the share `q` in [0,1] of the values lies, interpolated between neighbours. NaN is
/// left out; 0 when nothing else is there. Exact up to a million values, a fixed-stride sample of as many
/// beyond.
float quantile(std::span<const float> values, double q);

/// The 2 % and 98 % quantiles of `values`.
Quantiles quantiles(std::span<const float> values);

/// F01 = clamp((F - q02) / (q98 - q02), 0, 1): 0 where the field does not vary beyond float rounding, or is
/// NaN. Seemann 2018 maps to [0,1] without saying how; plain minimum and maximum are decided by one outlier.
float normalized(float value, const Quantiles& range);

}  // namespace sfumato::analysis
