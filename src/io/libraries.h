// The libraries behind reading and writing, for `--version`.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sfumato::io {

std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace sfumato::io
