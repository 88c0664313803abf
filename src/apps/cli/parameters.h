// The chosen techniques and their parameters as options of the command line.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"
#include "session/choice.h"

namespace sfumato::cli {

/// --parameter and --technique.parameter for every parameter.
void declare(Choice& choice, CommandLine& line);
/// A parameter as an option; one that is true or false may stand alone.
void declare_parameter(CommandLine& line, const Param& param, const std::string& name, bool hidden,
                       std::function<void(const std::string&)> apply);
/// "FLOAT [0.1, 64] = 1": kind, range or choices, default.
std::string describe_values(const Param& param);

}  // namespace sfumato::cli
