// Fast text: a file is cut into blocks at line ends, the lines are counted, then parsed by several threads
// into rows of doubles that a CloudBuilder decodes like binary records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "io/columns.h"
#include "io/file.h"

namespace sfumato::io {

/// Thrown by a grammar; becomes Error(bad_input) with file and line.
struct LineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads one number at `at` (blanks must be skipped before); returns the place behind it, or null when there
/// is none. Up to 15 digits exactly rounded without a library call (Clinger 1990), the others by
/// std::from_chars.
const char* parse_number(const char* at, const char* end, double& value);

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
inline const char* skip_blanks(const char* at, const char* end) {
  while (at < end && is_blank(*at)) ++at;
  return at;
}

/// Parted by blanks.
std::size_t count_words(std::string_view line);

/// The usual spelling, -12.345 with at most 15 digits, without leaving the caller: the value that
/// `parse_number` gives, or null for everything else. What stands behind the number is for the caller to see.
inline const char* parse_plain_number(const char* at, const char* end, double& value) {
  static constexpr double power[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool is_negative = at < end && *at == '-';
  at += is_negative;
  const char* digits = at;
  std::uint64_t mantissa = 0;
  while (at < end && unsigned(*at - '0') < 10) mantissa = mantissa * 10 + unsigned(*at++ - '0');
  std::ptrdiff_t count = at - digits;
  double magnitude = 0;
  if (at < end && *at == '.') {
    const char* fraction = ++at;
    while (at < end && unsigned(*at - '0') < 10) mantissa = mantissa * 10 + unsigned(*at++ - '0');
    const std::ptrdiff_t places = at - fraction;
    count += places;
    if (count == 0 || count > 15) return nullptr;
    magnitude = double(std::int64_t(mantissa)) / power[places];  // both exact: rounded once, and correctly
  } else {
    if (count == 0 || count > 15) return nullptr;
    magnitude = double(std::int64_t(mantissa));
  }
  if (at < end && ((*at | 0x20) == 'e' || *at == '#')) return nullptr;
  value = is_negative ? -magnitude : magnitude;
  return at;
}

/// The next number of a line separated by blanks; LineError(`what` is missing or no number).
double next_number(const char*& at, const char* end, std::string_view what);

/// How the lines of a format become rows.
class LineGrammar {
 public:
  virtual ~LineGrammar() = default;
  /// Whether the line may hold a row. Must be cheap. By default every line that is not blank.
  virtual bool counts(std::string_view line) const;
  /// Fills one value per column; false when the line turns out to hold no row. Throws LineError.
  virtual bool parse(std::string_view line, double* row) const = 0;
};

/// Lines of a file, cut into blocks.
struct TextBlocks {
  struct Block {
    std::uint64_t begin = 0, end = 0;         ///< bytes
    std::uint64_t first_row = 0, rows = 0;    ///< lines that count
    std::uint64_t first_line = 0, lines = 0;  ///< all lines, the first is 1
  };
  std::vector<Block> blocks;
  std::uint64_t rows = 0, lines = 0;
};

/// `first_line`: the number of the line at `begin`.
TextBlocks cut_lines(const File& file, std::uint64_t begin, std::uint64_t first_line,
                     const LineGrammar& grammar, Progress& progress);

/// Of so many lines at the end of a file, those that end: what is cut short may end within a number.
std::uint64_t whole_lines(const File& file, std::uint64_t lines);

/// Parses the counted rows [first, last) into the columns, which it lays out as doubles, and builds the
/// cloud. Error(bad_input) with the line that is no row.
void read_rows(const File& file, const TextBlocks& text, std::uint64_t first, std::uint64_t last,
               const LineGrammar& grammar, std::vector<Column> columns, bool keep_places, Progress& progress,
               ReadResult& result);

/// Line after line from a place on, for what is read by one thread.
class LineReader {
 public:
  LineReader(const File& file, std::uint64_t begin, std::uint64_t first_line);
  /// False at the end of the file. The text lives until the next call.
  bool next(std::string_view& line);
  std::uint64_t line_number() const { return line_number_; }

 private:
  const File& file_;
  std::uint64_t next_block_ = 0, line_number_ = 0;
  std::string buffer_;
  std::size_t at_ = 0;
};

}  // namespace sfumato::io
