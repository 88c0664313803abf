#include "techniques/soft/sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/normals.h"
#include "analysis/quantiles.h"
#include "core/error.h"

namespace sfumato::soft {
namespace {

/// Grazing rays: beyond it the surface no longer fills the beam.
constexpr double least_cosine = 0.1;
constexpr double cosine_without_normal = 0.5;

}  // namespace

std::vector<float> sensor_uncertainty(const PreparedCloud& prepared, std::vector<std::string>& notes) {
  const PointCloud& cloud = prepared.cloud;
  const ScalarField *scanner = cloud.scalar("scanner"), *returns = cloud.scalar("number_of_returns");
  const bool knows_scanner = (scanner || cloud.scanners.size() == 1) &&
                             std::any_of(cloud.scanners.begin(), cloud.scanners.end(),
                                         [](const dvec3& p) { return std::isfinite(p.x); });
  if (!knows_scanner && !returns)
    throw Error(
        ErrorCode::usage,
        "field = sensor needs the scanner's position (E57, PTX, PCD with a viewpoint) or number_of_returns "
        "(LAS); the cloud has neither, use field = uncertainty");

  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> sigma(cloud.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    double value = 1;
    if (returns) value = std::max(1.0, returns->value(i));  // 0 and NaN: a file that does not say
    if (knows_scanner) {
      if (const std::optional<dvec3> way = analysis::way_to_scanner(cloud, scanner, i)) {
        const double range = glm::length(*way);
        const vec3 normal = i < cloud.normals.size() ? cloud.normals[i] : vec3(0);
        const double cosine = glm::dot(normal, normal) > 0.25f
                                  ? std::max(std::abs(glm::dot(dvec3(normal), *way / range)), least_cosine)
                                  : cosine_without_normal;
        value *= range * range / cosine;
      } else {
        value = unknown;
      }
    }
    sigma[i] = float(value);
  }
  std::vector<float> known;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(known), [](float v) { return !std::isnan(v); });
  const float median = known.empty() ? 1 : analysis::quantile(known, 0.5);
  for (float& value : sigma) value = std::isnan(value) ? 0 : 1 - 1 / std::max(value / median, 1.0f);
  notes.push_back(std::string("uncertainty of the sensor from ") +
                  (knows_scanner ? "range and incidence angle" : "") +
                  (knows_scanner && returns ? " and " : "") + (returns ? "the number of returns" : ""));
  return sigma;
}

}  // namespace sfumato::soft
