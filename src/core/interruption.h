// Ctrl-C for what waits where no Progress reaches: files at servers.
#pragma once

#include <atomic>

namespace sfumato {

/// True once the user wants everything to stop. Set in a signal handler.
inline constinit std::atomic<bool> interruption = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace sfumato
