// What somebody meant who wrote an option or a command that does not exist.
#pragma once

#include <string>
#include <vector>

namespace sfumato::cli {

/// "; did you mean --point-size?", or nothing. `names` with their dashes.
std::string suggest_option(const std::string& word, const std::vector<std::string>& names);

}  // namespace sfumato::cli
