// PTX (Leica): scans one after the other, each a grid of scan directions, column after column, with the
// scanner's pose and a matrix for row vectors. A cell at 0 0 0 had no return.
#include <algorithm>
#include <cmath>
#include <optional>

#include "io/file.h"
#include "io/format.h"
#include "io/table.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    double value = 0;
    at = parse_number(at, end, value);
    if (!at || (at < end && !is_blank(*at)) || numbers.size() > 16) return std::nullopt;
    numbers.push_back(value);
  }
  return numbers;
}

struct Scan {
  std::size_t first = 0, cells = 0;
  std::uint32_t columns = 0, rows = 0;
  dvec3 scanner{0};
};

class PtxReader {
 public:
  explicit PtxReader(const std::filesystem::path& path) : file_(path), lines_(file_, 0, 1) {}

  ReadResult read(Progress& progress) {
    while (read_scan(progress)) {
    }
    const bool has_color = !values_[4].empty(), has_intensity = !values_[3].empty();
    std::vector<Column> columns;
    const char* names[] = {"x", "y", "z", "intensity", "red", "green", "blue"};
    std::vector<int> used{0, 1, 2};
    if (has_intensity) used.push_back(3);
    if (has_color) used.insert(used.end(), {4, 5, 6});
    for (int k : used) columns.push_back({names[k], StoredType::float64});
    if (scans_.size() > 1) columns.push_back({"scanner", StoredType::uint32});
    assign_roles(columns);
    Table table(std::move(columns), values_[0].size());
    for (std::size_t i = 0; i < used.size(); ++i) {
      std::vector<double>& from = values_[std::size_t(used[i])];
      from.resize(table.rows(), std::nan(""));  // scans at the end may lack what others have
      std::copy(from.begin(), from.end(), table.column(i).begin());
      from = {};
    }
    if (std::span<double> scanner = table.column("scanner"); !scanner.empty())
      for (std::size_t s = 0; s < scans_.size(); ++s)
        std::fill_n(scanner.begin() + std::ptrdiff_t(scans_[s].first), scans_[s].cells, double(s));
    ReadResult result;
    table.build(true, progress, result);
    // Text says nothing about types: float unless the numbers need the offset.
    for (ScalarField& field : result.cloud.scalars)
      if (field.offset == 0) field.type = StoredType::float32;
    place_grids(result.cloud);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    bad_input(file_.path(), "line " + std::to_string(lines_.line_number()), what);
  }

  std::vector<double> next(std::size_t count, const char* what) {
    std::string_view line;
    if (!lines_.next(line))
      fail(std::string("the file ends before ") + what + "; it is cut short, fetch it again");
    const auto numbers = numbers_of(line);
    if (!numbers || numbers->size() != count)
      fail("found '" + std::string(line.substr(0, 20)) + "', expected " + what + " (" +
           std::to_string(count) + " numbers); the file is damaged");
    return *numbers;
  }

  std::uint32_t size(double value) const {
    if (!(value >= 0 && value <= 0x1p31) || value != std::floor(value))
      fail("found no size of a grid; the file is damaged");
    return std::uint32_t(value);
  }

  bool read_scan(Progress& progress) {
    std::string_view line;
    do {
      if (!lines_.next(line)) return false;
    } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
    const auto first = numbers_of(line);
    if (!first || first->size() != 1)
      fail("found '" + std::string(line.substr(0, 20)) + "', expected the columns of a scan");
    Scan scan;
    scan.columns = size((*first)[0]);
    scan.rows = size(next(1, "the rows of the scan")[0]);
    scan.first = values_[0].size();
    scan.cells = std::size_t(scan.columns) * scan.rows;
    // The shortest line of a cell is "0 0 0" and its end.
    if (scan.cells > file_.size() / 6 + 1)
      fail("found a grid of " + std::to_string(scan.cells) + " cells, more than the file of " +
           std::to_string(file_.size()) + " bytes can hold; it is cut short or damaged");
    next(3, "the scanner's position");
    for (int axis = 0; axis < 3; ++axis) next(3, "the scanner's axes");
    double m[4][4];
    for (auto& row : m) {
      const std::vector<double> numbers = next(4, "the matrix");
      for (int k = 0; k < 4; ++k)
        row[k] = std::isfinite(numbers[std::size_t(k)]) ? numbers[std::size_t(k)] : 0;
    }
    scan.scanner = {m[3][0], m[3][1], m[3][2]};
    for (std::size_t i = 0; i < scan.cells; ++i) {
      if (i % 65536 == 0) {
        progress.check();
        progress.update(double(i) / double(scan.cells), "reading scan " + std::to_string(scans_.size() + 1));
      }
      read_cell(m);
    }
    leave_out_zero_colors(scan);
    scans_.push_back(scan);
    return true;
  }

  void read_cell(const double (&m)[4][4]) {
    std::string_view line;
    if (!lines_.next(line)) fail("the file ends inside a grid; it is cut short, fetch it again");
    double v[7];
    int count = 0;
    for (const char *at = line.data(), *end = at + line.size();
         count < 7 && (at = skip_blanks(at, end)) < end; ++count) {
      const char* behind = parse_number(at, end, v[count]);
      if (!behind || (behind < end && !is_blank(*behind)))
        fail("found '" + std::string(at, std::min(end, at + 20)) +
             "', expected a number; the file is damaged");
      at = behind;
    }
    if (count != 3 && count != 4 && count != 6 && count != 7)
      fail("found " + std::to_string(count) +
           " numbers, expected x y z [intensity] [r g b]; the file is damaged");
    const std::size_t place = values_[0].size();
    const bool missing = v[0] == 0 && v[1] == 0 && v[2] == 0;
    for (int k = 0; k < 3; ++k)
      values_[std::size_t(k)].push_back(missing ? std::nan("")
                                                : v[0] * m[0][k] + v[1] * m[1][k] + v[2] * m[2][k] + m[3][k]);
    const int color = count == 6 ? 3 : 4;
    const auto keep = [&](std::size_t column, double value) {
      values_[column].resize(place, std::nan(""));  // earlier scans may have had no such column
      values_[column].push_back(missing ? std::nan("") : value);
    };
    if (count == 4 || count == 7) keep(3, v[3]);
    for (int k = 0; k < 3 && count >= 6; ++k) keep(std::size_t(4 + k), v[color + k]);
  }

  /// A scan whose colours are all zero has none.
  void leave_out_zero_colors(const Scan& scan) {
    const auto begin = [&](std::size_t k) {
      return values_[k].begin() + std::ptrdiff_t(std::min(values_[k].size(), scan.first));
    };
    for (std::size_t k = 4; k < 7; ++k)
      if (std::any_of(begin(k), values_[k].end(), [](double value) { return value > 0; })) return;
    for (std::size_t k = 4; k < 7; ++k) std::fill(begin(k), values_[k].end(), std::nan(""));
  }

  /// From record numbers, column after column, to places in each scan's grid.
  void place_grids(PointCloud& cloud) const {
    std::size_t at = 0;
    for (const Scan& scan : scans_) {
      Grid grid{at, 0, scan.columns, scan.rows, scan.scanner};
      for (; at < cloud.size() && cloud.grid_index[at] < scan.first + scan.cells; ++at) {
        const std::size_t cell = cloud.grid_index[at] - scan.first;
        cloud.grid_index[at] = std::uint32_t(cell % scan.rows * scan.columns + cell / scan.rows);
      }
      grid.count = at - grid.first;
      cloud.grids.push_back(grid);
      cloud.scanners.push_back(scan.scanner);
    }
  }

  File file_;
  LineReader lines_;
  std::vector<double> values_[7];
  std::vector<Scan> scans_;
};

}  // namespace

bool is_ptx(std::string_view head) {
  // Two counts, then three numbers on each of four lines, then the matrix.
  const std::size_t counts[] = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
  for (std::size_t count : counts) {
    const std::size_t end = head.find('\n');
    if (end == std::string_view::npos) return false;
    const auto numbers = numbers_of(head.substr(0, end));
    if (!numbers || numbers->size() != count) return false;
    head.remove_prefix(end + 1);
  }
  return true;
}

ReadResult read_ptx(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  return PtxReader(path).read(progress);
}

}  // namespace sfumato::io
