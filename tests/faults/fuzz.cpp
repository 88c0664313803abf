// The fuzzer: SFUMATO_FUZZ_TARGET says what it feeds. See `make fuzz`.
#include <cstdio>
#include <cstdlib>

#include "faults/fuzz_targets.h"

namespace {
sfumato::test::FuzzTarget target = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("SFUMATO_FUZZ_TARGET");
  const auto& all = sfumato::test::fuzz_targets();
  if (const auto found = all.find(name ? name : ""); found != all.end()) return target = found->second, 0;
  std::fprintf(stderr, "SFUMATO_FUZZ_TARGET is one of:");
  for (const auto& [each, function] : all) std::fprintf(stderr, " %s", each.c_str());
  std::fprintf(stderr, "\n");
  std::exit(1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target({reinterpret_cast<const char*>(data), size});
  return 0;
}
