#include "session/part_renderer.h"

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "session/choice.h"
#include "session/drawing.h"
#include "session/opening.h"

namespace sfumato {

namespace {

/// Does one thing after the other, for who waits.
class Worker {
 public:
  ~Worker() { next({}); }
  /// Returns what `work` returns, and throws what it throws.
  template <class Work>
  auto run(Work work) {
    std::packaged_task<std::invoke_result_t<Work>()> task(std::move(work));
    auto result = task.get_future();
    next([&] { task(); });
    return result.get();
  }

 private:
  /// Nothing: that was all.
  void next(std::function<void()> work) {
    std::unique_lock lock(mutex_);
    const bool is_last = !work;
    work_ = std::move(work), is_idle_ = false;
    changed_.notify_all();
    if (!is_last) return changed_.wait(lock, [&] { return is_idle_; });
    lock.unlock();
    thread_.join();
  }
  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return !is_idle_; });
      if (!work_) return;
      work_();
      is_idle_ = true;
      changed_.notify_all();
    }
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> work_;
  bool is_idle_ = true;
  std::thread thread_{[this] { work(); }};
};

}  // namespace

struct PartRenderer::State {
  std::optional<Drawing> drawing;
  std::string resolve(const std::string& technique) const {
    return technique == automatic_technique ? drawing->session.suggest().technique : technique;
  }
  Look& look_of(const std::string& technique, const Parameters& parameters) {
    Look& look = drawing->look_of(resolve(technique), parameters);
    look.settings.transparent = true;
    return look;
  }
  Worker worker;
  State() {
    worker.run([&] { drawing.emplace(); });
  }
  ~State() {
    worker.run([&] { drawing.reset(); });
  }
};

PartRenderer::PartRenderer() : state_(std::make_unique<State>()) {}
PartRenderer::~PartRenderer() = default;

void PartRenderer::set_part(PointCloud part, std::shared_ptr<const WholeCloud> whole,
                            const ColorSettings& coloring, std::optional<Around> around) {
  state_->worker.run([&] {
    Attributes needs;
    if (around) needs = state_->look_of(around->technique, {}).technique->needs();
    state_->drawing->forget_look();
    Request wanted;
    wanted.points.up = part.up;
    wanted.whole = true;
    scene::Scene sample;
    sample.cloud = whole->sample;
    const Opening opening(wanted, std::move(sample));
    scene::Scene scene;
    scene.cloud = std::move(part);
    scene.whole = std::move(whole);
    if (around) scene.around = std::move(around->points);
    state_->drawing->session.set_scene(std::move(scene), opening.pose(), {{}, coloring, {}});
    state_->drawing->session.measure(needs);
  });
}

std::string PartRenderer::resolve(const std::string& technique) const {
  return state_->worker.run([&] { return state_->resolve(technique); });
}

bool PartRenderer::merges(const std::string& technique, const Camera& camera, const Parameters& parameters) {
  return state_->worker.run(
      [&] { return state_->drawing->session.merges(state_->look_of(technique, parameters), camera); });
}

bool PartRenderer::lacks(const std::string& technique, const Parameters& parameters) {
  return state_->worker.run(
      [&] { return !state_->drawing->session.has_needs(state_->look_of(technique, parameters)); });
}

int PartRenderer::rounds(const std::string& technique, const Parameters& parameters) {
  return state_->worker.run([&] { return state_->look_of(technique, parameters).technique->rounds(); });
}

VisiblePoints PartRenderer::visible(const std::string& technique, const Camera& camera,
                                    const Parameters& parameters, const VisiblePoints* merged) {
  return state_->worker.run([&] {
    return state_->drawing->session.visible(state_->look_of(technique, parameters), camera, merged);
  });
}

Pictures PartRenderer::picture(const VisiblePoints& merged, const std::string& technique,
                               const Camera& camera, const Parameters& parameters) {
  return state_->worker.run([&] {
    RenderWants wants;
    wants.depth = true;
    Look& look = state_->look_of(technique, parameters);
    RenderOutput out = state_->drawing->session.render_merged(merged, look, camera, wants);
    Pictures pictures;
    pictures.color = std::move(out.rgba8), pictures.depth = std::move(out.depth);
    pictures.technique = look.name, pictures.notes = std::move(out.notes);
    return pictures;
  });
}

}  // namespace sfumato
