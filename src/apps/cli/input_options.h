// The table of options on the command line, and what is said of files that were read.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "command_line.h"
#include "scene/scene.h"
#include "session/request.h"

namespace sfumato::cli {

/// Declares a group of the table of options (session/request.h).
void declare_group(CommandLine& line, Request& request, std::string_view group);
/// Declares one of its rows, with words of its own for --help where they differ.
void declare_option(CommandLine& line, Request& request, const Option& option, const std::string& help);

/// The files with their transforms: "N: 16 numbers", N counts from 1 and may be left out for a single file.
std::vector<scene::SceneFile> placed_files(const Words& files, const Words& transforms);

/// What --columns could not do: the files are no text. Empty when there is nothing to say.
std::string unused_columns(std::span<const io::ReadReport> files, const io::ReadOptions& options);

/// What is said of files whose damaged parts were left out.
std::string missing_points(std::uint64_t missing, std::uint64_t points);

}  // namespace sfumato::cli
