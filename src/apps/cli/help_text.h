// Help as text that fits a terminal: paragraphs and lists of options.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"

namespace sfumato::cli {

/// Columns of the terminal on standard output: COLUMNS, else what the terminal says, else 80; 40 to 120 are
/// used.
int terminal_width();
/// The text in lines of at most `width`, every one after the first with `indent` blanks before it. Words
/// longer than a line stay whole.
std::string wrap(const std::string& text, int width, int indent = 0);
/// A command line of an example: continued with backslashes where it is longer than the terminal.
std::string wrap_example(const std::string& line, int width, int indent);
/// "-o, --output FILE".
std::string spelling(const OptionInfo& option);
/// The part of a metavar that is a value: "FLOAT [0..1] (0.5)" is FLOAT.
std::string value_names(const std::string& metavar);
/// The options as two columns, on narrow terminals one below the other.
std::string option_rows(const std::vector<OptionInfo>& options, int width);
/// Rows of a name and what it is.
std::string rows(const std::vector<std::pair<std::string, std::string>>& entries, int width, int column = 16);
/// Description, usage, every option by group, footer.
std::string full_help(const CommandHelp& help, int width);

}  // namespace sfumato::cli
