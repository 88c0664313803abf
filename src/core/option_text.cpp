#include "core/option_text.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/color.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/param.h"

namespace sfumato {
namespace {

template <class T>
std::string shortest(T value) {
  char text[64];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc() ? std::string(text, end) : std::string("0");
}

}  // namespace

std::string number_text(double value) { return shortest(value); }
std::string number_text(float value) { return shortest(value); }

double parse_number(const std::string& option, std::string_view text) {
  const std::optional<double> value = parse_real(text);
  if (!value || !std::isfinite(*value)) {
    const std::string shown(text);
    const bool comma = shown.find(',') != std::string::npos;
    throw Error(ErrorCode::usage, option + ": '" + shown + "' is not a number" +
                                      (comma ? "; write decimals with a point: 1.5" : ""));
  }
  return *value;
}

bool parse_flag(const std::string& option, std::string_view text) {
  for (const char* yes : {"true", "on", "yes", "1"})
    if (text == yes) return true;
  for (const char* no : {"false", "off", "no", "0"})
    if (text == no) return false;
  throw Error(ErrorCode::usage, option + ": '" + std::string(text) + "' is not true or false");
}

long parse_whole(const std::string& option, std::string_view text, long least) {
  const std::optional<double> value = parse_count(text);
  if (!value || *value < double(least) || *value > 9e15)
    throw Error(ErrorCode::usage, option + ": '" + std::string(text) +
                                      "' is not a whole number of at least " + std::to_string(least) +
                                      " (1000, 250k, 2M, 1e6)");
  return long(*value);
}

std::vector<double> parse_numbers(const std::string& option, std::string_view text, std::size_t count,
                                  const std::string& form) {
  std::vector<double> values;
  for (const std::string& word : split(text, ',')) values.push_back(parse_number(option, word));
  if (values.size() != count)
    throw Error(ErrorCode::usage, option + ": '" + std::string(text) + "' is not " + std::to_string(count) +
                                      " numbers separated by commas" +
                                      (values.size() == 2 * count ? "; write decimals with a point: 1.5"
                                       : form.empty()             ? ""
                                                                  : "; write " + form));
  return values;
}

Bounds parse_box(const std::string& option, const std::string& text) {
  const std::vector<double> v = parse_numbers(
      option, text, 6, "X0,Y0,Z0,X1,Y1,Z1: the corner of the smallest numbers, then that of the largest");
  const Bounds box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  for (int k = 0; k < 3; ++k)
    if (box.min[k] > box.max[k])
      throw Error(ErrorCode::usage, option + ": '" + text + "' is empty along " + std::string(1, "xyz"[k]) +
                                        "; write X0,Y0,Z0,X1,Y1,Z1 with the smaller numbers first");
  return box;
}

std::pair<int, int> parse_resolution(const std::string& option, std::string_view text) {
  const std::size_t cut = text.find_first_of("xX,");
  const std::string shape = option + ": '" + std::string(text) + "' is not WIDTHxHEIGHT, such as 1920x1080";
  if (cut == std::string_view::npos) throw Error(ErrorCode::usage, shape);
  const auto side = [&](std::string_view part) {
    const std::optional<double> value = parse_count(part);
    if (!value || *value < 1 || *value > 65536)
      throw Error(ErrorCode::usage, shape + ", of 1 to 65536 pixels a side");
    return int(*value);
  };
  return {side(text.substr(0, cut)), side(text.substr(cut + 1))};
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> words;
  while (true) {
    const std::size_t cut = text.find(separator);
    words.emplace_back(text.substr(0, cut));
    if (cut == std::string_view::npos) return words;
    text.remove_prefix(cut + 1);
  }
}

double parse_positive(const std::string& option, const std::string& text) {
  const double value = parse_number(option, text);
  if (value <= 0) throw Error(ErrorCode::usage, option + ": '" + text + "' is not more than 0");
  return value;
}

double parse_degrees(const std::string& option, const std::string& text, double low, double high) {
  const double value = parse_number(option, text);
  if (value < low || value > high) {
    std::ostringstream why;
    why << option << ": " << text << " degrees is outside [" << low << ", " << high << "]";
    throw Error(ErrorCode::usage, why.str());
  }
  return value;
}

dvec3 parse_vector(const std::string& option, const std::string& text) {
  const std::vector<double> v = parse_numbers(option, text, 3, "X,Y,Z");
  for (double number : v)
    if (std::abs(number) > 1e15)
      throw Error(ErrorCode::usage, option + ": '" + text + "' is beyond 1e15, where no point can be seen");
  return {v[0], v[1], v[2]};
}

std::vector<int> parse_classes(const std::string& option, const std::string& text) {
  std::vector<int> codes;
  if (text.empty() || text == "none") return codes;
  for (const std::string& code : split(text, ',')) {
    const long id = parse_whole(option, code, 0);
    if (id > 255)
      throw Error(ErrorCode::usage, option + ": class " + code + " is beyond 255, the last there is");
    codes.push_back(int(id));
  }
  return codes;
}

std::string classes_text(const std::vector<int>& classes) {
  std::string text;
  for (int id : classes) text += (text.empty() ? "" : ",") + std::to_string(id);
  return text.empty() ? "none" : text;
}

vec3 parse_color_of(const std::string& option, const std::string& text) {
  if (const auto color = parse_color(text)) return *color;
  const std::string near = nearest_color(text);
  throw Error(ErrorCode::usage,
              option + ": '" + text + "' is no colour" +
                  (near.empty() ? "." : "; did you mean " + near + "?") +
                  " Write a name (steelblue), #hex (#4682b4) or R,G,B in 0..1 (0.27,0.51,0.71)");
}

std::string quote(const std::vector<std::string>& words) {
  static const std::string plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%^";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace sfumato
