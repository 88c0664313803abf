// The commands of `sfumato`. Each takes the words after its name and returns the exit code.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"

namespace sfumato::cli {

int render_command(const Words& words);
int info_command(const Words& words);
int convert_command(const Words& words);
int build_command(const Words& words);
int publish_command(const Words& words);
int serve_command(const Words& words);
int synth_command(const Words& words);
int techniques_command(const Words& words);
int formats_command(const Words& words);
int doctor_command(const Words& words);
int help_command(const Words& words);
int completion_command(const Words& words);
int manual_command(const Words& words);

struct Command {
  std::string name, summary;
  int (*run)(const Words&);
  bool hidden = false;
};

/// In the order of help; rendering, which has no name, is not among them.
const std::vector<Command>& all_commands();
/// Null when there is none of that name.
const Command* find_command(const std::string& name);
/// What a command declares, found without running it. An empty name is rendering, with every technique.
CommandHelp help_of(const std::string& command);
/// Version, commit, OpenGL and libraries.
std::string version_text();
/// Throws Error(usage) when `word`, the first of the line, is neither file nor command but looks like a
/// command.
void refuse_unknown_command(const std::string& word);

}  // namespace sfumato::cli
