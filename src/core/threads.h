// How many threads readers start.
#pragma once

namespace sfumato {

/// As many as the processor has, unless set.
unsigned thread_count();
void set_thread_count(unsigned count);

}  // namespace sfumato
