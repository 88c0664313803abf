// Many files, one after the other: one that fails does not stop the rest.
#pragma once

#include <functional>
#include <string>

#include "console.h"

namespace sfumato::cli {

class Batch {
 public:
  /// With one file errors are what they always are; with `several` they are told and counted.
  Batch(bool several, Console& console) : several_(several), console_(console) {}

  /// Does `work`. Bad input, unreadable files and impossible requests of one file end it alone; Ctrl-C, a
  /// missing OpenGL and a full memory end everything.
  void run(const std::string& file, const std::function<void()>& work);
  /// 0, or 3 when some failed. Throws Error with the code of the last failure when all of them did.
  int exit_code() const;
  std::size_t failed() const { return failed_; }

 private:
  const bool several_;
  Console& console_;
  std::size_t done_ = 0, failed_ = 0;
  ErrorCode last_ = ErrorCode::partial;
};

}  // namespace sfumato::cli
