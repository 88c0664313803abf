#include "faults/damage.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "io/e57_file.h"

namespace sfumato::test {
namespace {

class Damage {
 public:
  Damage(std::string bytes, std::uint64_t number)
      : bytes_(std::move(bytes)), random_(number * 0x9E3779B97F4A7C15ull + 1) {}

  std::string make() {
    const std::string before = bytes_;
    for (std::uint64_t left = 1 + below(4); left > 0; --left) once();
    if (before.starts_with("ASTM-E57") && below(4) > 0) mend_e57();
    if (before.starts_with("\x89PNG") && below(4) > 0) mend_png();
    return std::move(bytes_);
  }

 private:
  std::uint64_t below(std::uint64_t limit) { return limit ? random_() % limit : 0; }
  std::size_t place() {
    return std::size_t(below(below(2) ? bytes_.size() : std::min<std::size_t>(512, bytes_.size())));
  }

  void once() {
    if (bytes_.empty()) return;
    const std::size_t at = place();
    const std::size_t length =
        std::min<std::size_t>(1 + std::size_t(below(below(2) ? 16 : 4096)), bytes_.size() - at);
    switch (below(12)) {
      case 0:
      case 1: bytes_[at] = char(bytes_[at] ^ char(1 << below(8))); break;
      case 2: bytes_[at] = "\0\xFF\x7F\x80\x01"[below(5)]; break;
      case 3: bytes_[at] = char(random_()); break;
      case 4:
      case 5: put_word(at); break;
      case 6: bytes_.resize(at); break;
      case 7: bytes_.erase(at, length); break;
      case 8: bytes_.insert(at, bytes_.substr(at, length)); break;
      case 9: std::fill_n(bytes_.begin() + std::ptrdiff_t(at), length, below(2) ? '\0' : '\xFF'); break;
      case 10: swap(at, length); break;
      case 11: put_number(at); break;
    }
  }

  // What a size, a count, an address or a coordinate should not be.
  void put_word(std::size_t at) {
    static constexpr std::array<std::uint64_t, 20> words = {0,
                                                            1,
                                                            2,
                                                            0xFF,
                                                            0x7FFF,
                                                            0xFFFF,
                                                            0x7FFFFFFF,
                                                            0x80000000,
                                                            0xFFFFFFFE,
                                                            0xFFFFFFFF,
                                                            0x100000000,
                                                            0x7FFFFFFFFFFFFFFF,
                                                            0x8000000000000000,
                                                            0xFFFFFFFFFFFFFFFE,
                                                            0xFFFFFFFFFFFFFFFF,
                                                            0x7FF8000000000000 /* NaN */,
                                                            0x7FF0000000000000 /* inf */,
                                                            0x7FC00000 /* NaN, single */,
                                                            0x7E37E43C8800759C /* 1e300 */,
                                                            0x0000000100000001};
    const std::uint64_t word =
        below(8) ? words[std::size_t(below(words.size()))] : bytes_.size() << (below(2) ? 32 : 0);
    const std::size_t size = std::size_t(1) << (1 + below(3));
    std::memcpy(bytes_.data() + at, &word, std::min(size, bytes_.size() - at));
  }

  void swap(std::size_t at, std::size_t length) {
    const std::size_t other = std::size_t(below(bytes_.size() - length + 1));
    if (other + length > at && at + length > other) return;
    std::swap_ranges(bytes_.begin() + std::ptrdiff_t(at), bytes_.begin() + std::ptrdiff_t(at + length),
                     bytes_.begin() + std::ptrdiff_t(other));
  }

  // The next number of a text.
  void put_number(std::size_t at) {
    static const std::array<const char*, 14> numbers = {"nan",
                                                        "inf",
                                                        "-1",
                                                        "0",
                                                        "1e400",
                                                        "1e-400",
                                                        "4294967296",
                                                        "2147483647",
                                                        "18446744073709551616",
                                                        "99999999999999999999999999",
                                                        "",
                                                        "-",
                                                        "1e308",
                                                        "0x10"};
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    while (at < bytes_.size() && !is_digit(bytes_[at])) ++at;
    std::size_t end = at;
    while (end < bytes_.size() && is_digit(bytes_[end])) ++end;
    if (at < end) bytes_.replace(at, end - at, numbers[std::size_t(below(numbers.size()))]);
  }

  void mend_e57() {
    for (std::size_t at = 0; at + 1024 <= bytes_.size(); at += 1024) {
      const std::uint32_t sum = io::crc32c(reinterpret_cast<const std::byte*>(bytes_.data() + at), 1020);
      for (std::size_t i = 0; i < 4; ++i) bytes_[at + 1020 + i] = char(sum >> (8 * (3 - i)));
    }
  }

  void mend_png() {
    const auto u32 = [&](std::size_t at) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes_[at + i]);
      return value;
    };
    for (std::size_t at = 8; at + 12 <= bytes_.size();) {
      const std::size_t size = u32(at);
      if (size > bytes_.size() - at - 12) return;
      std::uint32_t sum = ~0u;
      for (std::size_t i = at + 4; i < at + 8 + size; ++i) {
        sum ^= std::uint8_t(bytes_[i]);
        for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) ? 0xEDB88320u : 0);
      }
      for (std::size_t i = 0; i < 4; ++i) bytes_[at + 8 + size + i] = char(~sum >> (8 * (3 - i)));
      at += 12 + size;
    }
  }

  std::string bytes_;
  std::mt19937_64 random_;
};

}  // namespace

std::string damaged(const std::string& bytes, std::uint64_t number) { return Damage(bytes, number).make(); }

}  // namespace sfumato::test
