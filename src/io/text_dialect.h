// How a text file writes its lines: what parts the words, what a comma means, and what a header calls the
// columns.
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
  bool label = false;           ///< every line begins with a word that is no number
  bool operator==(const Dialect&) const = default;

  bool is_plain() const { return !decimal_commas && !quotes; }
  /// The line as we read it.
  void translate(std::string& line) const;
};

/// What commas are in a line of numbers.
enum class Commas { none, decimal, separating };
/// "1,5 2,5 3" or "1,5;2,5;3": words between blanks and semicolons that are numbers, some with a decimal
/// comma. Read as separators, the commas would make 1, 5, 2, 5, 3 of it.
Commas commas_of(std::string_view line);

/// The names in a header line of `width` columns, without comment signs, quotes and units: `//X`, `"Red"`,
/// `Z [m]`; blanks part them, or commas, semicolons or tabs do. Others' words for the axes (easting,
/// northing, elevation; ParaView's Points:0 ...) become x, y and z where these are no names themselves; the
/// case of other names is kept. Nothing where there are more names, or fewer.
std::vector<std::string> names_in(std::string_view line, std::size_t width);

}  // namespace sfumato::io
