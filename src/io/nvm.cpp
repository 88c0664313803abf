// Models of VisualSFM (Wu 2011): "NVM_V3", so many cameras, one a line, and so many points, each a place, a
// colour and where the pictures see it. A file may hold further, smaller models, which are not read.
#include "io/nvm.h"

#include <charconv>

#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

class NvmLines final : public LineGrammar {
 public:
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data(), *end = at + line.size();
    for (const char* what : {"x", "y", "z", "red", "green", "blue", "the number of measurements"})
      *row++ = next_number(at, end, what);
    return true;
  }
};

class NvmHead {
 public:
  explicit NvmHead(const File& file) : reader_(file, 0, 1) {}
  std::uint64_t rows = 0;  ///< lines that are not blank

  std::string_view line() {
    std::string_view line;
    do
      if (!reader_.next(line)) throw LineError("the file ends before its points");
    while (count_words(line) == 0);
    ++rows;
    return line;
  }
  std::uint64_t count() {
    const std::string_view text = line();
    const char *at = skip_blanks(text.data(), text.data() + text.size()), *end = text.data() + text.size();
    std::uint64_t count = 0;
    const auto [behind, error] = std::from_chars(at, end, count);
    if (error != std::errc() || skip_blanks(behind, end) != end)
      throw LineError("expected a whole number, alone in its line");
    return count;
  }
  std::uint64_t line_number() const { return reader_.line_number(); }

 private:
  LineReader reader_;
};

}  // namespace

bool is_nvm(std::string_view head) { return head.starts_with("NVM_V3"); }

ReadResult read_nvm(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  NvmHead head(file);
  std::uint64_t points = 0;
  try {
    head.line();
    for (std::uint64_t cameras = head.count(); cameras > 0; --cameras) {
      if (cameras % 65'536 == 0) progress.check();
      head.line();
    }
    points = head.count();
  } catch (const LineError& error) {
    bad_input(path, "line " + std::to_string(head.line_number()), error.what());
  }
  std::vector<Column> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back({name, StoredType::float64});
  for (const char* name : {"red", "green", "blue"}) columns.push_back({name, StoredType::uint8});
  columns.push_back({"track_length", StoredType::uint16});
  assign_roles(columns);
  const NvmLines grammar;
  const TextBlocks text = cut_lines(file, 0, 1, grammar, progress);
  ReadResult result;
  // Lines follow the points in whole files.
  const std::uint64_t held = text.rows - head.rows,
                      rows =
                          held_points(file, "line " + std::to_string(text.lines),
                                      held <= points ? whole_lines(file, held) : held, points, result.report);
  read_rows(file, text, head.rows, head.rows + rows, grammar, std::move(columns), false, progress, result);
  result.cloud.up = UpAxis::neg_y;  // of the first camera, whose y looks down
  result.cloud.provenance = Provenance::photographs;
  return result;
}

}  // namespace sfumato::io
