#include "io/bounded_json.h"

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
  const auto bound = [&](int, Json::parse_event_t event, Json&) {
    using Event = Json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) {
      keys.push_back(0);
      if (keys.size() > deepest) refuse("nested more than " + std::to_string(deepest) + " deep; write it flat");
    } else if (event == Event::object_end || event == Event::array_end) {
      keys.pop_back();
    } else if (event == Event::key && ++keys.back() > most_keys) {
      refuse("an object of more than " + std::to_string(most_keys) + " keys; this is no file of ours");
    }
    return true;
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  Json json = Json::parse(text.begin(), text.end(), bound, false);
  if (json.is_discarded()) refuse("not valid JSON");
  return json;
}

nlohmann::ordered_json load_json(const std::filesystem::path& file) {
  const File input(file);
  if (input.size() > largest_file)
    throw Error(ErrorCode::bad_input, file.string() + ": larger than 16 MB; this is no camera, path or preset");
  return parse_json(input.read_text(0, std::size_t(input.size())), file.string());
}

}  // namespace sfumato::io
