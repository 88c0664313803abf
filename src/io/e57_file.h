// The pages of an E57 file (ASTM E2807): each ends with the CRC-32C of its other bytes, stored big-endian.
// Offsets in the file are physical, contents are read in the logical stream without the checksums.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/file.h"

namespace sfumato::io {

std::uint32_t crc32c(const std::byte* bytes, std::size_t size);

class E57File {
 public:
  explicit E57File(const std::filesystem::path& path);
  /// Logical bytes from a physical offset, every page checked. Error(bad_input) names the page that is
  /// damaged.
  std::vector<std::byte> read(std::uint64_t physical, std::uint64_t logical_size) const;
  /// The physical offset `logical_size` logical bytes behind `physical`.
  std::uint64_t behind(std::uint64_t physical, std::uint64_t logical_size) const;
  const std::string& xml() const { return xml_; }
  std::uint64_t size() const { return file_.size(); }
  [[noreturn]] void fail(std::uint64_t byte, const std::string& what) const;

 private:
  File file_;
  std::uint64_t page_size_ = 1024;
  std::string xml_;
};

}  // namespace sfumato::io
