// The numbers of one NPY array, for files that hold several.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/io.h"

namespace sfumato::io {

struct NpyValues {
  std::vector<std::string> names;  ///< of records whose fields all have one; otherwise none
  std::vector<StoredType> types;
  std::vector<std::vector<double>> columns;
};

/// A list of numbers, rows of up to 256 of them, or records. Throws Error(bad_input).
NpyValues read_npy_values(const std::filesystem::path& file, Progress& progress);

}  // namespace sfumato::io
