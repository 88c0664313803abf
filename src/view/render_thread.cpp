#include "view/render_thread.h"

#include <chrono>
#include <cmath>

#include "core/error.h"
#include "gl/reset.h"
#include "view/navigator.h"

namespace sfumato::view {
namespace {

using Clock = std::chrono::steady_clock;

/// Without a request, until attributes are measured that somebody may want.
constexpr std::chrono::milliseconds idle_time(1500);

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

/// Progress of the job under way, and the way to cancel it.
class RenderThread::Watch final : public Progress {
 public:
  enum class Kind { scene, live, kept, idle };
  Watch(RenderThread& thread, State* one, Kind kind) : thread_(thread), one_(one), kind_(kind) {}
  Kind kind() const { return kind_; }
  void update(double fraction, std::string_view text) override {
    if (!one_) return;
    const std::lock_guard lock(thread_.mutex);
    one_->activity = {fraction, std::string(text)};
    // A progress bar moves a few times a second; a call for every step would keep the window busy.
    if (const auto now = Clock::now(); now - last_wake_ > std::chrono::milliseconds(100)) {
      last_wake_ = now;
      one_->wake();
    }
  }
  bool cancelled() const override {
    if (thread_.stop_) return true;
    if (kind_ == Kind::idle) return thread_.cancel_idle;
    if (one_->gone) return true;
    if (kind_ == Kind::kept) return false;
    return one_->cancel_scene || (kind_ == Kind::live && one_->cancel_live);
  }

 private:
  RenderThread& thread_;
  State* one_;  ///< null: nobody waits for it
  Kind kind_;
  Clock::time_point last_wake_{};
};

void RenderThread::answer(State& one, Answer answer) {
  std::function<void()> wake;
  {
    const std::lock_guard lock(mutex);
    one.answers.push_back(std::move(answer));
    one.activity = {};
    wake = one.wake;
  }
  wake();
}

void RenderThread::do_scene(State& one, SceneJob job, Watch& watch) {
  if (const std::shared_ptr<SharedSession> known = find(job.shared_key)) {
    SceneReady ready = known->ready;
    ready.id = job.id;
    {
      const std::lock_guard lock(mutex);
      one.shared = known;
      one.held_key.reset();
    }
    drop_unused();
    return answer(one, std::move(ready));
  }
  // Memory for two scenes at a time is not asked for where nobody else shows the old one.
  std::shared_ptr<SharedSession> shared = std::exchange(one.shared, nullptr);
  if (shared &&
      std::any_of(shared_.begin(), shared_.end(), [&](const auto& each) { return each.second == shared; })) {
    shared.reset();
    drop_unused();
  }
  if (!shared) shared = std::make_shared<SharedSession>();
  shared->sessions.resize(1);
  SharedSession::Colored& first = shared->sessions.front();
  if (!first.session) first.session = std::make_unique<Session>(*context_);
  shared->looks.clear();  // what they hold of the last cloud is of no use for this one
  first.color = job.options.color;
  shared->file_names = job.scene.file_names;
  shared->prepares_ahead = true;
  SceneReady ready;
  ready.id = job.id;
  try {
    first.session->open(std::move(job.scene), std::move(job.pose), job.options, job.choice.get(), watch,
                        job.measures);
  } catch (...) {
    // Refused before anything changed, it still draws the last scene; cut off half way, it has nothing.
    if (!first.session->empty()) one.shared = shared;
    throw;
  }
  if (job.choice && job.choice->techniques.front()->of_auto)
    ready.choice = {job.choice->techniques.front()->name, job.choice->techniques.front()->reason};
  ready.points = first.session->prepared_points();
  ready.notes = first.session->notes();
  ready.left_out = first.session->left_out();
  ready.coloring = first.session->coloring();
  shared->ready = ready;
  {
    const std::lock_guard lock(mutex);
    one.shared = shared;
    one.held_key.reset();
    if (job.shared_key) shared_.emplace_back(*job.shared_key, shared);
  }
  answer(one, std::move(ready));
}

namespace {

/// The corners of a grid over the picture, the first and last of them on its border.
Image<float> sampled(const Image<float>& depth, int step) {
  Image<float> out(std::max(2, depth.width() / step), std::max(2, depth.height() / step));
  const auto place = [](int i, int count, int pixels) {
    return int(std::lround(double(i) / (count - 1) * (pixels - 1)));
  };
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = depth.at(place(x, out.width(), depth.width()), place(y, out.height(), depth.height()));
  return out;
}

}  // namespace

/// As they are now: others come at any time.
std::vector<std::shared_ptr<RenderClient::State>> RenderThread::clients() const {
  const std::lock_guard lock(mutex);
  return clients_;
}

std::size_t RenderThread::clients_of(const SharedSession& shared) const {
  const std::lock_guard lock(mutex);
  return std::size_t(std::count_if(clients_.begin(), clients_.end(),
                                   [&](const auto& one) { return one->shared.get() == &shared; }));
}

Picture RenderThread::do_picture(State& one, const PictureJob& job, Watch& watch) {
  SharedSession& shared = *one.shared;
  const auto asked = Clock::now();
  Look& look = shared.look_of(job.technique, job.parameters);
  Session& session = shared.session_of(job.color, job.background, clients_of(shared), *context_);
  // What is measured once for all pictures is not cancelled with this one: a hand that moves on would never
  // see its end.
  Watch for_all(*this, &one, watch.kind() == Watch::Kind::kept ? Watch::Kind::kept : Watch::Kind::scene);
  session.complete(look, for_all);
  watch.check();
  const auto start = Clock::now();
  RenderWants wants;
  wants.timings = job.timings;
  wants.depth = job.depth_step > 0;
  RenderOutput out = session.render(look, job.camera, wants, watch);
  Picture picture;
  picture.id = job.id;
  picture.image = std::move(out.rgba8);
  if (wants.depth) picture.depth = sampled(out.depth, job.depth_step);
  picture.camera = job.camera;
  picture.technique = job.technique;
  for (const auto& [param, value] : look.resolved(out.settings))
    if (param.can_be_auto) picture.resolved.emplace_back(param.name, value);
  picture.notes = std::move(out.notes);
  picture.timings = std::move(out.timings);
  picture.points_drawn = out.points_drawn;
  picture.coloring = session.coloring();
  picture.background = session.background();
  picture.draw_ms = ms_since(start);
  picture.took_ms = ms_since(asked);
  return picture;
}

/// The nearest of what each part offers: what lies clearly behind another part's point is hidden by it.
PickAnswer RenderThread::do_pick(State& one, const PickJob& job) {
  const SharedSession& shared = *one.shared;
  const Session& session = shared.session();
  PickAnswer found{job.id, {}};
  double nearest = 0;
  for (std::size_t k = 0; k < session.parts().size(); ++k) {
    const PointCloud& cloud = session.cloud(k);
    const auto index = nearest_point(cloud, job.camera, job.x_px, job.y_px, 12, 0.02,
                                     session.pose().subject.room, session.prepared(k).batches);
    if (!index) continue;
    const double depth = project(job.camera, cloud.world(*index)).z;
    if (found.picked && depth >= nearest) continue;
    nearest = depth;
    found.picked = describe(cloud, *index, shared.file_names);
    found.picked->source = session.source(k, *index);
  }
  return found;
}

/// While nothing is asked for: measures what other techniques will want, so that the first switch to one does
/// not wait for it. False when there is nothing to do.
bool RenderThread::prepare_ahead() {
  for (const std::shared_ptr<State>& one : clients()) {
    if (!one->shared || !one->shared->prepares_ahead) continue;
    SharedSession& shared = *one->shared;
    if (shared.session().prepared_points() > SharedSession::most_points_of_looks) continue;
    Watch watch(*this, nullptr, Watch::Kind::idle);
    try {
      const Attributes of_most = Attributes(Attribute::normal) | Attribute::radius | Attribute::uncertainty;
      if (shared.session().complete(of_most, watch) ||
          shared.session().complete(of_most | Attribute::cluster | Attribute::support, watch))
        return true;
      shared.prepares_ahead = false;  // it is all there
    } catch (const Cancelled&) {
      return true;  // another time
    } catch (const std::exception&) {
      shared.prepares_ahead = false;  // who asks for it will be told
    }
  }
  return false;
}

Profile RenderThread::do_profile(State& one, const ProfileJob& job) {
  const Session& session = one.shared->session();
  Profile profile;
  profile.id = job.id, profile.line = job.line, profile.width = job.width;
  for (std::size_t k = 0; k < session.parts().size(); ++k)
    add_to_profile(profile, session.cloud(k), session.colors(k), session.pose().upright.up,
                   [&](std::size_t i) { return session.source(k, i); });
  return profile;
}

/// Nothing more can be drawn: whoever asked is told by an answer of id 0.
void RenderThread::lose(const Failure& failure) {
  std::vector<std::shared_ptr<State>> all;
  {
    const std::lock_guard lock(mutex);
    lost_ = failure;
    all = clients_;
  }
  for (const auto& one : all) answer(*one, failure);
}

bool RenderThread::is_lost() {
  try {
    gl::check_reset();
    return false;
  } catch (...) {
    lose(failure_of(0));
    return true;
  }
}

/// Points that nobody shows or holds any more are dropped, and render clients that are gone.
void RenderThread::drop_unused() {
  std::vector<std::shared_ptr<SharedSession>> unused;  // freed without the lock
  std::vector<std::shared_ptr<State>> gone;
  const std::lock_guard lock(mutex);
  std::erase_if(clients_, [&](const auto& one) {
    if (!one->gone) return false;  // asked once: it is said without the lock
    unused.push_back(std::exchange(one->shared, nullptr));
    gone.push_back(one);
    return true;
  });
  std::erase_if(shared_, [&](const auto& each) {
    if (std::any_of(clients_.begin(), clients_.end(), [&](const auto& one) {
          return one->shared == each.second || one->held_key == each.first;
        }))
      return false;
    unused.push_back(each.second);
    return true;
  });
}

/// With the lock.
std::shared_ptr<RenderClient::State> RenderThread::next_waiting() {
  for (std::size_t k = 1; k <= clients_.size(); ++k) {
    const std::size_t i = (turn_ + k) % clients_.size();
    if (!clients_[i]->is_waiting()) continue;
    turn_ = i;
    return clients_[i];
  }
  return nullptr;
}

void RenderThread::do_jobs() {
  while (!stop_) {
    std::optional<SceneJob> scene;
    std::optional<PictureJob> picture;
    std::optional<PickJob> pick;
    std::optional<ProfileJob> profile;
    std::shared_ptr<State> one;
    auto kind = Watch::Kind::live;
    drop_unused();
    {
      std::unique_lock lock(mutex);
      const auto has_gone = [&] {
        return std::any_of(clients_.begin(), clients_.end(),
                           [](const auto& each) { return each->gone.load(); });
      };
      const auto is_wanted = [&] {
        return stop_ || has_gone() || std::any_of(clients_.begin(), clients_.end(), [](const auto& each) {
                 return each->is_waiting();
               });
      };
      if (!work.wait_for(lock, idle_time, is_wanted)) {
        cancel_idle = false;
        lock.unlock();
        if (prepare_ahead()) continue;
        lock.lock();
        work.wait(lock, is_wanted);
      }
      if (stop_) break;
      if (has_gone()) continue;
      one = next_waiting();
      if (!one) continue;
      // Pictures for keeps are of the points that they were asked for with.
      if (one->scene && (one->kept.empty() || !one->shared)) {
        scene = std::exchange(one->scene, std::nullopt);
        one->cancel_scene = false;
        kind = Watch::Kind::scene;
      } else if (!one->picks.empty()) {
        pick = std::move(one->picks.front());
        one->picks.pop_front();
      } else if (one->profile) {
        profile = std::exchange(one->profile, std::nullopt);
      } else if (!one->kept.empty()) {
        picture = std::move(one->kept.front());
        one->kept.pop_front();
        kind = Watch::Kind::kept;
      } else {
        picture = std::exchange(one->live, std::nullopt);
        one->cancel_live = false;
      }
    }
    const std::uint64_t id = scene ? scene->id : picture ? picture->id : pick ? pick->id : profile->id;
    Watch watch(*this, one.get(), kind);
    try {
      if (forget_programs.exchange(false))
        for (const auto& each : clients())
          if (each->shared) {
            each->shared->looks.clear();
            for (SharedSession::Colored& in : each->shared->sessions) in.session->forget_programs();
          }
      if (scene) {
        do_scene(*one, std::move(*scene), watch);
      } else if (picture) {
        answer(*one, do_picture(*one, *picture, watch));
      } else if (profile) {
        answer(*one, do_profile(*one, *profile));
      } else {
        answer(*one, do_pick(*one, *pick));
      }
    } catch (const Cancelled&) {
      answer(*one, JobCancelled{id});
    } catch (...) {
      answer(*one, failure_of(id));
    }
    if (one->shared) one->point_bytes = one->shared->session().point_bytes();
    if (is_lost()) break;
    const std::vector<std::string> complaints = context_->take_messages();
    const std::lock_guard lock(mutex);
    one->driver_messages.insert(one->driver_messages.end(), complaints.begin(), complaints.end());
    if (one->driver_messages.size() > 100) one->driver_messages.resize(100);
  }
}

void RenderThread::run() {
  try {
    const std::lock_guard lock(gate_->mutex);
    context_ = gl::Context::create_headless();
  } catch (...) {
    lose(failure_of(0));
  }
  {
    // The limits of the driver are read by everybody and written by each that comes.
    std::unique_lock lock(gate_->mutex);
    --gate_->missing;
    gate_->all_there.notify_all();
    gate_->all_there.wait(lock, [&] { return gate_->missing <= 0; });
  }
  if (!context_) return;
  {
    const std::lock_guard lock(mutex);
    renderer_name = context_->limits().renderer;
  }
  do_jobs();
  // What is on the GPU goes before its context does.
  shared_.clear();
  for (const auto& one : clients()) one->shared.reset();
  context_.reset();
}

}  // namespace sfumato::view
