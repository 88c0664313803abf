// Lines of numbers (XYZ, TXT, CSV, PTS, ASC): blanks, tabs, commas and semicolons separate, mixed as they
// come, unless commas are decimal. The columns are named by a header line or guessed from the first lines;
// the guess is a note of the report.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "io/columns.h"
#include "core/counted.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_dialect.h"

namespace sfumato::io {
namespace {

constexpr std::size_t sample_lines = 100;
constexpr std::size_t most_columns = 256;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// `at`: behind the blanks that a line begins with.
bool is_comment(const char* at, const char* end) {
  return at < end && (*at == '#' || *at == '%' || (*at == '/' && at + 1 < end && at[1] == '/'));
}
bool is_comment(std::string_view line) {
  const char* end = line.data() + line.size();
  return is_comment(skip_blanks(line.data(), end), end);
}

std::optional<double> to_number(std::string_view word) {
  double value = 0;
  const char* end = word.data() + word.size();
  if (word.empty()) return std::nan("");
  if (parse_number(word.data(), end, value) != end) return std::nullopt;
  return value;
}

/// All words as numbers, or nothing. Words of columns that the user passes over may be anything.
std::optional<std::vector<double>> to_numbers(const std::vector<std::string_view>& words,
                                              const std::vector<std::string>& columns) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool unwanted = i < columns.size() && columns[i] == "_";
    const std::optional<double> number = unwanted ? std::nan("") : to_number(words[i]);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// What the first lines of a file tell.
struct Beginning {
  std::string header;                       ///< the last line before the numbers that is none of them
  std::vector<std::vector<double>> rows;    ///< the first lines of numbers
  std::uint64_t begin = 0, first_line = 1;  ///< where the numbers begin
  bool has_count = false;                   ///< a lone count came first (PTS)
  bool has_quotes = false, has_decimal_commas = false, has_separating_commas = false;
};

Beginning look_at_beginning(const File& file, const std::vector<std::string>& columns,
                            const Dialect& dialect) {
  Beginning found;
  std::string translated;
  LineReader lines(file, 0, 1);
  std::string_view line;
  std::uint64_t at = 0;
  std::size_t looked = 0;
  while (found.rows.size() < sample_lines && looked++ < 10 * sample_lines && lines.next(line)) {
    const std::uint64_t here = at;
    at += line.size() + 1;
    if (here == 0 && line.starts_with(byte_order_mark)) {
      line.remove_prefix(byte_order_mark.size());
      found.begin = byte_order_mark.size();
    }
    translated = line;
    dialect.translate(translated);
    const std::vector<std::string_view> words = split(translated);
    if (words.empty()) continue;
    found.has_quotes = found.has_quotes || line.find('"') != std::string_view::npos;
    std::optional<std::vector<double>> numbers = is_comment(line) ? std::nullopt : to_numbers(words, columns);
    const bool lone = numbers && numbers->size() == 1;
    if (found.rows.empty() && (!numbers || lone)) {
      found.begin = at;
      found.first_line = lines.line_number() + 1;
      found.has_count = found.has_count || lone;
      if (numbers) continue;
      found.header = line;
    } else if (numbers && !lone) {
      const Commas commas = commas_of(line);
      found.has_decimal_commas = found.has_decimal_commas || commas == Commas::decimal;
      found.has_separating_commas = found.has_separating_commas || commas == Commas::separating;
      found.rows.push_back(std::move(*numbers));
    }
  }
  return found;
}

/// The same, in the dialect that it is written in. Lines that begin with a word are the last resort.
Beginning look_at_beginning(const File& file, const std::vector<std::string>& columns, Dialect& dialect) {
  for (;;) {
    const std::vector<std::string> label{"_"};
    Beginning found = look_at_beginning(file, dialect.label ? label : columns, std::as_const(dialect));
    const Dialect before = dialect;
    dialect.quotes = dialect.quotes || found.has_quotes;
    dialect.decimal_commas =
        dialect.decimal_commas || (found.has_decimal_commas && !found.has_separating_commas);
    if (dialect == before && found.rows.empty() && columns.empty()) dialect.label = true;
    if (dialect == before) return found;
  }
}

/// Questions about a column of the first lines.
class Sample {
 public:
  explicit Sample(const std::vector<std::vector<double>>& rows) : rows_(rows) {}
  bool are_bytes(std::size_t first) const {
    return all(first, 3, [](const double* v) {
      for (int k = 0; k < 3; ++k)
        if (!(v[k] >= 0 && v[k] <= 255 && v[k] == std::floor(v[k]))) return false;
      return true;
    });
  }
  bool are_fractions(std::size_t first) const {
    return all(first, 3, [](const double* v) {
      return v[0] >= 0 && v[0] <= 1 && v[1] >= 0 && v[1] <= 1 && v[2] >= 0 && v[2] <= 1;
    });
  }
  bool are_normals(std::size_t first) const {
    return all(first, 3, [](const double* v) {
      const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      return square == 0 || std::abs(square - 1) < 0.02 || !std::isfinite(square);
    });
  }

 private:
  template <class Test>
  bool all(std::size_t first, std::size_t count, Test&& test) const {
    return std::all_of(rows_.begin(), rows_.end(), [&](const std::vector<double>& row) {
      return row.size() >= first + count && test(row.data() + first);
    });
  }
  const std::vector<std::vector<double>>& rows_;
};

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

/// The columns of a line by name; `_` is passed over.
class PointLines final : public LineGrammar {
 public:
  PointLines(const std::vector<bool>& wanted, bool allow_counts, const Dialect& dialect)
      : wanted_(wanted.begin(), wanted.end()), allow_counts_(allow_counts), dialect_(dialect) {}
  bool counts(std::string_view line) const override {
    const char *end = line.data() + line.size(), *at = skip_blanks(line.data(), end);
    return at < end && !is_comment(at, end);
  }
  bool parse(std::string_view line, double* row) const override {
    if (dialect_.is_plain()) return parse_plain(line, row);
    std::string translated(line);
    dialect_.translate(translated);
    return parse_plain(translated, row);
  }

 private:
  bool parse_plain(std::string_view line, double* row) const {
    const char *at = line.data(), *end = at + line.size();
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
      at = skip_blanks(at, end);
      if (at == end || *at == '#') {
        if (k == 1 && allow_counts_) return false;  // the count of the next scan
        throw LineError("found " + std::to_string(k) + " numbers, expected " +
                        std::to_string(wanted_.size()));
      }
      double value = std::nan("");
      if (!is_separator(*at)) {
        const char* behind = parse_plain_number(at, end, value);
        if (!behind) {
          double other = value;  // of its own: `value` stays in a register
          behind = parse_number(at, end, other);
          value = other;
        }
        const bool whole = behind && (behind == end || is_blank(*behind) || is_separator(*behind));
        if (!wanted_[k])
          behind = word_end(at, end);
        else if (!whole)
          throw LineError("found '" + std::string(at, word_end(at, std::min(end, at + 20))) +
                          "', expected a number in column " + std::to_string(k + 1));
        at = skip_blanks(behind, end);
      }
      if (at < end && is_separator(*at)) ++at;
      if (wanted_[k]) *row++ = value;
    }
    return true;
  }

  static const char* word_end(const char* at, const char* end) {
    while (at < end && !is_blank(*at) && !is_separator(*at)) ++at;
    return at;
  }
  std::vector<char> wanted_;
  bool allow_counts_;
  Dialect dialect_;
};

/// Names of the columns: what the user says, else the header line, else the guess.
std::vector<std::string> name_columns(const File& file, const Beginning& beginning, const Dialect& dialect,
                                      const ReadOptions& options, std::vector<std::string>& notes) {
  std::size_t width = most_columns + 1;
  for (const std::vector<double>& row : beginning.rows) width = std::min(width, row.size());
  const std::string place = "line " + std::to_string(beginning.first_line);
  if (beginning.rows.empty() && options.columns.empty())
    bad_input(file.path(), place,
              "found no line of numbers, expected lines 'x y z ...'; this is no text of points");
  if (!options.columns.empty()) {
    if (!beginning.rows.empty() && options.columns.size() > width)
      bad_input(file.path(), place,
                "found " + std::to_string(width) + " numbers, expected " +
                    std::to_string(options.columns.size()) + " as the columns given; name fewer");
    return options.columns;
  }
  if (width < (dialect.label ? 4 : 3) || width > most_columns)
    bad_input(file.path(), place,
              "found " + std::to_string(std::min(width, most_columns)) +
                  " numbers in a line, expected x y z and at most " + std::to_string(most_columns) +
                  "; this is no text of points");
  if (std::vector<std::string> names = names_in(beginning.header, width); !names.empty()) {
    if (dialect.label) names[0] = "_";
    std::vector<Column> columns;
    for (const std::string& name : names) columns.push_back({name});
    if (assign_roles(columns)) {
      notes.push_back("columns from the header line: " + join(names));
      return names;
    }
  }
  // A count on top makes it a PTS, whose columns are fixed: x y z [intensity] [r g b].
  if (beginning.has_count && (width == 4 || width == 6 || width == 7)) {
    std::vector<std::string> names = {"x", "y", "z"};
    if (width != 6) names.push_back("intensity");
    if (width != 4) names.insert(names.end(), {"red", "green", "blue"});
    notes.push_back("columns of a PTS: " + join(names) + " (--columns names them otherwise)");
    return names;
  }
  std::vector<std::vector<double>> rows = beginning.rows;
  if (dialect.label)
    for (std::vector<double>& row : rows) row.erase(row.begin());
  std::vector<std::string> names = guess_columns(rows, dialect.label ? width - 1 : width);
  if (dialect.label) names.insert(names.begin(), "_");
  notes.push_back("columns guessed from the first " +
                  (beginning.rows.size() == 1 ? "line" : counted(beginning.rows.size(), "line")) + ": " +
                  join(names) + " (--columns names them otherwise)");
  return names;
}

}  // namespace

std::vector<std::string> guess_columns(const std::vector<std::vector<double>>& rows, std::size_t width) {
  const Sample sample(rows);
  std::vector<std::string> names = {"x", "y", "z"};
  bool color = false, normal = false, intensity = false;
  const auto add = [&](std::initializer_list<const char*> group) {
    names.insert(names.end(), group.begin(), group.end());
  };
  while (names.size() < width) {
    const std::size_t at = names.size(), left = width - at;
    // x y z i r g b: three bytes behind one more column are the colour, and the column is the intensity.
    const bool shifted =
        left >= 4 && !intensity && sample.are_bytes(at + 1) && (left == 4 || !sample.are_bytes(at));
    if (left >= 3 && !color && !shifted && sample.are_bytes(at)) {
      add({"red", "green", "blue"});
      color = true;
    } else if (left >= 3 && !normal && sample.are_normals(at)) {
      add({"nx", "ny", "nz"});
      normal = true;
    } else if (left >= 3 && !color && !shifted && sample.are_fractions(at)) {
      add({"red", "green", "blue"});
      color = true;
    } else if (!intensity) {
      add({"intensity"});
      intensity = true;
    } else {
      names.push_back("column_" + std::to_string(at + 1));
    }
  }
  return names;
}

bool is_text(std::string_view head) {
  // Printable as far as we see, and a line that starts with three numbers somewhere. Two counts of one number
  // each on top are the grid of a PTX scan, whose pose would pass for points.
  if (head.starts_with(byte_order_mark)) head.remove_prefix(byte_order_mark.size());
  const auto is_control = [](char c) {
    return static_cast<unsigned char>(c) < 32 && c != '\n' && !is_blank(c);
  };
  if (std::any_of(head.begin(), head.end(), is_control)) return false;
  for (int counts = 0; !head.empty();) {
    const std::size_t end = std::min(head.find('\n'), head.size());
    const std::vector<std::string_view> words = split(head.substr(0, end));
    const bool numbers =
        words.size() >= 3 && std::all_of(words.begin(), words.begin() + 3,
                                         [](std::string_view word) { return to_number(word).has_value(); });
    if (numbers) return counts < 2;
    counts += words.size() == 1 && to_number(words[0]).has_value();
    head.remove_prefix(std::min(head.size(), end + 1));
  }
  return false;
}

ReadResult read_text(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  const std::string mark = file.read_text(0, 2);
  if (mark == "\xFF\xFE" || mark == "\xFE\xFF")
    bad_input(path, "byte 0", "found UTF-16, expected UTF-8; save it so (iconv -f UTF-16 -t UTF-8 does)");
  Dialect dialect;
  const Beginning beginning = look_at_beginning(file, options.columns, dialect);
  ReadResult result;
  if (dialect.decimal_commas) result.report.notes.push_back("commas are decimal: 1,5 is one and a half");
  if (dialect.label) result.report.notes.push_back("the first word of each line is passed over");
  const std::vector<std::string> names = name_columns(file, beginning, dialect, options, result.report.notes);
  std::vector<Column> columns;
  std::vector<bool> wanted;
  for (const std::string& name : names) {
    wanted.push_back(name != "_");
    if (name != "_") columns.push_back({name, StoredType::float64});
  }
  if (!assign_roles(columns))
    throw Error(options.columns.empty() ? ErrorCode::bad_input : ErrorCode::usage,
                path.string() + ": the columns " + join(names) + " lack x, y or z; name them");
  use_usual_names(columns);
  const PointLines grammar(wanted, beginning.has_count, dialect);
  const TextBlocks text = cut_lines(file, beginning.begin, beginning.first_line, grammar, progress);
  read_rows(file, text, 0, text.rows, grammar, std::move(columns), false, progress, result);
  if (result.report.points == 0)
    bad_input(path, "line " + std::to_string(text.lines),
              "the file ends without a point; this is no text of points");
  // Text says nothing about types: float unless the numbers need the offset.
  for (ScalarField& field : result.cloud.scalars)
    field.type = field.offset == 0 ? StoredType::float32 : StoredType::float64;
  return result;
}

}  // namespace sfumato::io
