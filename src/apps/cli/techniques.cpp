// sfumato techniques: what exists, and every parameter of one.
#include <fmt/format.h>

#include "commands.h"
#include "console.h"
#include "parameters.h"
#include "report.h"

namespace sfumato::cli {
namespace {

std::string rows(const ParamList& parameters, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i < last; ++i) {
    const Param& p = parameters.all()[i];
    text += fmt::format("  --{:<24} {}\n      {}{}{}\n", with_dashes(p.name), describe_values(p), p.help_text,
                        p.unit_text.empty() ? "" : " (" + p.unit_text + ")",
                        p.paper_text.empty() ? "" : " [" + p.paper_text + "]");
  }
  return text;
}

std::string page(const TechniqueInfo& info) {
  const ChosenTechnique chosen(info);
  std::string text = info.name + ": " + info.summary + "\n";
  if (chosen.own_count > 0) text += "\nParameters\n" + rows(chosen.parameters, 0, chosen.own_count);
  text += "\nParameters of every technique\n" +
          rows(chosen.parameters, chosen.own_count, chosen.parameters.all().size());
  return text;
}

}  // namespace

int techniques_command(const Words& words) {
  std::string name;
  bool json = false;
  CommandLine line("sfumato techniques", "Lists the techniques, or every parameter of one.");
  line.positional("NAME", name, "a technique");
  line.flag("--json", json, "machine-readable");
  if (!line.parse(words)) return 0;
  if (json) {
    print(techniques_json(name));
  } else if (!name.empty()) {
    print(page(find_technique(name)));
  } else {
    std::string text;
    for (const TechniqueInfo& info : all_techniques())
      text += fmt::format("{:<12}{}\n", info.name, info.summary);
    print(text);
  }
  return 0;
}

}  // namespace sfumato::cli
