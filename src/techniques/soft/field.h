// The scalar that decides which points are soft: F in [0,1] for every point.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/nearby.h"
#include "core/param.h"
#include "core/prepared_cloud.h"

namespace sfumato::soft {

enum class DistanceTo { axis, plane, point, box };

struct FieldSettings {
  std::string field = "uncertainty";
  std::vector<float> classes{6};
  DistanceTo distance_to = DistanceTo::axis;
  std::string origin = "auto", direction = "auto", size = "auto";
  Auto<float> range;
  bool invert = false;
  /// Not something that the user chose to see through.
  bool is_uncertainty() const { return field == "uncertainty" || field == "sensor"; }
  /// Whether parts of a cloud find the values of their points. The sensor's follow from the median of all.
  bool is_of_parts() const { return field != "sensor"; }
  void describe(ParamList& p);
  bool operator==(const FieldSettings&) const = default;
};

/// Values of a field, or those of a random sample between the least and the most of all.
struct FieldSample {
  std::span<const float> values;
  float least = 0, most = 0;
};

struct Field {
  std::vector<float> values;  ///< one per point of the prepared cloud, in [0,1], never NaN
  float threshold =
      1;  ///< automatic: of 15 % of the points the field is above; fewer where fewer are uncertain
  float modulation_threshold = 1;
  bool is_measured = false;  ///< on a scale of its own, whatever the values of the cloud are
  bool nothing_is_uncertain = false;
  std::vector<std::string> notes;
  /// Finds the thresholds. Where the values are those of a part, `of_all` is of the whole.
  void set_thresholds(const FieldSettings& settings, const FieldSample& of_all);
};

/// Evaluates the field. Throws Error(usage) that names the nearest scalar when there is none of that name, or
/// the text that is no position.
/// `nearby`, filled when it is needed, has the points around each other. Of a part of a cloud the thresholds
/// are its own.
Field evaluate(const PreparedCloud& prepared, FieldSettings& settings, analysis::Nearby& nearby,
               Progress& progress = no_progress());

}  // namespace sfumato::soft
