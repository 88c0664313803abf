// What a bare --help says, and the topics of `sfumato help`.
#pragma once

#include <string>

#include "command_line.h"

namespace sfumato::cli {

/// Five examples, the ten options most used, the commands: one screen of 80 x 50.
std::string short_help(const CommandHelp& help);
Words topic_names();

}  // namespace sfumato::cli
