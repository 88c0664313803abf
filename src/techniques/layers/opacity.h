// Opacity of every point from a list: by file, by piece, by class.
#pragma once

#include <string>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::layers {

/// The scalar that picks from a list of several opacities: `by`, or for "auto" the first of `file`, `layer`
/// and `classification` that the cloud has. Throws Error(usage) when there is none.
const ScalarField& opacity_scalar(const PointCloud& cloud, const std::string& by);

/// One opacity per point: the distinct values of `scalar`, ascending, take the entries of `list` in order.
/// Points without a value (NaN) take the last one. Throws Error(usage) unless there are as many values as
/// entries.
std::vector<float> opacities(const ScalarField& scalar, const std::vector<float>& list);

}  // namespace sfumato::layers
