#include "techniques/layers/opacity.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"

namespace sfumato::layers {

const ScalarField& opacity_scalar(const PointCloud& cloud, const std::string& by) {
  if (by != "auto") {
    if (const ScalarField* field = cloud.scalar(by)) return *field;
    throw Error(ErrorCode::usage,
                "opacity_by: the cloud has no scalar '" + by + "'; sfumato info lists what it has");
  }
  for (const char* name : {"file", "layer", "classification"})
    if (const ScalarField* field = cloud.scalar(name)) return *field;
  throw Error(ErrorCode::usage,
              "opacity lists several values, but the cloud has no scalar file, layer or "
              "classification to choose by: give one value, or name a scalar with opacity_by");
}

std::vector<float> opacities(const ScalarField& scalar, const std::vector<float>& list) {
  std::set<float> distinct;
  for (float value : scalar.values) {
    if (!std::isnan(value)) distinct.insert(value);
    // A field of measurements may have millions.
    if (distinct.size() > 256) break;
  }
  if (distinct.size() != list.size())
    throw Error(ErrorCode::usage,
                "opacity lists " + std::to_string(list.size()) + " values, but scalar " + scalar.name +
                    " has " + (distinct.size() > 256 ? "over 256" : std::to_string(distinct.size())) +
                    " different ones: give one for each in ascending order, or a single one");
  const std::vector<float> ascending(distinct.begin(), distinct.end());
  std::vector<float> result;
  result.reserve(scalar.values.size());
  for (float value : scalar.values) {
    const auto at =
        std::isnan(value) ? ascending.end() - 1 : std::lower_bound(ascending.begin(), ascending.end(), value);
    result.push_back(list[std::size_t(at - ascending.begin())]);
  }
  return result;
}

}  // namespace sfumato::layers
