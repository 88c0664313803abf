// A parameter is written once, next to its default: command line flags, presets, docs tables, viewer sliders
// and sweeps in tests all read the same list.
//
//   void Points::describe(ParamList& p) {
//     p.add("point_size", point_size).range(0.1, 64).help("factor on the automatic size");
//   }
#pragma once

#include <concepts>
#include <functional>
#include <type_traits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace sfumato {

/// A metric parameter that finds its own value unless the user gives one. `auto` is a state, not a magic
/// number.
template <class T>
struct Auto {
  std::optional<T> user;  ///< what the user asked for
  T resolved{};           ///< what `resolve` chose last; shown by --json
  bool is_auto() const { return !user.has_value(); }
  T value() const { return user ? *user : resolved; }
  /// Sets the automatic value and returns the one in force.
  T resolve(T automatic) {
    resolved = user ? *user : automatic;
    return resolved;
  }
  /// Whether the same was asked for.
  bool operator==(const Auto& other) const { return user == other.user; }
};

enum class ParamKind { boolean, integer, real, choice, text, real_list, vector3 };

/// References and metadata; owns nothing but its texts. Values travel as text in one spelling: `true`, `12`,
/// `0.5`, `adaptive`, `0.3,0.5,1`, `auto`.
class Param {
 public:
  std::string name;  ///< snake_case; the command line spells it with dashes
  ParamKind kind = ParamKind::real;
  std::string default_text;
  std::vector<std::string> choices;
  std::optional<double> min, max;
  bool can_be_auto = false;
  bool is_point_size = false;  ///< `+` and `-` in a window change it
  std::string unit_text, help_text, paper_text;

  Param& range(double lo, double hi) {
    min = lo, max = hi;
    return *this;
  }
  Param& at_least(double lo) {
    min = lo;
    return *this;
  }
  Param& unit(std::string text) {
    unit_text = std::move(text);
    return *this;
  }
  Param& help(std::string text) {
    help_text = std::move(text);
    return *this;
  }
  Param& paper(std::string text) {
    paper_text = std::move(text);
    return *this;
  }
  /// How large points, or what is drawn in their place, are.
  Param& point_size() {
    is_point_size = true;
    return *this;
  }

  /// Current value as text (`auto` while automatic).
  std::string get() const { return print_(); }
  /// Current value as text, with `auto` replaced by what was resolved.
  std::string resolved() const { return print_resolved_ ? print_resolved_() : print_(); }
  /// Parses and checks range or choice; throws `Error(usage)` that names the parameter and what is allowed.
  void set(std::string_view text);

 private:
  friend class ParamList;
  std::function<std::string()> print_, print_resolved_;
  std::function<bool(std::string_view)> parse_;   // false: not of this kind
  std::function<std::vector<double>()> numbers_;  // for the range check
};

class ParamList {
 public:
  Param& add(std::string name, bool& value);
  Param& add(std::string name, int& value);
  Param& add(std::string name, float& value);
  Param& add(std::string name, std::string& value);
  Param& add(std::string name, std::vector<float>& value);
  Param& add(std::string name, vec3& value);
  Param& add(std::string name, Auto<float>& value);
  Param& add(std::string name, Auto<int>& value);
  Param& add(std::string name, Auto<bool>& value);
  Param& add(std::string name, Auto<std::vector<float>>& value);
  /// An enum class whose values 0,1,2... are spelled by `names`.
  template <class E>
  requires std::is_enum_v<E> Param& add(std::string name, E& value, std::vector<std::string> names) {
    return add_choice(
        std::move(name), std::move(names), [&value] { return int(value); },
        [&value](int i) { value = E(i); });
  }

  /// By name, underscores or dashes; null when there is none.
  Param* find(std::string_view name);
  const Param* find(std::string_view name) const { return const_cast<ParamList*>(this)->find(name); }
  const std::vector<Param>& all() const { return params_; }
  std::vector<Param>& all() { return params_; }

 private:
  Param& add_choice(std::string name, std::vector<std::string> names, std::function<int()> get,
                    std::function<void(int)> set);
  template <class T>
  Param& add_auto(std::string name, ParamKind kind, Auto<T>& value);
  Param& insert(Param param);
  std::vector<Param> params_;
};

/// A whole number as people write counts: 12, 1e6, 250k, 2M, 1.5M. Nothing when it is none.
std::optional<double> parse_count(std::string_view text);

/// The candidate nearest to `word` by edit distance, for "did you mean"; empty when nothing is near.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace sfumato
