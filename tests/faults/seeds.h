// Small whole files, at least one a format: what damage and fuzzing begin with.
#pragma once

#include <string>
#include <vector>

namespace sfumato::test {

struct Seed {
  std::string format;     ///< the fuzz target of that name reads it
  std::string extension;  ///< ".laz"
  std::string bytes;
  std::string companion_name, companion;  ///< a second file that the first one names
};

/// Writes temporary files; the same bytes each time.
std::vector<Seed> seeds();

}  // namespace sfumato::test
