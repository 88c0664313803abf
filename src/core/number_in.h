// Numbers as text, whatever the locale.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace sfumato {

/// A number and nothing around it, neither blanks nor a plus; nothing for one that T cannot hold.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace sfumato
