// Zips: which files are inside, and their bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "io/byte_source.h"

namespace sfumato::io {

struct ZipMember {
  std::string name;
  std::uint64_t byte = 0, packed = 0, size = 0;
  bool is_deflated = false;
};

/// The list at the end of the zip. Throws Error(bad_input).
std::vector<ZipMember> zip_members(const ByteSource& file, const std::filesystem::path& path);

/// Calls `take` with the bytes of a member in order, at most `member.size`. Throws Error(bad_input) where
/// they are damaged.
void unpack(const ByteSource& file, const std::filesystem::path& path, const ZipMember& member,
            const std::function<void(std::span<const char>)>& take, Progress& progress = no_progress());

}  // namespace sfumato::io
