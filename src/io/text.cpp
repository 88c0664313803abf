// Lines of numbers (XYZ, TXT, CSV, PTS, ASC): blanks, tabs, commas and semicolons separate, mixed as they
// come, unless commas are decimal. The columns are named by a header line or guessed from the first lines;
// the guess is a note of the report.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "io/columns.h"
#include "core/counted.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_columns.h"
#include "io/text_dialect.h"

namespace sfumato::io {
namespace {

constexpr std::size_t sample_lines = 100;
constexpr std::size_t most_columns = 256;
/// Of names of longitude and latitude, which say no more.
constexpr const char* degrees_crs = "EPSG:4326";
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

/// The words of a line as numbers; NaN for those that are none.
struct Words {
  std::vector<double> numbers;
  std::vector<bool> are_words;
  std::size_t count = 0;  ///< of numbers
  bool are_numbers() const { return count == numbers.size(); }
};

Words to_words(const std::vector<std::string_view>& words, const std::vector<std::string>& columns) {
  Words found;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool unwanted = i < columns.size() && columns[i] == "_";
    const std::optional<double> number = unwanted ? std::nan("") : to_number(words[i]);
    found.numbers.push_back(number.value_or(std::nan("")));
    found.are_words.push_back(!number);
    found.count += number.has_value();
  }
  return found;
}

/// What the first lines of a file tell.
struct Beginning {
  std::vector<std::string> headers;                 ///< the lines before the numbers that are none of them
  SampleRows rows;                                  ///< the first lines of numbers
  std::vector<bool> are_words;                      ///< columns that hold words
  std::vector<std::string> lines;                   ///< the first of those lines
  std::uint64_t begin = 0, first_line = 1;          ///< where the numbers begin
  std::uint64_t behind_first = 0, second_line = 1;  ///< where those behind the first of them do
  bool has_count = false;                           ///< a lone count came first (PTS)
  bool has_brackets = false, has_quotes = false, has_decimal_commas = false, has_separating_commas = false,
       has_empty_tabs = false;
};

Beginning look_at_beginning(const File& file, const std::vector<std::string>& columns,
                            const Dialect& dialect) {
  constexpr std::size_t least_numbers = 3;
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
    found.has_brackets = found.has_brackets || has_brackets(line);
    found.has_quotes = found.has_quotes || line.find('"') != std::string_view::npos;
    const Words read = to_words(words, columns);
    const bool lone = read.are_numbers() && words.size() == 1 && !is_comment(line);
    // Words may stand among the numbers, and behind those that the user names.
    const std::size_t wanted = std::min(columns.size(), words.size());
    const bool is_row =
        !is_comment(line) && !lone &&
        (read.are_numbers() || (dialect.words && read.count >= least_numbers) ||
         (wanted > 0 && std::find(read.are_words.begin(), read.are_words.begin() + std::ptrdiff_t(wanted),
                                  true) == read.are_words.begin() + std::ptrdiff_t(wanted)));
    if (found.rows.empty() && !is_row) {
      found.begin = at;
      found.first_line = lines.line_number() + 1;
      found.has_count = found.has_count || lone;
      if (!lone) found.headers.emplace_back(line);
    } else if (is_row) {
      const Commas commas = commas_of(line);
      found.has_decimal_commas = found.has_decimal_commas || commas == Commas::decimal;
      found.has_separating_commas = found.has_separating_commas || commas == Commas::separating;
      // Where semicolons separate, tabs are blanks.
      found.has_empty_tabs = found.has_empty_tabs || (line.find("\t\t") != std::string_view::npos &&
                                                      line.find(';') == std::string_view::npos);
      found.are_words.resize(std::max(found.are_words.size(), words.size()));
      for (std::size_t k = 0; k < words.size(); ++k)
        found.are_words[k] = found.are_words[k] || (read.are_words[k] && k >= wanted);
      if (found.rows.empty()) found.behind_first = at, found.second_line = lines.line_number() + 1;
      if (found.lines.size() < sample_lines) found.lines.emplace_back(line);
      found.rows.push_back(read.numbers);
    }
  }
  return found;
}

/// Tables of pandas number their columns from 0 where they have no names: 0,1,2 above numbers with decimals.
void pass_over_column_numbers(Beginning& found) {
  if (found.rows.size() < 2 || found.rows[0].size() < 3 || found.rows[1].size() < 3) return;
  for (std::size_t k = 0; k < found.rows[0].size(); ++k)
    if (found.rows[0][k] != double(k)) return;
  for (std::size_t k = 0; k < 3; ++k)
    if (found.rows[1][k] == std::floor(found.rows[1][k])) return;
  found.rows.erase(found.rows.begin());
  found.begin = found.behind_first;
  found.first_line = found.second_line;
}

/// The same, in the dialect that it is written in. Words among the numbers are the last resort.
Beginning look_at_beginning(const File& file, const std::vector<std::string>& columns, Dialect& dialect) {
  for (;;) {
    Beginning found = look_at_beginning(file, columns, std::as_const(dialect));
    const Dialect before = dialect;
    dialect.quotes = dialect.quotes || found.has_quotes;
    dialect.decimal_commas =
        dialect.decimal_commas || (found.has_decimal_commas && !found.has_separating_commas);
    if (found.has_empty_tabs) dialect.cells = '\t';
    if (dialect == before && found.rows.empty()) dialect.brackets = found.has_brackets;
    if (dialect == before && found.rows.empty() && columns.empty()) dialect.words = true;
    if (dialect == before && dialect.words && dialect.cells == 0) dialect.cells = cells_of_lines(found.lines);
    if (dialect != before) continue;
    pass_over_column_numbers(found);
    return found;
  }
}

/// The first number of each of the last lines.
std::vector<double> numbers_at_end(const File& file, const Dialect& dialect) {
  constexpr std::size_t tail_bytes = 1 << 14;
  const std::uint64_t from = file.size() - std::min<std::uint64_t>(file.size(), tail_bytes);
  const std::string tail = file.read_text(from, tail_bytes);
  std::vector<double> numbers;
  for (std::size_t at = from == 0 ? 0 : tail.find('\n'); at < tail.size();) {
    const std::size_t end = std::min(tail.find('\n', at), tail.size());
    std::string line = tail.substr(at, end - at);
    dialect.translate(line);
    if (const std::vector<std::string_view> words = split(line); words.size() > 3 && !is_comment(line))
      if (const std::optional<double> number = to_number(words[0])) numbers.push_back(*number);
    at = end + 1;
  }
  return numbers;
}

/// BEGIN, END: one word of letters.
bool is_mark(std::string_view line) {
  const char *at = skip_blanks(line.data(), line.data() + line.size()), *end = line.data() + line.size();
  const char* const first = at;
  while (at < end && std::isalpha(static_cast<unsigned char>(*at))) ++at;
  return at > first && skip_blanks(at, end) == end;
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
        if (!wanted_[k]) {
          behind = word_end(at, end);
        } else if (!whole) {
          if (k == 0 && is_mark(line)) return false;
          throw LineError("found '" + std::string(at, word_end(at, std::min(end, at + 20))) +
                          "', expected a number in column " + std::to_string(k + 1));
        }
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

/// Eastings of UTM lie within 833 km of the grid's zero; northings beyond a million metres are farther from
/// the equator than that.
bool are_north_and_east(const SampleRows& rows, std::size_t first) {
  return std::all_of(rows.begin(), rows.end(), [&](const std::vector<double>& row) {
    return row[first] > 1e6 && row[first] < 1e7 && row[first + 1] > 166e3 && row[first + 1] < 834e3;
  });
}

/// Of the numbers, when neither the user nor a header names them.
std::vector<std::string> guess_names(const File& file, const Beginning& beginning, const Dialect& dialect,
                                     std::size_t width, std::vector<std::string>& notes) {
  // Columns of words are passed over, and so is one that numbers the points.
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < width; ++k)
    if (!beginning.are_words[k]) kept.push_back(k);
  const auto rows_of_kept = [&] {
    SampleRows rows;
    for (const std::vector<double>& row : beginning.rows) {
      std::vector<double>& chosen = rows.emplace_back();
      for (const std::size_t k : kept) chosen.push_back(row[k]);
    }
    return rows;
  };
  SampleRows rows = rows_of_kept();
  const bool is_numbered =
      is_running_number(rows, beginning.are_words[0] ? std::vector<double>{} : numbers_at_end(file, dialect));
  const bool has_pixels = !is_numbered && are_pixels(rows);
  if (is_numbered || has_pixels)
    kept.erase(kept.begin(), kept.begin() + (has_pixels ? 2 : 1)), rows = rows_of_kept();
  if (kept.size() < 3)
    bad_input(file.path(), "line " + std::to_string(beginning.first_line),
              "found " + std::to_string(kept.size()) +
                  " numbers in a line, expected x y z; this is no text of points");
  std::vector<std::string> guessed = guess_columns(rows, kept.size());
  if (are_north_and_east(rows, 0)) std::swap(guessed[0], guessed[1]);
  std::vector<std::string> names(width, "_");
  for (std::size_t k = 0; k < kept.size(); ++k) names[kept[k]] = guessed[k];
  notes.push_back("columns guessed from the first " +
                  (beginning.rows.size() == 1 ? "line" : counted(beginning.rows.size(), "line")) + ": " +
                  join(names) +
                  (is_numbered  ? ", behind a number of the point"
                   : has_pixels ? ", behind a row and a column"
                                : "") +
                  " (--columns names them otherwise)");
  return names;
}

/// Names of the columns: what the user says, else the header line, else the guess.
Naming name_columns(const File& file, const Beginning& beginning, const Dialect& dialect,
                    const ReadOptions& options, ReadReport& report) {
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
    return {options.columns};
  }
  if (width < 3 || width > most_columns)
    bad_input(file.path(), place,
              "found " + std::to_string(std::min(width, most_columns)) +
                  " numbers in a line, expected x y z and at most " + std::to_string(most_columns) +
                  "; this is no text of points");
  for (auto header = beginning.headers.rbegin(); header != beginning.headers.rend(); ++header) {
    auto [names, z_is_depth] = names_in(*header, width);
    // A table with names of rows has one name less.
    const SampleRows& rows = beginning.rows;
    const bool has_row_names = !names.empty() && names.size() + 1 == width &&
                               (beginning.are_words[0] || is_running_number(rows, {}) ||
                                (rows.size() > 1 && rows[0][0] == 1 && rows[1][0] == 2));
    if (has_row_names) names.insert(names.begin(), "_");
    for (std::size_t k = 0; k < names.size(); ++k)
      if (beginning.are_words[k]) names[k] = "_";
    std::vector<Column> columns;
    for (const std::string& name : names) columns.push_back({name});
    if (names.empty() || !assign_roles(columns)) continue;
    // What stands behind x y z alone is still guessed; what stands behind more names has none.
    if (names.size() == 3 && width > 3 && !has_row_names) names = guess_columns(rows, width, names);
    if (names_degrees(*header)) report.crs = degrees_crs;
    report.notes.push_back("columns from the header line: " + join(names));
    return {std::move(names), z_is_depth};
  }
  // A count on top makes it a PTS, whose columns are fixed: x y z [intensity] [r g b].
  if (beginning.has_count && !dialect.words && (width == 4 || width == 6 || width == 7)) {
    std::vector<std::string> names = {"x", "y", "z"};
    if (width != 6) names.push_back("intensity");
    if (width != 4) names.insert(names.end(), {"red", "green", "blue"});
    report.notes.push_back("columns of a PTS: " + join(names) + " (--columns names them otherwise)");
    return {std::move(names)};
  }
  return {guess_names(file, beginning, dialect, width, report.notes)};
}

/// Depths below a surface become heights, which x and y east and north of maps go with. Those that are
/// written as negative numbers are heights already.
void turn_depths_over(ReadResult& result) {
  PointCloud& cloud = result.cloud;
  std::size_t positive = 0, negative = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    positive += cloud.world(i).z > 0, negative += cloud.world(i).z < 0;
  if (positive <= negative) {
    if (negative > 0) result.report.notes.emplace_back("depths are negative, and taken for heights");
    return;
  }
  cloud.origin.z = 0 - cloud.origin.z;  // no -0
  for (vec3& position : cloud.positions) position.z = 0 - position.z;
  for (vec3& normal : cloud.normals) normal.z = 0 - normal.z;
  result.report.notes.emplace_back(
      "z is a depth, and drawn downwards (--columns x,y,z takes it for a height)");
}

}  // namespace

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
  if (dialect.decimal_commas) result.report.notes.emplace_back("commas are decimal: 1,5 is one and a half");
  auto [names, z_is_depth] = name_columns(file, beginning, dialect, options, result.report);
  while (!names.empty() && names.back() == "_") names.pop_back();  // nobody reads what stands behind
  result.cloud.crs = result.report.crs;
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
  if (z_is_depth) turn_depths_over(result);
  // Text says nothing about types: float unless the numbers need the offset.
  for (ScalarField& field : result.cloud.scalars)
    field.type = field.offset == 0 ? StoredType::float32 : StoredType::float64;
  return result;
}

}  // namespace sfumato::io
