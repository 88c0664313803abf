// Values of options as people write them. All throw Error(usage) that names the option.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato {

/// A number as the shortest text that reads back the same.
std::string number_text(double value);
std::string number_text(float value);
double parse_number(const std::string& option, std::string_view text);
double parse_positive(const std::string& option, const std::string& text);
/// true, on, yes or 1, or their opposites.
bool parse_flag(const std::string& option, std::string_view text);
/// Degrees in [low, high].
double parse_degrees(const std::string& option, const std::string& text, double low, double high);
/// Also as 1e6, 250k or 2M.
long parse_whole(const std::string& option, std::string_view text, long least);
std::vector<double> parse_numbers(const std::string& option, std::string_view text, std::size_t count,
                                  const std::string& form = "");
/// A place or a direction, "X,Y,Z".
dvec3 parse_vector(const std::string& option, const std::string& text);
/// "X0,Y0,Z0,X1,Y1,Z1", the smaller numbers first.
Bounds parse_box(const std::string& option, const std::string& text);
/// "1280x720" or "1280,720".
std::pair<int, int> parse_resolution(const std::string& option, std::string_view text);
/// Codes of classes, "2,6"; `none` and nothing are none.
std::vector<int> parse_classes(const std::string& option, const std::string& text);
std::string classes_text(const std::vector<int>& classes);
/// sRGB 0..1; one that nobody knows names the nearest.
vec3 parse_color_of(const std::string& option, const std::string& text);
/// Words as a line that a POSIX shell reads back.
std::string quote(const std::vector<std::string>& words);
std::vector<std::string> split(std::string_view text, char separator);

}  // namespace sfumato
