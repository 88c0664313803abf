// Work that the interpreter waits for: without its lock, so that other threads of Python go on, and so that
// Ctrl-C and progress still reach it.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "core/progress.h"
#include "gl/context.h"

namespace sfumato::python {

namespace py = pybind11;

/// Runs `work` on a thread of its own and waits. `progress` is None or called now and then with the share
/// done (0 to 1) and a text, on the calling thread; what it raises, and Ctrl-C, stops the work and comes out
/// of here.
void run(const std::function<void(Progress&)>& work, const py::object& progress);

/// What lives on the one thread that has the OpenGL context; freed there, when its last user has gone or
/// before the context goes at the end of the program.
class OnGl {
 public:
  virtual ~OnGl() = default;
  /// Frees everything that needs the context.
  virtual void clear() = 0;
};

/// The same on the thread of the OpenGL context, which the first call starts: contexts belong to a thread,
/// Python's objects do not. Throws Error(no_gl) without OpenGL 4.5 and in a process that was forked after
/// rendering had begun.
void run_gl(const std::function<void(gl::Context&, Progress&)>& work, const py::object& progress);
/// From within `run_gl`: to be cleared there, at the latest when the interpreter ends.
void keep_gl(const std::shared_ptr<OnGl>& object);
/// Hands the object over to be cleared, without waiting.
void free_gl(std::shared_ptr<OnGl> object) noexcept;
/// Ends the thread; nothing can be rendered after that.
void stop_gl();

}  // namespace sfumato::python
