#include "io/text_rows.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstring>
#include <exception>

#include "io/format.h"
#include "io/parallel.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t block_bytes = 4 << 20;
constexpr std::uint64_t longest_line = 1 << 20;
constexpr std::size_t batch_rows = 512;

[[noreturn]] void line_too_long(const File& file, std::uint64_t at) {
  bad_input(file.path(), "byte " + std::to_string(at),
            "found a line of more than " + std::to_string(longest_line) +
                " bytes, expected lines of numbers; "
                "this is no text of points");
}

/// The place behind the first line end at or after `from`, or the file's end.
std::uint64_t next_line(const File& file, std::uint64_t from) {
  constexpr std::size_t step = 16384;
  for (std::uint64_t at = from; at < file.size(); at += step) {
    if (at - from > longest_line) line_too_long(file, from);
    const std::string text = file.read_text(at, step);
    if (const std::size_t end = text.find('\n'); end != std::string::npos) return at + end + 1;
  }
  return file.size();
}

template <class Visit>
void for_each_line(std::string_view text, Visit&& visit) {
  while (!text.empty()) {
    const char* end = static_cast<const char*>(std::memchr(text.data(), '\n', text.size()));
    const std::size_t length = end ? std::size_t(end - text.data()) : text.size();
    if (!visit(text.substr(0, length))) return;
    text.remove_prefix(std::min(text.size(), length + 1));
  }
}

/// Calls `work(block, text of the block)` for every block, in order of the blocks, on several threads. The
/// error of the first bad block wins.
template <class Work>
void for_each_block(const File& file, const std::vector<TextBlocks::Block>& blocks, Progress& progress,
                    Work&& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::vector<std::exception_ptr> errors(blocks.size());
  in_parallel(std::min(blocks.size(), thread_count()), [&](std::size_t) {
    std::vector<char> bytes;
    for (std::size_t b; !stop && (b = next++) < blocks.size();) {
      try {
        progress.check();
        bytes.resize(std::size_t(blocks[b].end - blocks[b].begin));
        file.read(blocks[b].begin, std::as_writable_bytes(std::span(bytes)));
        work(b, std::string_view(bytes.data(), bytes.size()));
      } catch (...) {
        errors[b] = std::current_exception();
        stop = true;
      }
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace

namespace {

/// Whether a well formed number is below 1, however many digits it has.
bool is_tiny(const char* at, const char* end) {
  long long place = 0, written = 0;  // the exponent of the first digit that is not 0
  bool seen = false, behind_point = false;
  for (; at < end && *at != 'e' && *at != 'E'; ++at) {
    if (*at == '.') behind_point = true;
    if (*at < '0' || *at > '9') continue;
    if (!seen && *at != '0') {
      seen = true;
      place = behind_point ? place - 1 : 0;
    } else if (seen ? !behind_point : behind_point) {
      place += seen ? 1 : -1;
    }
  }
  if (at < end && ++at < end && *at == '+') ++at;
  const bool negative = at < end && *at == '-';
  if (std::from_chars(at, end, written).ec == std::errc::result_out_of_range) return negative;
  return written < -place;  // their sum may be more than fits
}

/// What Windows wrote for numbers that are none, from its # on: 1.#QNAN0, -1.#IND00, 1.#INF. Null for others.
const char* behind_no_number(const char* at, const char* end) {
  const std::string_view text(at, std::size_t(end - at));
  for (const std::string_view name : {"#QNAN", "#SNAN", "#IND", "#INF"})
    if (text.starts_with(name)) {
      at += name.size();
      while (at < end && unsigned(*at - '0') < 10) ++at;
      return at;
    }
  return nullptr;
}

}  // namespace

std::size_t count_words(std::string_view line) {
  std::size_t count = 0;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    ++count;
    while (at < end && !is_blank(*at)) ++at;
  }
  return count;
}

const char* parse_number(const char* at, const char* end, double& value) {
  static constexpr double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                     1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* begin = at;
  if (at < end && *at == '+') begin = ++at;
  const bool negative = at < end && *at == '-';
  if (negative) ++at;
  std::uint64_t mantissa = 0;
  const char* first_digit = at;
  while (at < end && unsigned(*at - '0') < 10) mantissa = mantissa * 10 + unsigned(*at++ - '0');
  std::ptrdiff_t digits = at - first_digit;
  int exponent = 0;
  if (at < end && *at == '.') {
    const char* fraction = ++at;
    if (at < end && *at == '#')
      if (const char* behind = behind_no_number(at, end)) {
        value = std::nan("");  // no coordinate, as infinity is none
        return behind;
      }
    while (at < end && unsigned(*at - '0') < 10) mantissa = mantissa * 10 + unsigned(*at++ - '0');
    exponent = -int(std::min<std::ptrdiff_t>(at - fraction, 1000));
    digits += at - fraction;
  }
  bool simple = digits > 0 && digits <= 19;
  if (simple && at < end && (*at == 'e' || *at == 'E')) {
    int written = 0;
    const char* number = at + 1;
    if (number < end && *number == '+') ++number;
    const auto [behind, error] = std::from_chars(number, end, written);
    simple = error == std::errc() && written > -400 && written < 400;
    exponent += written;
    at = behind;
  }
  // Both factors are exact, so the one multiplication or division rounds correctly (Clinger 1990).
  if (simple && mantissa <= (1ull << 53) && exponent >= -22 && exponent <= 22) {
    const double magnitude =
        exponent < 0 ? double(mantissa) / power[-exponent] : double(mantissa) * power[exponent];
    value = negative ? -magnitude : magnitude;
    return at;
  }
  const auto [behind, error] = std::from_chars(begin, end, value);
  if (error == std::errc::invalid_argument) return nullptr;
  // Beyond double: too large a number is no coordinate, and its point is dropped like any that is not finite;
  // one too small is 0. Which it is shows in the place of its first digit that is not 0.
  if (error == std::errc::result_out_of_range)
    value = is_tiny(begin, behind) ? 0 : std::numeric_limits<double>::infinity();
  return behind;
}

double next_number(const char*& at, const char* end, std::string_view what) {
  at = skip_blanks(at, end);
  if (at == end) throw LineError("the line ends before " + std::string(what));
  double value = 0;
  const char* behind = parse_plain_number(at, end, value);
  if (!behind) behind = parse_number(at, end, value);
  if (!behind || (behind < end && !is_blank(*behind))) {
    const char* word = at;
    while (at < end && !is_blank(*at) && at - word < 20) ++at;
    throw LineError("found '" + std::string(word, at) + "', expected a number for " + std::string(what));
  }
  at = behind;
  return value;
}

bool LineGrammar::counts(std::string_view line) const {
  return skip_blanks(line.data(), line.data() + line.size()) != line.data() + line.size();
}

TextBlocks cut_lines(const File& file, std::uint64_t begin, std::uint64_t first_line,
                     const LineGrammar& grammar, Progress& progress) {
  TextBlocks text;
  for (std::uint64_t at = std::min(begin, file.size()); at < file.size();) {
    const std::uint64_t end =
        file.size() - at <= block_bytes ? file.size() : next_line(file, at + block_bytes);
    text.blocks.push_back({at, end});
    at = end;
  }
  for_each_block(file, text.blocks, progress, [&](std::size_t b, std::string_view bytes) {
    TextBlocks::Block& block = text.blocks[b];
    for_each_line(bytes, [&](std::string_view line) {
      if (line.size() > longest_line)
        line_too_long(file, block.begin + std::uint64_t(line.data() - bytes.data()));
      ++block.lines;
      block.rows += grammar.counts(line);
      return true;
    });
  });
  text.lines = first_line;
  for (TextBlocks::Block& block : text.blocks) {
    block.first_row = text.rows;
    block.first_line = text.lines;
    text.rows += block.rows;
    text.lines += block.lines;
  }
  return text;
}

std::uint64_t whole_lines(const File& file, std::uint64_t lines) {
  const std::string last = file.size() > 0 ? file.read_text(file.size() - 1, 1) : "";
  return last == "\n" || last == "\r" || lines == 0 ? lines : lines - 1;
}

void read_rows(const File& file, const TextBlocks& text, std::uint64_t first, std::uint64_t last,
               const LineGrammar& grammar, std::vector<Column> columns, bool keep_places, Progress& progress,
               ReadResult& result) {
  const std::size_t width = columns.size();
  lay_out_as_doubles(columns);
  last = std::min(last, text.rows);
  first = std::min(first, last);
  // A number and what parts it from the next take two bytes: memory is asked for after checking.
  if (last - first > file.size() / (2 * width) + 1)
    bad_input(file.path(), "line " + std::to_string(text.lines),
              "found " + std::to_string(last - first) + " lines of points in " + std::to_string(file.size()) +
                  " bytes, expected " + std::to_string(width) + " numbers a line; most lines are too short");
  CloudBuilder builder(std::move(columns), std::size_t(last - first), false, keep_places);
  std::vector<CloudBuilder::Cursor> cursors;
  for (const TextBlocks::Block& block : text.blocks)
    cursors.push_back(
        builder.cursor(std::size_t(std::clamp(block.first_row, first, last) - first),
                       std::size_t(std::clamp(block.first_row + block.rows, first, last) - first)));
  std::atomic<std::size_t> done{0};
  for_each_block(file, text.blocks, progress, [&](std::size_t b, std::string_view bytes) {
    const TextBlocks::Block& block = text.blocks[b];
    CloudBuilder::Cursor& cursor = cursors[b];
    std::vector<double> rows(batch_rows * width);
    std::size_t filled = 0;
    std::uint64_t row = block.first_row, line_number = block.first_line, place = cursor.begin;
    const auto flush = [&] {
      builder.decode(cursor, reinterpret_cast<const std::byte*>(rows.data()), 0, filled, place);
      place += filled;
      filled = 0;
    };
    for_each_line(bytes, [&](std::string_view line) {
      if (row >= last) return false;
      if (grammar.counts(line) && row++ >= first) {
        try {
          filled += grammar.parse(line, rows.data() + filled * width);
        } catch (const LineError& error) {
          bad_input(file.path(), "line " + std::to_string(line_number),
                    std::string(error.what()) + "; the file is damaged or of another layout");
        }
        if (filled == batch_rows) flush();
      }
      ++line_number;
      return true;
    });
    flush();
    progress.update(double(++done) / double(text.blocks.size()), "reading");
  });
  builder.finish(cursors, result);
}

LineReader::LineReader(const File& file, std::uint64_t begin, std::uint64_t first_line)
    : file_(file), next_block_(begin), line_number_(first_line - 1) {}

bool LineReader::next(std::string_view& line) {
  for (;;) {
    const std::size_t end = buffer_.find('\n', at_);
    const bool last = next_block_ >= file_.size();
    if (end != std::string::npos || (last && at_ < buffer_.size())) {
      const std::size_t behind = end == std::string::npos ? buffer_.size() : end;
      line = std::string_view(buffer_).substr(at_, behind - at_);
      at_ = std::min(behind + 1, buffer_.size());
      ++line_number_;
      return true;
    }
    if (last) return false;
    if (buffer_.size() - at_ > longest_line) line_too_long(file_, next_block_);
    buffer_.erase(0, at_);
    at_ = 0;
    const std::string more = file_.read_text(next_block_, 1 << 20);
    next_block_ += more.size();
    buffer_ += more;
  }
}

}  // namespace sfumato::io
