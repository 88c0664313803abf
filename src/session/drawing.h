// A session on a context of its own, and the look of its last picture.
#pragma once

#include <memory>
#include <string>

#include "session/preset.h"
#include "session/session.h"

namespace sfumato {

class Drawing {
 public:
  ~Drawing() { forget_look(); }
  /// Another picture by the technique of the last one needs nothing made anew. Throws as Look::set.
  Look& look_of(const std::string& technique, const NamesAndValues& parameters) {
    if (look_ && look_->name != technique) forget_look();
    if (!look_) look_ = std::make_unique<Look>(technique);
    look_->reset();
    for (const auto& [name, value] : parameters) look_->set(name, value);
    return *look_;
  }
  /// What it holds of a cloud is of no use for another one.
  void forget_look() {
    const gl::Context::Use use(*context_);  // what is on the GPU goes where it was made
    look_.reset();
  }

 private:
  std::unique_ptr<gl::Context> context_ = gl::Context::create_headless();
  std::unique_ptr<Look> look_;

 public:
  Session session{*context_};
};

}  // namespace sfumato
