// A thread that paints: a GL context without a window, a session on it, and finished pictures out of it.
// Whoever asks never waits; a newer request cancels an older one.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "session/preset.h"
#include "session/session.h"
#include "view/picking.h"
#include "view/profile.h"

namespace sfumato::view {

/// Makes of a suggestion the technique that is drawn.
using Settle = std::function<TechniqueChoice(const TechniqueChoice&)>;

struct SceneJob {
  std::uint64_t id = 0;
  scene::Scene scene;
  Pose pose;
  SessionOptions options;
  std::string color_key;
  std::string technique;  ///< empty: `settle` chooses it
  std::function<NamesAndValues(const std::string&)> parameters_of;
  bool measures = true;  ///< what the technique needs; else its first picture does
  Settle settle;         ///< may be empty: then nothing is chosen, and nothing analysed for it
};

struct PictureJob {
  std::uint64_t id = 0;
  std::string technique;
  NamesAndValues parameters;
  Camera camera;
  ColorSettings color;
  std::string color_key;  ///< colours are made anew when it differs from the last one's
  std::optional<vec3> background;
  bool timings = false;
};

struct PickJob {
  std::uint64_t id = 0;
  Camera camera;
  double x_px = 0, y_px = 0;
};

struct ProfileJob {
  std::uint64_t id = 0;
  std::vector<dvec3> line;
  double width = 0;
};

/// A finished picture and what is known of it.
struct Picture {
  std::uint64_t id = 0;
  Image<Rgba8> image;
  Camera camera;
  std::string technique;
  NamesAndValues resolved;  ///< what automatic parameters became
  std::vector<std::string> notes;
  std::vector<PassTiming> timings;
  double took_ms = 0;  ///< from taking the job to the picture in memory
  double draw_ms = 0;  ///< of it, without what is measured once for all pictures
  std::uint64_t points_drawn = 0;
  Coloring coloring;  ///< without colours
  vec3 background{1};
};

struct SceneReady {
  std::uint64_t id = 0;
  std::size_t points = 0, left_out = 0;
  TechniqueChoice choice;          ///< empty technique: none was chosen
  std::vector<std::string> notes;  ///< on what rules selected
  Coloring coloring;
};

struct PickAnswer {
  std::uint64_t id = 0;
  std::optional<Picked> picked;
};

struct CalledOff {
  std::uint64_t id = 0;
};

struct Failure {
  std::uint64_t id = 0;
  ErrorCode code = ErrorCode::usage;
  std::string message;
};

using Answer = std::variant<Picture, SceneReady, PickAnswer, Profile, CalledOff, Failure>;

/// What is going on, for a progress bar.
struct Activity {
  double fraction = 0;
  std::string text;  ///< empty: nothing
};

class Painter {
 public:
  /// `wake` is called from the thread of the painter whenever there is an answer. `others` painters wait for
  /// each other until all have their contexts: creating one is no work for two threads.
  struct Gate {
    explicit Gate(int painters) : missing(painters) {}
    std::mutex mutex;
    std::condition_variable all_there;
    int missing;
  };
  Painter(std::shared_ptr<Gate> gate, std::function<void()> wake);
  /// Cancels what is going on and waits for it.
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Replaces the scene; pictures asked for before are cancelled, but for those to be kept, which it waits
  /// for.
  void show(SceneJob job);
  /// The newest wins; the one under way is cancelled.
  void paint(PictureJob job);
  /// For files: nothing calls it off but the end of the painter.
  void paint_for_keeps(PictureJob job);
  void pick(PickJob job);
  /// The newest wins.
  void profile(ProfileJob job);
  /// Cancels the live picture, if one is under way or waiting.
  void call_off();

  /// Files of shaders changed: the next picture is drawn by what is in them now.
  void forget_programs();

  std::vector<Answer> take_answers();
  Activity activity() const;
  /// What the driver complained of since the last call; tests fail on any.
  std::vector<std::string> take_driver_messages();
  /// What the points take in memory, as of the last picture.
  std::uint64_t point_bytes() const { return point_bytes_; }
  /// Of the context; empty while there is none.
  std::string renderer_name() const;

 private:
  class Watch;
  struct Easel;
  void run();
  void answer(Answer answer);
  void do_scene(Easel& easel, SceneJob job, Watch& watch);
  PickAnswer do_pick(Easel& easel, const PickJob& job);
  bool prepare_ahead(Easel& easel);
  bool is_lost();
  Profile do_profile(Easel& easel, const ProfileJob& job);
  Picture do_picture(Easel& easel, const PictureJob& job, Watch& watch);

  std::shared_ptr<Gate> gate_;
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::optional<SceneJob> scene_;
  std::optional<PictureJob> live_;
  std::deque<PictureJob> kept_;
  std::deque<PickJob> picks_;
  std::optional<ProfileJob> profile_;
  std::vector<Answer> answers_;
  Activity activity_;
  std::string renderer_name_;
  std::vector<std::string> driver_messages_;
  std::atomic<std::uint64_t> point_bytes_{0};
  bool prepares_ahead_ = true;  ///< of the thread alone
  std::atomic<bool> forget_programs_{false};
  std::atomic<bool> stop_{false}, cancel_live_{false}, cancel_scene_{false}, cancel_idle_{false};
  std::thread thread_;  // last: it uses all the others
};

}  // namespace sfumato::view
