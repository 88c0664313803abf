// How a text file writes its lines: what parts the words, and what a comma means.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/text_rows.h"

namespace sfumato::io {

inline bool is_separator(char c) { return c == ',' || c == ';'; }

/// The words of a line. An empty cell between two commas is a word too; one behind the last comma is not.
std::vector<std::string_view> split(std::string_view line);

/// What of a file's lines is not as we read numbers.
struct Dialect {
  bool decimal_commas = false;  ///< 1,5;2,5;3
  bool quotes = false;          ///< "1.5","2.5","3"
  bool brackets = false;        ///< (1.5, 2.5, 3), as lists of Python are printed
  bool words = false;           ///< some columns hold words that are no numbers
  char cells = 0;               ///< the only separator: words may have blanks, and cells may be empty
  bool operator==(const Dialect&) const = default;

  bool is_plain() const { return !decimal_commas && !quotes && !brackets && cells == 0; }
  /// The line as we read it.
  void translate(std::string& line) const;
};

/// Whether a line of numbers is in brackets.
bool has_brackets(std::string_view line);

/// What commas are in a line of numbers.
enum class Commas { none, decimal, separating };
/// "1,5 2,5 3" or "1,5;2,5;3": words between blanks and semicolons that are numbers, some with a decimal
/// comma. Read as separators, the commas would make 1, 5, 2, 5, 3 of it.
Commas commas_of(std::string_view line);

/// What alone parts the cells of these lines, as many in each: a semicolon, a tab or a comma; 0 when nothing
/// does.
char cells_of_lines(const std::vector<std::string>& lines);

}  // namespace sfumato::io
