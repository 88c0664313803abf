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
  const std::string name = word.substr(std::min(word.size(), word.find_first_not_of('-')));  // "---" has none
  const std::string owners = techniques_with(name);
  if (!owners.empty())
    throw Error(ErrorCode::usage,
                word + " is a parameter of " + owners + ", not of " + chosen + " (choose with -t)");
}

}  // namespace

void declare(Choice& choice, CommandLine& line) {
  std::set<std::string> seen;
  bool hidden = false;
  auto declare_one = [&](const Param& param) {
    if (!seen.insert(param.name).second) return;
    declare_parameter(line, param, "--" + with_dashes(param.name), hidden,
                      [found = choice.find(param.name)](const std::string& text) {
                        for (Param* each : found) each->set(text);
                      });
  };
  for (const auto& chosen : choice.techniques) {
    hidden = chosen->candidate;  // seven lists of parameters are no help
    if (!hidden) line.group("Parameters of " + chosen->name);
    for (std::size_t i = 0; i < chosen->own_count; ++i) declare_one(chosen->parameters.all()[i]);
  }
  hidden = false;
  line.group("Parameters of every technique");
  for (const Param& param : choice.techniques.front()->parameters.all()) declare_one(param);
  line.group("Parameters of the analysis before rendering");
  for (const Param& param : choice.prepare_parameters.all()) declare_one(param);

  // Qualified names come last, so that they win over the plain ones wherever they stand on the line.
  seen.clear();
  std::string chosen_names;
  for (const auto& chosen : choice.techniques) {
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
    text = join(param.choices, "|");
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
