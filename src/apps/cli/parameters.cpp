#include "parameters.h"

#include <algorithm>
#include <set>

#include "core/error.h"

namespace sfumato::cli {
namespace {

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string help_of(const Param& param) {
  return param.help_text + (param.unit_text.empty() ? "" : " (" + param.unit_text + ")");
}

/// A parameter that only techniques outside the choice have deserves to be told so.
void explain_foreign(const std::string& word, const std::string& chosen) {
  const std::string name = word.substr(word.find_first_not_of('-'));
  const std::size_t dot = name.find('.');
  std::string owners;
  for (const TechniqueInfo& info : all_techniques()) {
    ChosenTechnique other(info);
    if (dot != std::string::npos
            ? info.name == name.substr(0, dot) && other.parameters.find(name.substr(dot + 1))
            : other.parameters.find(name) != nullptr)
      owners += (owners.empty() ? "" : ", ") + info.name;
  }
  if (!owners.empty())
    throw Error(ErrorCode::usage,
                word + " is a parameter of " + owners + ", not of " + chosen + " (choose with -t)");
}

}  // namespace

Choice::Choice(const std::string& names) {
  for (const std::string& name : split(names, ',')) {
    const auto add = [&](const TechniqueInfo& info, bool candidate) {
      techniques.push_back(std::make_unique<ChosenTechnique>(info));
      techniques.back()->place = count;
      techniques.back()->candidate = candidate;
    };
    if (name == automatic_technique)
      for (const TechniqueInfo& info : all_techniques()) add(info, true);
    else
      add(find_technique(name), false);
    ++count;
  }
  prepare.describe(prepare_parameters);
}

void Choice::settle(const TechniqueChoice& found) {
  if (!automatic()) return;
  const auto has_all = [&](ChosenTechnique& one, std::string* lacks) {
    for (const auto& [name, value] : given) {
      if (one.parameters.find(name) || prepare_parameters.find(name)) continue;
      const bool of_another = std::any_of(techniques.begin(), techniques.end(), [&](const auto& other) {
        return other->candidate && other->parameters.find(name);
      });
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
      throw Error(ErrorCode::usage, "no technique has all the parameters given: choose with -t (sfumato techniques)");
    if (best->candidate) {
      best->candidate = false;
      best->reason = reason;
      best->surface_share = found.surface_share, best->line_share = found.line_share;
    }
    for (auto& one : techniques)
      if (one.get() == best) kept.push_back(std::move(one));
    std::erase(techniques, nullptr);
  }
  techniques = std::move(kept);
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

void Choice::declare(CommandLine& line) {
  std::set<std::string> seen;
  bool hidden = false;
  auto declare_one = [&](const Param& param) {
    if (!seen.insert(param.name).second) return;
    declare_parameter(line, param, "--" + with_dashes(param.name), hidden,
                      [found = find(param.name)](const std::string& text) {
                        for (Param* each : found) each->set(text);
                      });
  };
  for (const auto& chosen : techniques) {
    hidden = chosen->candidate;  // seven lists of parameters are no help
    if (!hidden) line.group("Parameters of " + chosen->name);
    for (std::size_t i = 0; i < chosen->own_count; ++i) declare_one(chosen->parameters.all()[i]);
  }
  hidden = false;
  line.group("Parameters of every technique");
  for (const Param& param : techniques.front()->parameters.all()) declare_one(param);
  line.group("Parameters of the analysis before rendering");
  for (const Param& param : prepare_parameters.all()) declare_one(param);

  // Qualified names come last, so that they win over the plain ones wherever they stand on the line.
  seen.clear();
  std::string chosen_names;
  for (const auto& chosen : techniques) {
    chosen_names += (chosen_names.empty() ? "" : ", ") + chosen->name;
    if (!seen.insert(chosen->name).second) continue;
    for (Param& param : chosen->parameters.all())
      declare_parameter(line, param, "--" + chosen->name + "." + with_dashes(param.name), true,
                        [&param](const std::string& text) { param.set(text); });
  }
  Words others;
  for (const TechniqueInfo& info : all_techniques()) {
    ChosenTechnique other(info);
    for (std::size_t i = 0; i < other.own_count; ++i)
      others.push_back("--" + with_dashes(other.parameters.all()[i].name));
  }
  line.elsewhere(others, " of another technique (choose with -t)");
  line.explain_unknown([chosen_names](const std::string& word) { explain_foreign(word, chosen_names); });
}

void declare_parameter(CommandLine& line, const Param& param, const std::string& name, bool hidden,
                       std::function<void(const std::string&)> apply) {
  if (param.kind == ParamKind::boolean)
    line.boolean(name, describe_values(param), help_of(param), hidden, std::move(apply));
  else
    line.handler(name, describe_values(param), help_of(param), hidden, std::move(apply));
}

std::string describe_values(const Param& param) {
  std::string text;
  if (param.kind == ParamKind::choice) {
    for (const std::string& choice : param.choices) text += (text.empty() ? "" : "|") + choice;
  } else {
    text = kind_name(param.kind);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return char(std::toupper(c)); });
    if (param.min || param.max)
      text +=
          " [" + (param.min ? number(*param.min) : "") + ".." + (param.max ? number(*param.max) : "") + "]";
    if (param.can_be_auto) text += "|auto";
  }
  return text + " (" + param.default_text + ")";
}

}  // namespace sfumato::cli
