#include "io/bounded_json.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "io/file.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t largest_file = 16 << 20;
constexpr std::size_t deepest = 16, most_keys = 1000;

}  // namespace

nlohmann::ordered_json parse_json(std::string_view text, const std::string& where) {
  using Json = nlohmann::ordered_json;
  auto refuse = [&](const std::string& what) { throw Error(ErrorCode::bad_input, where + ": " + what); };
  std::vector<std::size_t> keys;  // of the open objects and lists
  // Messages quote keys and values, and are one line.
  const auto is_line = [](const std::string& quoted) {
    return std::none_of(quoted.begin(), quoted.end(), [](unsigned char c) { return c < 32; });
  };
  const auto bound = [&](int, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) {
      keys.push_back(0);
      if (keys.size() > deepest)
        refuse("nested more than " + std::to_string(deepest) + " deep; write it flat");
    } else if (event == Event::object_end || event == Event::array_end) {
      keys.pop_back();
    } else if (event == Event::key && ++keys.back() > most_keys) {
      refuse("an object of more than " + std::to_string(most_keys) + " keys; sfumato writes none");
    }
    const bool is_text = event == Event::key || (event == Event::value && parsed.is_string());
    if (is_text && !is_line(parsed.get_ref<const std::string&>()))
      refuse("a key or a text holds a line break or another control character; sfumato writes none");
    return true;
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  try {
    return Json::parse(text.begin(), text.end(), bound);
  } catch (const Json::parse_error& error) {
    const std::string_view read = text.substr(0, error.byte > 0 ? std::min(error.byte - 1, text.size()) : 0);
    const std::size_t line = 1 + std::size_t(std::count(read.begin(), read.end(), '\n'));
    const std::size_t column = read.size() - (read.rfind('\n') == read.npos ? 0 : read.rfind('\n') + 1) + 1;
    std::string what =
        error.what();  // "... syntax error while parsing object - unexpected ...; expected ..."
    what = what.substr(what.find(" - ") == what.npos ? what.size() : what.find(" - ") + 3);
    what = what.substr(0, what.find("; last read"));
    refuse("not valid JSON: line " + std::to_string(line) + ", column " + std::to_string(column) +
           (what.empty() ? "" : ": " + what));
  } catch (const Json::exception&) {  // 1e400
    refuse("a number is too large; numbers end at 1.8e308");
  }
  return {};
}

nlohmann::ordered_json load_json(const std::filesystem::path& file) {
  const File input(file);
  if (input.size() > largest_file)
    throw Error(ErrorCode::bad_input,
                file.string() + ": larger than 16 MB; this is no camera, path or preset");
  return parse_json(input.read_text(0, std::size_t(input.size())), file.string());
}

bool begins_as_object_with(std::string_view head, std::initializer_list<std::string_view> words) {
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  return begin < head.size() && head[begin] == '{' &&
         std::all_of(words.begin(), words.end(), [&](std::string_view word) {
           return head.find('"' + std::string(word) + '"') != head.npos;
         });
}

}  // namespace sfumato::io
