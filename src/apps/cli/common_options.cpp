#include "common_options.h"

#include <tbb/global_control.h>

#include <cstdlib>

#include "core/error.h"
#include "core/threads.h"

namespace sfumato::cli {

struct CommonOptions::Limit {
  tbb::global_control control;
};

CommonOptions::CommonOptions() = default;
CommonOptions::~CommonOptions() = default;

void CommonOptions::declare(CommandLine& line) {
  line.text("--threads", threads_, "N", "processor threads to use (all)");
  line.flag("--verbose", verbose, "more output: files read, automatic values, times");
  line.flag("--quiet", quiet, "no progress, no notes");
}

void CommonOptions::apply() {
  if (quiet && verbose)
    throw Error(ErrorCode::usage, "--quiet and --verbose contradict each other: give one of them");
  if (threads_.empty()) return;
  const long count = parse_whole("--threads", threads_, 1);
  if (count > 4096) throw Error(ErrorCode::usage, "--threads: " + threads_ + " is more than 4096");
  set_thread_count(unsigned(count));
  limit_.reset(
      new Limit{tbb::global_control(tbb::global_control::max_allowed_parallelism, std::size_t(count))});
  setenv("LP_NUM_THREADS", std::to_string(count > 1 ? count : 0).c_str(),
         0);  // Mesa's; 0 is the calling thread alone
}

}  // namespace sfumato::cli
