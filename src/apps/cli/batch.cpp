#include "batch.h"

#include "core/error.h"

namespace sfumato::cli {

void Batch::run(const std::string& file, const std::function<void()>& work) {
  if (!several_) {
    work();
    ++done_;
    return;
  }
  try {
    work();
    ++done_;
  } catch (const Error& error) {
    const bool of_this_file = error.code() == ErrorCode::bad_input || error.code() == ErrorCode::io ||
                              error.code() == ErrorCode::usage || error.code() == ErrorCode::partial ||
                              error.code() == ErrorCode::out_of_memory;  // refused before it is tried
    if (!of_this_file) throw;
    ++failed_;
    last_ = error.code();
    const std::string text = error.what();
    console_.complain("sfumato: " + (text.find(file) == std::string::npos ? file + ": " : "") + text);
  }
}

int Batch::exit_code() const {
  if (failed_ == 0) return 0;
  const std::string all = std::to_string(failed_ + done_);
  if (done_ == 0) throw Error(last_, "none of the " + all + " files could be done");
  console_.complain("sfumato: " + std::to_string(failed_) + " of " + all + " files failed");
  return int(ErrorCode::partial);
}

}  // namespace sfumato::cli
