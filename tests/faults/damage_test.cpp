// A thousand damaged files of each format: none crashes, takes over two seconds of a processor, or more
// memory than what the whole file needs twice and 256 MB. SFUMATO_DAMAGE=N tries N.
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>

#include "core/threads.h"
#include "faults/damage.h"
#include "faults/input.h"
#include "faults/seeds.h"
#include "io/io.h"

namespace sfumato {
namespace {

using test::Seed;

#ifdef __SANITIZE_ADDRESS__
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif
constexpr long seconds_a_file = is_sanitized ? 20 : 2;
constexpr std::uint64_t spare_memory = 256 << 20;

const std::vector<Seed>& all_seeds() {
  static const std::vector<Seed> all = test::seeds();
  return all;
}

std::uint64_t input_count() {
  const char* text = std::getenv("SFUMATO_DAMAGE");
  return text ? std::strtoull(text, nullptr, 10) : 1000;
}

/// What the child tells its parent, in memory that they share.
struct Board {
  std::uint64_t number = 0;  ///< of the input at work
  std::uint64_t need = 0;    ///< address space that whole files take
  std::uint64_t refused = 0, read = 0;
  char fault[512] = {};
};

std::uint64_t kilobytes(const char* what) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == what) {
      std::uint64_t value = 0;
      status >> value;
      return value;
    }
  return 0;
}

/// Reads files of one format in a process of its own.
class Reader {
 public:
  explicit Reader(const Seed& seed)
      : seed_(seed),
        file_(folder_, "input" + seed.extension),
        companion_(folder_, seed.companion_name.empty() ? "unused" : seed.companion_name) {
    companion_.set(seed.companion);
  }

  /// Empty when it was read, or refused as it should be.
  std::string read(const std::string& bytes, const std::string* companion, Board& board) {
    file_.set(bytes);
    if (companion) companion_.set(*companion);
    try {
      const io::ReadResult result = io::read(file_.path());
      ++board.read;
      for (std::size_t i = 0; i < result.cloud.size(); ++i)
        for (int k = 0; k < 3; ++k)
          if (!std::isfinite(result.cloud.positions[i][k])) return "a point is not finite";
      return {};
    } catch (const Error& error) {
      ++board.refused;
      const std::string what = error.what();
      const bool names_other =
          !seed_.companion.empty() && error.code() == ErrorCode::io;  // a file that is not there
      if (error.code() != ErrorCode::bad_input && !names_other)
        return "exit code " + std::to_string(int(error.code())) + ": " + what;
      if (what.find('\n') != std::string::npos) return "more than a line: " + what;
      if (what.find("input" + seed_.extension) == std::string::npos && seed_.companion.empty())
        return "names no file: " + what;
      return {};
    } catch (const std::bad_alloc&) {
      return "takes too much memory";
    } catch (const std::exception& error) {
      return std::string("throws ") + error.what();
    }
  }

 private:
  const Seed& seed_;
  test::MemoryFolder folder_;
  test::MemoryFolder::File file_, companion_;
};

void limit_processor(long seconds) {
  const struct itimerval timer {
    {0, 0}, { seconds, 0 }
  };
  setitimer(ITIMER_PROF, &timer, nullptr);  // of all threads; SIGPROF ends the process
}

void measure(const std::vector<const Seed*>& seeds, Board& board) {
  for (const Seed* seed : seeds) {
    Reader reader(*seed);
    const std::uint64_t before = kilobytes("VmSize:");
    if (const std::string fault = reader.read(seed->bytes, &seed->companion, board);
        !fault.empty() || board.refused)
      std::snprintf(board.fault, sizeof board.fault, "the whole %s: %s", seed->format.c_str(), fault.c_str());
    board.need = std::max(board.need, (kilobytes("VmPeak:") - before) << 10);
  }
}

/// Faults of a damaged file: one or both of the two that make it up.
struct Input {
  std::string bytes, companion;
};
Input input_of(const std::vector<const Seed*>& seeds, std::uint64_t number) {
  const Seed& seed = *seeds[number % seeds.size()];
  if (seed.companion.empty() || number % 3 == 0) return {test::damaged(seed.bytes, number), seed.companion};
  return {seed.bytes, test::damaged(seed.companion, number)};
}

void read_damaged(const std::vector<const Seed*>& seeds, std::uint64_t first, std::uint64_t count,
                  Board& board) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (const Seed* seed : seeds) readers.push_back(std::make_unique<Reader>(*seed));
  struct rlimit limit {};
  limit.rlim_cur = limit.rlim_max = (kilobytes("VmSize:") << 10) + spare_memory + 2 * board.need;
  if (!is_sanitized) setrlimit(RLIMIT_AS, &limit);
  for (std::uint64_t number = first; number < count; ++number) {
    board.number = number;
    const Input input = input_of(seeds, number);
    limit_processor(seconds_a_file);
    const std::string fault = readers[number % seeds.size()]->read(input.bytes, &input.companion, board);
    if (fault.empty()) continue;
    std::snprintf(board.fault, sizeof board.fault, "%s", fault.c_str());
    return;
  }
  board.number = count;
}

class DamageTest : public testing::TestWithParam<std::string> {};

TEST_P(DamageTest, IsNeverFatal) {
  std::vector<const Seed*> seeds;
  for (const Seed& seed : all_seeds())
    if (seed.format == GetParam()) seeds.push_back(&seed);
  void* shared = mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  Board& board = *new (shared) Board;
  const auto in_child = [&](auto&& work) {
    const pid_t child = fork();
    if (child == 0) {
      mallopt(M_ARENA_MAX, 1);  // an arena of glibc takes 64 MB of addresses, which are no memory
      set_thread_count(2);
      setenv("SFUMATO_THREADS", "2", 1);
      const struct rlimit none {};
      setrlimit(RLIMIT_CORE, &none);
      work();
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? std::string(strsignal(WTERMSIG(status))) : WEXITSTATUS(status) ? "exit" : "";
  };
  ASSERT_EQ(in_child([&] { measure(seeds, board); }), "");
  ASSERT_STREQ(board.fault, "");
  board.read = 0;
  const std::uint64_t count = input_count();
  int faults = 0;
  for (std::uint64_t next = 0; next < count && faults < 5; next = board.number + 1) {
    board.fault[0] = 0;
    const std::string died = in_child([&] { read_damaged(seeds, next, count, board); });
    if (died.empty() && board.fault[0] == 0) break;
    ++faults;
    const Seed& seed = *seeds[board.number % seeds.size()];
    const Input input = input_of(seeds, board.number);
    const std::string name = testing::TempDir() + "/damaged_" + std::to_string(board.number) + seed.extension;
    std::ofstream(name, std::ios::binary) << input.bytes;
    if (!input.companion.empty())
      std::ofstream(name + "." + seed.companion_name, std::ios::binary) << input.companion;
    ADD_FAILURE() << GetParam() << " number " << board.number << " (kept as " << name
                  << "): " << (died.empty() ? board.fault : died.c_str());
  }
  EXPECT_GT(board.refused, count / 10) << "the damage is too mild to show anything";
  munmap(shared, sizeof(Board));
}

std::vector<std::string> formats() {
  std::set<std::string> names;
  for (const Seed& seed : all_seeds()) names.insert(seed.format);
  return {names.begin(), names.end()};
}

INSTANTIATE_TEST_SUITE_P(Formats, DamageTest, testing::ValuesIn(formats()),
                         [](const auto& one) { return one.param; });

}  // namespace
}  // namespace sfumato
