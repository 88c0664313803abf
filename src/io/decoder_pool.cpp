#include "io/decoder_pool.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/file.h"

extern char** environ;

namespace sfumato::io {
namespace {

namespace fs = std::filesystem;

// A process that took more shared memory for one job is not kept for the next.
constexpr std::uint64_t kept_memory = 64 << 20;
// Records a second that the slowest machine decodes at the least; LASzip makes 2 to 5 million on ours.
constexpr std::uint64_t slowest_rate = 50'000;
constexpr int hello_wait_ms = 20'000, poll_ms = 50;

/// A file descriptor that closes itself.
class Handle {
 public:
  Handle() = default;
  explicit Handle(int handle) : handle_(handle) {}
  Handle(Handle&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Handle() {
    if (handle_ >= 0) ::close(handle_);
  }
  int get() const { return handle_; }

 private:
  int handle_ = -1;
};

/// Where the decoder may be; the first that is there is taken.
std::vector<fs::path> places() {
  std::vector<fs::path> all;
  Dl_info info{};
  std::error_code ignored;
  const auto add = [&](const fs::path& file) {
    const fs::path folder = fs::canonical(file, ignored).parent_path();
    if (ignored || folder.empty()) return;
    all.push_back(folder / "sfumato-decoder");
    all.push_back(folder.parent_path() / "libexec" / "sfumato" / "sfumato-decoder");
  };
  // A name that is not absolute is what the program was called, which may be anything in the folder it is
  // called from.
  if (::dladdr(reinterpret_cast<const void*>(&why_no_decoders), &info) && info.dli_fname &&
      info.dli_fname[0] == '/')
    add(info.dli_fname);
  add("/proc/self/exe");
  all.push_back(SFUMATO_DECODER_FILE);
  return all;
}

}  // namespace

class DecoderJob::Process {
 public:
  explicit Process(const fs::path& program) {
    memory_ = Handle(::memfd_create("sfumato decoder", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    int pair[2] = {-1, -1};
    if (memory_.get() < 0 || ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0)
      fail("cannot be set up", errno);
    socket_ = Handle(pair[0]);
    const Handle other(pair[1]);
    // Shared memory cut short would end us with SIGBUS.
    if (::fcntl(memory_.get(), F_ADD_SEALS, F_SEAL_SHRINK) != 0) fail("cannot be set up", errno);
    // dup2 onto the same number would keep close-on-exec: both numbers come from above.
    const Handle far_socket(::fcntl(other.get(), F_DUPFD_CLOEXEC, 16)),
        far_memory(::fcntl(memory_.get(), F_DUPFD_CLOEXEC, 16));
    if (far_socket.get() < 0 || far_memory.get() < 0) fail("cannot be set up", errno);
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, far_socket.get(), decoder_socket);
    ::posix_spawn_file_actions_adddup2(&actions, far_memory.get(), decoder_memory);
    sigset_t none, all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &all);
    ::posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C is ours to answer
    ::posix_spawnattr_setflags(&attributes,
                               POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    char name[] = "sfumato-decoder";
    char* const words[] = {name, nullptr};
    const int error = ::posix_spawn(&id_, program.c_str(), &actions, &attributes, words, environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
    if (error != 0) id_ = -1, fail("cannot be started", error);
#ifdef SYS_pidfd_open
    id_handle_ = Handle(int(::syscall(SYS_pidfd_open, id_, 0)));
#endif
  }

  ~Process() {
    if (map_) ::munmap(map_, map_size_);
    socket_ = Handle();  // an idle process ends of this
    if (is_busy) kill();
    if (id_ > 0 && is_busy)
      wait();
    else if (id_ > 0)
      ::waitpid(id_, nullptr, WNOHANG);
  }

  Process(const Process&) = delete;

  void kill() const {
    if (id_ <= 0) return;
#ifdef SYS_pidfd_send_signal
    if (id_handle_.get() >= 0) {
      ::syscall(SYS_pidfd_send_signal, id_handle_.get(), SIGKILL, nullptr, 0);
      return;
    }
#endif
    ::kill(id_, SIGKILL);
  }

  /// Of what it ended; empty when that cannot be known, as in programs that wait for every child themselves.
  std::string wait() {
    int status = 0;
    pid_t got = -1;
    while (id_ > 0 && (got = ::waitpid(id_, &status, 0)) < 0 && errno == EINTR) {
    }
    id_ = -1;
    if (got <= 0) return {};
    if (!WIFSIGNALED(status)) return "exit code " + std::to_string(WEXITSTATUS(status));
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return "SIGXCPU, it took too long";
    if (signal == SIGSYS) return "SIGSYS, it called what it may not";
    const char* name = ::sigabbrev_np(signal);
    return name ? std::string("SIG") + name : "signal " + std::to_string(signal);
  }

  int socket() const { return socket_.get(); }
  std::uint8_t* map() const { return map_; }
  std::uint64_t map_size() const { return map_size_; }

  void grow(std::uint64_t size) {
    if (size <= map_size_) return;
    size = (std::max<std::uint64_t>(size + size / 4, 1 << 20) + 4095) / 4096 * 4096;
    if (map_) ::munmap(map_, map_size_);
    map_ = nullptr, map_size_ = 0;
    void* mapped = MAP_FAILED;
    if (::ftruncate(memory_.get(), off_t(size)) == 0)
      mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory_.get(), 0);
    if (mapped == MAP_FAILED)
      throw Error(ErrorCode::out_of_memory,
                  "decoding needs " + std::to_string(size >> 20) + " MB (" + cause_of(errno) +
                      "); close other programs, or take fewer threads (SFUMATO_THREADS=1)");
    map_ = static_cast<std::uint8_t*>(mapped), map_size_ = size;
  }

  /// What it may take from now on. A limit that cannot be set is one that is tighter already.
  void limit(std::uint64_t memory, std::uint64_t seconds) const {
    struct rlimit space {
    }, time{};
    if (::prlimit(id_, RLIMIT_AS, nullptr, &space) == 0) {
      space.rlim_cur = std::min<rlim_t>(space.rlim_max, memory);
#ifndef SFUMATO_DECODER_SANITIZED
      ::prlimit(id_, RLIMIT_AS, &space, nullptr);
#endif
    }
    if (const time_t used = used_seconds(); used >= 0 && ::prlimit(id_, RLIMIT_CPU, nullptr, &time) == 0) {
      time.rlim_cur = std::min<rlim_t>(time.rlim_max, rlim_t(used) + 1 + seconds);
      ::prlimit(id_, RLIMIT_CPU, &time, nullptr);
    }
  }

  /// It is somebody else's.
  void abandon() { id_ = -1; }

  bool is_busy = false;

 private:
  /// Processor time so far; negative when it cannot be known. Linux holds RLIMIT_CPU against ticks of its
  /// timer, not against the time that was used, and for work in short turns the two drift apart: by 0.5 s in
  /// 17 s, measured on a busy machine.
  time_t used_seconds() const {
    clockid_t precise{};
    struct timespec used {
    }, ticks{};
    if (::clock_getcpuclockid(id_, &precise) != 0 || ::clock_gettime(precise, &used) != 0) return -1;
    const clockid_t by_ticks =
        precise & ~clockid_t(7);  // CPUCLOCK_PROF of the same process; the low bits are the kind
    if (::clock_gettime(by_ticks, &ticks) != 0) return used.tv_sec;
    return std::max(used.tv_sec, ticks.tv_sec);
  }

  [[noreturn]] static void fail(const std::string& what, int error) {
    throw std::runtime_error(what + " (" + cause_of(error) + ")");
  }

  pid_t id_ = -1;
  Handle socket_, memory_, id_handle_;
  std::uint8_t* map_ = nullptr;
  std::uint64_t map_size_ = 0;
};

namespace {

/// Waits for a packet: true when there is one, or the end. `wait_ms` < 0: as long as it takes.
bool is_ready(int socket, int wait_ms, const Progress& progress) {
  struct pollfd one {
    socket, POLLIN, 0
  };
  for (int waited = 0; wait_ms < 0 || waited < wait_ms; waited += poll_ms) {
    const int got = ::poll(&one, 1, poll_ms);
    if (got > 0) return true;
    progress.check();
  }
  return false;
}

template <class Message>
bool send(int socket, const Message& message) {
  ssize_t sent = 0;
  do sent = ::send(socket, &message, sizeof message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == ssize_t(sizeof message);
}

template <class Message>
bool take(int socket, Message& message) {
  ssize_t got = 0;
  do got = ::recv(socket, &message, sizeof message, 0);
  while (got < 0 && errno == EINTR);
  return got == ssize_t(sizeof message);
}

}  // namespace

class DecoderPool {
 public:
  using Process = DecoderJob::Process;

  static DecoderPool& get() {
    static auto* pool =
        new DecoderPool;  // never destroyed: sockets close when we end, and the processes with them
    return *pool;
  }

  std::string why_none() {
    const std::lock_guard lock(mutex_);
    forget_those_of_parent();
    find();
    return reason_;
  }

  std::unique_ptr<Process> take() {
    {
      const std::lock_guard lock(mutex_);
      forget_those_of_parent();
      find();
      while (!idle_.empty()) {
        std::unique_ptr<Process> process = std::move(idle_.back());
        idle_.pop_back();
        struct pollfd one {
          process->socket(), POLLIN, 0
        };
        if (::poll(&one, 1, 0) == 0) return process;  // otherwise somebody has ended it
      }
    }
    try {
      return started();
    } catch (const std::runtime_error& error) {
      throw Error(ErrorCode::out_of_memory,
                  std::string("one more decoder ") + error.what() +
                      "; close other programs, or take fewer threads (SFUMATO_THREADS=1)");
    }
  }

  void give(std::unique_ptr<Process> process) {
    const std::lock_guard lock(mutex_);
    if (process->map_size() <= kept_memory)
      idle_.push_back(std::move(process));
    else
      process->is_busy = true;  // and it is ended
  }

 private:
  // The processes of a program before it forked are not those of the new one.
  void forget_those_of_parent() {
    if (owner_ == ::getpid()) return;
    for (std::unique_ptr<Process>& process : idle_) process->abandon();
    idle_.clear();
    owner_ = ::getpid();
  }

  std::unique_ptr<Process> started() const {
    auto process = std::make_unique<Process>(program_);
    DecodeReply hello;
    process->is_busy = true;
    if (!is_ready(process->socket(), hello_wait_ms, no_progress()) || !io::take(process->socket(), hello))
      throw std::runtime_error("does not answer");
    if (hello.kind != DecodeReply::hello || hello.points != decoder_version)
      throw std::runtime_error("is of another version");
    process->is_busy = false;
    return process;
  }

  // The first process is started to see whether that can be done.
  void find() {
    if (is_known_) return;
    const char* wanted = std::getenv("SFUMATO_DECODER");
    const std::string named = wanted ? wanted : "";
    is_known_ = true;
    reason_.clear();
    if (named == "none") {
      reason_ = "SFUMATO_DECODER=none";
      return;
    }
    std::vector<fs::path> all = named.empty() ? places() : std::vector<fs::path>{named};
    std::error_code ignored;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const fs::path& file) { return fs::exists(file, ignored); });
    if (found == all.end()) {
      reason_ = named.empty() ? "sfumato-decoder is not installed" : named + " is not there";
    } else {
      program_ = *found;
      try {
        idle_.push_back(started());
      } catch (const std::runtime_error& error) {
        reason_ = program_.string() + " " + error.what();
      }
    }
    if (reason_.empty() || named.empty()) return;
    is_known_ = false;
    throw Error(ErrorCode::usage,
                "SFUMATO_DECODER: " + reason_ + "; name the program sfumato-decoder, or none");
  }

  std::mutex mutex_;
  pid_t owner_ = ::getpid();
  bool is_known_ = false;
  std::string reason_;
  fs::path program_;
  std::vector<std::unique_ptr<Process>> idle_;
};

std::string why_no_decoders() { return DecoderPool::get().why_none(); }

DecoderJob::DecoderJob() : process_(DecoderPool::get().take()) {}

DecoderJob::~DecoderJob() {
  if (is_at_work_)
    process_->is_busy = true;  // ended with the job
  else
    done();
}

std::span<std::uint8_t> DecoderJob::make_room(std::size_t input_size, std::size_t block_size) {
  output_ = (input_size + 63) / 64 * 64;
  block_size_ = (block_size + 63) / 64 * 64;
  process_->grow(output_ + 2 * block_size_);
  return {process_->map(), input_size};
}

void DecoderJob::begin(DecodeJob job, std::uint64_t memory) {
  job.memory_size = process_->map_size();
  job.output = output_, job.block_size = block_size_;
  process_->limit(process_->map_size() + memory, 1 + job.points / slowest_rate);
  is_at_work_ = true;
  blocks_ = 0;
  if (!send(process_->socket(), job)) throw DecodeFault("no decoder");
}

DecodeReply DecoderJob::receive(Progress& progress) {
  DecodeReply reply;
  is_ready(process_->socket(), -1, progress);
  if (!take(process_->socket(), reply)) {
    const std::string end = process_->wait();
    throw DecodeFault("bytes that ended their decoder" + (end.empty() ? "" : " (" + end + ")"));
  }
  reply.text[sizeof reply.text - 1] = 0;
  if (reply.kind == DecodeReply::fault) {
    std::string text = reply.text;
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
    done();
    throw DecodeFault(text);
  }
  return reply;
}

DecodeReply DecoderJob::fields(Progress& progress) {
  DecodeReply reply = receive(progress);
  if (reply.kind != DecodeReply::fields) throw DecodeFault("a decoder out of step");
  return reply;
}

std::span<std::uint8_t> DecoderJob::next(std::uint64_t most, std::size_t record_length, Progress& progress) {
  if (blocks_ > 0 && !send(process_->socket(), 'n')) {
    // It has ended; what of, `receive` finds.
  }
  const DecodeReply reply = receive(progress);
  if (reply.kind != DecodeReply::block || reply.points == 0 || reply.points > most ||
      reply.points * record_length > block_size_)
    throw DecodeFault("a decoder out of step");
  return {process_->map() + output_ + (blocks_++ % 2) * block_size_, reply.points * record_length};
}

void DecoderJob::done() {
  is_at_work_ = false;
  if (!process_) return;
  DecoderPool::get().give(std::move(process_));
  process_.reset();
}

}  // namespace sfumato::io
