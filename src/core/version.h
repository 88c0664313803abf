#pragma once

namespace sfumato {

/// "major.minor.patch"
const char* version();

}  // namespace sfumato
