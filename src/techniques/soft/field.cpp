#include "techniques/soft/field.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/attributes.h"
#include "analysis/prepare.h"
#include "analysis/quantiles.h"
#include "core/error.h"
#include "core/number_in.h"
#include "core/option_text.h"
#include "techniques/soft/sensor.h"

namespace sfumato::soft {
namespace {

dvec3 parse_vector(const std::string& name, const std::string& text) {
  std::vector<double> values;
  for (const std::string& word : split(text, ','))
    if (const auto value = number_in<double>(word); value && std::isfinite(*value)) values.push_back(*value);
  if (values.size() != 3 || std::count(text.begin(), text.end(), ',') != 2)
    throw Error(ErrorCode::usage, name + " is '" + text + "', not auto or X,Y,Z");
  return {values[0], values[1], values[2]};
}

// By view: g++ 13 and later take a reference to a temporary name for one that the result refers to.
const ScalarField& scalar_of(const PointCloud& cloud, std::string_view name) {
  if (const ScalarField* scalar = cloud.scalar(name)) return *scalar;
  std::vector<std::string> names{"uncertainty", "sensor", "class", "distance"};
  for (const ScalarField& scalar : cloud.scalars) names.push_back(scalar.name);
  std::string list;
  for (const std::string& one : names) list += (list.empty() ? "" : ", ") + one;
  const std::string nearest = nearest_word(name, names);
  throw Error(ErrorCode::usage, "the cloud has no scalar '" + std::string(name) + "' to be the field" +
                                    (nearest.empty() ? "" : "; did you mean " + nearest + "?") + " (" + list +
                                    ")");
}

/// Scene units, from the place or surface that the settings name.
double distance(const FieldSettings& s, const dvec3& from_origin, const dvec3& direction,
                const dvec3& half_size) {
  switch (s.distance_to) {
    case DistanceTo::plane: return std::abs(glm::dot(from_origin, direction));
    case DistanceTo::point: return glm::length(from_origin);
    case DistanceTo::box: return glm::length(glm::max(glm::abs(from_origin) - half_size, dvec3(0)));
    case DistanceTo::axis: break;
  }
  return glm::length(from_origin - glm::dot(from_origin, direction) * direction);
}

std::vector<float> distances(const PreparedCloud& prepared, FieldSettings& s) {
  const PointCloud& cloud = prepared.cloud;
  const Bounds box = prepared.whole ? prepared.whole->usual_box : robust_bounds(cloud);
  const dvec3 origin = s.origin == "auto" ? box.center() : parse_vector("field_origin", s.origin);
  const dvec3 half_size = 0.5 * (s.size == "auto" ? 0.5 * box.size() : parse_vector("field_size", s.size));
  dvec3 direction =
      s.direction == "auto" ? up_vector(cloud.up) : parse_vector("field_direction", s.direction);
  if (!(glm::length(direction) > 0))
    throw Error(ErrorCode::usage, "field_direction is 0,0,0, which is no direction; give X,Y,Z or auto");
  direction = glm::normalize(direction);
  const auto distances_in = [&](const PointCloud& of) {
    std::vector<float> out(of.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = float(distance(s, of.world(i) - origin, direction, half_size));
    return out;
  };
  std::vector<float> values = distances_in(cloud);
  const float range = s.range.resolve(
      analysis::quantile(prepared.whole ? distances_in(prepared.whole->sample) : values, 0.98));
  for (float& value : values) value = range > 0 ? std::min(value / range, 1.0f) : 0;
  return values;
}

std::vector<float> classes(const PointCloud& cloud, const std::vector<float>& soft) {
  const ScalarField& scalar = scalar_of(cloud, "classification");
  std::vector<float> values(cloud.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = std::find(soft.begin(), soft.end(), float(scalar.value(i))) != soft.end() ? 1.0f : 0.0f;
  return values;
}

std::vector<float> scalar_values(const PreparedCloud& prepared, const std::string& name,
                                 std::vector<std::string>& notes) {
  const ScalarField& scalar = scalar_of(prepared.cloud, name);
  const ScalarField& of_all = prepared.whole ? scalar_of(prepared.whole->sample, name) : scalar;
  std::vector<float> values = scalar.values;
  // A length has no natural scale in [0,1], so uncertainty is always measured against its own spread.
  const bool is_unit =
      name != "uncertainty" && std::all_of(of_all.values.begin(), of_all.values.end(), [&](float v) {
        return !std::isfinite(v) || (of_all.offset + v >= 0 && of_all.offset + v <= 1);
      });
  if (is_unit) {
    for (float& value : values)
      value = std::isnan(value) ? 0 : std::clamp(float(scalar.offset + value), 0.0f, 1.0f);
    return values;
  }
  Quantiles range = name == "uncertainty" && !prepared.whole ? prepared.uncertainty_range
                                                             : analysis::quantiles(of_all.values);
  range.q02 += float(of_all.offset - scalar.offset), range.q98 += float(of_all.offset - scalar.offset);
  for (float& value : values) value = analysis::normalized(value, range);
  if (analysis::normalized(range.q98, range) == 0 && !values.empty())
    notes.push_back("the field " + name + " hardly varies: every point is solid");
  return values;
}

enum class Uncertainty {
  given,    ///< as an ordinary scalar
  stored,   ///< analysis::stored_uncertainty
  measured  ///< by us
};

/// The same for all parts of a cloud: as its sample has it.
Uncertainty uncertainty_of(const PreparedCloud& prepared) {
  const PointCloud& all = prepared.whole ? prepared.whole->sample : prepared.cloud;
  const bool has_own = !prepared.whole && prepared.computed.has(Attribute::uncertainty);
  if (!has_own && analysis::whole_stored_uncertainty(all)) return Uncertainty::stored;
  return has_own || (prepared.whole && !all.scalar("uncertainty")) ? Uncertainty::measured
                                                                   : Uncertainty::given;
}

/// 0 for the few points of a part that lack one, where the sample of the whole has none of those.
std::vector<float> stored_values(const PointCloud& cloud) {
  const ScalarField* stored = cloud.scalar(analysis::stored_uncertainty);
  std::vector<float> values = stored ? stored->values : std::vector<float>(cloud.size());
  for (float& value : values)
    if (std::isnan(value)) value = 0;
  return values;
}

/// Of a part that has a stored one of every point, where other parts have not.
PreparedCloud without_stored(PreparedCloud part, Progress& progress) {
  std::erase_if(part.cloud.scalars,
                [](const ScalarField& of) { return of.name == analysis::stored_uncertainty; });
  analysis::PrepareOptions options;
  options.neighbors = part.neighbors;
  analysis::complete(part, Attribute::uncertainty, options, progress);
  return part;
}

}  // namespace

void FieldSettings::describe(ParamList& p) {
  p.add("field", field)
      .help(
          "what makes a point soft: uncertainty, sensor (range, incidence angle, number of returns), class, "
          "distance, or a scalar of the cloud by name")
      .paper("Seemann 2018, F");
  p.add("field_classes", classes).help("field = class: classification codes that are soft (6 is building)");
  p.add("field_distance", distance_to, {"axis", "plane", "point", "box"}).help("field = distance: from what");
  p.add("field_origin", origin)
      .help(
          "field = distance: X,Y,Z on the axis or plane, the point or the box's centre "
          "(auto: the middle of the cloud)");
  p.add("field_direction", direction)
      .help("field = distance: X,Y,Z along the axis or across the plane (auto: up)");
  p.add("field_size", size).help("field = distance: X,Y,Z, the sides of the box (auto: half of the cloud's)");
  p.add("field_range", range)
      .at_least(0)
      .unit("scene units")
      .help("field = distance: where the field reaches 1 (auto: the distance that 98 % of the points keep)");
  p.add("field_invert", invert).help("low values are soft instead of high ones (confidence, for example)");
}

Field evaluate(const PreparedCloud& prepared, FieldSettings& settings, analysis::Nearby& nearby,
               Progress& progress) {
  Field field;
  const PointCloud& cloud = prepared.cloud;
  // A file may bring an uncertainty of its own, whose scale is its own, too.
  const Uncertainty uncertainty =
      settings.field == "uncertainty" ? uncertainty_of(prepared) : Uncertainty::given;
  field.is_measured = uncertainty != Uncertainty::given;
  if (cloud.empty()) return field;
  if (settings.field == "class")
    field.values = classes(cloud, settings.classes);
  else if (settings.field == "distance")
    field.values = distances(prepared, settings);
  else if (settings.field == "sensor")
    field.values = sensor_uncertainty(prepared, field.notes);
  else if (uncertainty == Uncertainty::stored)
    field.values = stored_values(cloud);
  else if (uncertainty == Uncertainty::measured) {
    if (nearby.size() != cloud.size()) nearby = analysis::Nearby(cloud.positions, progress);
    field.values = cloud.scalar("uncertainty")
                       ? analysis::scale_free_uncertainty(prepared, nearby)
                       : analysis::scale_free_uncertainty(without_stored(prepared, progress), nearby);
  } else {
    field.values = scalar_values(prepared, settings.field, field.notes);
  }
  if (settings.invert)
    for (float& value : field.values) value = 1 - value;

  const auto [least, most] = std::minmax_element(field.values.begin(), field.values.end());
  field.set_thresholds(settings, {field.values, *least, *most});
  return field;
}

void Field::set_thresholds(const FieldSettings& settings, const FieldSample& of_all) {
  threshold = analysis::quantile(of_all.values, 0.85);
  modulation_threshold = analysis::quantile(of_all.values, 0.95);
  nothing_is_uncertain = false;
  // Half of the way out is what a user means by far; and a field of few values, like classes, may have no
  // point above its quantile.
  if (settings.field == "class") {
    threshold = modulation_threshold = 0.5f;
  } else if (settings.field == "distance") {
    threshold = 0.5f;
    modulation_threshold = 0.75f;
  } else if (settings.field == "sensor" && !settings.invert) {
    // Twice the standard deviation of an ordinary point, and four times.
    threshold = std::max(threshold, 0.5f);
    modulation_threshold = std::max(modulation_threshold, 0.75f);
    nothing_is_uncertain = of_all.most <= threshold;
  } else if (is_measured && !settings.invert) {
    threshold = std::max(threshold, analysis::uncertain_from);
    modulation_threshold = std::max(modulation_threshold, analysis::fully_uncertain);
    nothing_is_uncertain = of_all.most <= threshold;
  } else if (threshold >= of_all.most && of_all.most > of_all.least) {
    threshold = 0.5f * (of_all.least + of_all.most);
  }
}

}  // namespace sfumato::soft
