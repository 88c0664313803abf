// Which attribute `--color-by auto` shows, and what a wrong name is near to.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/coloring.h"
#include "core/error.h"
#include "core/order.h"
#include "core/param.h"

namespace sfumato {
namespace {

bool is_color(const Rgba8& c) { return c != no_color && (c.r != 0 || c.g != 0 || c.b != 0); }

bool has_colors(const PointCloud& cloud) {
  return std::any_of(cloud.colors.begin(), cloud.colors.end(), is_color);
}

/// Whether most points have one: black is what programs write where they know none.
bool are_colored(const PointCloud& cloud) {
  return 2 * std::count_if(cloud.colors.begin(), cloud.colors.end(), is_color) > std::ptrdiff_t(cloud.size());
}

/// Whether colours tell places apart: more than one point in a hundred is not of the middle colour.
bool vary(const std::vector<Rgba8>& colors) {
  constexpr int alike = 8;  // codes of a channel
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  std::array<std::vector<std::uint8_t>, 3> channels;
  for (std::size_t i = 0; i < colors.size(); i += stride)
    channels[0].push_back(colors[i].r), channels[1].push_back(colors[i].g),
        channels[2].push_back(colors[i].b);
  const std::array<int, 3> middle{value_at_share(channels[0], 0.5), value_at_share(channels[1], 0.5),
                                  value_at_share(channels[2], 0.5)};
  std::size_t others = 0, seen = 0;
  for (std::size_t i = 0; i < colors.size(); i += stride, ++seen)
    others += std::abs(colors[i].r - middle[0]) > alike || std::abs(colors[i].g - middle[1]) > alike ||
              std::abs(colors[i].b - middle[2]) > alike;
  return 100 * others > seen;
}

bool varies(const ScalarField* field) {
  if (!field || field->values.empty()) return false;
  const float first = field->values[0];
  return std::any_of(field->values.begin(), field->values.end(),
                     [&](float v) { return std::isfinite(v) && v != first; });
}

/// Geary's contiguity ratio (Geary 1954, "The Contiguity Ratio and Statistical Mapping") of points that
/// follow each other and are near: what neighbours differ by over what any two do, 1 for values without
/// regard to place, 0 where they do not change between neighbours. Prepared clouds follow a Morton curve; 0
/// where what follows each other is not near.
double contiguity_ratio(const PointCloud& cloud, const ScalarField& field) {
  const std::size_t n = std::min(cloud.size(), field.values.size());
  if (n < 100) return 0;
  const std::size_t stride = std::max<std::size_t>(1, n / 65'536);
  std::vector<float> values, distances;
  for (std::size_t i = 0; i + 1 < n; i += stride) {
    if (std::isfinite(field.values[i])) values.push_back(field.values[i]);
    distances.push_back(glm::distance(cloud.positions[i], cloud.positions[i + 1]));
  }
  if (values.size() < 100) return 0;
  const float low = value_at_share(values, 0.02), high = value_at_share(values, 0.98);
  const float near = 2 * value_at_share(distances, 0.5);
  constexpr double nearest_share = 0.1;  // of the diagonal
  if (!(double(near) < nearest_share * robust_bounds(cloud).diagonal())) return 0;
  double sum = 0, squares = 0, differences = 0;
  for (const float value : values) {
    const double v = double(std::clamp(value, low, high));
    sum += v, squares += v * v;
  }
  std::size_t pairs = 0;
  for (std::size_t i = 0; i + 1 < n; i += stride) {
    const float a = field.values[i], b = field.values[i + 1];
    if (!std::isfinite(a) || !std::isfinite(b) || distances[i / stride] > near) continue;
    const double d = double(std::clamp(a, low, high)) - double(std::clamp(b, low, high));
    differences += d * d, ++pairs;
  }
  const double count = double(values.size()), variance = squares / count - sum * sum / (count * count);
  return variance > 0 && pairs > 0 ? differences / (2 * double(pairs) * variance) : 0;
}

/// Whether intensities show the place and not only the ray: more than half of what they vary by is shared by
/// neighbours.
bool is_coherent(const PointCloud& cloud, const ScalarField* field) {
  return varies(field) && contiguity_ratio(cloud, *field) < 0.5;
}

/// Whether classes tell points apart: 0 and 1 both say that a point has none, more than one point in a
/// hundred is not of the commonest, and points that follow each other on the curve differ in class less than
/// half as often as any two (a join count, Moran 1948): classes of single returns mottle a crown.
bool is_classified(const ScalarField* field) {
  if (!field) return false;
  std::map<long, std::size_t> counts;
  std::size_t most = 0, all = 0, pairs = 0, joins = 0;
  long last = -1;
  for (std::size_t i = 0; i < field->values.size(); ++i) {
    if (!std::isfinite(field->values[i])) continue;
    const long id = std::lround(std::clamp(field->value(i), 1.0, 1e6));
    most = std::max(most, ++counts[id]), ++all;
    if (last >= 0) ++pairs, joins += id != last;
    last = id;
  }
  double alike = 0;
  for (const auto& [id, count] : counts) alike += double(count) * double(count) / (double(all) * double(all));
  const bool is_mottled = pairs >= 100 && double(joins) >= 0.5 * (1 - alike) * double(pairs);
  return 100 * (all - most) > all && !is_mottled;
}

/// Whether colours show the place. Grey ones are one channel three times: they are asked what intensities
/// are.
bool are_coherent(const PointCloud& cloud) {
  ScalarField grey{"grey", 0, {}, StoredType::float32};
  for (const Rgba8& c : cloud.colors) {
    if (c.r != c.g || c.g != c.b) return true;
    grey.values.push_back(float(c.g));
  }
  return is_coherent(cloud, &grey);
}

/// A place on a map, or much wider than high: land, a street, a floor, where height tells most. Objects are
/// of clay, and so is what has no height.
bool is_land(const PointCloud& cloud) {
  const dvec3 size = robust_bounds(cloud).size(), up = glm::abs(up_vector(cloud.up));
  const double height = glm::dot(size, up);
  double narrow = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k)
    if (up[k] < 0.5) narrow = std::min(narrow, size[k]);
  return height > 0 && (!cloud.crs.empty() || height < 0.4 * narrow);
}

bool is_label(std::string_view name) {
  static const std::set<std::string, std::less<>> names{"label",   "labels",   "class",
                                                        "segment", "instance", "semantic"};
  std::string plain;
  for (const char c : name) plain += char(std::tolower(static_cast<unsigned char>(c)));
  return names.contains(plain.starts_with("scalar_") ? plain.substr(7) : plain);
}

/// What other programs call what colours come from.
std::string nearest_source(std::string_view wanted, const std::vector<std::string>& names) {
  static const std::map<std::string, std::string, std::less<>> synonyms = {{"height", "elevation"},
                                                                           {"altitude", "elevation"},
                                                                           {"z", "elevation"},
                                                                           {"color", "rgb"},
                                                                           {"colour", "rgb"},
                                                                           {"colors", "rgb"},
                                                                           {"colours", "rgb"},
                                                                           {"rgba", "rgb"},
                                                                           {"class", "classification"},
                                                                           {"classes", "classification"},
                                                                           {"label", "classification"},
                                                                           {"reflectance", "intensity"},
                                                                           {"amplitude", "intensity"},
                                                                           {"normals", "normal"},
                                                                           {"none", "clay"}};
  std::string plain;
  for (const char c : wanted) plain += char(std::tolower(static_cast<unsigned char>(c)));
  const auto found = synonyms.find(plain);
  if (found != synonyms.end() && std::find(names.begin(), names.end(), found->second) != names.end())
    return found->second;
  return nearest_word(wanted, names);
}

/// The first column of labels that tells points apart.
const ScalarField* labels_of(const PointCloud& cloud) {
  const auto found = std::find_if(cloud.scalars.begin(), cloud.scalars.end(), [](const ScalarField& field) {
    return is_label(field.name) && names_things(field);
  });
  return found == cloud.scalars.end() ? nullptr : &*found;
}

}  // namespace

bool names_things(const ScalarField& field) {
  static const std::set<std::string, std::less<>> names{
      "point_source_id", "return_number", "number_of_returns", "scanner_channel", "user_data",
      "scanner",         "cluster"};
  const bool is_label_column = is_label(field.name);
  if (!names.contains(field.name) && !is_label_column) return false;
  const std::size_t most = is_label_column ? 64 : 8;  // 8 are told apart at a glance, neighbours of 64
  std::set<float> found;
  float last = std::numeric_limits<float>::quiet_NaN();
  for (const float value : field.values) {
    if (!std::isfinite(value) || value == last) continue;
    last = value;
    found.insert(value);
    if (found.size() > most || value != std::round(value)) return false;
  }
  return found.size() > 1;
}

std::string resolve_color_by(const PointCloud& cloud, std::string_view color_by) {
  if (color_by == "auto") {
    const bool colored = are_colored(cloud) && are_coherent(cloud);
    if (colored && vary(cloud.colors)) return "rgb";
    if (is_land(cloud)) return "elevation";
    if (is_coherent(cloud, cloud.scalar("intensity"))) return "intensity";
    if (is_classified(cloud.scalar("classification"))) return "classification";
    if (const ScalarField* labels = labels_of(cloud)) return labels->name;
    return "clay";  // one colour for all tells no more, and light shows less on it
  }
  if (color_by == "elevation" || color_by == "normal" || color_by == "clay" || cloud.scalar(color_by))
    return std::string(color_by);
  if (color_by == "rgb" && has_colors(cloud)) return "rgb";
  if (color_by == "rgb" && !cloud.colors.empty())
    throw Error(ErrorCode::usage, "the cloud's rgb is all zero and would be black; use --color-by auto");
  std::vector<std::string> names = {"auto", "elevation", "normal", "clay", "density"};
  if (has_colors(cloud)) names.push_back("rgb");
  for (const ScalarField& field : cloud.scalars) names.push_back(field.name);
  const std::string near = nearest_source(color_by, names);
  std::string all;
  for (const std::string& name : names) all += " " + name;
  throw Error(ErrorCode::usage, "the cloud has no '" + std::string(color_by) + "' to colour by" +
                                    (near.empty() ? ";" : "; did you mean '" + near + "'?") +
                                    " it has:" + all);
}

}  // namespace sfumato
