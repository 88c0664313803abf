// Point sets of Expe (Guennebaud's point renderer; also read and written by MeshLab): a header that names the
// properties of a point, then records, or lines whose properties are parted by semicolons.
#include <algorithm>
#include <charconv>
#include <optional>

#include "core/counted.h"
#include "io/file.h"
#include "io/flat_records.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::string_view first_words = "[Expe/PointSet/";

struct ExpeHeader {
  bool is_binary = false;
  std::uint64_t points = 0, data = 0;  ///< where the points begin, bytes
  std::uint64_t lines = 0;             ///< of the header
  std::size_t record = 0;              ///< bytes of a point
  std::vector<Column> columns;         ///< of all numbers of a point, as records hold them
};

std::optional<StoredType> type_of(std::string_view name) {
  if (name == "r32") return StoredType::float32;
  if (name == "i32") return StoredType::int32;
  if (name == "ui32") return StoredType::uint32;
  if (name == "i16") return StoredType::int16;
  if (name == "ui16") return StoredType::uint16;
  if (name == "i8") return StoredType::int8;
  if (name == "ui8") return StoredType::uint8;
  return std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    const char* first = at;
    while (at < end && !is_blank(*at)) ++at;
    words.emplace_back(first, std::size_t(at - first));
  }
  return words;
}

std::uint64_t count_of(std::string_view word) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size())
    throw LineError("found '" + std::string(word) + "', expected a whole number");
  return count;
}

/// Adds the numbers of a property. Version 0.1 has their bytes, 0.2 how many and their type.
void add_property(ExpeHeader& header, const std::vector<std::string_view>& words) {
  if (words.size() != 3 && words.size() != 4) throw LineError("expected 'property NAME SIZE [TYPE]'");
  const std::string name(words[1]);
  std::uint64_t numbers = count_of(words[2]);
  StoredType type = name == "color" ? StoredType::uint8 : StoredType::float32;
  if (words.size() == 4) {
    const std::optional<StoredType> named = type_of(words[3]);
    if (!named) throw LineError("found numbers of type '" + std::string(words[3]) + "'");
    type = *named;
  } else if (numbers % size_of(type) != 0) {
    type = StoredType::uint8;
  }
  if (words.size() == 3) numbers /= size_of(type);
  constexpr std::uint64_t most = 256;  // as of text
  if (numbers > most - std::min<std::uint64_t>(most, header.columns.size()))
    throw LineError("found more than " + counted(most, "number") + " a point");
  static constexpr const char* position[] = {"x", "y", "z"};
  static constexpr const char* normal[] = {"nx", "ny", "nz"};
  static constexpr const char* color[] = {"red", "green", "blue", "alpha"};
  for (std::uint64_t k = 0; k < numbers; ++k) {
    std::string each = numbers == 1 ? name : name + "_" + std::to_string(k + 1);
    if (name == "position" && k < 3) each = position[k];
    if (name == "normal" && k < 3) each = normal[k];
    if (name == "color" && k < 4) each = color[k];
    header.columns.push_back({each, type, type, header.record, 0});
    header.record += size_of(type);
  }
}

ExpeHeader read_expe_header(const File& file) {
  constexpr std::size_t most_bytes = 64 << 10;
  const std::string head = file.read_text(0, most_bytes);
  ExpeHeader header;
  std::optional<std::uint64_t> points;
  std::string_view rest = head;
  try {
    for (;;) {
      const std::size_t end = rest.find('\n');
      ++header.lines;
      if (end == std::string_view::npos) throw LineError("the file ends before 'data'");
      const std::vector<std::string_view> words = words_of(rest.substr(0, end));
      rest.remove_prefix(end + 1);
      if (words.empty()) continue;
      if (words[0].starts_with(first_words))
        header.is_binary = words[0].find("/Binary/") != std::string_view::npos;
      else if (words[0] == "property")
        add_property(header, words);
      else if (words[0] == "nofpoints" && words.size() == 2)
        points = count_of(words[1]);
      else if (words[0] == "data")
        break;
    }
    if (!points) throw LineError("found no number of points");
    header.points = *points;
    header.data = head.size() - rest.size();
    for (Column& column : header.columns) column.stride = header.record;
    if (!assign_roles(header.columns)) throw LineError("found no property 'position' of three numbers");
  } catch (const LineError& error) {
    bad_input(file.path(), "line " + std::to_string(header.lines), error.what());
  }
  return header;
}

/// `0.1,2,3 ; 0.6 ; 0,0,1 ; 255,255,255,255`
class ExpeLines final : public LineGrammar {
 public:
  explicit ExpeLines(std::size_t numbers) : numbers_(numbers) {}
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data(), *end = at + line.size();
    for (std::size_t k = 0; k < numbers_; ++k) {
      while (at < end && (is_blank(*at) || *at == ',' || *at == ';')) ++at;
      const char* behind = parse_number(at, end, row[k]);
      if (!behind) throw LineError("expected " + counted(numbers_, "number"));
      at = behind;
    }
    return true;
  }

 private:
  std::size_t numbers_;
};

}  // namespace

bool is_expe(std::string_view head) { return head.starts_with(first_words); }

ReadResult read_expe(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  ExpeHeader header = read_expe_header(file);
  ReadResult result;
  if (header.is_binary) {
    ReadReport damage;
    const std::uint64_t held = (file.size() - header.data) / header.record;
    const std::uint64_t rows =
        held_points(file, "byte " + std::to_string(file.size()), held, header.points, damage);
    result = read_flat_records(file, std::move(header.columns), rows, header.record, progress, header.data);
    result.report.damage = std::move(damage.damage);
    result.report.points_missing = damage.points_missing;
    result.report.points += damage.points_missing;
  } else {
    // Who writes lines writes colours of 0 to 1 as well, whatever type the header names.
    for (Column& column : header.columns)
      if (column.role == Role::red || column.role == Role::green || column.role == Role::blue ||
          column.role == Role::alpha)
        column.stored = StoredType::float32;
    const ExpeLines grammar(header.columns.size());
    const TextBlocks text = cut_lines(file, header.data, header.lines + 1, grammar, progress);
    const std::uint64_t rows = held_points(
        file, "line " + std::to_string(text.lines),
        text.rows < header.points ? whole_lines(file, text.rows) : text.rows, header.points, result.report);
    read_rows(file, text, 0, rows, grammar, std::move(header.columns), false, progress, result);
  }
  result.cloud.up = UpAxis::pos_y;  // models, as in PLY
  return result;
}

}  // namespace sfumato::io
