// Options that every command with work to do has.
#pragma once

#include <memory>
#include <string>

#include "command_line.h"

namespace sfumato::cli {

class CommonOptions {
 public:
  CommonOptions();
  ~CommonOptions();
  void declare(CommandLine& line);
  /// Call once the line has parsed: limits the threads of readers, of the analysis and of software GL.
  void apply();

  bool quiet = false, verbose = false;

 private:
  std::string threads_;
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

}  // namespace sfumato::cli
