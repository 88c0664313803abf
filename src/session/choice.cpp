#include "session/choice.h"

#include <algorithm>

#include "core/error.h"

namespace sfumato {

Choice::Choice(const std::string& names) {
  for (std::size_t at = 0; at <= names.size();) {
    const std::size_t end = std::min(names.find(',', at), names.size());
    const std::string name = names.substr(at, end - at);
    at = end + 1;
    const auto add = [&](const TechniqueInfo& info, bool candidate) {
      techniques.push_back(std::make_unique<ChosenTechnique>(info));
      techniques.back()->place = count;
      techniques.back()->candidate = techniques.back()->of_auto = candidate;
    };
    if (name == automatic_technique)
      for (const TechniqueInfo& info : all_techniques()) add(info, true);
    else
      add(find_technique(name), false);
    ++count;
  }
  prepare.describe(prepare_parameters);
}

void Choice::resolve(const TechniqueChoice& found) {
  if (!automatic()) return;
  const auto has_all = [&](ChosenTechnique& one, std::string* lacks) {
    for (const auto& [name, value] : given) {
      if (one.parameters.find(name) || prepare_parameters.find(name)) continue;
      const bool of_another = std::any_of(
          techniques.begin(), techniques.end(),
          [&, name = name](const auto& other) { return other->candidate && other->parameters.find(name); });
      if (of_another) return *lacks = name, false;
    }
    return true;
  };
  std::vector<std::unique_ptr<ChosenTechnique>> kept;
  for (std::size_t place = 0; place < count; ++place) {
    ChosenTechnique* best = nullptr;
    std::string lacks, reason = found.reason;
    for (const auto& one : techniques) {
      if (one->place != place) continue;
      if (!one->candidate || (one->name == found.technique && has_all(*one, &lacks))) best = one.get();
    }
    for (std::size_t i = 0; !best && i < techniques.size(); ++i)
      if (std::string other; techniques[i]->place == place && has_all(*techniques[i], &other)) {
        best = techniques[i].get();
        reason = "has --" + with_dashes(lacks) + ", which " + found.technique + " has not";
      }
    if (!best)
      throw Error(ErrorCode::usage,
                  "no technique has all the parameters given: choose with -t (sfumato techniques)");
    if (best->candidate) {
      best->candidate = false;
      best->reason = reason;
      best->surface_share = found.surface_share;
    }
    for (auto& one : techniques)
      if (one.get() == best) kept.push_back(std::move(one));
    std::erase(techniques, nullptr);
  }
  passed_over = std::move(techniques);
  techniques = std::move(kept);
}

void Choice::reopen() {
  for (auto& one : passed_over) techniques.push_back(std::move(one));
  passed_over.clear();
  for (auto& one : techniques) one->candidate = one->of_auto;
  const std::vector<TechniqueInfo>& all = all_techniques();
  const auto rank = [&](const ChosenTechnique& one) {
    return std::pair(one.place, std::find_if(all.begin(), all.end(),
                                             [&](const auto& info) { return info.name == one.name; }));
  };
  std::sort(techniques.begin(), techniques.end(),
            [&](const auto& a, const auto& b) { return rank(*a) < rank(*b); });
}

Attributes Choice::needs() const {
  Attributes needs;
  for (const auto& chosen : techniques) needs = needs | chosen->technique->needs();
  return needs;
}

std::vector<const Look*> Choice::looks() const {
  std::vector<const Look*> looks;
  for (const auto& chosen : techniques) looks.push_back(chosen.get());
  return looks;
}

std::vector<Param*> Choice::find(const std::string& name) {
  std::vector<Param*> found;
  for (const auto& chosen : techniques)
    if (Param* param = chosen->parameters.find(name)) found.push_back(param);
  if (Param* param = prepare_parameters.find(name)) found.push_back(param);
  return found;
}

std::string techniques_with(const std::string& parameter) {
  const std::size_t dot = parameter.find('.');
  std::string owners;
  for (const TechniqueInfo& info : all_techniques()) {
    const Look look(info);
    if (dot != std::string::npos
            ? info.name == parameter.substr(0, dot) && look.parameters.find(parameter.substr(dot + 1))
            : look.parameters.find(parameter) != nullptr)
      owners += (owners.empty() ? "" : ", ") + info.name;
  }
  return owners;
}

}  // namespace sfumato
