#include "core/selector.h"

#include <algorithm>
#include <limits>

#include "core/classes.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/param.h"

namespace sfumato {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::string_view trim(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cut(std::string_view text, std::string_view by) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t next = text.find(by, at);
    parts.push_back(trim(text.substr(at, next == std::string_view::npos ? next : next - at)));
    if (next == std::string_view::npos) return parts;
    at = next + by.size();
  }
}

[[noreturn]] void selects_nothing(const std::string& whole, const std::string& why) {
  throw Error(ErrorCode::usage,
              "'" + whole + "' selects nothing: " + why +
                  "; write *, \"classification 3-5\", \"intensity 10..200\", \"file 2\", \"box "
                  "x0,y0,z0,x1,y1,z1\", joined by and / not");
}

/// "vegetation" is low, medium and high vegetation: every class whose name ends in the word.
std::vector<int> classes_of_group(std::string_view word) {
  std::vector<int> found;
  for (int id = 0; id < 23; ++id)
    if (const std::string name = class_name(id); name.ends_with(" " + std::string(word))) found.push_back(id);
  return found;
}

std::string nearest_class(std::string_view name) {
  std::vector<std::string> names;
  for (int id = 0; id < 19; ++id) names.push_back(class_name(id));
  return nearest_word(name, names);
}

}  // namespace

Selector Selector::parse(std::string_view text) {
  Selector selector;
  selector.text_ = std::string(trim(text));
  for (std::string_view term : cut(selector.text_, " and "))
    selector.terms_.push_back(parse_term(term, selector.text_));
  return selector;
}

Selector::Term Selector::parse_term(std::string_view text, const std::string& whole) {
  Term term;
  while (text.starts_with("not ")) {
    term.negated = !term.negated;
    text = trim(text.substr(4));
  }
  if (text == "*") return term;
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos)
    selects_nothing(whole, text.empty() ? "a term is missing" : "'" + std::string(text) + "' has no range");
  if (text.starts_with("box ")) {
    term.kind = Term::Kind::box;
    std::vector<double> numbers;
    for (std::string_view part : cut(text.substr(4), ",")) {
      const auto number = parse_real(part);
      if (!number) selects_nothing(whole, "'" + std::string(part) + "' is no number");
      numbers.push_back(*number);
    }
    if (numbers.size() != 6) selects_nothing(whole, "a box has six numbers");
    term.box = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    if (glm::any(glm::greaterThan(term.box.min, term.box.max))) selects_nothing(whole, "its box is empty");
    return term;
  }
  term.kind = Term::Kind::scalar;
  const bool is_class = text.starts_with("class ") || text.starts_with("classification ");
  // Names of classes have blanks, and so have names of scalars.
  const std::size_t end = is_class ? blank : text.rfind(' ');
  term.scalar = is_class ? "classification" : std::string(trim(text.substr(0, end)));
  for (std::string_view part : cut(text.substr(end + 1), ",")) {
    if (const auto id = is_class ? class_named(part) : std::nullopt) {
      term.ranges.push_back({double(*id), double(*id)});
      continue;
    }
    if (const auto number = parse_real(part)) {
      term.ranges.push_back({*number, *number});
      continue;
    }
    if (const std::vector<int> group = is_class ? classes_of_group(part) : std::vector<int>();
        !group.empty()) {
      for (const int id : group) term.ranges.push_back({double(id), double(id)});
      continue;
    }
    // "3-5", "-2..-1", "3..", "..5"
    std::size_t at = part.find(".."), size = 2;
    if (at == std::string_view::npos) at = part.find('-', 1), size = 1;
    const auto low = at == std::string_view::npos ? std::nullopt : parse_real(part.substr(0, at)),
               high = at == std::string_view::npos ? std::nullopt : parse_real(part.substr(at + size));
    const bool open_low = size == 2 && at == 0,
               open_high = size == 2 && at != std::string_view::npos && at + 2 == part.size();
    if ((!low && !open_low) || (!high && !open_high) || (open_low && open_high)) {
      const std::string near = is_class ? nearest_class(part) : "";
      selects_nothing(whole, "'" + std::string(part) + "' is no number, range" +
                                 (is_class ? " or class" : "") +
                                 (near.empty() ? "" : " (did you mean '" + near + "'?)"));
    }
    term.ranges.push_back({low.value_or(-infinite), high.value_or(infinite)});
    if (term.ranges.back().low > term.ranges.back().high)
      selects_nothing(whole, "the range " + std::string(part) + " is empty");
  }
  return term;
}

std::vector<bool> Selector::matches(const PointCloud& cloud) const {
  std::vector<bool> chosen(cloud.size(), true);
  for (const Term& term : terms_) {
    std::function<bool(std::size_t)> holds = [](std::size_t) { return true; };
    if (term.kind == Term::Kind::box) {
      holds = [&](std::size_t i) {
        const dvec3 p = cloud.world(i);
        return glm::all(glm::greaterThanEqual(p, term.box.min)) &&
               glm::all(glm::lessThanEqual(p, term.box.max));
      };
    } else if (term.kind == Term::Kind::scalar) {
      // One file needs no number to tell it from others.
      const bool is_only_file = term.scalar == "file" && !cloud.scalar("file");
      const auto number = numbers_of(cloud, term.scalar);
      if (!number && !is_only_file) throw Error(ErrorCode::usage, no_such_number(cloud, term.scalar));
      holds = [&term, number](std::size_t i) {
        const double value = number ? number(i) : 1;
        return std::any_of(term.ranges.begin(), term.ranges.end(),
                           [&](const Range& range) { return value >= range.low && value <= range.high; });
      };
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = chosen[i] && holds(i) != term.negated;
  }
  return chosen;
}

}  // namespace sfumato
