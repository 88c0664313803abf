// A named scope around every pass. GL timestamps on GPUs; finish and a clock on software GL, whose timer
// queries return 0. Off unless asked for: measuring costs a finish per pass.
#pragma once

#include <epoxy/gl.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace sfumato::gl {

class Timers {
 public:
  explicit Timers(bool enabled) : enabled_(enabled) {}

  class Scope {
   public:
    Scope(Timers* timers, std::string name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Timers* timers_;
    std::string name_;
    GLuint queries_[2] = {0, 0};
    std::chrono::steady_clock::time_point start_;
  };

  /// `auto timing = frame.timers.scope("depth");` Scopes of one name add up; nested scopes count in both.
  [[nodiscard]] Scope scope(std::string name) { return Scope(enabled_ ? this : nullptr, std::move(name)); }
  /// Milliseconds by name, in the order of first use.
  std::vector<std::pair<std::string, double>> results();

 private:
  struct Pending {
    std::string name;
    GLuint queries[2];
  };
  void add(const std::string& name, double ms);
  bool enabled_;
  std::vector<Pending> pending_;
  std::vector<std::pair<std::string, double>> results_;
};

}  // namespace sfumato::gl
