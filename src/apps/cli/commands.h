// The commands of `sfumato`. Each takes the words after its name and returns the exit code.
#pragma once

#include "command_line.h"

namespace sfumato::cli {

int render_command(const Words& words);
int info_command(const Words& words);
int techniques_command(const Words& words);
int synth_command(const Words& words);
int convert_command(const Words& words);
int doctor_command(const Words& words);

}  // namespace sfumato::cli
