#include "view/painter.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "core/error.h"
#include "gl/reset.h"
#include "view/navigator.h"

namespace sfumato::view {
namespace {

using Clock = std::chrono::steady_clock;

/// Without a wish, until attributes are measured that somebody may want.
constexpr std::chrono::milliseconds idle_time(1500);
constexpr std::size_t most_points_of_looks = 5'000'000;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The message that a person gets for whatever was thrown.
Failure failure_of(std::uint64_t id) {
  try {
    throw;
  } catch (const Error& error) {
    return {id, error.code(), error.what()};
  } catch (const std::bad_alloc&) {
    return {id, ErrorCode::out_of_memory, "out of memory; open fewer points (--max-points N)"};
  } catch (const std::exception& error) {
    return {id, ErrorCode::usage, error.what()};
  }
}

}  // namespace

/// Progress of the job under way, and the way to call it off.
class Painter::Watch final : public Progress {
 public:
  enum class Kind { scene, live, kept, idle };
  Watch(Painter& painter, Kind kind) : painter_(painter), kind_(kind) {}
  Kind kind() const { return kind_; }
  void update(double fraction, std::string_view text) override {
    const std::lock_guard lock(painter_.mutex_);
    painter_.activity_ = {fraction, std::string(text)};
    // A progress bar moves a few times a second; a call for every step would keep the window busy.
    if (const auto now = Clock::now(); now - last_wake_ > std::chrono::milliseconds(100)) {
      last_wake_ = now;
      painter_.wake_();
    }
  }
  bool cancelled() const override {
    if (kind_ == Kind::kept) return painter_.stop_;
    if (painter_.stop_ || painter_.cancel_scene_) return true;
    if (kind_ == Kind::idle) return painter_.cancel_idle_;
    return kind_ == Kind::live && painter_.cancel_live_;
  }

 private:
  Painter& painter_;
  Kind kind_;
  Clock::time_point last_wake_{};
};

/// What lives on the thread of the context.
struct Painter::Easel {
  std::unique_ptr<gl::Context> context;
  std::unique_ptr<Session> session;
  /// Those drawn last, newest first: another picture of one needs no programs or tables made anew.
  std::vector<std::unique_ptr<Look>> looks;
  std::string color_key;
  std::optional<vec3> background;
  std::vector<std::string> file_names;

  Look& look_of(const std::string& technique, const NamesAndValues& parameters) {
    const auto found =
        std::find_if(looks.begin(), looks.end(), [&](const auto& each) { return each->name == technique; });
    if (found == looks.end())
      looks.insert(looks.begin(), std::make_unique<Look>(technique));
    else
      std::rotate(looks.begin(), found, found + 1);
    // Of very large clouds the tables of several techniques would not fit beside each other.
    if (const std::size_t most = session->prepared_points() > most_points_of_looks ? 1 : 3;
        looks.size() > most)
      looks.resize(most);
    Look& look = *looks.front();
    look.reset();
    for (const auto& [name, value] : parameters) look.set(name, value);
    look.check();
    return look;
  }
};

Painter::Painter(std::shared_ptr<Gate> gate, std::function<void()> wake)
    : gate_(std::move(gate)), wake_(std::move(wake)), thread_([this] { run(); }) {}

Painter::~Painter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    work_.notify_all();
  }
  thread_.join();
}

void Painter::show(SceneJob job) {
  const std::lock_guard lock(mutex_);
  if (live_) answers_.push_back(CalledOff{live_->id});
  live_.reset();
  scene_ = std::move(job);
  cancel_scene_ = cancel_idle_ = true;
  work_.notify_all();
}

void Painter::paint(PictureJob job) {
  const std::lock_guard lock(mutex_);
  if (live_) answers_.push_back(CalledOff{live_->id});
  live_ = std::move(job);
  cancel_live_ = cancel_idle_ = true;
  work_.notify_all();
}

void Painter::paint_for_keeps(PictureJob job) {
  const std::lock_guard lock(mutex_);
  kept_.push_back(std::move(job));
  cancel_idle_ = true;
  work_.notify_all();
}

void Painter::pick(PickJob job) {
  const std::lock_guard lock(mutex_);
  picks_.push_back(std::move(job));
  cancel_idle_ = true;
  work_.notify_all();
}

void Painter::profile(ProfileJob job) {
  const std::lock_guard lock(mutex_);
  profile_ = std::move(job);
  cancel_idle_ = true;
  work_.notify_all();
}

void Painter::call_off() {
  const std::lock_guard lock(mutex_);
  if (live_) answers_.push_back(CalledOff{live_->id});
  live_.reset();
  cancel_live_ = cancel_idle_ = true;
}

void Painter::forget_programs() {
  forget_programs_ = true;
  call_off();
}

std::vector<Answer> Painter::take_answers() {
  const std::lock_guard lock(mutex_);
  return std::exchange(answers_, {});
}

std::vector<std::string> Painter::take_driver_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(driver_messages_, {});
}

Activity Painter::activity() const {
  const std::lock_guard lock(mutex_);
  return activity_;
}

std::string Painter::renderer_name() const {
  const std::lock_guard lock(mutex_);
  return renderer_name_;
}

void Painter::answer(Answer answer) {
  {
    const std::lock_guard lock(mutex_);
    answers_.push_back(std::move(answer));
    activity_ = {};
  }
  wake_();
}

void Painter::do_scene(Easel& easel, SceneJob job, Watch& watch) {
  SceneReady ready;
  ready.id = job.id;
  easel.looks.clear();  // what they hold of the last cloud is of no use for this one
  easel.color_key = job.color_key;
  easel.background = job.options.background;
  easel.file_names = job.scene.file_names;
  const auto needs = [&](const Session::Suggest& suggest) {
    std::string technique = job.technique;
    if (technique.empty() && job.settle) {
      ready.choice = job.settle(suggest());
      technique = ready.choice.technique;
    }
    if (technique.empty() || !job.measures) return Attributes();
    return easel.look_of(technique, job.parameters_of(technique)).technique->needs();
  };
  easel.session->set_scene(std::move(job.scene), std::move(job.pose), job.options, needs, watch);
  ready.points = easel.session->prepared_points();
  ready.notes = easel.session->notes();
  ready.left_out = easel.session->left_out();
  ready.coloring = easel.session->coloring();
  answer(std::move(ready));
}

Picture Painter::do_picture(Easel& easel, const PictureJob& job, Watch& watch) {
  const auto asked = Clock::now();
  Session& session = *easel.session;
  Look& look = easel.look_of(job.technique, job.parameters);
  if (easel.color_key != job.color_key) {
    easel.color_key.clear();  // half coloured where a source is refused
    session.set_color(job.color);
    easel.color_key = job.color_key;
  }
  if (easel.background != job.background) {
    session.set_background(job.background);
    easel.background = job.background;
  }
  // What is measured once for all pictures is not called off with this one: a hand that moves on would never
  // see its end.
  Watch for_all(*this, watch.kind() == Watch::Kind::kept ? Watch::Kind::kept : Watch::Kind::scene);
  session.complete(look, for_all);
  watch.check();
  const auto start = Clock::now();
  RenderWants wants;
  wants.timings = job.timings;
  RenderOutput out = session.render(look, job.camera, wants, watch);
  Picture picture;
  picture.id = job.id;
  picture.image = std::move(out.rgba8);
  picture.camera = job.camera;
  picture.technique = job.technique;
  for (const Param& param : look.parameters.all())
    if (param.can_be_auto) picture.resolved.emplace_back(param.name, param.resolved());
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
PickAnswer Painter::do_pick(Easel& easel, const PickJob& job) {
  const Session& session = *easel.session;
  PickAnswer found{job.id, {}};
  double nearest = 0;
  for (std::size_t k = 0; k < session.parts().size(); ++k) {
    const PointCloud& cloud = session.cloud(k);
    const auto index =
        nearest_point(cloud, job.camera, job.x_px, job.y_px, 12, 0.02, session.pose().subject.room);
    if (!index) continue;
    const double depth = project(job.camera, cloud.world(*index)).z;
    if (found.picked && depth >= nearest) continue;
    nearest = depth;
    found.picked = describe(cloud, *index, easel.file_names);
    found.picked->source = session.source(k, *index);
  }
  return found;
}

/// While nothing is asked for: measures what other techniques will want, so that the first switch to one does
/// not wait for it. False when there is nothing to do.
bool Painter::prepare_ahead(Easel& easel) {
  if (easel.session->prepared_points() > most_points_of_looks) return false;
  Watch watch(*this, Watch::Kind::idle);
  bool did = false;
  try {
    const Attributes of_most = Attributes(Attribute::normal) | Attribute::radius | Attribute::uncertainty;
    did = easel.session->complete(of_most, watch) ||
          easel.session->complete(of_most | Attribute::cluster, watch);
  } catch (const Cancelled&) {
    did = true;  // another time
  } catch (const std::exception&) {
    prepares_ahead_ = false;  // who asks for it will be told
  }
  const std::lock_guard lock(mutex_);
  activity_ = {};
  return did;
}

Profile Painter::do_profile(Easel& easel, const ProfileJob& job) {
  const Session& session = *easel.session;
  Profile profile;
  profile.id = job.id, profile.line = job.line, profile.width = job.width;
  for (std::size_t k = 0; k < session.parts().size(); ++k)
    add_to_profile(profile, session.cloud(k), session.colors(k), session.pose().upright.up,
                   [&](std::size_t i) { return session.source(k, i); });
  return profile;
}

/// Nothing more can be drawn: whoever asked is told by an answer of id 0.
bool Painter::is_lost() {
  try {
    gl::check_reset();
    return false;
  } catch (...) {
    answer(failure_of(0));
    return true;
  }
}

void Painter::run() {
  Easel easel;
  try {
    const std::lock_guard lock(gate_->mutex);
    easel.context = gl::Context::create_headless();
    easel.session = std::make_unique<Session>(*easel.context);
  } catch (...) {
    answer(failure_of(0));
  }
  {
    // The limits of the driver are read by everybody and written by each that comes.
    std::unique_lock lock(gate_->mutex);
    --gate_->missing;
    gate_->all_there.notify_all();
    gate_->all_there.wait(lock, [&] { return gate_->missing <= 0; });
  }
  if (!easel.context) return;
  {
    const std::lock_guard lock(mutex_);
    renderer_name_ = easel.context->limits().renderer;
  }
  while (!stop_) {
    std::optional<SceneJob> scene;
    std::optional<PictureJob> picture;
    std::optional<PickJob> pick;
    std::optional<ProfileJob> profile;
    auto kind = Watch::Kind::live;
    {
      std::unique_lock lock(mutex_);
      const auto is_wanted = [&] {
        const bool can_draw = !easel.session->empty();
        return stop_ || scene_ || (can_draw && (live_ || profile_ || !kept_.empty() || !picks_.empty()));
      };
      if (!work_.wait_for(lock, idle_time, is_wanted)) {
        cancel_idle_ = false;
        lock.unlock();
        if (prepares_ahead_ && prepare_ahead(easel)) continue;
        lock.lock();
        work_.wait(lock, is_wanted);
      }
      if (stop_) break;
      // Pictures for keeps are of the points that they were asked for with.
      if (scene_ && (kept_.empty() || easel.session->empty())) {
        scene = std::exchange(scene_, std::nullopt);
        cancel_scene_ = false;
        kind = Watch::Kind::scene;
      } else if (!picks_.empty()) {
        pick = std::move(picks_.front());
        picks_.pop_front();
      } else if (profile_) {
        profile = std::exchange(profile_, std::nullopt);
      } else if (!kept_.empty()) {
        picture = std::move(kept_.front());
        kept_.pop_front();
        kind = Watch::Kind::kept;
      } else {
        picture = std::exchange(live_, std::nullopt);
        cancel_live_ = false;
      }
    }
    const std::uint64_t id = scene ? scene->id : picture ? picture->id : pick ? pick->id : profile->id;
    Watch watch(*this, kind);
    try {
      if (forget_programs_.exchange(false)) {
        easel.looks.clear();
        easel.session->forget_programs();
      }
      if (scene) {
        do_scene(easel, std::move(*scene), watch);
      } else if (picture) {
        answer(do_picture(easel, *picture, watch));
      } else if (profile) {
        answer(do_profile(easel, *profile));
      } else {
        answer(do_pick(easel, *pick));
      }
    } catch (const Cancelled&) {
      answer(CalledOff{id});
    } catch (...) {
      answer(failure_of(id));
    }
    point_bytes_ = easel.session->point_bytes();
    if (is_lost()) break;
    const std::vector<std::string> complaints = easel.context->take_messages();
    const std::lock_guard lock(mutex_);
    driver_messages_.insert(driver_messages_.end(), complaints.begin(), complaints.end());
    if (driver_messages_.size() > 100) driver_messages_.resize(100);
  }
  // What techniques hold on the GPU goes before its context does.
  easel.looks.clear();
  easel.session.reset();
}

}  // namespace sfumato::view
