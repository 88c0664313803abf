#include "view/paint_thread.h"

namespace sfumato::view {

std::shared_ptr<PaintThread> Painter::make_thread(std::shared_ptr<Gate> gate) {
  return std::make_shared<PaintThread>(std::move(gate));
}

Painter::Painter(std::shared_ptr<PaintThread> thread, std::function<void()> wake)
    : thread_(std::move(thread)), mine_(thread_->add(std::move(wake))) {}

Painter::~Painter() { thread_->remove(*mine_); }

bool Painter::hold(const SceneKey& shared_key) {
  const std::lock_guard lock(thread_->mutex);
  mine_->held_key.reset();
  if (thread_->find(shared_key)) mine_->held_key = shared_key;
  return mine_->held_key.has_value();
}

void Painter::show(SceneJob job) {
  const std::lock_guard lock(thread_->mutex);
  if (mine_->live) mine_->answers.push_back(CalledOff{mine_->live->id});
  mine_->live.reset();
  mine_->scene = std::move(job);
  mine_->cancel_scene = thread_->cancel_idle = true;
  thread_->work.notify_all();
}

void Painter::paint(PictureJob job) {
  const std::lock_guard lock(thread_->mutex);
  if (mine_->live) mine_->answers.push_back(CalledOff{mine_->live->id});
  mine_->live = std::move(job);
  mine_->cancel_live = thread_->cancel_idle = true;
  thread_->work.notify_all();
}

void Painter::paint_for_keeps(PictureJob job) {
  const std::lock_guard lock(thread_->mutex);
  mine_->kept.push_back(std::move(job));
  thread_->cancel_idle = true;
  thread_->work.notify_all();
}

void Painter::pick(PickJob job) {
  const std::lock_guard lock(thread_->mutex);
  mine_->picks.push_back(std::move(job));
  thread_->cancel_idle = true;
  thread_->work.notify_all();
}

void Painter::profile(ProfileJob job) {
  const std::lock_guard lock(thread_->mutex);
  mine_->profile = std::move(job);
  thread_->cancel_idle = true;
  thread_->work.notify_all();
}

void Painter::call_off() {
  const std::lock_guard lock(thread_->mutex);
  if (mine_->live) mine_->answers.push_back(CalledOff{mine_->live->id});
  mine_->live.reset();
  mine_->cancel_live = thread_->cancel_idle = true;
}

void Painter::forget_programs() {
  thread_->forget_programs = true;
  call_off();
}

std::vector<Answer> Painter::take_answers() {
  const std::lock_guard lock(thread_->mutex);
  return std::exchange(mine_->answers, {});
}

std::vector<std::string> Painter::take_driver_messages() {
  const std::lock_guard lock(thread_->mutex);
  return std::exchange(mine_->driver_messages, {});
}

Activity Painter::activity() const {
  const std::lock_guard lock(thread_->mutex);
  return mine_->activity;
}

std::uint64_t Painter::point_bytes() const { return mine_->point_bytes; }

std::string Painter::renderer_name() const {
  const std::lock_guard lock(thread_->mutex);
  return thread_->renderer_name;
}

}  // namespace sfumato::view
