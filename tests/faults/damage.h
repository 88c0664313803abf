// Damage as it happens, and as somebody who means harm does it: the same for the same number.
#pragma once

#include <cstdint>
#include <string>

namespace sfumato::test {

/// `bytes` with one to four faults: bits, bytes and words changed (among them what sizes and counts must not
/// be), ends cut off, blocks lost, doubled, swapped or zeroed, and numbers of text changed to impossible
/// ones. Half of the places lie in the first 512 bytes, where headers are. Some of what is checked by sums
/// gets right sums again, or nothing behind the sums would ever be reached.
std::string damaged(const std::string& bytes, std::uint64_t number);

}  // namespace sfumato::test
