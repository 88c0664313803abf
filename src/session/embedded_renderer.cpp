#include "sfumato/embedded.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/error.h"
#include "gl/host_canvas.h"

namespace sfumato {
namespace {

class CancelFlag final : public Progress {
 public:
  void update(double, std::string_view) override {}
  bool cancelled() const override { return is_up; }
  std::atomic<bool> is_up{false};
};

struct PictureToDraw {
  std::string technique;
  HostView view;
  Parameters parameters;
  Camera camera;  ///< of the view
  bool asks_for_same(const PictureToDraw& other) const {
    return technique == other.technique && view == other.view && parameters == other.parameters;
  }
};

struct CloudToShow {
  PointCloud cloud;
  ColorSettings coloring;
};

struct Answer {
  std::uint64_t serial = 0;  ///< of the request
  HostView view;
  Image<Rgba8> color;
  Image<float> depth;
};

}  // namespace

struct EmbeddedRenderer::State {
  std::mutex mutex;
  std::condition_variable work, answered;
  std::optional<CloudToShow> cloud;             ///< to be set next
  std::optional<PictureToDraw> waiting, asked;  ///< to be drawn next; the last one
  std::uint64_t serial = 0,
                answered_serial = 0;  ///< of the last request, and of the last that was answered or failed
  std::shared_ptr<const Answer> answer;
  std::exception_ptr failure;
  CancelFlag picture_flag, cloud_flag;
  bool ends = false;
  gl::HostCanvas canvas;
  std::thread thread;

  void run();
  void paint(HeadlessRenderer& renderer, const PictureToDraw& request, std::uint64_t number);
  void rethrow();
};

void EmbeddedRenderer::State::paint(HeadlessRenderer& renderer, const PictureToDraw& request,
                                    std::uint64_t number) {
  Pictures pictures =
      renderer.render(request.technique, request.camera, request.parameters, std::nullopt, picture_flag);
  auto made = std::make_shared<Answer>(
      Answer{number, request.view, std::move(pictures.color), std::move(pictures.depth)});
  const std::lock_guard lock(mutex);
  answer = std::move(made);
}

void EmbeddedRenderer::State::run() {
  std::optional<HeadlessRenderer> renderer;
  std::unique_lock lock(mutex);
  while (true) {
    work.wait(lock, [&] { return ends || cloud || waiting; });
    if (ends) return;
    std::optional<CloudToShow> next_cloud = std::exchange(cloud, std::nullopt);
    std::optional<PictureToDraw> request;
    if (!next_cloud) request = std::exchange(waiting, std::nullopt);
    const std::uint64_t number = serial;
    (next_cloud ? cloud_flag : picture_flag).is_up = false;
    lock.unlock();
    std::exception_ptr wrong;
    try {
      if (!renderer) {
        renderer.emplace().set_outputs({.linear = false, .normal = false});
        renderer->set_whole(true);  // what of the scene is hidden is the host's to say
      }
      if (next_cloud) renderer->set_cloud(std::move(next_cloud->cloud), next_cloud->coloring, cloud_flag);
      if (request) paint(*renderer, *request, number);
    } catch (const Cancelled&) {  // for what is newer
    } catch (...) {
      wrong = std::current_exception();
    }
    lock.lock();
    if (wrong) failure = wrong;
    if (wrong && next_cloud && !cloud) waiting.reset();  // there is nothing to draw it from
    if (request || wrong) answered_serial = number;
    answered.notify_all();
  }
}

/// Of what went wrong its one report; the next request may go better.
void EmbeddedRenderer::State::rethrow() {
  if (const std::exception_ptr wrong = std::exchange(failure, nullptr)) std::rethrow_exception(wrong);
}

EmbeddedRenderer::EmbeddedRenderer() : state_(std::make_unique<State>()) {
  state_->thread = std::thread([this] { state_->run(); });
}

EmbeddedRenderer::~EmbeddedRenderer() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ends = true;
    state_->picture_flag.is_up = state_->cloud_flag.is_up = true;
  }
  state_->work.notify_all();
  state_->thread.join();
}

void EmbeddedRenderer::set_cloud(PointCloud cloud, const ColorSettings& coloring) {
  {
    const std::lock_guard lock(state_->mutex);
    // What a host coloured keeps its colours, also where all points have one.
    const bool is_colored = coloring.color_by == "auto" && !cloud.colors.empty();
    state_->cloud = {std::move(cloud), coloring};
    if (is_colored) state_->cloud->coloring.color_by = "rgb";
    state_->failure = nullptr;
    state_->picture_flag.is_up = state_->cloud_flag.is_up = true;
    // The last request holds for the new points.
    state_->waiting = state_->asked;
    ++state_->serial;
  }
  state_->work.notify_all();
}

void EmbeddedRenderer::request(const std::string& technique, const HostView& view,
                               const Parameters& parameters) {
  PictureToDraw next{technique, view, parameters,
                     camera_of_matrices(view.view, view.projection, view.width, view.height)};
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->asked && state_->asked->asks_for_same(next)) return;
    state_->asked = state_->waiting = std::move(next);
    ++state_->serial;
    state_->picture_flag.is_up = true;
  }
  state_->work.notify_all();
}

bool EmbeddedRenderer::wait(double seconds) {
  std::unique_lock lock(state_->mutex);
  const bool is_answered = state_->answered.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
    return state_->answered_serial == state_->serial && !state_->waiting && !state_->cloud;
  });
  state_->rethrow();
  return is_answered;
}

bool EmbeddedRenderer::draw(std::uint32_t framebuffer, const std::array<int, 4>& viewport, float opacity) {
  std::shared_ptr<const Answer> answer;
  {
    const std::lock_guard lock(state_->mutex);
    state_->rethrow();
    answer = state_->answer;
  }
  gl::HostCanvas::require_context();
  if (!answer) return false;
  state_->canvas.draw(answer->color, answer->depth, answer->serial, answer->view.projection, framebuffer,
                      viewport, opacity);
  return true;
}

HostView EmbeddedRenderer::drawn() const {
  const std::lock_guard lock(state_->mutex);
  return state_->answer ? state_->answer->view : HostView();
}

void EmbeddedRenderer::release() { state_->canvas.release(); }

}  // namespace sfumato
