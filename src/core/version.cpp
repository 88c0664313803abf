#include "core/version.h"

namespace sfumato {

const char* version() { return SFUMATO_VERSION; }

}  // namespace sfumato
