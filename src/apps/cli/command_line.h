// One command's options: declared with the place of their value, parsed, and listed for --help, the manual
// page and the completion of shells. Every one of those reads the same list.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/option_text.h"

namespace sfumato::cli {

using Words = std::vector<std::string>;

/// What is known of one option; `--no-NAME` exists for every kind but `value`.
struct OptionInfo {
  enum class Kind { flag, boolean, value };
  char short_name = 0;
  std::string long_name, metavar, help, group;
  Kind kind = Kind::value;
  bool hidden = false;
};

/// One command as help, manual page and completions show it.
struct CommandHelp {
  std::string name, description, usage;
  std::vector<OptionInfo> options;
  std::string footer;
};

class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description);
  ~CommandLine();

  /// Heading in --help of the options that follow.
  void group(const std::string& title);
  /// `names`: "-o,--output" or "--output". `metavar` also shows range and default.
  void flag(const std::string& names, bool& value, const std::string& help);
  void flag(const std::string& names, const std::string& help,
            std::function<void(const std::string&)> apply);  ///< gets "true" or "false"
  void text(const std::string& names, std::string& value, const std::string& metavar,
            const std::string& help);
  void text(const std::string& names, std::optional<std::string>& value, const std::string& metavar,
            const std::string& help);
  void positional(const std::string& metavar, std::string& value, const std::string& help);
  void positionals(const std::string& metavar, Words& values, const std::string& help);
  /// Every value given, in the order of the line.
  void texts(const std::string& names, Words& values, const std::string& metavar, const std::string& help);
  /// The same, `clear` before the first of a line.
  void texts(const std::string& names, const std::string& metavar, const std::string& help,
             std::function<void()> clear, std::function<void(const std::string&)> apply);
  /// `apply` gets the value once the whole line has parsed, in the order of declaration. `hidden`: not in
  /// --help.
  void handler(const std::string& names, const std::string& metavar, const std::string& help, bool hidden,
               std::function<void(const std::string&)> apply);
  /// The same for true, false or (where the parameter has it) auto; alone it means true.
  void boolean(const std::string& names, const std::string& metavar, const std::string& help, bool hidden,
               std::function<void(const std::string&)> apply);
  /// What an option declared before takes and does in this command.
  void restate(const std::string& long_name, const std::string& metavar, const std::string& help);
  /// Leaves options, by their long names, out of --help.
  void hide(const std::vector<const char*>& names);
  /// Called with the first word that is no option here; may throw a better error than "unknown option".
  void explain_unknown(std::function<void(const std::string&)> explain);
  /// Options that exist elsewhere: suggested, followed by `where`, when nothing here is near.
  void elsewhere(Words names, const std::string& where);
  /// Stands after "usage:".
  void usage(const std::string& text);
  void footer(const std::string& text);
  /// Printed by a bare --help instead of the whole list, which --help all then shows.
  void short_help(std::function<std::string(const CommandHelp&)> make);

  /// False when --help was asked for; it is then on stdout. A later value of an option wins over an earlier
  /// one, and a later call over an earlier call. Throws Error(usage): unknown options name the nearest.
  bool parse(const Words& words);
  /// Long name and value of every option given, in the order of declaration; a flag's value is "true" or
  /// "false".
  std::vector<std::pair<std::string, std::string>> given() const;
  const CommandHelp& described() const;

  /// While set, `parse` hands the declared options over and returns false: how help lists a command.
  static std::function<void(const CommandHelp&)> listener;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string join(const Words& words, const std::string& between = " ");

}  // namespace sfumato::cli
