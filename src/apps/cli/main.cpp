// sfumato: point clouds to pictures. This file picks the command and turns errors into one line and an exit
// code.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "allocation.h"
#include "commands.h"
#include "console.h"
#include "core/version.h"

namespace {

using namespace sfumato;

int run(const cli::Words& words) {
  if (words.empty()) return cli::render_command(words);
  const cli::Words rest(words.begin() + 1, words.end());
  if (words[0] == "--version") return cli::print(cli::version_text()), 0;
  if (words[0] == "-V") return cli::print("sfumato " + std::string(version()) + "\n"), 0;
  if (const cli::Command* command = cli::find_command(words[0])) return command->run(rest);
  cli::refuse_unknown_command(words[0]);
  return cli::render_command(words);
}

int fail(ErrorCode code, const char* what) {
  std::fprintf(stderr, "sfumato: %s\n", what);
  return int(code);
}

}  // namespace

int main(int argc, char** argv) {
  cli::allocate_in_large_pages(argv);
  cli::catch_interrupt();
  setenv("EGL_LOG_LEVEL", "fatal", 0);  // our one line says what lacks, without Mesa's warnings before it
  try {
    return run(cli::Words(argv + 1, argv + argc));
  } catch (const Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory,
                "out of memory; rendering takes less with --max-points N, or with levels: sfumato build "
                "IN... -o OUT.copc.laz");
  } catch (const std::length_error&) {
    return fail(ErrorCode::out_of_memory,
                "a size is beyond what memory can hold; use fewer points or pixels");
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(ErrorCode::io, error.what());
  } catch (const std::system_error& error) {
    // A thread that cannot be started lacks memory or is beyond a limit.
    return fail(ErrorCode::out_of_memory, error.what());
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal, (std::string(error.what()) +
                                      " (this is a fault of sfumato; please report it with the command)")
                                         .c_str());
  }
}
