// What the columns of a text file are: named by one of its header lines, or guessed from all of their
// numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sfumato::io {

/// What the columns of a file are called.
struct Naming {
  std::vector<std::string> names;
  bool z_is_depth = false;  ///< which counts downwards
};

/// The names in a header line for rows of `width` columns, without comment signs, quotes and units: `//X`,
/// `"Red"`, `Z [m]`; blanks part them, or commas, semicolons or tabs do. Others' words for the axes (easting,
/// Hochwert, latitude, depth, `Points_m_XYZ:0`, POINT_X ...) become x, y and z where these are no names
/// themselves; the case of other names is kept; a column without a name is `_`. A line that names fewer
/// columns or more counts where commas, semicolons or tabs part it and x, y and z are among them, or where it
/// names nothing else. Nothing otherwise.
Naming names_in(std::string_view line, std::size_t width);

/// Whether the line names its axes by longitude and latitude.
bool names_degrees(std::string_view line);

/// Rows of the beginning of a file; NaN is what is no number.
using SampleRows = std::vector<std::vector<double>>;

/// Whether the first column numbers the points, beside coordinates with decimals: whole numbers of which none
/// repeats in the rows at the beginning nor in those at the end. Where there are few they rise or fall.
bool is_running_number(const SampleRows& beginning, const std::vector<double>& end);

/// Whether x y z stand behind row and column of a scan, as FARO and scanners of lines write them: two columns
/// of whole numbers in which one counts while the other stays, and three that are not whole.
bool are_pixels(const SampleRows& rows);

/// Names for the columns from `names.size()` to `width`, by ranges and whole numbers of all of them.
std::vector<std::string> guess_columns(const SampleRows& rows, std::size_t width,
                                       std::vector<std::string> names = {});

std::string join(const std::vector<std::string>& names);

}  // namespace sfumato::io
