// JSON from files that nobody vouches for: nested at most 16 deep, objects of at most 1000 keys, at most 16
// MB. Deeper nesting would overflow the stack of whoever walks it; the key lists of our ordered objects are
// searched one by one.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace sfumato::io {

/// Throws Error(bad_input) that begins with `where`.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& where);
nlohmann::ordered_json load_json(const std::filesystem::path& file);
/// Whether a file that begins so is an object of JSON which has these words in quotes there.
bool begins_as_object_with(std::string_view head, std::initializer_list<std::string_view> words);

}  // namespace sfumato::io
