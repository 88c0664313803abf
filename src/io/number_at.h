// Numbers of little-endian files, wherever they lie.
#pragma once

#include <cstddef>
#include <cstring>

namespace sfumato::io {

template <class T>
T number_at(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

}  // namespace sfumato::io
