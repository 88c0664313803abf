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

/// What the columns of an array, or of a field that is one, are called: those of a cloud for known names,
/// else NAME or NAME_0, NAME_1 ...
std::vector<std::string> columns_named(const std::string& name, std::size_t width);

/// A list of numbers, rows of up to 256 of them, or records. Throws Error(bad_input).
NpyValues read_npy_values(const std::filesystem::path& file, Progress& progress);

}  // namespace sfumato::io
