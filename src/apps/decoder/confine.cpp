#include "confine.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cstddef>
#include <cstdint>
#include <iterator>

#if defined(__x86_64__)
#define SFUMATO_ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define SFUMATO_ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

namespace sfumato {

const char* confine() {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return "privileges cannot be given up";
#if defined(SFUMATO_ARCHITECTURE) && !defined(SFUMATO_DECODER_SANITIZED)  // sanitizers do more than compute
  constexpr std::uint32_t allowed[] = {SYS_recvfrom, SYS_sendto, SYS_futex, SYS_mmap, SYS_munmap, SYS_mremap,
                                       SYS_mprotect, SYS_madvise, SYS_brk, SYS_clock_gettime, SYS_getrandom,
                                       SYS_exit, SYS_exit_group, SYS_rt_sigreturn, SYS_restart_syscall,
                                       // abort()
                                       SYS_rt_sigprocmask, SYS_rt_sigaction, SYS_getpid, SYS_gettid,
                                       SYS_tgkill,
                                       // what is printed on the way down goes to /dev/null
                                       SYS_write, SYS_writev};
  struct sock_filter filter[4 + 2 * std::size(allowed) + 1] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SFUMATO_ARCHITECTURE, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr))};
  std::size_t n = 4;
  for (const std::uint32_t call : allowed) {
    filter[n++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    filter[n++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  filter[n++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS);
  struct sock_fprog program {};
  program.len = static_cast<unsigned short>(n);
  program.filter = filter;
  // A kernel without it leaves us with the limits.
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
#endif
  return nullptr;
}

}  // namespace sfumato
