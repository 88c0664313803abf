// The table of commands, and what is said of words that are none.
#include "commands.h"

#include <filesystem>
#include <set>

#include "core/error.h"
#include "core/param.h"

namespace sfumato::cli {

const std::vector<Command>& all_commands() {
  static const std::vector<Command> commands = {
      {"info", "what files hold: points, extent, attributes, spacing", info_command},
      {"convert", "one or several clouds to LAS, LAZ, PLY, PCD, CSV, XYZ, NPY", convert_command},
      {"build", "files of any size to one COPC file with levels of detail", build_command},
      {"publish", "a turntable of pictures, as static files for browsers", publish_command},
#ifdef SFUMATO_SERVE
      {"serve", "scans in the browser, rendered on this machine", serve_command},
#endif
      {"synth", "synthetic scans with ground truth", synth_command},
      {"techniques", "the techniques, and their parameters", techniques_command},
      {"formats", "formats that are read and written", formats_command},
      {"doctor", "check OpenGL, and list what to install", doctor_command},
      {"help", "this, a command, or a topic", help_command},
      {"completion", "completion for bash, zsh or fish", completion_command},
      {"manual", "the manual page, as roff", manual_command, true},
  };
  return commands;
}

const Command* find_command(const std::string& name) {
  for (const Command& command : all_commands())
    if (command.name == name) return &command;
  return nullptr;
}

CommandHelp help_of(const std::string& command) {
  CommandHelp found;
  CommandLine::listener = [&](const CommandHelp& help) { found = help; };
  if (const Command* known = find_command(command))
    known->run({});
  else
    render_command({"-t", "all"});
  CommandLine::listener = nullptr;
  return found;
}

void refuse_unknown_command(const std::string& word) {
  std::error_code error;
  if (word.empty() || word[0] == '-' || word.find_first_of("./*?[") != std::string::npos ||
      std::filesystem::exists(word, error))
    return;
  static const std::set<std::string> rendering = {"render", "draw", "show", "image", "picture", "shoot"};
  static const std::set<std::string> looking = {"view", "viewer", "gui", "open", "window"};
  if (rendering.contains(word))
    throw Error(ErrorCode::usage,
                "there is no command '" + word + "': rendering needs none, sfumato FILE... -o OUT.png");
  if (looking.contains(word))
    throw Error(ErrorCode::usage,
                "there is no command '" + word +
                    "': a window needs none, sfumato FILE...; sfumato FILE... -o OUT.png writes a picture");
  std::vector<std::string> names;
  for (const Command& command : all_commands())
    if (!command.hidden) names.push_back(command.name);
  const std::string near = nearest_word(word, names);
  throw Error(ErrorCode::usage, "'" + word + "' is neither a file here nor a command" +
                                    (near.empty() ? "; the commands are " + join(names, ", ")
                                                  : "; did you mean " + near + "?") +
                                    " (sfumato help)");
}

}  // namespace sfumato::cli
