#include "session/draw_rule.h"

#include <algorithm>

#include "core/error.h"

namespace sfumato {

DrawRule DrawRule::parse(std::string_view text) {
  DrawRule rule;
  rule.text = std::string(text);
  const std::size_t colon = text.find(':');
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::usage,
                "--draw: '" + rule.text + "': " + why +
                    "; write \"SELECTION: TECHNIQUE [name=value ...]\", such as \"classification 3-5: soft "
                    "opacity=0.2\"");
  };
  if (colon == std::string_view::npos) refuse("there is no colon between selection and technique");
  rule.selector = Selector::parse(text.substr(0, colon));
  std::vector<std::string> words;
  for (std::size_t at = colon + 1; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (end > at) words.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  if (words.empty()) refuse("the technique is missing");
  if (words[0] == none) {
    if (words.size() > 1) refuse("'none' draws nothing and has no parameters");
    rule.technique = none;
    return rule;
  }
  rule.technique = find_technique(words[0]).name;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    if (equals == std::string::npos) refuse("'" + words[i] + "' is no name=value");
    rule.parameters.emplace_back(words[i].substr(0, equals), words[i].substr(equals + 1));
  }
  Look look(rule.technique);
  const Technique::Values suited = look.technique->of_selected(rule.parameters);
  rule.parameters.insert(rule.parameters.begin(), suited.begin(), suited.end());
  for (const auto& [name, value] : rule.parameters) look.set(name, value);
  return rule;
}

std::unique_ptr<Look> DrawRule::look(const Look& base) const {
  auto look = std::make_unique<Look>(technique);
  look->take_over(base, true);
  for (const auto& [name, value] : parameters) look->set(name, value);
  return look;
}

std::vector<std::uint32_t> first_matches(const std::vector<DrawRule>& rules, const PointCloud& cloud) {
  const std::uint32_t none = std::uint32_t(rules.size());
  std::vector<std::uint32_t> places(cloud.size(), none);
  for (std::uint32_t r = 0; r < none; ++r) {
    const std::vector<bool> chosen = rules[r].selector.matches(cloud);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] == none && chosen[i]) places[i] = r;
  }
  return places;
}

}  // namespace sfumato
