#include "run.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/interruption.h"

namespace sfumato::python {
namespace {

/// What the work says, until the interpreter asks.
class Reporter final : public Progress {
 public:
  void update(double fraction, std::string_view text) override {
    const std::lock_guard lock(mutex_);
    fraction_ = fraction;
    text_ = text;
  }
  bool cancelled() const override { return cancelled_.load(std::memory_order_relaxed); }
  void cancel() { cancelled_ = true; }
  std::pair<double, std::string> latest() const {
    const std::lock_guard lock(mutex_);
    return {fraction_, text_};
  }

 private:
  mutable std::mutex mutex_;
  double fraction_ = 0;
  std::string text_;
  std::atomic<bool> cancelled_ = false;
};

/// Waits without the interpreter's lock, which is held again on return.
void wait(std::future<void>& done, Reporter& reporter, const py::object& progress) {
  std::exception_ptr raised;
  {
    const py::gil_scoped_release release;
    while (done.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      if (raised) continue;
      const py::gil_scoped_acquire acquire;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const auto [fraction, text] = reporter.latest();
        if (!progress.is_none() && !text.empty()) progress(fraction, text);
      } catch (...) {
        raised = std::current_exception();
        reporter.cancel();
        interruption = true;
      }
    }
  }
  if (raised) interruption = false;
  if (raised) std::rethrow_exception(raised);
  done.get();
  if (const auto [fraction, text] = reporter.latest(); !progress.is_none() && !text.empty())
    progress(1.0, text);
}

class GlThread {
 public:
  /// Never destroyed: who still waits at the end of the process must find it.
  static GlThread& get() {
    static GlThread& one = *new GlThread;
    return one;
  }

  std::future<void> post(std::function<void(gl::Context&)> work) {
    const std::lock_guard lock(mutex_);
    if (forked_)
      throw Error(ErrorCode::no_gl,
                  "OpenGL does not survive a fork, and rendering had begun before this process was forked; "
                  "start workers "
                  "with multiprocessing.get_context('spawn')");
    if (stopped_)
      throw Error(ErrorCode::no_gl, "the interpreter is ending; nothing can be rendered any more");
    if (!thread_.joinable()) {
      setenv("EGL_LOG_LEVEL", "fatal", 0);  // our one line says what lacks, without Mesa's warnings before it
      pthread_atfork(nullptr, nullptr, [] { get().forked_ = true; });
      thread_ = std::thread([this] { serve(); });
    }
    auto task = std::packaged_task<void()>([this, work = std::move(work)] {
      if (!context_) context_ = gl::Context::create_headless();
      work(*context_);
    });
    std::future<void> done = task.get_future();
    tasks_.push_back(std::move(task));
    wake_.notify_one();
    return done;
  }

  void free(std::shared_ptr<OnGl> object) {
    const std::lock_guard lock(mutex_);
    // After a fork or the end, what the driver holds is gone or goes with the process.
    if (forked_ || !thread_.joinable()) return leak(std::move(object));
    tasks_.push_back(std::packaged_task<void()>([object = std::move(object)] { object->clear(); }));
    wake_.notify_one();
  }

  void keep(const std::shared_ptr<OnGl>& object) {  // on the thread
    std::erase_if(kept_, [](const auto& each) { return each.expired(); });
    kept_.push_back(object);
  }

  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
      if (forked_ || !thread_.joinable()) return;
      wake_.notify_one();
    }
    thread_.join();
  }

 private:
  static void leak(std::shared_ptr<OnGl> object) { new std::shared_ptr<OnGl>(std::move(object)); }

  void serve() {
    while (true) {
      std::packaged_task<void()> task;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stopped_ || !tasks_.empty(); });
        if (tasks_.empty()) break;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task();
    }
    for (const auto& each : kept_)
      if (const auto object = each.lock()) object->clear();
    context_.reset();
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::packaged_task<void()>> tasks_;
  std::thread thread_;
  std::unique_ptr<gl::Context> context_;
  std::vector<std::weak_ptr<OnGl>> kept_;
  bool stopped_ = false;
  std::atomic<bool> forked_ = false;
};

}  // namespace

void run(const std::function<void(Progress&)>& work, const py::object& progress) {
  Reporter reporter;
  std::future<void> done = std::async(std::launch::async, [&] { work(reporter); });
  wait(done, reporter, progress);
}

void run_gl(const std::function<void(gl::Context&, Progress&)>& work, const py::object& progress) {
  Reporter reporter;
  std::future<void> done = GlThread::get().post([&](gl::Context& context) {
    reporter.check();
    work(context, reporter);
  });
  wait(done, reporter, progress);
}

void keep_gl(const std::shared_ptr<OnGl>& object) { GlThread::get().keep(object); }
void free_gl(std::shared_ptr<OnGl> object) noexcept {
  try {
    GlThread::get().free(std::move(object));
  } catch (...) {  // out of memory: the object stays where it is
  }
}
void stop_gl() {
  const py::gil_scoped_release release;
  GlThread::get().stop();
}

}  // namespace sfumato::python
