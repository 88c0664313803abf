#include "io/text_dialect.h"

#include <algorithm>
#include <cctype>

namespace sfumato::io {
namespace {

bool is_bracket(char c) { return std::string_view("()[]{}").find(c) != std::string_view::npos; }

/// A word that is no number becomes one word without blanks and separators; `cell` is between separators.
void join_words(std::string& line, std::size_t begin, std::size_t end) {
  while (begin < end && is_blank(line[begin])) ++begin;
  while (end > begin && is_blank(line[end - 1])) --end;
  for (std::size_t i = begin; i < end; ++i)
    if (is_blank(line[i]) || is_separator(line[i])) line[i] = '_';
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
  bool is_quoted = false;
  for (char& c : line) {
    is_quoted = quotes && c == '"' ? !is_quoted : is_quoted;
    if (c == ',' && decimal_commas) c = '.';
    if (c == '"' && quotes && cells == 0) c = ' ';
    if (brackets && is_bracket(c)) c = ' ';
    if (is_quoted && cells != 0 && (c == cells || c == ',')) c = '.';
  }
  if (cells == 0) return;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(cells, at), line.size());
    for (std::size_t i = at; i < end; ++i)
      if (line[i] == '"') line[i] = ' ';
    join_words(line, at, end);
    if (end < line.size()) line[end] = ',';
    at = end + 1;
  }
}

bool has_brackets(std::string_view line) {
  const char* end = line.data() + line.size();
  const char *at = skip_blanks(line.data(), end), *const first = at;
  while (end > at && (is_blank(end[-1]) || is_separator(end[-1]))) --end;
  if (at == end || !is_bracket(*first) || !is_bracket(end[-1])) return false;
  while (at < end && (is_bracket(*at) || is_blank(*at))) ++at;
  double value = 0;
  return parse_plain_number(at, end, value) != nullptr;
}

char cells_of_lines(const std::vector<std::string>& lines) {
  for (const char separator : {';', '\t', ','}) {
    const auto count = [&](const std::string& line) {
      return std::count(line.begin(), line.end(), separator);
    };
    if (lines.empty() || count(lines[0]) < 2) continue;
    if (std::all_of(lines.begin(), lines.end(),
                    [&](const std::string& line) { return count(line) == count(lines[0]); }))
      return separator;
  }
  return 0;
}

Commas commas_of(std::string_view line) {
  int words = 0, with_comma = 0;
  for (const char *at = line.data(), *end = at + line.size(); (at = skip_blanks(at, end)) < end;) {
    const char* word = at;
    while (at < end && !is_blank(*at) && *at != ';') ++at;
    const std::string_view text(word, std::size_t(at - word));
    at = skip_blanks(at, end);
    if (at < end && *at == ';') ++at;
    const auto is_letter = [](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) && c != 'e' && c != 'E';
    };
    if (std::any_of(text.begin(), text.end(), is_letter)) continue;  // no number, whatever its commas are
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

}  // namespace sfumato::io
