#include "gl/timer.h"

#include "gl/context.h"

namespace sfumato::gl {

Timers::Scope::Scope(Timers* timers, std::string name) : timers_(timers), name_(std::move(name)) {
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(name_.size()), name_.data());
  if (!timers_) return;
  if (limits().software) {
    glFinish();
    start_ = std::chrono::steady_clock::now();
  } else {
    glGenQueries(2, queries_);
    glQueryCounter(queries_[0], GL_TIMESTAMP);
  }
}

Timers::Scope::~Scope() {
  glPopDebugGroup();
  if (!timers_) return;
  if (limits().software) {
    glFinish();
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start_;
    timers_->add(name_, ms.count());
  } else {
    glQueryCounter(queries_[1], GL_TIMESTAMP);
    timers_->pending_.push_back({name_, {queries_[0], queries_[1]}});
  }
}

void Timers::add(const std::string& name, double ms) {
  for (auto& [known, sum] : results_)
    if (known == name) {
      sum += ms;
      return;
    }
  results_.emplace_back(name, ms);
}

std::vector<std::pair<std::string, double>> Timers::results() {
  for (Pending& pending : pending_) {
    GLuint64 from = 0, to = 0;
    glGetQueryObjectui64v(pending.queries[0], GL_QUERY_RESULT, &from);
    glGetQueryObjectui64v(pending.queries[1], GL_QUERY_RESULT, &to);
    glDeleteQueries(2, pending.queries);
    add(pending.name, double(to - from) * 1e-6);
  }
  pending_.clear();
  return results_;
}

}  // namespace sfumato::gl
