#include "core/coloring.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/color.h"
#include "core/colormap.h"
#include "core/error.h"
#include "core/order.h"

namespace sfumato {
namespace {

constexpr Rgba8 unknown_gray{128, 128, 128, 255};
/// Unglazed pottery: light enough for shadows to show, warm enough to stand before white.
constexpr Rgba8 clay{201, 186, 168, 255};

/// World coordinate along up, as offset + float.
ScalarField elevation(const PointCloud& cloud) {
  const dvec3 up = up_vector(cloud.up);
  ScalarField field{"elevation", glm::dot(up, cloud.origin), {}, StoredType::float32};
  field.values.reserve(cloud.size());
  for (const vec3& p : cloud.positions) field.values.push_back(glm::dot(vec3(up), p));
  return field;
}

/// Some heights as a field.
ScalarField field_of(const std::vector<double>& heights) {
  ScalarField field{"elevation", heights.front(), {}, StoredType::float32};
  for (const double height : heights) field.values.push_back(float(height - field.offset));
  return field;
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

/// Between even steps of height and even numbers of points (histogram equalization): most of land is ground,
/// which roofs and crowns above it leave in one colour. Readers mark .35 and .7 higher than 0
/// (docs/measurements/first_view.md).
std::vector<double> places_by_number(const ScalarField& field, const std::array<double, 2>& range) {
  constexpr double by_number = 0.35;
  constexpr std::size_t steps = 32;
  const double span = range[1] - range[0];
  if (!(span > 0)) return {};
  std::array<std::size_t, steps> counts{};
  std::size_t all = 0;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    const double place = (field.value(i) - range[0]) / span * double(steps);
    if (place >= 0 && place <= double(steps)) ++counts[std::min(steps - 1, std::size_t(place))], ++all;
  }
  if (all == 0) return {};
  std::vector<double> places{0};
  std::size_t below = 0;
  for (std::size_t step = 0; step < steps; ++step) {
    below += counts[step];
    places.push_back(std::lerp(double(step + 1) / double(steps), double(below) / double(all), by_number));
  }
  return places;
}

/// `deciding`: the values that the range and the places are for.
void color_scalar(const ScalarField& field, const ScalarField& deciding, const ColorSettings& settings,
                  Coloring& out) {
  out.kind = ColorKind::scalar;
  out.colormap = !settings.colormap.empty()  ? settings.colormap
                 : out.source == "intensity" ? "gray"
                 : out.source == "elevation" ? "land"
                                             : "viridis";
  const bool is_height = out.source == "elevation";
  const std::array<double, 2> range =
      settings.range ? *settings.range : stretch(deciding, is_height, out.source == "intensity");
  out.low = range[0], out.high = range[1];
  const bool is_own = settings.range || !settings.colormap.empty();
  out.places = is_height && !is_own ? places_by_number(deciding, range) : settings.places;
  const Colormap map = out.ramp();
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

/// A colour for each of so many groups that nobody reads their numbers: neighbours in number, which are so in
/// space, differ. Hues are a golden section of the circle apart, and three lightnesses take turns.
void color_groups(const ScalarField& field, Coloring& out) {
  out.kind = ColorKind::files;
  out.colors.reserve(field.values.size());
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (!std::isfinite(field.values[i])) {
      out.colors.push_back(unknown_gray);
      continue;
    }
    const long number = std::abs(number_of(field, i));
    const double hue = 6 * std::fmod(double(number) * 0.6180339887498949, 1);
    const double value = 0.95 - 0.15 * double(number % 3);
    std::array<std::uint8_t, 3> code;
    for (int k = 0; k < 3; ++k) {  // HSV of saturation 0.6
      const double turn = std::fmod(hue + std::array{5.0, 3.0, 1.0}[std::size_t(k)], 6);
      code[std::size_t(k)] =
          std::uint8_t(std::lround(255 * value * (1 - 0.6 * std::clamp(std::min(turn, 4 - turn), 0.0, 1.0))));
    }
    out.colors.push_back({code[0], code[1], code[2], 255});
  }
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

/// A scan of which a tenth is lighter than this is light enough: sRGB 211 of its strongest channel. Readers
/// mark .65 higher than .24, .36, .5 and .8 (docs/measurements/first_view.md).
constexpr float light_enough = 0.65f, most_exposure = 8;
/// More shows the noise of dark colours: half of it, in stops, is taken.
constexpr float clean_exposure = 3;
/// Nobody sees less, and the file's own colours are worth more.
constexpr float least_exposure = 1.1f;
/// Less is as when a photograph is developed: not worth a line.
constexpr float told_exposure = 2;

/// Brings the colour that a tenth of the points exceed to `light_enough`, or towards it.
double automatic_exposure(const std::vector<Rgba8>& colors) {
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  std::vector<std::uint8_t> strongest;
  for (std::size_t i = 0; i < colors.size(); i += stride)
    if (colors[i] != no_color) strongest.push_back(std::max({colors[i].r, colors[i].g, colors[i].b}));
  if (strongest.empty()) return 1;
  const float light = linear_from_srgb(value_at_share(strongest, 0.9));
  if (!(light > 0) || light >= light_enough) return 1;
  float exposure = light_enough * (1 - light) / (light * (1 - light_enough));
  if (exposure > clean_exposure) exposure = std::sqrt(clean_exposure * exposure);
  return exposure < least_exposure ? 1 : std::min(most_exposure, exposure);
}

/// Photographs in colour fade towards black: where more is black than in all other dark colours, also of four
/// bits a channel, it is what tools write for points that no photograph shows.
bool is_black_none(const std::vector<Rgba8>& colors) {
  constexpr int dark = 25;                        // of each channel
  constexpr std::size_t seen = 500, chance = 16;  // one in so many; points
  std::size_t black = 0, nearly = 0, grey = 0;
  for (const Rgba8& c : colors) {
    const int most = std::max({c.r, c.g, c.b});
    black += most == 0, nearly += most > 0 && most < dark, grey += c.r == c.g && c.g == c.b;
  }
  return black > nearly && black >= chance && seen * black > colors.size() && 2 * grey < colors.size();
}

Rgba8 median_but_black(const std::vector<Rgba8>& colors) {
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  Rgba8 median{0, 0, 0, 255};
  for (const auto channel : {&Rgba8::r, &Rgba8::g, &Rgba8::b}) {
    std::vector<std::uint8_t> values;
    for (std::size_t i = 0; i < colors.size(); i += stride)
      if (const Rgba8& c = colors[i]; c != no_color && (c.r | c.g | c.b) != 0) values.push_back(c.*channel);
    if (!values.empty()) median.*channel = value_at_share(values, 0.5);
  }
  return median;
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

bool are_labels(const std::vector<Rgba8>& colors) {
  constexpr int most_labels = 64;
  std::vector<bool> seen(std::size_t(1) << 24);
  int count = 0;
  for (const Rgba8& c : colors) {
    if (c == no_color) continue;
    const std::size_t code = std::size_t(c.r) << 16 | std::size_t(c.g) << 8 | c.b;
    if (seen[code]) continue;
    seen[code] = true;
    if (++count > most_labels) return false;
  }
  return true;
}

bool are_of_photographs(const std::vector<Rgba8>& colors) {
  // Of 38 public files of photographs 36 have fewer than .0005 such colours, two .01 and .02; of three with
  // ramps or labels .25 to 1 of them are such.
  constexpr double most_pure = 0.1;
  std::size_t pure = 0, all = 0;
  for (const Rgba8& c : colors) {
    if (c == no_color) continue;
    const auto [low, high] = std::minmax({c.r, c.g, c.b});
    ++all, pure += low == 0 && high == 255;
  }
  return double(pure) < most_pure * double(all) && !are_labels(colors);
}

Coloring color_points(const PointCloud& cloud, const ColorSettings& settings,
                      const std::vector<double>& shown_heights) {
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
    out.is_photographed = are_of_photographs(out.colors);
    if (settings.for_black) {
      out.for_black = *settings.for_black;
    } else if (out.is_photographed && settings.exposure != 1 && !cloud.scalar("opacity") &&
               is_black_none(out.colors)) {  // Gaussian splats are as black as their training left them
      out.for_black = median_but_black(out.colors);
      out.notes.push_back(
          "points that are 0 0 0, which no photograph shows, have the median colour; --exposure 1 leaves "
          "them");
    }
    for (Rgba8& c : out.colors)
      if ((c.r | c.g | c.b) == 0) c = out.for_black;
    out.exposure = settings.exposure.value_or(out.is_photographed ? automatic_exposure(out.colors) : 1);
    for (Rgba8& c : out.colors) c.a = 255;
    if (out.exposure != 1) expose(out.colors, out.exposure);
    if (out.exposure >= double(told_exposure) && !settings.exposure) {
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
  } else if (out.source == "cluster" && settings.colormap.empty() && !settings.range) {
    color_groups(*cloud.scalar(out.source), out);
  } else if (out.source == "elevation" && !cloud.scalar(out.source)) {
    const ScalarField heights = elevation(cloud);
    color_scalar(heights, shown_heights.empty() ? heights : field_of(shown_heights), settings, out);
  } else {
    const ScalarField& numbers = *cloud.scalar(out.source);
    color_scalar(numbers, numbers, settings, out);
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
  // WCAG 2.2 asks for a contrast of 3 of what is no text: with the dark page a luminance above 0.14, of the
  // luma of 105. One colour is lost on white with one of less than 1.5: above 0.65, of 210; what a third of
  // the points have is an outline of the whole.
  const vec3 white(1), dark(0.11f, 0.12f, 0.13f);
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / 65'536);
  std::size_t light = 0, deep = 0, seen = 0, votes = 0, same = 0;
  Rgba8 most{};  // what more than half have (Boyer and Moore 1981)
  for (std::size_t i = 0; i < colors.size(); i += stride, ++seen) {
    light += luma(colors[i]) > 210, deep += luma(colors[i]) < 105;
    if (votes == 0) most = colors[i];
    votes += colors[i] == most ? 1 : std::size_t(-1);
  }
  for (std::size_t i = 0; i < colors.size(); i += stride) same += colors[i] == most;
  if (double(same) >= 0.95 * double(seen)) return 3 * light > seen ? dark : white;
  return 2 * deep > seen ? white : dark;
}

Colormap Coloring::ramp() const {
  const Colormap map = Colormap::named(colormap);
  return places.empty() ? map : map.spread(places);
}

Rgba8 Coloring::color_of_class(int id) const {
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k].id == id) return swatches[k].color;
  return class_color(id);
}

}  // namespace sfumato
