// Numbers of things in sentences: "1 point", "2 points".
#pragma once

#include <cstdint>
#include <string>

namespace sfumato {

/// "12 345 678".
inline std::string thousands(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), 1, ' ');
  return text;
}

/// `noun` is regular: its plural ends in s.
inline std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// "1 point is", "2 points are".
inline std::string are(std::uint64_t count, const std::string& noun) {
  return counted(count, noun) + (count == 1 ? " is" : " are");
}

/// "2 points" where that is all of them, "1 of 2 points".
inline std::string counted_of(std::uint64_t count, std::uint64_t all, const std::string& noun) {
  return (count == all ? "" : std::to_string(count) + " of ") + counted(all, noun);
}

}  // namespace sfumato
