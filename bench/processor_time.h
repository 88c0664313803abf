// Processor time of the process and its threads.
#pragma once

#include <sys/resource.h>

namespace sfumato::bench {

/// User and system time since it began, ms.
inline double cpu_ms() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1e3 * double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-3 * double(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

}  // namespace sfumato::bench
