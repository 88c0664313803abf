// Asks a render thread for pictures. The thread has a GL context without a window and sessions on it;
// finished pictures come back as answers. Whoever asks never waits; a newer request cancels an older one.
// Several render clients may share one thread, and those of them that look at the same points share these:
// each has a camera, a look and colours of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "session/session.h"
#include "view/picking.h"
#include "view/profile.h"
#include "view/view_request.h"

namespace sfumato::view {

struct SceneJob {
  std::uint64_t id = 0;
  /// Render clients of one thread that show the same key have the same points, those of the first that came;
  /// nothing: points of its own.
  std::optional<SceneKey> shared_key;
  scene::Scene scene;
  Pose pose;
  SessionOptions options;
  std::unique_ptr<Choice> choice;  ///< null: nothing is chosen, and nothing analysed for it
  bool measures = true;            ///< what its techniques need, with the scene; else their first pictures do
};

struct PictureJob {
  std::uint64_t id = 0;
  std::string technique;
  NamesAndValues parameters;
  Camera camera;
  ColorSettings color;  ///< made anew where they differ from the last one's
  std::optional<vec3> background;
  bool timings = false;
  int depth_step = 0;  ///< depth of every so many pixels is wanted as well; 0: none
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
  Image<float> depth;  ///< eye depth of each `depth_step` pixels, from border to border; inf where nothing is
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

struct JobCancelled {
  std::uint64_t id = 0;
};

struct Failure {
  std::uint64_t id = 0;
  ErrorCode code = ErrorCode::usage;
  std::string message;
};

/// The message that a person gets for what is being thrown, only inside a catch; `other`: the code of what is
/// no Error.
Failure failure_of(std::uint64_t id, ErrorCode other = ErrorCode::usage);

using Answer = std::variant<Picture, SceneReady, PickAnswer, Profile, JobCancelled, Failure>;

/// What is going on, for a progress bar.
struct Activity {
  double fraction = 0;
  std::string text;  ///< empty: nothing
};

/// The context, the sessions and the thread itself. It ends with the last render client that uses it.
class RenderThread;

class RenderClient {
 public:
  /// Render threads wait here until `clients` of them have their contexts: creating one is no work for two
  /// threads.
  struct Gate {
    explicit Gate(int clients) : missing(clients) {}
    std::mutex mutex;
    std::condition_variable all_there;
    int missing;
  };
  static std::shared_ptr<RenderThread> make_thread(std::shared_ptr<Gate> gate);
  /// `wake` is called from the render thread when there is an answer or progress.
  RenderClient(std::shared_ptr<RenderThread> thread, std::function<void()> wake);
  RenderClient(std::shared_ptr<Gate> gate, std::function<void()> wake)
      : RenderClient(make_thread(std::move(gate)), std::move(wake)) {}
  /// Cancels what is going on for it, and waits for that where nobody else uses the thread.
  ~RenderClient();
  RenderClient(const RenderClient&) = delete;
  RenderClient& operator=(const RenderClient&) = delete;

  /// The points of that key stay until this render client shows or holds something else; false: they are not
  /// here.
  bool hold(const SceneKey& shared_key);
  /// Replaces the scene; pictures asked for before are cancelled, but for those to be kept, which it waits
  /// for.
  void show(SceneJob job);
  /// The newest wins; the one under way is cancelled.
  void render(PictureJob job);
  /// For files: nothing cancels it but the end of the render client.
  void render_to_keep(PictureJob job);
  void pick(PickJob job);
  /// The newest wins.
  void profile(ProfileJob job);
  /// Cancels the live picture, if one is under way or waiting.
  void cancel();

  /// Files of shaders changed: the next picture is drawn by what is in them now.
  void forget_programs();

  std::vector<Answer> take_answers();
  Activity activity() const;
  /// What the driver complained of since the last call; tests fail on any.
  std::vector<std::string> take_driver_messages();
  /// What the points take in memory, as of the last picture.
  std::uint64_t point_bytes() const;
  /// Of the context; empty while there is none.
  std::string renderer_name() const;

  struct State;  ///< what it asks for and gets, shared with the thread

 private:
  std::shared_ptr<RenderThread> thread_;
  std::shared_ptr<State> state_;
};

}  // namespace sfumato::view
