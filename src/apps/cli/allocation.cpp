#include "allocation.h"

#include <sys/auxv.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace sfumato::cli {
namespace {

constexpr const char* name = "GLIBC_TUNABLES";
/// Pages of 2 MB where the system has them on request (glibc 2.35); arrays of any size are kept for the next,
/// up to 256 MB at the end of the heap.
constexpr const char* ours =
    "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=1099511627776:"
    "glibc.malloc.trim_threshold=268435456";

}  // namespace

void allocate_in_large_pages(char** argv) {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (const char* given = std::getenv(name)) {
    if (std::string_view(ours).starts_with(given)) unsetenv(name);  // glibc 2.36 cuts it at its first colon
    return;
  }
  // With rights of another user the loader takes the variable out; started by a loader by hand, the program
  // is the loader.
  if (getauxval(AT_SECURE) || !getauxval(AT_BASE)) return;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  setenv(name, ours, 1);
  if (!error) execv(program.c_str(), argv);
  unsetenv(name);
#endif
}

}  // namespace sfumato::cli
