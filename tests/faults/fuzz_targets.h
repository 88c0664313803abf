// What reads bytes that nobody vouches for, by name: fed by libFuzzer (`make fuzz`) and by the corpora in
// tests/corpus.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace sfumato::test {

/// Ends the process when the bytes do what they must not.
using FuzzTarget = void (*)(std::string_view bytes);
const std::map<std::string, FuzzTarget>& fuzz_targets();

}  // namespace sfumato::test
