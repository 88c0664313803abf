#include "core/param.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/number_in.h"

namespace sfumato {
namespace {

template <class T>
bool parse_number(std::string_view text, T& out) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const std::optional<T> value = number_in<T>(text);
  if (!value) return false;
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(*value)) return false;
  out = *value;
  return true;
}

/// Whole parameters are also written as counts: 250k, 1e6.
bool parse_number(std::string_view text, int& out) {
  const std::optional<double> value = parse_count(text);
  if (!value || std::abs(*value) > double(std::numeric_limits<int>::max())) return false;
  out = int(*value);
  return true;
}

bool parse_bool(std::string_view text, bool& out) {
  if (text == "true" || text == "on" || text == "yes" || text == "1" || text.empty()) return out = true, true;
  if (text == "false" || text == "off" || text == "no" || text == "0") return out = false, true;
  return false;
}

std::string print_number(float value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};  // shortest text that reads back
}

bool parse_list(std::string_view text, std::vector<float>& out) {
  std::vector<float> values;
  while (true) {
    const std::size_t comma = text.find(',');
    float value;
    if (!parse_number(text.substr(0, comma), value)) return false;
    values.push_back(value);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  out = values;
  return true;
}

std::string print_list(const float* values, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i ? "," : "") + print_number(values[i]);
  return text;
}

/// A bound as people write it: 1000000, not 1e+06.
std::string print_bound(double value) {
  char buffer[400];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, float(value), std::chars_format::fixed).ptr};
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " | ") + word;
  return text;
}

std::string did_you_mean(std::string_view text, const std::vector<std::string>& choices) {
  bool on = false;
  if (parse_bool(text, on) && on && !text.empty() &&
      std::find(choices.begin(), choices.end(), "off") != choices.end()) {
    std::string kinds;  // "on" does not say which kind
    for (const std::string& choice : choices)
      if (choice != "off") kinds += (kinds.empty() ? "" : " or ") + choice;
    return "; say which: " + kinds;
  }
  const std::string near = nearest_word(text, choices);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

}  // namespace

void Param::set(std::string_view text) {
  const std::string before = print_();
  auto refuse = [&](const std::string& expected) {
    throw Error(ErrorCode::usage, "parameter '" + name + "': '" + std::string(text) + "' is not " + expected);
  };
  static const char* kinds[] = {
      "a boolean (true | false)",      "a whole number",       "a number", "", "a text",
      "a list of numbers (0.3,0.5,1)", "three numbers (X,Y,Z)"};
  if (!parse_(text))
    refuse((kind == ParamKind::choice ? "one of: " + join(choices) : std::string(kinds[int(kind)])) +
           (can_be_auto ? " or auto" : "") + did_you_mean(text, choices));
  for (double value : numbers_ ? numbers_() : std::vector<double>{}) {
    // Bounds are compared as floats, as the values are: 0.01 is in [0.01, 1].
    if ((!min || float(value) >= float(*min)) && (!max || float(value) <= float(*max))) continue;
    parse_(before);
    refuse("in range [" + (min ? print_bound(*min) : std::string("-inf")) + ", " +
           (max ? print_bound(*max) : std::string("inf")) + "]; the nearest is " +
           print_bound(min && value < *min ? *min : *max));
  }
}

Param& ParamList::insert(Param param) {
  param.default_text = param.print_();
  return params_.emplace_back(std::move(param));
}

Param& ParamList::add(std::string name, bool& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::boolean;
  p.print_ = [&value] { return std::string(value ? "true" : "false"); };
  p.parse_ = [&value](std::string_view text) { return parse_bool(text, value); };
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, int& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::integer;
  p.print_ = [&value] { return std::to_string(value); };
  p.parse_ = [&value](std::string_view text) { return parse_number(text, value); };
  p.numbers_ = [&value] { return std::vector<double>{double(value)}; };
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, float& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::real;
  p.print_ = [&value] { return print_number(value); };
  p.parse_ = [&value](std::string_view text) { return parse_number(text, value); };
  p.numbers_ = [&value] { return std::vector<double>{double(value)}; };
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, std::string& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::text;
  p.print_ = [&value] { return value; };
  p.parse_ = [&value](std::string_view text) { return value = std::string(text), true; };
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, std::vector<float>& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::real_list;
  p.print_ = [&value] { return print_list(value.data(), value.size()); };
  p.parse_ = [&value](std::string_view text) {
    if (text.empty()) return value.clear(), true;
    return parse_list(text, value);
  };
  p.numbers_ = [&value] { return std::vector<double>(value.begin(), value.end()); };
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, vec3& value) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::vector3;
  p.print_ = [&value] { return print_list(&value.x, 3); };
  p.parse_ = [&value](std::string_view text) {
    std::vector<float> numbers;
    if (const auto color = parse_color(text); color && !(text[0] >= '0' && text[0] <= '9') && text[0] != '.')
      return value = *color, true;  // a name or #hex where three numbers are a colour
    if (!parse_list(text, numbers) || numbers.size() != 3) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  };
  p.numbers_ = [&value] { return std::vector<double>{value.x, value.y, value.z}; };
  return insert(std::move(p));
}

namespace {

template <class T>
std::string print_any(T value) {
  if constexpr (std::is_same_v<T, bool>)
    return value ? "true" : "false";
  else if constexpr (std::is_same_v<T, int>)
    return std::to_string(value);
  else if constexpr (std::is_same_v<T, std::vector<float>>)
    return print_list(value.data(), value.size());
  else
    return print_number(value);
}

template <class T>
bool parse_any(std::string_view text, T& value) {
  if constexpr (std::is_same_v<T, bool>)
    return parse_bool(text, value);
  else if constexpr (std::is_same_v<T, std::vector<float>>)
    return parse_list(text, value);
  else
    return parse_number(text, value);
}

template <class T, class Print, class PrintResolved, class Parse, class Numbers>
void bind_auto(Auto<T>& value, Print& print, PrintResolved& print_resolved, Parse& parse, Numbers& numbers) {
  print = [&value] { return value.is_auto() ? std::string("auto") : print_any(*value.user); };
  print_resolved = [&value] { return print_any(value.value()); };
  parse = [&value](std::string_view text) {
    if (text == "auto") return value.user.reset(), true;
    T parsed{};
    if (!parse_any(text, parsed)) return false;
    value.user = parsed;
    return true;
  };
  numbers = [&value]() -> std::vector<double> {
    if (value.is_auto()) return {};
    if constexpr (std::is_same_v<T, std::vector<float>>)
      return {value.user->begin(), value.user->end()};
    else
      return {double(*value.user)};
  };
}

}  // namespace

template <class T>
Param& ParamList::add_auto(std::string name, ParamKind kind, Auto<T>& value) {
  Param p;
  p.name = std::move(name);
  p.kind = kind;
  p.can_be_auto = true;
  bind_auto(value, p.print_, p.print_resolved_, p.parse_, p.numbers_);
  return insert(std::move(p));
}

Param& ParamList::add(std::string name, Auto<float>& value) {
  return add_auto(std::move(name), ParamKind::real, value);
}

Param& ParamList::add(std::string name, Auto<int>& value) {
  return add_auto(std::move(name), ParamKind::integer, value);
}

Param& ParamList::add(std::string name, Auto<bool>& value) {
  return add_auto(std::move(name), ParamKind::boolean, value);
}

Param& ParamList::add(std::string name, Auto<std::vector<float>>& value) {
  return add_auto(std::move(name), ParamKind::real_list, value);
}

Param& ParamList::add_choice(std::string name, std::vector<std::string> names, std::function<int()> get,
                             std::function<void(int)> set) {
  Param p;
  p.name = std::move(name);
  p.kind = ParamKind::choice;
  p.choices = names;
  p.print_ = [names, get] { return names.at(std::size_t(get())); };
  p.parse_ = [names, set](std::string_view text) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) return false;
    set(int(found - names.begin()));
    return true;
  };
  return insert(std::move(p));
}

Param* ParamList::find(std::string_view name) {
  std::string snake(name);
  std::replace(snake.begin(), snake.end(), '-', '_');
  for (Param& param : params_)
    if (param.name == snake) return &param;
  return nullptr;
}

std::optional<double> parse_count(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  double unit = 1;
  if (!text.empty()) switch (text.back()) {
      case 'k':
      case 'K': unit = 1e3; break;
      case 'm':
      case 'M': unit = 1e6; break;
      case 'g':
      case 'G': unit = 1e9; break;
      default: break;
    }
  if (unit != 1) text.remove_suffix(1);
  const std::optional<double> number = number_in<double>(text);
  if (!number) return std::nullopt;
  const double value = *number * unit;
  // 2.3M is whole although 2.3 times a million in doubles need not be.
  if (!std::isfinite(value) || std::abs(value - std::round(value)) > 1e-9 * std::abs(value))
    return std::nullopt;
  return std::round(value);
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  // RGB is rgb, and Point-Size point_size.
  const auto same = [](char a, char b) {
    const auto plain = [](char c) { return c == '-' ? '_' : std::tolower(static_cast<unsigned char>(c)); };
    return plain(a) == plain(b);
  };
  std::string best;
  // A third of the letters may differ: two letters of a word of three make another word.
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);  // Levenshtein, one row at a time
    std::iota(row.begin(), row.end(), 0u);
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = std::exchange(row[0], i);
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t replace = diagonal + !same(word[i - 1], candidate[j - 1]);
        diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replace}));
      }
    }
    if (row.back() < best_distance) best_distance = row.back(), best = candidate;
  }
  return best;
}

}  // namespace sfumato
