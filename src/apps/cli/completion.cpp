// sfumato completion SHELL and sfumato manual: made of the same list of options as --help.
#include <algorithm>
#include <cctype>
#include <set>

#include "commands.h"
#include "console.h"
#include "core/error.h"
#include "core/version.h"
#include "help.h"
#include "help_text.h"
#include "synth/scene.h"
#include "techniques/technique.h"

namespace sfumato::cli {
namespace {

Words technique_names() {
  Words names;
  for (const TechniqueInfo& info : all_techniques()) names.push_back(info.name);
  return names;
}

/// The values that an option's metavar lists: "off|hard|soft (off)".
Words choices_of(const OptionInfo& option) {
  if (option.long_name == "technique") {
    Words names = technique_names();
    names.push_back("all");
    return names;
  }
  const std::string values = value_names(option.metavar);
  if (values.find('|') == std::string::npos) return {};
  Words choices;
  for (const std::string& word : split(values, '|'))
    if (!word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
          return std::islower(c) || std::isdigit(c) || c == '_' || c == '-';
        }))
      choices.push_back(word);
  return choices;
}

struct Entry {
  std::string name;  ///< empty: rendering
  CommandHelp help;
  Words arguments;
};

std::vector<Entry> entries() {
  std::vector<Entry> all = {{"", help_of(""), {}}};
  for (const Command& command : all_commands()) {
    if (command.hidden) continue;
    Entry entry{command.name, help_of(command.name), {}};
    if (command.name == "techniques") entry.arguments = technique_names();
    if (command.name == "completion") entry.arguments = {"bash", "zsh", "fish"};
    if (command.name == "synth") entry.arguments = synth::scene_names();
    if (command.name == "help") {
      entry.arguments = topic_names();
      for (const Command& each : all_commands())
        if (!each.hidden) entry.arguments.push_back(each.name);
    }
    all.push_back(std::move(entry));
  }
  return all;
}

Words spellings(const CommandHelp& help) {
  Words names = {"--help"};
  for (const OptionInfo& option : help.options) {
    if (option.hidden) continue;
    names.push_back("--" + option.long_name);
    if (option.kind != OptionInfo::Kind::value && !option.long_name.starts_with("no-"))
      names.push_back("--no-" + option.long_name);
  }
  return names;
}

std::string bash() {
  std::string text =
      "# Completion of sfumato for bash: source it, or install it into bash-completion's folder.\n_sfumato() "
      "{\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} options= arguments=\n"
      "  COMPREPLY=()\n  case $prev in\n";
  std::set<std::string> seen;
  for (const Entry& entry : entries())
    for (const OptionInfo& option : entry.help.options) {
      const Words choices = choices_of(option);
      if (option.hidden || choices.empty() || !seen.insert(option.long_name).second) continue;
      text += std::string("    ") + (option.short_name ? std::string("-") + option.short_name + "|" : "") +
              "--" + option.long_name + ") COMPREPLY=($(compgen -W '" + join(choices) +
              "' -- \"$cur\")); return ;;\n";
    }
  text += "  esac\n  case ${COMP_WORDS[1]} in\n";
  std::string rendering, names;
  for (const Entry& entry : entries()) {
    const std::string row = "options='" + join(spellings(entry.help)) + "'" +
                            (entry.arguments.empty() ? "" : " arguments='" + join(entry.arguments) + "'");
    if (entry.name.empty())
      rendering = "    *) " + row + " ;;\n";
    else
      text += "    " + entry.name + ") " + row + " ;;\n", names += (names.empty() ? "" : " ") + entry.name;
  }
  text += rendering +
          "  esac\n  if [[ $cur == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n    "
          "return\n"
          "  fi\n  [[ $COMP_CWORD == 1 ]] && arguments='" +
          names +
          "'\n  COMPREPLY=($(compgen -W \"$arguments\" -- \"$cur\") $(compgen -f -- \"$cur\"))\n}\n"
          "complete -o filenames -F _sfumato sfumato\n";
  return text;
}

/// What zsh and fish would read as their own.
std::string plain(const std::string& text) {
  std::string out;
  for (char c : text) out += std::string_view("'\"[]:\\`$").find(c) == std::string_view::npos ? c : ' ';
  return out;
}

std::string zsh() {
  std::string text =
      "#compdef sfumato\n# Completion of sfumato for zsh: a file _sfumato in a folder of fpath.\n_sfumato() "
      "{\n"
      "  local -a commands\n  commands=(\n";
  for (const Command& command : all_commands())
    if (!command.hidden) text += "    '" + command.name + ":" + plain(command.summary) + "'\n";
  text += "  )\n  case ${words[2]} in\n";
  std::string rendering;
  for (const Entry& entry : entries()) {
    std::string specs;
    for (const OptionInfo& option : entry.help.options) {
      if (option.hidden) continue;
      const Words choices = choices_of(option);
      std::string value;
      if (option.kind == OptionInfo::Kind::value)
        value = ":" + plain(value_names(option.metavar)) + ":" +
                (choices.empty() ? "_files" : "(" + join(choices) + ")");
      const std::string what = "[" + plain(option.help) + "]" + value + "'";
      specs += " \\\n        '--" + option.long_name + what;
      if (option.short_name) specs += std::string(" \\\n        '-") + option.short_name + what;
      if (option.kind != OptionInfo::Kind::value && !option.long_name.starts_with("no-"))
        specs += " \\\n        '--no-" + option.long_name + "[" + plain(option.help) + " (off)]'";
    }
    const std::string rest =
        entry.arguments.empty() ? "'*:file:_files'" : "'*:argument:(" + join(entry.arguments) + ")'";
    const std::string row = "      _arguments" + specs + " \\\n        " + rest + "\n";
    if (entry.name.empty())
      rendering = "    *)\n      (( CURRENT == 2 )) && _describe command commands\n" + row + "      ;;\n";
    else
      text += "    " + entry.name + ")\n" + row + "      ;;\n";
  }
  return text + rendering + "  esac\n}\n_sfumato \"$@\"\n";
}

std::string fish() {
  std::string text = "# Completion of sfumato for fish: a file sfumato.fish in ~/.config/fish/completions.\n",
              names;
  for (const Command& command : all_commands()) {
    if (command.hidden) continue;
    names += " " + command.name;
    text += "complete -c sfumato -n __fish_use_subcommand -a " + command.name + " -d '" +
            plain(command.summary) + "'\n";
  }
  for (const Entry& entry : entries()) {
    const std::string when = entry.name.empty() ? "'not __fish_seen_subcommand_from" + names + "'"
                                                : "'__fish_seen_subcommand_from " + entry.name + "'";
    for (const OptionInfo& option : entry.help.options) {
      if (option.hidden) continue;
      const Words choices = choices_of(option);
      text += "complete -c sfumato -n " + when + " -l " + option.long_name +
              (option.short_name ? std::string(" -s ") + option.short_name : "") +
              (option.kind == OptionInfo::Kind::value ? " -r" : "") +
              (choices.empty() ? "" : " -f -a '" + join(choices) + "'") + " -d '" + plain(option.help) +
              "'\n";
      if (option.kind != OptionInfo::Kind::value && !option.long_name.starts_with("no-"))
        text += "complete -c sfumato -n " + when + " -l no-" + option.long_name + " -d '" +
                plain(option.help) + " (off)'\n";
    }
    if (!entry.arguments.empty())
      text += "complete -c sfumato -n " + when + " -f -a '" + join(entry.arguments) + "'\n";
  }
  return text;
}

std::string roff(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string roff_options(const CommandHelp& help) {
  std::string text, group;
  for (const OptionInfo& option : help.options) {
    if (option.hidden) continue;
    if (option.group != group) text += ".SS " + roff(group = option.group) + "\n";
    text += ".TP\n.B " + roff(spelling(option)) + "\n" + roff(option.help) + "\n";
  }
  return text;
}

}  // namespace

int completion_command(const Words& words) {
  std::string shell;
  CommandLine line("sfumato completion",
                   "Prints the completion of a shell: sfumato completion bash >> ~/.bashrc, or as your shell "
                   "requires. make install installs all three.");
  line.positional("bash|zsh|fish", shell, "");
  if (!line.parse(words)) return 0;
  if (shell != "bash" && shell != "zsh" && shell != "fish")
    throw Error(ErrorCode::usage,
                (shell.empty() ? "completion needs a shell" : "there is no completion for '" + shell + "'") +
                    ": sfumato completion bash|zsh|fish");
  print(shell == "bash" ? bash() : shell == "zsh" ? zsh() : fish());
  return 0;
}

int manual_command(const Words& words) {
  CommandLine line("sfumato manual", "Prints the manual page (man -l, make install).");
  if (!line.parse(words)) return 0;
  std::string text = std::string(".TH SFUMATO 1 \"\" \"sfumato ") + version() +
                     "\"\n.SH NAME\nsfumato \\- point clouds to pictures\n";
  text += ".SH SYNOPSIS\n.B sfumato\n" + roff("FILE... [-t TECHNIQUE] -o PICTURE") +
          "\n.br\n.B sfumato\nCOMMAND ...\n";
  text += ".SH DESCRIPTION\n" + roff(help_of("").description) + "\n.SH OPTIONS\n" + roff_options(help_of(""));
  text += ".SH COMMANDS\n";
  for (const Command& command : all_commands()) {
    if (command.hidden) continue;
    const CommandHelp help = help_of(command.name);
    text += ".SS " + roff(help.usage) + "\n" + roff(help.description) + "\n";
    for (const OptionInfo& option : help.options)
      if (!option.hidden) text += ".TP\n.B " + roff(spelling(option)) + "\n" + roff(option.help) + "\n";
  }
  text +=
      ".SH EXIT STATUS\n0 done, 1 usage, 2 bad input, 3 partial, 4 no usable OpenGL, 5 out of memory, 6 "
      "reading or writing "
      "failed, 130 interrupted\n.SH FILES\n.I ~/.config/sfumato/config.json\n.br\ndefaults of your own, in "
      "the form of a preset\n"
      ".SH ENVIRONMENT\n.TP\n.B SFUMATO_CONFIG\nanother file of defaults; empty: none\n";
  print(text);
  return 0;
}

}  // namespace sfumato::cli
