// Everything between the hand and the picture: the request, camera, history, the reading of files, and two
// render clients, one of the whole cloud and one of a sample that moves. A front end calls `tick` whenever it
// draws itself and shows what is here, in `scene`, `picks`, `saved_pictures`, `path` and `sequence`; it never
// waits. All of it is used on one thread.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "view/history.h"
#include "view/key_frames.h"
#include "view/navigator.h"
#include "view/render_client.h"
#include "view/picks.h"
#include "view/refinement.h"
#include "view/scene_state.h"
#include "view/sequence.h"
#include "view/shared_scenes.h"
#include "view/saved_pictures.h"
#include "view/view_request.h"

namespace sfumato::view {

struct Start {
  ViewRequest request;
  NamesAndValues given;      ///< parameters that the technique must have, where none is chosen yet
  CameraRequest first_view;  ///< of the first files, in the size of the window where it has no `start`
  std::uint64_t memory = scene::default_memory;
  bool watch = false;  ///< read files again when they change
  int depth_step = 0;  ///< pictures come with the depth of every so many pixels; 0: without
  std::string
      shader_folder;  ///< of a checkout whose shaders are compiled again when they change; empty: none
  std::vector<scene::SceneFile>
      frames;  ///< of a sequence: files that are shown one at a time; the first is in the request
  std::function<void()> wake;            ///< from any thread: there is something to `tick` for
  std::shared_ptr<SharedScenes> shared;  ///< with other view models of this thread; null: alone
};

/// What a hand moves that drags over the picture.
enum class Drag { none, rotate, pan, light };

/// Bytes.
struct Memory {
  std::uint64_t process = 0, process_peak = 0;  ///< resident; 0 where the system does not tell
  std::uint64_t points = 0;                     ///< of the whole cloud, with what was measured of it
};

/// A line for the person, and whether it is about a mistake.
struct Message {
  std::string text;
  bool is_error = false;
};

class ViewModel {
 public:
  explicit ViewModel(Start start);

  /// Takes what has come and asks for what is missing. Cheap.
  void tick(double now_ms);
  /// When `tick` is due even if nothing happens; nothing: not before something does.
  std::optional<double> wait_ms(double now_ms) const;

  const ViewRequest& request() const { return request_; }
  /// Every change of the request goes through here: `what` names its kind for undo. Shows a message instead
  /// where `edit` throws.
  void change(const std::string& what, const std::function<void(ViewRequest&)>& edit);
  /// The same for the camera.
  void move(const std::string& what, const std::function<void(Navigator&)>& edit);
  /// Of a drag that holds what `grab` found where it began.
  void drag(Drag kind, const dvec3& grabbed, double dx_px, double dy_px);
  dvec3 grab(Drag kind, double x_px, double y_px) const {
    return kind == Drag::rotate ? pivot_at(x_px, y_px) : place_at(x_px, y_px);
  }
  /// Every class that is not named stays as it is shown.
  void show_class(int id, bool shown);
  void undo();
  void redo();
  bool can_undo() const { return history_.can_undo(); }
  bool can_redo() const { return history_.can_redo(); }

  void set_size(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  Camera camera() const { return request_.camera.to_camera(width_, height_); }
  const Navigator& navigator() const { return navigator_; }

  /// The point of the scene under the cursor; where there is none, the place there at the depth of the
  /// target.
  dvec3 place_at(double x_px, double y_px) const;
  /// What a turn that begins there turns about: the point under the cursor, else the target.
  dvec3 pivot_at(double x_px, double y_px) const;

  Picks picks;
  /// Asks for the point under the cursor with all that it holds; it comes to `picks`.
  /// `add`: to a line of as many points as are picked so; else the last two remain.
  void pick(double x_px, double y_px, bool add = false);
  /// Along the line of picked points, of whatever stands in a corridor that wide; it comes to `picks`.
  void cut_profile(double width);

  /// The newest picture; null before the first.
  std::shared_ptr<const Picture> picture() const { return shown_; }
  Quality shown_quality() const { return shown_quality_; }
  /// What an automatic parameter of its technique became in it; nothing where that is not known.
  std::optional<std::string> resolved(const std::string& parameter) const;
  bool settled() const { return refinement_.settled() && !scene.loading() && !is_coarser_than_wanted(); }
  bool moving() const { return refinement_.moving(now_ms_); }
  double motion_ms() const { return motion_ms_; }  ///< between two pictures in motion, smoothed; 0: none yet
  double first_picture_ms() const { return first_picture_ms_; }
  const Activity& activity() const { return activity_; }
  /// What is shown is out of date.
  void repaint();

  SceneState scene;
  /// In place of what is open, or beside it; where that changes nothing, the files are read again.
  void open(const std::vector<std::string>& files, bool add);
  bool watch = false;    ///< read files again when they change
  bool timings = false;  ///< whole pictures come with the time of every pass
  std::string renderer_name() const { return whole_->renderer_name(); }
  /// What the drivers of both render clients complained of since the last call.
  std::vector<std::string> take_driver_messages();
  Memory memory() const;

  SavedPictures saved_pictures;
  /// A picture of the present view for keeps; it comes to `saved_pictures`, once everything is loaded. Of
  /// files with levels, what it shows is read before.
  void save_picture(int width, int height) { save_picture(request_, width, height); }

  std::vector<Message> take_messages() { return std::exchange(messages_, {}); }
  void say(const std::string& text, bool is_error = false);
  std::function<void(const Message&)> on_message;  ///< sees every message as well
  /// An error that leaves nothing to show: no driver, or the first files cannot be read.
  const std::optional<Failure>& fatal() const { return fatal_; }

  KeyFrames path;
  /// Plays the path from its begin, or stops it.
  void play(bool on);
  bool playing() const { return play_began_ms_.has_value(); }

  Sequence sequence;
  /// Of `sequence.frames`; no step that could be undone.
  void show_frame(std::size_t i);

 private:
  using SeenView = SceneState::SeenView;
  using LoadState = SceneState::LoadState;

  std::optional<dvec3> point_at(const Camera& seen, double x_px, double y_px) const;
  void take_loaded(Loaded loaded);
  void take_answer(Answer answer, bool of_whole);
  void load(bool anew);
  static SeenView view_of(const ViewRequest& request, int width, int height);
  /// Of the window, or of a picture to be kept that waits for its points.
  SeenView wanted_view() const;
  const ViewRequest& request_of_view() const;
  bool is_coarser_than_wanted() const;
  void follow_view();
  bool is_loading_request() const;
  std::optional<double> load_due_ms() const;
  void save_what_is_loaded();
  /// Of what was found only when the files were read: `edit` is called of every state that somebody may see.
  void amend(const std::function<void(ViewRequest&)>& edit);
  void save_picture(const ViewRequest& request, int width, int height);
  void render_saved(const ViewRequest& request, int width, int height);
  LoadJob load_job(const ViewRequest& request) const;
  void send_scene(Loaded& loaded, bool is_another_view);
  PictureJob job_for(const ViewRequest& request, const Quality& quality, int width, int height) const;
  void ask();
  void watch_files();
  void watch_shaders();

  Start start_;
  ViewRequest request_;
  Navigator navigator_;
  History<ViewRequest> history_;
  Refinement refinement_;
  int width_ = 0, height_ = 0;
  double now_ms_ = 0, began_ms_ = -1, motion_ms_ = 0, last_motion_ms_ = -1, first_picture_ms_ = 0,
         watched_ms_ = 0, shaders_watched_ms_ = 0;
  std::uint64_t next_id_ = 1, in_flight_ = 0;
  Quality in_flight_quality_, shown_quality_;
  ViewRequest look_;
  std::shared_ptr<const Picture> shown_;
  Activity activity_;
  bool stand_in_is_due_ = false;  ///< for a view that the technique has yet to measure
  std::vector<Message> messages_;
  std::set<std::string> notes_said_;  ///< of readers
  std::optional<Failure> fatal_;
  std::optional<double> play_began_ms_;
  std::vector<std::pair<std::string, std::int64_t>> file_times_, shader_times_;

  std::shared_ptr<RenderClient::Gate> gate_ = std::make_shared<RenderClient::Gate>(2);
  std::unique_ptr<RenderClient> sample_, whole_;
  std::unique_ptr<Loader> loader_;
};

}  // namespace sfumato::view
