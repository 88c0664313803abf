// Of a view model: what its files are read for, and what comes of them.
#include <algorithm>
#include <filesystem>

#include "core/counted.h"
#include "core/error.h"
#include "view/view_model.h"

namespace sfumato::view {

/// The scene that is drawn is not yet the one that is asked for.
bool ViewModel::is_loading_request() const {
  return scene.loading() || (!scene.whole_.is_ready && !scene.follows_view()) ||
         request_.scene_key() != scene.key_;
}

/// Nothing while points are read for a picture to be kept.
std::optional<double> ViewModel::load_due_ms() const {
  return saved_pictures.of_view_.empty() ? scene.due_ms() : std::nullopt;
}

LoadJob ViewModel::load_job(const ViewRequest& request) const {
  LoadJob job{scene.load_id_, request, request.scene_files()};
  job.request.memory = start_.memory;
  // Windows show heights as they are.
  job.request.exaggeration.reset(), job.request.output_index.clear(), job.request.panorama = false;
  return job;
}

void ViewModel::load(bool anew) {
  scene.load_id_ = next_id_++;
  scene.load_state_ = LoadState::reading;
  scene.is_to_read_anew_ = false;
  scene.wanted_key_ = request_.scene_key();
  if (scene.key_ != scene.wanted_key_) file_times_.clear();
  scene.key_ = scene.wanted_key_;
  scene.known_.reset();
  scene.is_reading_view_ = false;
  scene.read_view_.reset();
  if (start_.shared && !anew) {
    scene.known_ = start_.shared->find(scene.wanted_key_);
    // Both keep it: one that had to be read again would miss what the other has.
    const bool has_sample = sample_->hold(scene.wanted_key_), has_whole = whole_->hold(scene.wanted_key_);
    if (!has_sample || !has_whole) scene.known_.reset();
    if (scene.known_) return loader_->cancel();
  }
  LoadJob job = load_job(request_);
  job.anew = anew;
  job.sample_first = request_.frame_on_load && !anew;  // else something better is on the screen
  if (scene.follows_view() && !request_.frame_on_load) {
    scene.read_view_ = wanted_view();
    job.seen = camera();
    job.has_shadows = scene.read_view_->has_shadows;
  }
  loader_->load(std::move(job));
}

ViewModel::SeenView ViewModel::wanted_view() const {
  if (saved_pictures.of_view_.empty()) return view_of(request_, width_, height_);
  const SavedPictures::Order& order = saved_pictures.of_view_.front();
  return view_of(order.request, order.width, order.height);
}

const ViewRequest& ViewModel::request_of_view() const {
  return saved_pictures.of_view_.empty() ? request_ : saved_pictures.of_view_.front().request;
}

ViewModel::SeenView ViewModel::view_of(const ViewRequest& request, int width, int height) {
  return {request.camera, width, height, casts_shadows(request.settings().shadows)};
}

bool ViewModel::is_coarser_than_wanted() const {
  return scene.follows_view() && scene.load_state_ != LoadState::refused &&
         scene.load_state_ != LoadState::unreadable &&
         (!scene.whole_.is_ready || scene.is_reading_view_ || scene.read_view_ != wanted_view());
}

/// Reads what the view shows of files with levels, once the hand rests.
void ViewModel::follow_view() {
  if (!scene.may_follow_view() || width_ <= 0) return;
  const SeenView wanted = wanted_view();
  if (scene.read_view_ == wanted) {
    if (!saved_pictures.of_view_.empty() && scene.whole_.is_ready && !scene.is_reading_view_) {
      // A hand that went on while the points were read gets the picture it asked for.
      render_saved(saved_pictures.of_view_.front().request, wanted.width, wanted.height);
      saved_pictures.of_view_.pop_front();
    }
    return;
  }
  if (std::exchange(scene.is_reading_view_, false)) loader_->cancel();
  scene.read_view_.reset();
  if (refinement_.moving(now_ms_) && saved_pictures.of_view_.empty()) return;
  scene.read_view_ = wanted;
  scene.is_reading_view_ = true;
  scene.load_id_ = next_id_++;
  const ViewRequest& request = request_of_view();
  LoadJob job = load_job(request);
  job.seen = wanted.camera.to_camera(wanted.width, wanted.height);
  job.has_shadows = wanted.has_shadows;
  job.pose = scene.loaded_->pose;
  job.overview = scene.loaded_->overview;
  job.shown = scene.loaded_->nodes;
  loader_->load(std::move(job));
}

void ViewModel::send_scene(Loaded& loaded, bool is_another_view) {
  const ViewRequest& wanted = request_of_view();
  const auto job_of = [&](scene::Scene part) {
    SceneJob job;
    job.id = next_id_++;
    job.scene = std::move(part);
    job.pose = loaded.pose;
    job.options = wanted.session_options();
    if (start_.shared && !loaded.is_sample && !loaded.follows_view) job.shared_key = scene.key_;
    // A sample, or a coarse view, does not tell which technique suits the scan.
    if (!wanted.technique.empty()) job.choice = wanted.make_choice({});
    return job;
  };
  scene.sample_ = scene.whole_ = {};
  refinement_.set_whole_ready(false);
  if (!is_another_view) refinement_.forget();
  in_flight_ = 0;
  refinement_.cancel();
  SceneJob sample = job_of(std::move(loaded.sample));
  scene.sample_.id = sample.id;
  sample_->show(std::move(sample));
  if (loaded.is_sample) return;
  SceneJob whole = job_of(std::move(loaded.whole));
  scene.whole_.id = whole.id;
  if (scene.loading()) scene.load_state_ = LoadState::preparing;
  if (!loaded.is_coarse) whole.choice = wanted.make_choice(start_.given);
  // The view is shown before the technique has measured its points.
  whole.measures = !is_another_view;
  stand_in_is_due_ = is_another_view && request_.technique != stand_in_technique;
  whole_->show(std::move(whole));
}

void ViewModel::take_loaded(Loaded loaded) {
  if (loaded.id != scene.load_id_) return;
  const bool is_another_view = scene.is_reading_view_;
  if (!loaded.is_coarse) scene.is_reading_view_ = false;
  if (loaded.is_shown) return;
  if (loaded.failure) {
    if (!is_another_view) scene.load_state_ = LoadState::unreadable;
    saved_pictures.drop_waiting();
    if (!scene.loaded_) fatal_ = loaded.failure;
    say(loaded.failure->message, true);
    if (scene.has_sample_only()) say("what is shown is a sample of what could be read");
    return;
  }
  // What more was read of a sample waits while a hand turns what there is.
  if (loaded.is_sample && !loaded.is_first && refinement_.moving(now_ms_)) return;
  for (const std::string& note : loaded.notes)
    if (notes_said_.insert(note).second) say(note);  // not again for every slice of the same files
  if (!is_another_view) picks.clear(), picks.close_profile();
  navigator_.set_scene(loaded.pose.upright.up, loaded.pose.subject, loaded.pose.vertical());
  if (request_.frame_on_load && width_ > 0 && loaded.is_first) {
    ViewCamera first;
    CameraRequest view = start_.first_view;
    if (!view.start) view.size = {width_, height_};
    try {
      first = ViewCamera::from(sfumato::view_of(loaded.pose, view));
    } catch (const Error& error) {
      if (!loaded.is_sample) say(error.what(), true);
      first = ViewCamera::from(first_view(loaded.pose, width_, height_));
    }
    const auto place = [&](ViewRequest& each) {
      if (!each.frame_on_load || each.files != request_.files) return;
      each.home = first;
      // A hand that has turned the sample goes on from there.
      if (!scene.sample_camera_ || each.camera == *scene.sample_camera_) each.camera = first;
      each.frame_on_load = loaded.is_sample;  // the whole says where it is, exactly
      // The other frames stand as the first does.
      if (!loaded.is_sample && sequence.holds(each.files) && !each.points.up)
        each.points.up = loaded.pose.upright.up;
    };
    const bool is_wanted = request_.scene_key() == scene.key_;
    amend(place);
    if (is_wanted) scene.key_ = scene.wanted_key_ = request_.scene_key();
    scene.sample_camera_.reset();
    if (loaded.is_sample) scene.sample_camera_ = first;
    if (!scene.loaded_) history_ = History<ViewRequest>(request_);  // there is nothing to go back to
  }
  if (!loaded.is_sample) start_.first_view = {};  // it is of the first files
  if (on_message)
    on_message({loaded.is_sample
                    ? "a sample of " + counted(loaded.points_shown, "point") + ", while the files are read"
                    : are(loaded.points_shown, "point") + " read",
                false});
  send_scene(loaded, is_another_view);
  scene.loaded_ = std::move(loaded);
  if (scene.known_)
    scene.kept_ = std::exchange(scene.known_, nullptr);
  else if (start_.shared && scene.key_ && !scene.loaded_->is_sample && !scene.loaded_->follows_view)
    scene.kept_ = start_.shared->keep(*scene.key_, *scene.loaded_);
  // The picture of the view stays until there is a better one.
  if (!is_another_view || refinement_.moving(now_ms_)) repaint();
}

void ViewModel::watch_files() {
  if (!watch || scene.is_to_read_anew_ || now_ms_ - watched_ms_ < 500) return;
  watched_ms_ = now_ms_;
  std::vector<std::pair<std::string, std::int64_t>> times;
  for (const std::string& file : request_.files) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    if (error) return;  // being written: later
    times.emplace_back(file, std::int64_t(time.time_since_epoch().count()));
  }
  if (!file_times_.empty() && times != file_times_) {
    say("files changed: reading them again");
    scene.is_to_read_anew_ = true;
  }
  file_times_ = std::move(times);
}

/// A shader that does not compile is said, and the last picture stays.
void ViewModel::watch_shaders() {
  if (start_.shader_folder.empty() || now_ms_ - shaders_watched_ms_ < 500) return;
  shaders_watched_ms_ = now_ms_;
  std::vector<std::pair<std::string, std::int64_t>> times;
  for (const char* room : {"src", "shaders"}) {
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator
             at(std::filesystem::path(start_.shader_folder) / room, error),
         end;
         !error && at != end; at.increment(error)) {
      const std::string extension = at->path().extension().string();
      if (extension != ".glsl" && extension != ".comp" && extension != ".vert" && extension != ".frag")
        continue;
      std::error_code gone;  // an editor is writing it
      const auto time = at->last_write_time(gone);
      if (!gone) times.emplace_back(at->path().string(), std::int64_t(time.time_since_epoch().count()));
    }
  }
  std::sort(times.begin(), times.end());
  if (!shader_times_.empty() && times != shader_times_) {
    say("shaders changed: compiling them again");
    sample_->forget_programs();
    whole_->forget_programs();
    refinement_.forget();
    repaint();
  }
  shader_times_ = std::move(times);
}

}  // namespace sfumato::view
