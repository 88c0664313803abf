#include "io/e57_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "io/format.h"
#include "io/number_at.h"

namespace sfumato::io {
namespace {

static_assert(std::endian::native == std::endian::little, "E57 is read as the memory has it");
constexpr std::uint64_t header_size = 48, checksum_size = 4, largest_xml = 64 << 20;

/// Tables for eight bytes at a time (Intel, "slicing by 8"), of the Castagnoli polynomial, bits reversed.
const std::array<std::array<std::uint32_t, 256>, 8>& tables() {
  static const auto all = [] {
    std::array<std::array<std::uint32_t, 256>, 8> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t crc = i;
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0x82F63B78u : 0);
      t[0][i] = crc;
    }
    for (std::size_t k = 1; k < 8; ++k)
      for (std::size_t i = 0; i < 256; ++i) t[k][i] = (t[k - 1][i] >> 8) ^ t[0][t[k - 1][i] & 255];
    return t;
  }();
  return all;
}

}  // namespace

std::uint32_t crc32c(const std::byte* bytes, std::size_t size) {
  const auto& t = tables();
  std::uint32_t crc = ~0u;
  for (; size >= 8; bytes += 8, size -= 8) {
    const std::uint32_t low = number_at<std::uint32_t>(bytes) ^ crc,
                        high = number_at<std::uint32_t>(bytes + 4);
    crc = t[7][low & 255] ^ t[6][low >> 8 & 255] ^ t[5][low >> 16 & 255] ^ t[4][low >> 24] ^
          t[3][high & 255] ^ t[2][high >> 8 & 255] ^ t[1][high >> 16 & 255] ^ t[0][high >> 24];
  }
  for (; size > 0; ++bytes, --size) crc = (crc >> 8) ^ t[0][(crc ^ std::uint32_t(*bytes)) & 255];
  return ~crc;
}

E57File::E57File(const std::filesystem::path& path) : file_(path) {
  std::byte head[header_size] = {};
  if (file_.size() < header_size)
    fail(file_.size(), "the file ends here, expected a header of 48 bytes; fetch it again");
  file_.read(0, head);
  if (std::memcmp(head, "ASTM-E57", 8) != 0) fail(0, "found no ASTM-E57, expected an E57 file");
  if (const auto major = number_at<std::uint32_t>(head + 8); major != 1)
    fail(8, "found E57 version " + std::to_string(major) + ", expected 1; convert the file");
  const auto length = number_at<std::uint64_t>(head + 16), xml_at = number_at<std::uint64_t>(head + 24),
             xml_size = number_at<std::uint64_t>(head + 32);
  page_size_ = number_at<std::uint64_t>(head + 40);
  if (page_size_ < 64 || page_size_ > (1 << 20) || page_size_ % 4 != 0)
    fail(40, "found pages of " + std::to_string(page_size_) + " bytes, expected 1024; the file is damaged");
  if (length > file_.size())
    fail(16, "found a length of " + std::to_string(length) + " bytes, expected the file's " +
                 std::to_string(file_.size()) + "; it is cut short, fetch it again");
  if (xml_size > largest_xml)
    fail(32,
         "found " + std::to_string(xml_size) + " bytes of XML, expected at most 64 MB; the file is damaged");
  const std::vector<std::byte> xml = read(xml_at, xml_size);
  xml_.assign(reinterpret_cast<const char*>(xml.data()), xml.size());
}

std::uint64_t E57File::behind(std::uint64_t physical, std::uint64_t logical_size) const {
  const std::uint64_t payload = page_size_ - checksum_size;
  const std::uint64_t at = physical / page_size_ * payload + physical % page_size_ + logical_size;
  return at / payload * page_size_ + at % payload;
}

std::vector<std::byte> E57File::read(std::uint64_t physical, std::uint64_t logical_size) const {
  const std::uint64_t payload = page_size_ - checksum_size;
  if (physical >= file_.size() || logical_size > file_.size() || physical % page_size_ >= payload ||
      behind(physical, logical_size) > file_.size())
    fail(std::min(physical, file_.size()),
         "expected " + std::to_string(logical_size) + " bytes here, beyond the file's " +
             std::to_string(file_.size()) + "; the file is cut short or damaged");
  std::vector<std::byte> out(logical_size);
  constexpr std::uint64_t pages_at_once = 1024;
  std::vector<std::byte> pages;
  std::uint64_t page = physical / page_size_, skip = physical % page_size_;
  for (std::uint64_t done = 0; done < logical_size;) {
    const std::uint64_t wanted = (skip + logical_size - done + payload - 1) / payload;
    const std::uint64_t held = file_.size() / page_size_ - std::min(page, file_.size() / page_size_);
    const std::uint64_t count = std::min({wanted, held, pages_at_once});
    if (count == 0) fail(page * page_size_, "the file ends inside a page; it is cut short, fetch it again");
    pages.resize(count * page_size_);
    file_.read(page * page_size_, pages);
    for (std::uint64_t i = 0; i < count && done < logical_size; ++i, ++page) {
      const std::byte* bytes = pages.data() + i * page_size_;
      const std::uint32_t stored = __builtin_bswap32(number_at<std::uint32_t>(bytes + payload));
      if (crc32c(bytes, payload) != stored)
        fail(page * page_size_,
             "found a wrong checksum of the page here; the file is damaged, fetch it again");
      const std::uint64_t part = std::min(payload - skip, logical_size - done);
      std::memcpy(out.data() + done, bytes + skip, part);
      done += part;
      skip = 0;
    }
  }
  return out;
}

void E57File::fail(std::uint64_t byte, const std::string& what) const {
  bad_input(file_.path(), "byte " + std::to_string(byte), what);
}

}  // namespace sfumato::io
