// Words as they are compared: names of files, columns, formats.
#pragma once

#include <string>
#include <string_view>

namespace sfumato {

/// A to Z as a to z, whatever the locale; other bytes stay.
inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return lower;
}

}  // namespace sfumato
