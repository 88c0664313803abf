#include "core/coloring.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/color.h"
#include "core/colormap.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/order.h"
#include "core/param.h"

namespace sfumato {
namespace {

constexpr Rgba8 unknown_gray{128, 128, 128, 255};
/// Unglazed pottery: light enough for shadows to show, warm enough to stand before white.
constexpr Rgba8 clay{201, 186, 168, 255};

bool has_colors(const PointCloud& cloud) {
  return std::any_of(cloud.colors.begin(), cloud.colors.end(),
                     [](const Rgba8& c) { return c != no_color && (c.r != 0 || c.g != 0 || c.b != 0); });
}

/// Luma (Rec. 709) of an sRGB colour, 0 to 255.
double luma(const Rgba8& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

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

/// One colour for all on which neither light nor shadow shows.
bool swallows_light(const Rgba8& c) { return luma(c) < 24 || luma(c) > 231; }

bool varies(const ScalarField* field) {
  if (!field || field->values.empty()) return false;
  const float first = field->values[0];
  return std::any_of(field->values.begin(), field->values.end(),
                     [&](float v) { return std::isfinite(v) && v != first; });
}

/// Whether classes tell points apart: 0 and 1 both say that a point has none, and more than one point in a
/// hundred is not of the commonest.
bool is_classified(const ScalarField* field) {
  if (!field) return false;
  std::map<long, std::size_t> counts;
  std::size_t most = 0, all = 0;
  for (std::size_t i = 0; i < field->values.size(); ++i) {
    if (!std::isfinite(field->values[i])) continue;
    const long id = std::lround(std::clamp(field->value(i), 1.0, 1e6));
    most = std::max(most, ++counts[id]), ++all;
  }
  return 100 * (all - most) > all;
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

/// World coordinate along up, as offset + float.
ScalarField elevation(const PointCloud& cloud) {
  const dvec3 up = up_vector(cloud.up);
  ScalarField field{"elevation", glm::dot(up, cloud.origin), {}, StoredType::float32};
  field.values.reserve(cloud.size());
  for (const vec3& p : cloud.positions) field.values.push_back(glm::dot(vec3(up), p));
  return field;
}

/// Much wider than high: land, a street, a floor, where height tells most. Objects are of clay.
bool is_land(const PointCloud& cloud) {
  const dvec3 size = robust_bounds(cloud).size(), up = glm::abs(up_vector(cloud.up));
  const double height = glm::dot(size, up);
  double narrow = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k)
    if (up[k] < 0.5) narrow = std::min(narrow, size[k]);
  return narrow > 0 && height < 0.4 * narrow;
}

/// 2 and 98 % quantiles of at most a million finite values; all values when these coincide. `is_height`:
/// widened to 0.1 and 99.9 %, by a fifth at each end at most. What stands highest is few points and much of
/// the picture: crowns, roofs, ridges; but noise far above or below takes no more than that.
/// `is_intensity`: the upper end comes down until the median is in the middle, but not below the 90 %
/// quantile. Intensities fall with the square of the distance, so that the few beside the scanner would leave
/// all others in black.
std::array<double, 2> stretch(const ScalarField& field, bool is_height, bool is_intensity) {
  constexpr double most_widened = 0.2;
  const std::size_t stride = std::max<std::size_t>(1, field.values.size() / 1'000'000);
  std::vector<float> sample;
  for (std::size_t i = 0; i < field.values.size(); i += stride)
    if (std::isfinite(field.values[i])) sample.push_back(field.values[i]);
  if (sample.empty()) return {field.offset, field.offset + 1};
  const auto quantile = [&](double q) {
    return double(nth_value(sample, std::size_t(std::lround(q * double(sample.size() - 1)))));
  };
  double low = quantile(0.02), high = quantile(0.98);
  if (low == high) {
    const auto [least, most] = std::minmax_element(sample.begin(), sample.end());
    low = *least, high = *most;
  } else if (is_height) {
    const double room = most_widened * (high - low);
    low = std::max(low - room, quantile(0.001)), high = std::min(high + room, quantile(0.999));
  } else if (is_intensity) {
    const double in_the_middle = std::max(low + 2 * (quantile(0.5) - low), quantile(0.9));
    if (in_the_middle > low) high = std::min(high, in_the_middle);
  }
  return {field.offset + low, field.offset + high};
}

void color_scalar(const ScalarField& field, const ColorSettings& settings, Coloring& out) {
  out.kind = ColorKind::scalar;
  out.colormap = !settings.colormap.empty()  ? settings.colormap
                 : out.source == "intensity" ? "gray"
                 : out.source == "elevation" ? "land"
                                             : "viridis";
  const Colormap map = Colormap::named(out.colormap);
  const std::array<double, 2> range =
      settings.range ? *settings.range : stretch(field, out.source == "elevation", out.source == "intensity");
  out.low = range[0], out.high = range[1];
  std::array<Rgba8, 1024> table;
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = map.at(double(i) / double(table.size() - 1));
  const double span = out.high - out.low;
  const double scale = span != 0 ? double(table.size() - 1) / span : 0;
  const double shift = (field.offset - out.low) * scale + (span != 0 ? 0.5 : 0.5 * double(table.size()));
  out.colors.reserve(field.values.size());
  for (float value : field.values) {
    if (!std::isfinite(value)) {
      out.colors.push_back(unknown_gray);
      continue;
    }
    const double place = std::clamp(double(value) * scale + shift, 0.0, double(table.size() - 1));
    out.colors.push_back(table[std::size_t(place)]);
  }
}

/// Any scalar may be asked for as classes.
int class_at(const ScalarField& field, std::size_t i) {
  constexpr double most = std::numeric_limits<int>::max();
  return int(std::lround(std::clamp(field.value(i), -most, most)));
}

void color_classes(const ScalarField& field, const std::map<int, Rgba8>& own, Coloring& out) {
  out.kind = ColorKind::classes;
  out.classes = count_classes(field);
  std::map<int, Rgba8> colors;
  for (const auto& [id, points] : out.classes) {
    const auto found = own.find(id);
    colors[id] = found != own.end() ? found->second : class_color(id);
    out.swatches.push_back({class_name(id), colors[id], points});
  }
  out.colors.reserve(field.values.size());
  int last_id = 0;
  const Rgba8* last = nullptr;  // runs of a class are long
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (!std::isfinite(field.values[i])) {
      out.colors.push_back(unknown_gray);
      continue;
    }
    const int id = class_at(field, i);
    if (!last || id != last_id) last_id = id, last = &colors[id];
    out.colors.push_back(*last);
  }
}

long number_of(const ScalarField& field, std::size_t i) {
  constexpr double most = 0x1p53;  // beyond it whole numbers are not told apart
  return std::lround(std::clamp(field.value(i), -most, most));
}

/// How many points have each of the numbers.
std::map<long, std::size_t> counts_of(const ScalarField& field) {
  std::map<long, std::size_t> counts;
  for (std::size_t i = 0; i < field.values.size(); ++i)
    if (std::isfinite(field.values[i])) ++counts[number_of(field, i)];
  return counts;
}

/// Numbers that name something, each with a colour and a line of the legend, in their order; grey where there
/// is none. `swatch_of`: label and colour of a number.
template <class SwatchOf>
void color_names(const ScalarField& field, const std::map<long, std::size_t>& counts,
                 const SwatchOf& swatch_of, Coloring& out) {
  out.kind = ColorKind::files;
  std::map<long, Rgba8> colors;
  for (const auto& [number, points] : counts) {
    Swatch swatch = swatch_of(number);
    swatch.points = points;
    colors[number] = swatch.color;
    out.swatches.push_back(std::move(swatch));
  }
  out.colors.reserve(field.values.size());
  float last = std::numeric_limits<float>::quiet_NaN();
  Rgba8 color = unknown_gray;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    const float value = field.values[i];
    if (std::isfinite(value) && value != last) last = value, color = colors[number_of(field, i)];
    out.colors.push_back(std::isfinite(value) ? color : unknown_gray);
  }
}

/// A colour for each file of the scene: a ramp would say that the second is more than the first.
void color_files(const ScalarField& field, const ColorSettings& settings, Coloring& out) {
  const auto swatch_of = [&](long number) {
    const std::size_t index = std::size_t(std::max(0L, number - 1));
    const std::vector<std::string>& names = settings.file_names;
    return Swatch{index < names.size() ? names[index] : "file " + std::to_string(number),
                  swatch_color(index)};
  };
  color_names(field, counts_of(field), swatch_of, out);
}

constexpr std::size_t most_things = 8;  // colours that are told apart at a glance

/// Numbers of LAS that tell things apart instead of measuring them, and are few: a ramp between flight line
/// 66 and 67 shows nothing.
bool names_things(const ScalarField& field) {
  static const std::set<std::string> names{"point_source_id", "return_number", "number_of_returns",
                                           "scanner_channel", "user_data",     "scanner",
                                           "cluster"};
  if (!names.contains(field.name)) return false;
  std::vector<float> found;
  for (const float value : field.values) {
    if (!std::isfinite(value) || std::find(found.begin(), found.end(), value) != found.end()) continue;
    found.push_back(value);
    if (found.size() > most_things || value != std::round(value)) return false;
  }
  return found.size() > 1;
}

/// A colour for each of these numbers.
void color_numbers(const ScalarField& field, Coloring& out) {
  const std::map<long, std::size_t> counts = counts_of(field);
  // By the number itself, so that it has its colour in every view; by its place where two would share one.
  const auto own_place = [](long number) { return std::size_t(std::abs(number)) % most_things; };
  std::set<std::size_t> taken;
  for (const auto& [number, points] : counts) taken.insert(own_place(number));
  const bool by_place = taken.size() < counts.size();
  const auto swatch_of = [&](long number) {
    return Swatch{std::to_string(number), swatch_color(by_place ? out.swatches.size() : own_place(number))};
  };
  color_names(field, counts, swatch_of, out);
}

void color_normals(const PointCloud& cloud, Coloring& out) {
  if (cloud.normals.empty())
    throw Error(ErrorCode::usage, "cannot colour by normal: the cloud has no normals");
  out.kind = ColorKind::normal;
  out.colors.reserve(cloud.size());
  for (const vec3& n : cloud.normals) {
    const vec3 c = glm::clamp(0.5f * (n + 1.0f), 0.0f, 1.0f) * 255.0f + 0.5f;
    out.colors.push_back(n == vec3(0) ? unknown_gray
                                      : Rgba8{std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255});
  }
}

std::uint8_t code_of(float linear) {
  const float s = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return std::uint8_t(std::clamp(s, 0.0f, 1.0f) * 255 + 0.5f);
}

/// A scan of which a tenth is lighter than this is light enough: sRGB 135 of its strongest channel.
constexpr float light_enough = 0.24f, most_exposure = 4;
/// Nobody sees less, and the file's own colours are worth more.
constexpr float least_exposure = 1.1f;

/// Brings the colour that a tenth of the points exceed to `light_enough`.
double automatic_exposure(const std::vector<Rgba8>& colors) {
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  std::vector<std::uint8_t> strongest;
  for (std::size_t i = 0; i < colors.size(); i += stride)
    if (colors[i] != no_color) strongest.push_back(std::max({colors[i].r, colors[i].g, colors[i].b}));
  if (strongest.empty()) return 1;
  const float light = linear_from_srgb(value_at_share(strongest, 0.9));
  if (!(light > 0) || light >= light_enough) return 1;
  const float exposure = light_enough * (1 - light) / (light * (1 - light_enough));
  return exposure < least_exposure ? 1 : std::min(most_exposure, exposure);
}

/// m becomes e m / (1 + (e - 1) m): e times as much near black, 1 stays 1.
void expose(std::vector<Rgba8>& colors, double exposure) {
  std::array<std::array<std::uint8_t, 256>, 256> raised;  // of each strongest channel, each channel
  for (int most = 0; most < 256; ++most) {
    const float m = linear_from_srgb(std::uint8_t(most)),
                factor = float(exposure / (1 + (exposure - 1) * double(m)));
    for (int c = 0; c <= most; ++c)
      raised[std::size_t(most)][std::size_t(c)] = code_of(factor * linear_from_srgb(std::uint8_t(c)));
  }
  for (Rgba8& c : colors) {
    const auto& row = raised[std::max({c.r, c.g, c.b})];
    c.r = row[c.r], c.g = row[c.g], c.b = row[c.b];
  }
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

/// "rgb*intensity": the places of both; nothing where a scalar is called so.
std::optional<std::size_t> product_in(const PointCloud& cloud, std::string_view color_by) {
  const std::size_t star = color_by.find('*');
  if (star == color_by.npos || cloud.scalar(color_by)) return std::nullopt;
  return star;
}

/// Codes times the share of the way from black to full, as pictures are multiplied.
void shade(const ScalarField& field, const ColorSettings& settings, Coloring& out) {
  out.shade =
      settings.shade ? *settings.shade : stretch(field, field.name == "elevation", field.name == "intensity");
  const auto [low, high] = *out.shade;
  for (std::size_t i = 0; i < out.colors.size(); ++i) {
    if (!std::isfinite(field.values[i]) || !(high > low)) continue;
    const double share = std::clamp((field.value(i) - low) / (high - low), 0.0, 1.0);
    for (std::uint8_t* code : {&out.colors[i].r, &out.colors[i].g, &out.colors[i].b})
      *code = std::uint8_t(std::lround(share * *code));
  }
}

}  // namespace

std::string resolve_color_by(const PointCloud& cloud, std::string_view color_by) {
  if (color_by == "auto") {
    const bool colored = has_colors(cloud) && are_coherent(cloud);
    if (colored && vary(cloud.colors)) return "rgb";
    if (is_land(cloud)) return "elevation";
    if (is_coherent(cloud, cloud.scalar("intensity"))) return "intensity";
    if (is_classified(cloud.scalar("classification"))) return "classification";
    return colored && !swallows_light(cloud.colors[cloud.size() / 2]) ? "rgb" : "clay";
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

Coloring color_points(const PointCloud& cloud, const ColorSettings& settings) {
  Coloring out;
  if (settings.solid) {
    out.source = "one colour";
    out.colors.assign(cloud.size(), *settings.solid);
    return out;
  }
  if (const auto star = product_in(cloud, settings.color_by)) {
    ColorSettings first = settings;
    first.color_by = settings.color_by.substr(0, *star);
    out = color_points(cloud, first);
    const std::string second = resolve_color_by(cloud, settings.color_by.substr(*star + 1));
    const ScalarField* field = cloud.scalar(second);
    if (!field && second != "elevation")
      throw Error(ErrorCode::usage, "--color-by " + settings.color_by + ": '" + second +
                                        "' is no number of the points to multiply by; take intensity");
    shade(field ? *field : elevation(cloud), settings, out);
    out.source += "*" + second;
    return out;
  }
  out.source = resolve_color_by(cloud, settings.color_by);
  if (!settings.colormap.empty())
    Colormap::named(settings.colormap);  // a wrong name is refused whatever is shown
  if (out.source == "rgb") {
    out.colors = cloud.colors;
    out.exposure = settings.exposure.value_or(automatic_exposure(out.colors));
    for (Rgba8& c : out.colors) c.a = 255;
    if (out.exposure != 1) expose(out.colors, out.exposure);
    if (out.exposure != 1 && !settings.exposure) {
      std::string times = std::to_string(std::round(10 * out.exposure) / 10);
      times.resize(times.find('.') + 2);
      out.notes.push_back("the file's colours are dark and drawn up to " + times +
                          " times as bright; --exposure 1 draws them as they are");
    }
  } else if (out.source == "clay" && !cloud.scalar("clay")) {
    out.colors.assign(cloud.size(), clay);
  } else if (out.source == "normal") {
    color_normals(cloud, out);
  } else if (out.source == "classification" && settings.colormap.empty() && !settings.range) {
    color_classes(*cloud.scalar("classification"), settings.class_colors, out);
  } else if (out.source == "file" && !settings.file_names.empty() && settings.colormap.empty() &&
             !settings.range) {
    color_files(*cloud.scalar("file"), settings, out);
  } else if (const ScalarField* field = cloud.scalar(out.source);
             field && settings.colormap.empty() && !settings.range && names_things(*field)) {
    color_numbers(*field, out);
  } else {
    color_scalar(out.source == "elevation" && !cloud.scalar("elevation") ? elevation(cloud)
                                                                         : *cloud.scalar(out.source),
                 settings, out);
  }
  if (out.kind == ColorKind::rgb || out.kind == ColorKind::normal) {
    const std::string why =
        " has no effect: the points are coloured by " + out.source + " (--color-by says otherwise)";
    if (!settings.colormap.empty()) out.notes.push_back("--colormap " + settings.colormap + why);
    if (settings.range) out.notes.push_back("--color-range" + why);
  }
  return out;
}

std::vector<Rgba8> distinct_colors(const std::vector<Rgba8>& colors, std::size_t limit) {
  std::vector<Rgba8> distinct;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (i > 0 && colors[i] == colors[i - 1]) continue;
    if (std::find(distinct.begin(), distinct.end(), colors[i]) != distinct.end()) continue;
    if (distinct.size() == limit) return {};
    distinct.push_back(colors[i]);
  }
  return distinct;
}

vec3 contrasting_background(const std::vector<Rgba8>& colors) {
  // A contrast (WCAG 2.2) of less than 1.5 with white: luminance above 0.65, of the luma of 210. What a third
  // of the points have is an outline of the whole.
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  std::size_t light = 0, seen = 0;
  for (std::size_t i = 0; i < colors.size(); i += stride, ++seen) light += luma(colors[i]) > 210;
  return 3 * light > seen ? vec3(0.11f, 0.12f, 0.13f) : vec3(1);
}

std::string class_name(int id) {
  static const char* names[] = {"never classified",
                                "unclassified",
                                "ground",
                                "low vegetation",
                                "medium vegetation",
                                "high vegetation",
                                "building",
                                "low noise",
                                "model key point",
                                "water",
                                "rail",
                                "road surface",
                                "overlap",
                                "wire guard",
                                "wire conductor",
                                "transmission tower",
                                "wire connector",
                                "bridge deck",
                                "high noise",
                                "overhead structure",
                                "ignored ground",
                                "snow",
                                "temporal exclusion"};
  return id >= 0 && id < int(std::size(names)) ? names[id] : "class " + std::to_string(id);
}

Rgba8 Coloring::color_of_class(int id) const {
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k].id == id) return swatches[k].color;
  return class_color(id);
}

std::optional<int> class_named(std::string_view name) {
  for (int id = 0; id < 256; ++id)
    if (class_name(id) == name) return id;
  return std::nullopt;
}

std::vector<ClassShare> count_classes(const ScalarField& field) {
  std::map<int, std::size_t> counts;
  int last_id = 0;
  std::size_t* last = nullptr;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (!std::isfinite(field.values[i])) continue;
    const int id = class_at(field, i);
    if (!last || id != last_id) last_id = id, last = &counts[id];
    ++*last;
  }
  std::vector<ClassShare> shares;
  for (const auto& [id, points] : counts) shares.push_back({id, points});
  return shares;
}

std::map<int, Rgba8> parse_class_colors(std::string_view text) {
  std::map<int, Rgba8> colors;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find_first_of(",\n", from), text.size());
    std::string_view pair = text.substr(from, to - from);
    from = to + 1;
    while (!pair.empty() && std::isspace(static_cast<unsigned char>(pair.back()))) pair.remove_suffix(1);
    while (!pair.empty() && std::isspace(static_cast<unsigned char>(pair.front()))) pair.remove_prefix(1);
    if (pair.empty()) continue;
    const std::size_t sign = pair.find('=');
    const std::string_view name = pair.substr(0, sign);
    std::optional<int> id = class_named(name);
    if (!id)
      if (const std::optional<double> code = parse_real(name);
          code && *code >= 0 && *code < 65536 && *code == std::floor(*code))
        id = int(*code);
    const std::optional<vec3> color = sign == pair.npos ? std::nullopt : parse_color(pair.substr(sign + 1));
    if (!id || !color)
      throw Error(ErrorCode::usage, "'" + std::string(pair) + "' is not CLASS=COLOUR: " +
                                        (id ? "write a name (tan) or #hex (#aa7744)"
                                            : "the class is a code (2) or its name (ground)"));
    colors[*id] = to_rgba8(*color);
  }
  if (colors.empty()) throw Error(ErrorCode::usage, "no class has a colour in it; write 2=#aa7744,6=orange");
  return colors;
}

Rgba8 class_color(int id) {
  static const std::uint32_t colors[] = {0x8c8c8c, 0x9a9a9a, 0xa1522e, 0x8fdc5a, 0x45b83a, 0x127a2c,
                                         0xffa800, 0xff00ff, 0xff2a2a, 0x2a5cff, 0x6b4f8a, 0x5a5a66,
                                         0xffe600, 0xc9b037, 0xe0c84a, 0x7f6a2a, 0xb39a2f, 0x3fb8c4,
                                         0xc800c8, 0x2f8f9d, 0x7a5a45, 0xf2f6ff, 0x555555};
  if (id >= 0 && id < int(std::size(colors))) {
    const std::uint32_t c = colors[id];
    return {std::uint8_t(c >> 16), std::uint8_t(c >> 8 & 255), std::uint8_t(c & 255), 255};
  }
  // Codes that users define: spread over hues so that neighbours differ, always the same colour for one code.
  const float hue = std::fmod(std::abs(float(id)) * 0.61803399f, 1.0f) * 6;
  auto channel = [&](float centre) {
    const float d = std::abs(std::fmod(hue - centre + 9, 6.0f) - 3);
    return std::uint8_t(60 + 170 * std::clamp(2 - d, 0.0f, 1.0f));
  };
  return {channel(0), channel(2), channel(4), 255};
}

std::size_t hide_classes(PointCloud& cloud, const std::vector<int>& classes) {
  const ScalarField* code = cloud.scalar("classification");
  const ScalarField* withheld = cloud.scalar("withheld");
  if ((!code || classes.empty()) && !withheld) return 0;
  std::vector<std::uint32_t> kept;
  kept.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (withheld && withheld->value(i) > 0.5) continue;
    if (code && std::isfinite(code->values[i]) &&
        std::find(classes.begin(), classes.end(), int(std::lround(code->value(i)))) != classes.end())
      continue;
    kept.push_back(std::uint32_t(i));
  }
  const std::size_t hidden = cloud.size() - kept.size();
  if (hidden > 0) cloud = select(cloud, kept);
  return hidden;
}

}  // namespace sfumato
