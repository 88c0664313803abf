#include "io/text_dialect.h"

#include <algorithm>
#include <cctype>

namespace sfumato::io {
namespace {

std::string clean_name(std::string_view word) {
  const auto is_around = [](char c) { return c == '"' || is_blank(c); };
  while (!word.empty() && (word.front() == '/' || word.front() == '#' || is_around(word.front())))
    word.remove_prefix(1);
  if (const std::size_t unit = word.find_first_of("[("); unit != 0) word = word.substr(0, unit);
  while (!word.empty() && is_around(word.back())) word.remove_suffix(1);
  return std::string(word);
}

void use_names_of_axes(std::vector<std::string>& names) {
  static const std::vector<std::string> words[3] = {
      {"easting", "east", "e", "x_coord", "coord_x", "pos_x", "points:0", "points_0"},
      {"northing", "north", "n", "y_coord", "coord_y", "pos_y", "points:1", "points_1"},
      {"elevation", "height", "altitude", "elev", "alt", "h", "z_coord", "coord_z", "pos_z", "points:2",
       "points_2"}};
  std::vector<std::string> low = names;
  for (std::string& name : low)
    for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string own(1, "xyz"[axis]);
    if (std::find(low.begin(), low.end(), own) != low.end()) continue;
    for (const std::string& word : words[axis])
      if (const auto found = std::find(low.begin(), low.end(), word); found != low.end()) {
        names[std::size_t(found - low.begin())] = own;
        break;
      }
  }
}

}  // namespace

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    const char* word = at;
    while (at < end && !is_blank(*at) && !is_separator(*at)) ++at;
    words.emplace_back(word, std::size_t(at - word));
    at = skip_blanks(at, end);
    if (at < end && is_separator(*at)) ++at;
  }
  return words;
}

void Dialect::translate(std::string& line) const {
  for (char& c : line) {
    if (c == ',' && decimal_commas) c = '.';
    if (c == '"' && quotes) c = ' ';
  }
}

Commas commas_of(std::string_view line) {
  int words = 0, with_comma = 0;
  for (const char *at = line.data(), *end = at + line.size(); (at = skip_blanks(at, end)) < end;) {
    const char* word = at;
    while (at < end && !is_blank(*at) && *at != ';') ++at;
    const std::string_view text(word, std::size_t(at - word));
    at = skip_blanks(at, end);
    if (at < end && *at == ';') ++at;
    ++words;
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) continue;
    const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    if (comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1) ||
        text.find(',', comma + 1) != std::string_view::npos)
      return Commas::separating;
    ++with_comma;
  }
  return with_comma == 0 ? Commas::none : words >= 2 ? Commas::decimal : Commas::separating;
}

std::vector<std::string> names_in(std::string_view line, std::size_t width) {
  std::vector<std::string> names;
  for (std::string_view word : split(line))
    if (std::string name = clean_name(word); !name.empty()) names.push_back(std::move(name));
  for (const char separator : {';', ',', '\t'}) {
    if (names.size() == width) break;
    names.clear();
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find(separator, at), line.size());
      names.push_back(clean_name(line.substr(at, end - at)));
      at = end + 1;
    }
  }
  if (names.size() != width) return {};
  use_names_of_axes(names);
  return names;
}

}  // namespace sfumato::io
