// Drags files from another program and drops them on a window: a source of XDND, version 5, as file managers
// are.
#pragma once

#include <string>
#include <vector>

namespace sfumato::testing {

/// On the window below that place of the screen. Empty, or what went wrong.
std::string drop_files(const std::vector<std::string>& paths, int x, int y);

}  // namespace sfumato::testing
