// "classification 3-5: soft opacity=0.2": which points of a scene are drawn how.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/selector.h"
#include "session/look.h"

namespace sfumato {

struct DrawRule {
  std::string text;
  Selector selector;
  std::string technique;                                        ///< or `none`
  std::vector<std::pair<std::string, std::string>> parameters;  ///< as Look::set takes them

  static constexpr const char* none = "none";

  /// "SELECTION: TECHNIQUE [name=value ...]", or "SELECTION: none", which leaves the points out. What the
  /// technique has of its own for selected points comes before (Technique::of_selected). Throws Error(usage)
  /// for what is no selection (core/selector.h), technique or parameter of it.
  static DrawRule parse(std::string_view text);
  bool operator==(const DrawRule& other) const { return text == other.text; }
  bool draws_nothing() const { return technique == none; }
  /// A look by this rule in the light of `base`; not of one that draws nothing.
  std::unique_ptr<Look> look(const Look& base) const;
  /// Whether both draw alike.
  bool draws_like(const DrawRule& other) const {
    return technique == other.technique && parameters == other.parameters;
  }
};

/// The rule of each point: the place of the first that selects it, rules.size() for none.
std::vector<std::uint32_t> first_matches(const std::vector<DrawRule>& rules, const PointCloud& cloud);

}  // namespace sfumato
