// Heights on a regular grid as text: ESRI ASCII (ncols, nrows, xllcorner ...), GRASS ASCII (north: south:
// ...), Surfer ASCII (DSAA). A point in the middle of each cell that has a height.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "core/counted.h"
#include "core/lower_case.h"
#include "io/file.h"
#include "io/format.h"
#include "io/table.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr double least_of_surfer = 1.70141e38;  ///< what Surfer writes where there is nothing
constexpr std::size_t most_header_words = 16;

/// Words between blanks, over the ends of lines.
class WordReader {
 public:
  explicit WordReader(const File& file) : lines_(file, 0, 1) {}
  /// False at the end of the file.
  bool next(std::string_view& word) {
    for (;;) {
      at_ = skip_blanks(at_, end_);
      if (at_ < end_) break;
      if (!lines_.next(line_)) return false;
      if (lines_.line_number() == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
      at_ = line_.data(), end_ = at_ + line_.size();
    }
    const char* begin = at_;
    while (at_ < end_ && !is_blank(*at_)) ++at_;
    word = std::string_view(begin, std::size_t(at_ - begin));
    return true;
  }
  void unread(std::string_view word) { at_ = word.data(); }
  std::uint64_t line_number() const { return lines_.line_number(); }

 private:
  LineReader lines_;
  std::string_view line_;
  const char *at_ = nullptr, *end_ = nullptr;
};

struct HeightGrid {
  std::uint64_t columns = 0, rows = 0;
  double west = 0, first_y = 0;   ///< middle of the first cell that the file names
  double step_x = 0, step_y = 0;  ///< to the next cell and the next row
  double nothing = std::nan("");
};

class GridReader {
 public:
  explicit GridReader(const std::filesystem::path& path) : file_(path), words_(file_) {}

  ReadResult read(Progress& progress) {
    read_header();
    if (grid_.columns == 0 || grid_.rows == 0 || !(std::abs(grid_.step_x) > 0) ||
        !(std::abs(grid_.step_y) > 0))
      fail("found a grid without columns, rows or size of a cell; the file is damaged");
    // A height takes a digit and a blank.
    if (grid_.columns > file_.size() || grid_.rows > file_.size() ||
        grid_.columns * grid_.rows > file_.size() / 2 + 1)
      fail("found a grid of " + std::to_string(grid_.columns) + " x " + std::to_string(grid_.rows) +
           " cells, more than the file can hold; it is cut short or damaged");
    std::vector<Column> places{
        {"x", StoredType::float64}, {"y", StoredType::float64}, {"z", StoredType::float64}};
    assign_roles(places);
    Table table(std::move(places), std::size_t(grid_.columns * grid_.rows));
    std::uint64_t empty = 0;
    for (std::uint64_t row = 0; row < grid_.rows; ++row) {
      progress.check();
      for (std::uint64_t column = 0; column < grid_.columns; ++column) {
        const auto i = std::size_t(row * grid_.columns + column);
        const double height = number("a height");
        const bool is_empty = !std::isfinite(height) || height == grid_.nothing;
        empty += is_empty;
        table.column(0)[i] = grid_.west + double(column) * grid_.step_x;
        table.column(1)[i] = grid_.first_y + double(row) * grid_.step_y;
        table.column(2)[i] = is_empty ? std::nan("") : height;
      }
    }
    ReadResult result;
    table.build(false, progress, result);
    if (result.cloud.empty()) fail("no cell of the grid has a height");
    result.report.points -= empty;
    result.report.points_dropped -= empty;
    result.cloud.up = UpAxis::pos_z;
    result.report.notes.push_back("a grid of " + std::to_string(grid_.columns) + " x " +
                                  std::to_string(grid_.rows) + " heights, cells of " +
                                  short_text(std::abs(grid_.step_x)) + " x " +
                                  short_text(std::abs(grid_.step_y)) + ", a point in the middle of each" +
                                  (empty ? "; " + counted(empty, "cell") + " without a height" : ""));
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    bad_input(file_.path(), "line " + std::to_string(words_.line_number()), what);
  }

  std::optional<double> to_number(std::string_view word) const {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    double value = 0;
    const char* end = text.data() + text.size();
    if (lower_case(word) == "null" || word == "*") return grid_.nothing;
    return parse_number(text.data(), end, value) == end ? std::optional(value) : std::nullopt;
  }

  double number(const char* what) {
    std::string_view word;
    if (!words_.next(word))
      fail(std::string("the file ends before ") + what + "; it is cut short, fetch it again");
    const std::optional<double> value = to_number(word);
    if (!value)
      fail("found '" + std::string(word.substr(0, 20)) + "', expected " + what + "; the file is damaged");
    return *value;
  }

  std::uint64_t count(double value) const {
    if (!(value >= 1 && value <= 0x1p31) || value != std::floor(value))
      fail("found no number of rows or columns; the file is damaged");
    return std::uint64_t(value);
  }

  void read_header() {
    std::string_view word;
    if (!words_.next(word)) fail("the file is empty");
    if (lower_case(word) == "dsaa") return read_surfer();
    std::map<std::string, double> keys;
    do {
      std::string key = lower_case(word);
      if (!std::isalpha(static_cast<unsigned char>(key[0])) || key == "null" || key == "nan") break;
      if (keys.size() >= most_header_words) fail("found more words than a grid has; the file is damaged");
      if (key.back() == ':') key.pop_back();
      keys[key] = number(("a number for " + key).c_str());
      is_grass_ = is_grass_ || key == "rows";
    } while (words_.next(word));
    words_.unread(word);
    const auto value = [&](const char* key) {
      const auto found = keys.find(key);
      if (found == keys.end()) fail(std::string("the header of the grid lacks ") + key);
      return found->second;
    };
    const auto has = [&](const char* key) { return keys.contains(key); };
    if (is_grass_) {
      grid_.columns = count(value("cols")), grid_.rows = count(value("rows"));
      grid_.step_x = (value("east") - value("west")) / double(grid_.columns);
      grid_.step_y = (value("south") - value("north")) / double(grid_.rows);
      grid_.west = value("west") + grid_.step_x / 2, grid_.first_y = value("north") + grid_.step_y / 2;
      if (has("null")) grid_.nothing = keys["null"];
      return;
    }
    grid_.columns = count(value("ncols")), grid_.rows = count(value("nrows"));
    grid_.step_x = has("cellsize") ? keys["cellsize"] : value("dx");
    const double height = has("cellsize") ? keys["cellsize"] : value("dy");
    grid_.west = has("xllcenter") ? keys["xllcenter"] : value("xllcorner") + grid_.step_x / 2;
    const double south = has("yllcenter") ? keys["yllcenter"] : value("yllcorner") + height / 2;
    grid_.first_y = south + double(grid_.rows - 1) * height;  // from the north
    grid_.step_y = -height;
    grid_.nothing = has("nodata_value") ? keys["nodata_value"] : has("nodata") ? keys["nodata"] : -9999;
  }

  void read_surfer() {
    grid_.columns = count(number("the columns")), grid_.rows = count(number("the rows"));
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) low[k] = number("the bounds"), high[k] = number("the bounds");
    grid_.step_x = grid_.columns > 1 ? (high[0] - low[0]) / double(grid_.columns - 1) : 1;
    grid_.step_y = grid_.rows > 1 ? (high[1] - low[1]) / double(grid_.rows - 1) : 1;
    grid_.west = low[0], grid_.first_y = low[1];  // nodes, from the south
    is_surfer_ = true;
    grid_.nothing = least_of_surfer;
  }

  File file_;
  WordReader words_;
  HeightGrid grid_;
  bool is_grass_ = false, is_surfer_ = false;
};

}  // namespace

bool is_height_grid(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return false;
  const std::string low = lower_case(head.substr(begin, 512));
  const auto has = [&](const char* word) { return low.find(word) != std::string::npos; };
  if (low.starts_with("dsaa")) return true;
  if (low.starts_with("north:")) return has("rows:") && has("cols:");
  return (low.starts_with("ncols") || low.starts_with("nrows")) && has("ncols") && has("nrows") && has("xll");
}

ReadResult read_height_grid(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  return GridReader(path).read(progress);
}

}  // namespace sfumato::io
