// The thread behind render clients: its context, the points on it and who waits for pictures of them.
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <thread>

#include "view/render_client.h"

namespace sfumato::view {

/// Points that stand in memory, with what is drawn of them. They live on the thread of the context.
struct SharedSession {
  static constexpr std::size_t most_points_of_looks = 5'000'000;

  /// One over the points, and others that share them in other colours where several render clients look; the
  /// one drawn last first.
  struct Colored {
    std::unique_ptr<Session> session;
    std::optional<ColorSettings> color;  ///< nothing: half coloured, where a source was refused
  };
  std::vector<Colored> sessions;
  /// Those drawn last, newest first: another picture of one needs no programs or tables made anew.
  std::vector<std::unique_ptr<Look>> looks;
  std::vector<std::string> file_names;
  SceneReady ready;
  bool prepares_ahead = true;

  Session& session() const { return *sessions.front().session; }
  /// `most`: as many colours are kept at a time.
  Session& session_of(const ColorSettings& color, const std::optional<vec3>& background, std::size_t most,
                      gl::Context& context) {
    sessions.resize(std::min(sessions.size(), std::max<std::size_t>(1, most)));
    auto found = std::find_if(sessions.begin(), sessions.end(),
                              [&](const Colored& each) { return each.color == color; });
    if (found == sessions.end() && sessions.size() < most) {
      auto another = std::make_unique<Session>(context);
      another->share_scene(session());
      found = sessions.insert(found, {std::move(another), {}});
    } else if (found == sessions.end()) {
      --found;  // the one that was not drawn for longest
    }
    std::rotate(sessions.begin(), found, found + 1);
    Colored& first = sessions.front();
    if (first.color != color) {
      first.color.reset();
      first.session->set_color(color);
      first.color = color;
    }
    first.session->set_background(background);
    return *first.session;
  }

  Look& look_of(const std::string& technique, const NamesAndValues& parameters) {
    const auto found =
        std::find_if(looks.begin(), looks.end(), [&](const auto& each) { return each->name == technique; });
    if (found == looks.end())
      looks.insert(looks.begin(), std::make_unique<Look>(technique));
    else
      std::rotate(looks.begin(), found, found + 1);
    // Of very large clouds the tables of several techniques would not fit beside each other.
    if (const std::size_t most = session().prepared_points() > most_points_of_looks ? 1 : 3;
        looks.size() > most)
      looks.resize(most);
    Look& look = *looks.front();
    look.reset();
    for (const auto& [name, value] : parameters) look.set(name, value);
    look.check();
    return look;
  }
  // What techniques hold on the GPU goes before the session does.
  ~SharedSession() { looks.clear(); }
};

struct RenderClient::State {
  std::function<void()> wake;
  std::optional<SceneJob> scene;
  std::optional<PictureJob> live;
  std::deque<PictureJob> kept;
  std::deque<PickJob> picks;
  std::optional<ProfileJob> profile;
  std::vector<Answer> answers;
  Activity activity;
  std::vector<std::string> driver_messages;
  std::optional<SceneKey> held_key;
  std::shared_ptr<SharedSession> shared;  ///< null: nothing to draw
  std::atomic<std::uint64_t> point_bytes{0};
  std::atomic<bool> gone{false}, cancel_live{false}, cancel_scene{false};

  void drop_live() {
    if (live) answers.push_back(JobCancelled{live->id});
    live.reset();
  }
  bool is_waiting() const {
    return scene || (shared && (live || profile || !kept.empty() || !picks.empty()));
  }
};

class RenderThread {
 public:
  using State = RenderClient::State;
  explicit RenderThread(std::shared_ptr<RenderClient::Gate> gate)
      : gate_(std::move(gate)), thread_([this] { run(); }) {}
  ~RenderThread() {
    {
      const std::lock_guard lock(mutex);
      stop_ = true;
      work.notify_all();
    }
    thread_.join();
  }

  std::shared_ptr<State> add(std::function<void()> wake) {
    auto one = std::make_shared<State>();
    one->wake = std::move(wake);
    const std::lock_guard lock(mutex);
    if (lost_) one->answers.push_back(*lost_);
    clients_.push_back(one);
    return one;
  }
  void remove(State& one) {
    one.gone = one.cancel_live = one.cancel_scene = true;
    const std::lock_guard lock(mutex);
    one.wake = [] {};
    begin_work();
  }
  /// With the lock: there is something better to do than what may be wanted later.
  void begin_work() {
    cancel_idle = true;
    work.notify_all();
  }
  /// Null: no points of that key are shared.
  std::shared_ptr<SharedSession> find(const std::optional<SceneKey>& key) const {
    for (const auto& [its_key, shared] : shared_)
      if (its_key == key) return shared;
    return nullptr;
  }

  mutable std::mutex mutex;
  std::condition_variable work;
  std::string renderer_name;
  std::atomic<bool> cancel_idle{false}, forget_programs{false};

 private:
  class Watch;
  void run();
  void do_jobs();
  void answer(State& one, Answer answer);
  void do_scene(State& one, SceneJob job, Watch& watch);
  PickAnswer do_pick(State& one, const PickJob& job);
  bool prepare_ahead();
  void lose(const Failure& failure);
  bool is_lost();
  Profile do_profile(State& one, const ProfileJob& job);
  std::vector<std::shared_ptr<State>> clients() const;
  std::size_t clients_of(const SharedSession& shared) const;
  Picture do_picture(State& one, const PictureJob& job, Watch& watch);
  void drop_unused();
  std::shared_ptr<State> next_waiting();

  std::shared_ptr<RenderClient::Gate> gate_;
  std::unique_ptr<gl::Context> context_;
  std::vector<std::shared_ptr<State>> clients_;  ///< with the lock
  std::size_t turn_ = 0;                         ///< whose request was met last: each gets a picture in turn
  std::vector<std::pair<SceneKey, std::shared_ptr<SharedSession>>> shared_;
  std::optional<Failure> lost_;
  std::atomic<bool> stop_{false};
  std::thread thread_;  // last: it uses all the others
};

}  // namespace sfumato::view
