// The one exception type of sfumato. It is caught in three places only: the command line (one line, a fixed
// exit code), the viewer (a dialog) and Python (translated).
#pragma once

#include <stdexcept>
#include <string>

namespace sfumato {

/// What went wrong, and at the same time the exit code of the command.
enum class ErrorCode {
  usage = 1,          ///< the user asked for something that does not exist or cannot be combined
  bad_input = 2,      ///< a file is damaged, empty or not what it claims to be
  partial = 3,        ///< something was produced, but not all of it
  no_gl = 4,          ///< no usable OpenGL driver, or a feature is missing
  out_of_memory = 5,  ///< main or graphics memory
  io = 6,             ///< reading or writing failed: permission, disk full, vanished file
  internal = 70,      ///< a fault of ours
  interrupted = 130,  ///< Ctrl-C
};

/// Thrown for input, files, shaders and driver limits. `what()` is one line: what, where, what to do next.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// Thrown by long calls when `Progress::cancelled()` turns true.
class Cancelled : public Error {
 public:
  Cancelled() : Error(ErrorCode::interrupted, "interrupted") {}
};

}  // namespace sfumato
