#include "core/selection.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include "core/classes.h"
#include "core/numbers.h"

namespace sfumato {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, message); }

std::string text_of(double value) {
  char buffer[64];
  // Fifteen digits: 848935.2, not 848935.2000000001.
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 15).ptr};
}

std::string text_of(const dvec3& v) { return text_of(v.x) + "," + text_of(v.y) + "," + text_of(v.z); }

/// A box with as many digits as tell it from its neighbours, none of its points outside.
std::string rounded_outwards(const Bounds& box) {
  const dvec3 size = box.max - box.min;
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return text_of(box.min) + "," + text_of(box.max);
  const double steps = std::pow(10.0, 4 - std::floor(std::log10(longest)));  // of 1e-4 to 1e-5 of it
  return text_of(glm::floor(box.min * steps) / steps) + "," + text_of(glm::ceil(box.max * steps) / steps);
}

std::string list_classes(const std::map<int, std::size_t>& counts) {
  std::string text;
  for (const auto& [id, points] : counts)
    text += (text.empty() ? "" : ", ") + std::to_string(id) + " " + class_name(id);
  return text;
}

/// Keeps what `wanted` says and returns how many went.
std::size_t keep(PointCloud& cloud, const std::function<bool(std::size_t)>& wanted) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (wanted(i)) kept.push_back(std::uint32_t(i));
  const std::size_t gone = cloud.size() - kept.size();
  if (gone > 0) cloud = select(cloud, kept);
  return gone;
}

std::size_t crop_to(PointCloud& cloud, const Bounds& box, const Bounds& full) {
  const std::size_t gone = keep(cloud, [&](std::size_t i) {
    const dvec3 p = cloud.world(i);
    return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
  });
  if (cloud.empty())
    throw NothingSelected("no point lies in the crop " + text_of(box.min) + "," + text_of(box.max) +
                          ": the points lie in " + rounded_outwards(full));
  return gone;
}

void keep_classes(const Selection& selection, PointCloud& cloud, SelectionReport& report) {
  const ScalarField* code = cloud.scalar("classification");
  if (!code) {
    if (!selection.show_classes.empty())
      refuse("the points have no classification to choose from: leave out the classes to show");
    return;
  }
  const auto id_of = [&](std::size_t i) {
    return std::isfinite(code->values[i]) ? int(std::lround(code->value(i))) : -1;
  };
  std::map<int, std::size_t> counts;
  for (std::size_t i = 0; i < cloud.size(); ++i) ++counts[id_of(i)];
  counts.erase(-1);
  for (int id : selection.show_classes)
    if (!counts.contains(id))
      report.notes.push_back("class " + std::to_string(id) + " (" + class_name(id) +
                             ") does not occur; there are: " + list_classes(counts));
  if (selection.show_classes.empty()) return;
  const auto& shown = selection.show_classes;
  report.of_other_classes = keep(
      cloud, [&](std::size_t i) { return std::find(shown.begin(), shown.end(), id_of(i)) != shown.end(); });
  if (cloud.empty())
    throw NothingSelected("none of the classes to show occurs; there are: " + list_classes(counts));
}

void keep_filtered(const Filter& filter, PointCloud& cloud, SelectionReport& report) {
  const auto value = numbers_of(cloud, filter.scalar);
  if (!value) refuse(no_such_number(cloud, filter.scalar));
  double least = std::numeric_limits<double>::infinity(), most = -least;
  const std::size_t gone = keep(cloud, [&](std::size_t i) {
    const double v = value(i);
    least = std::min(least, v), most = std::max(most, v);
    return v >= filter.low && v <= filter.high;
  });
  report.filtered += gone;
  if (cloud.empty())
    throw NothingSelected("no point is left by the filter '" + filter.scalar + " " + text_of(filter.low) +
                          ".." + text_of(filter.high) + "': " + filter.scalar + " goes from " +
                          text_of(least) + " to " + text_of(most));
  if (gone == 0)
    report.notes.push_back("the filter on " + filter.scalar + " keeps every point: it goes from " +
                           text_of(least) + " to " + text_of(most));
}

}  // namespace

Filter parse_filter(std::string_view text) {
  const std::string shown(text);
  const auto fail = [&](const std::string& why = "") {
    refuse("'" + shown + "' is no filter" + why +
           ": write SCALAR A..B, such as \"intensity 10..200\", \"z 3..\" or \"row ..5\"");
  };
  while (text.ends_with(' ')) text.remove_suffix(1);
  const std::size_t cut = text.find_last_of(" =");
  if (cut == std::string_view::npos || cut == 0) fail();
  Filter filter;
  filter.scalar = std::string(text.substr(0, cut));
  while (!filter.scalar.empty() && (filter.scalar.back() == ' ' || filter.scalar.back() == '='))
    filter.scalar.pop_back();
  const std::string_view range = text.substr(cut + 1);
  const std::size_t dots = range.find("..");
  const std::string_view from = range.substr(0, dots);
  const std::string_view to = dots == std::string_view::npos ? from : range.substr(dots + 2);
  if (range == ".." || filter.scalar.empty()) fail();
  for (const auto& [part, end] : {std::pair(from, &filter.low), std::pair(to, &filter.high)}) {
    if (part.empty() && dots != std::string_view::npos) continue;
    const auto number = parse_real(part);
    if (!number) fail(" ('" + std::string(part) + "' is no number)");
    *end = *number;
  }
  if (filter.low > filter.high) fail(" (its range is empty)");
  return filter;
}

SelectionReport apply(const Selection& selection, PointCloud& cloud) {
  SelectionReport report;
  if (selection.empty() || cloud.empty()) return report;
  const Bounds full = bounds(cloud);
  if (selection.crop) report.cropped += crop_to(cloud, *selection.crop, full);
  if (selection.crop_share) {
    const auto place = [&](const dvec3& share) {
      dvec3 p = full.min + share * full.size();
      for (int k = 0; k < 3; ++k)
        if (share[k] == 1) p[k] = full.max[k];  // rounding must not lose the last point
      return p;
    };
    report.cropped +=
        crop_to(cloud, {place(selection.crop_share->min), place(selection.crop_share->max)}, full);
  }
  keep_classes(selection, cloud, report);
  if (!selection.hide_classes.empty() || selection.hide_withheld)
    report.hidden = hide_classes(cloud, selection.hide_classes);
  if (cloud.empty())
    throw NothingSelected("every point is withheld or of a hidden class; show them with --hide-classes none");
  for (const Filter& filter : selection.filters) keep_filtered(filter, cloud, report);
  return report;
}

}  // namespace sfumato
