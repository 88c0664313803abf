#include "view/render_client.h"

#include <new>

#include "core/error.h"
#include "view/render_thread.h"

namespace sfumato::view {

Failure failure_of(std::uint64_t id, ErrorCode other) {
  try {
    throw;
  } catch (const Error& error) {
    return {id, error.code(), error.what()};
  } catch (const std::bad_alloc&) {
    return {id, ErrorCode::out_of_memory, "out of memory; open fewer points (--max-points N)"};
  } catch (const std::exception& error) {
    return {id, other, error.what()};
  }
}

std::shared_ptr<RenderThread> RenderClient::make_thread(std::shared_ptr<Gate> gate) {
  return std::make_shared<RenderThread>(std::move(gate));
}

RenderClient::RenderClient(std::shared_ptr<RenderThread> thread, std::function<void()> wake)
    : thread_(std::move(thread)), state_(thread_->add(std::move(wake))) {}

RenderClient::~RenderClient() { thread_->remove(*state_); }

bool RenderClient::hold(const SceneKey& shared_key) {
  const std::lock_guard lock(thread_->mutex);
  state_->held_key.reset();
  if (thread_->find(shared_key)) state_->held_key = shared_key;
  return state_->held_key.has_value();
}

void RenderClient::show(SceneJob job) {
  const std::lock_guard lock(thread_->mutex);
  state_->drop_live();
  state_->scene = std::move(job);
  state_->cancel_scene = true;
  thread_->begin_work();
}

void RenderClient::render(PictureJob job) {
  const std::lock_guard lock(thread_->mutex);
  state_->drop_live();
  state_->live = std::move(job);
  state_->cancel_live = true;
  thread_->begin_work();
}

void RenderClient::render_to_keep(PictureJob job) {
  const std::lock_guard lock(thread_->mutex);
  state_->kept.push_back(std::move(job));
  thread_->begin_work();
}

void RenderClient::pick(PickJob job) {
  const std::lock_guard lock(thread_->mutex);
  state_->picks.push_back(std::move(job));
  thread_->begin_work();
}

void RenderClient::profile(ProfileJob job) {
  const std::lock_guard lock(thread_->mutex);
  state_->profile = std::move(job);
  thread_->begin_work();
}

void RenderClient::cancel() {
  const std::lock_guard lock(thread_->mutex);
  state_->drop_live();
  state_->cancel_live = thread_->cancel_idle = true;
}

void RenderClient::forget_programs() {
  thread_->forget_programs = true;
  cancel();
}

std::vector<Answer> RenderClient::take_answers() {
  const std::lock_guard lock(thread_->mutex);
  return std::exchange(state_->answers, {});
}

std::vector<std::string> RenderClient::take_driver_messages() {
  const std::lock_guard lock(thread_->mutex);
  return std::exchange(state_->driver_messages, {});
}

Activity RenderClient::activity() const {
  const std::lock_guard lock(thread_->mutex);
  return state_->activity;
}

std::uint64_t RenderClient::point_bytes() const { return state_->point_bytes; }

std::string RenderClient::renderer_name() const {
  const std::lock_guard lock(thread_->mutex);
  return thread_->renderer_name;
}

}  // namespace sfumato::view
