// Of a workbench: what its files are read for, and what comes of them.
#include <algorithm>
#include <filesystem>

#include "core/counted.h"
#include "core/error.h"
#include "view/workbench.h"

namespace sfumato::view {

/// The scene that is drawn is not yet the one that is wished for.
bool Workbench::is_loading_wishes() const {
  return loading_ || (!whole_ready_ && !follows_view()) || wishes_.scene_key() != loaded_key_;
}

LoadJob Workbench::load_job(const Wishes& wishes) const {
  LoadJob job{load_id_, wishes, wishes.scene_files()};
  job.request.memory = start_.memory;
  // Windows show heights as they are.
  job.request.exaggeration.reset(), job.request.output_index.clear(), job.request.panorama = false;
  return job;
}

void Workbench::load(bool anew) {
  load_id_ = next_id_++;
  loading_ = true;
  scene_failed_ = load_failed_ = false;
  is_to_read_anew_ = false;
  wanted_key_ = wishes_.scene_key();
  if (loaded_key_ != wanted_key_) file_times_.clear();
  loaded_key_ = wanted_key_;
  known_.reset();
  if (start_.shared && !anew) {
    known_ = start_.shared->find(wanted_key_);
    // Both keep it: one that had to be read again would miss what the other has.
    const bool has_sample = sample_->hold(wanted_key_), has_whole = whole_->hold(wanted_key_);
    if (!has_sample || !has_whole) known_.reset();
    if (known_) return loader_->call_off();
  }
  LoadJob job = load_job(wishes_);
  job.anew = anew;
  job.sample_first = wishes_.frame_on_load && !anew;  // else something better is on the screen
  reading_view_ = false;
  read_view_.reset();
  if (follows_view() && !wishes_.frame_on_load) {
    read_view_ = wanted_view();
    job.seen = camera();
    job.has_shadows = read_view_->has_shadows;
  }
  loader_->load(std::move(job));
}

Workbench::SeenView Workbench::wanted_view() const {
  if (shots.of_view_.empty()) return view_of(wishes_, width_, height_);
  const Shots::Order& shot = shots.of_view_.front();
  return view_of(shot.wishes, shot.width, shot.height);
}

const Wishes& Workbench::wishes_of_view() const {
  return shots.of_view_.empty() ? wishes_ : shots.of_view_.front().wishes;
}

Workbench::SeenView Workbench::view_of(const Wishes& wishes, int width, int height) {
  return {wishes.camera, width, height, casts_shadows(wishes.settings().shadows)};
}

bool Workbench::is_coarser_than_wanted() const {
  return follows_view() && !scene_failed_ && !load_failed_ &&
         (!whole_ready_ || reading_view_ || read_view_ != wanted_view());
}

/// Reads what the view shows of files with levels, once the hand rests.
void Workbench::follow_view() {
  if (!follows_view() || loading_ || load_failed_ || width_ <= 0) return;
  const SeenView wanted = wanted_view();
  if (read_view_ == wanted) {
    if (!shots.of_view_.empty() && whole_ready_ && !reading_view_) {
      // A hand that went on while the points were read gets the picture it asked for.
      paint_shot(shots.of_view_.front().wishes, wanted.width, wanted.height);
      shots.of_view_.pop_front();
    }
    return;
  }
  if (std::exchange(reading_view_, false)) loader_->call_off();
  read_view_.reset();
  if (refinement_.moving(now_ms_) && shots.of_view_.empty()) return;
  read_view_ = wanted;
  reading_view_ = true;
  load_id_ = next_id_++;
  const Wishes& wishes = wishes_of_view();
  LoadJob job = load_job(wishes);
  job.seen = wanted.camera.to_camera(wanted.width, wanted.height);
  job.has_shadows = wanted.has_shadows;
  job.pose = scene_->pose;
  job.overview = scene_->overview;
  job.shown = scene_->nodes;
  loader_->load(std::move(job));
}

void Workbench::send_scene(Loaded& loaded, bool is_another_view) {
  const Wishes& wanted = wishes_of_view();
  const auto job_of = [&](scene::Scene scene) {
    SceneJob job;
    job.id = next_id_++;
    job.scene = std::move(scene);
    job.pose = loaded.pose;
    job.options = wanted.session_options();
    job.technique = wanted.technique;
    if (start_.shared && !loaded.is_sample && !loaded.follows_view) job.shared_key = loaded_key_;
    job.parameters_of = [wishes = wanted](const std::string& technique) {
      return wishes.parameters_of(technique);
    };
    return job;
  };
  sample_ready_ = whole_ready_ = sample_failed_ = false;
  refinement_.set_whole_ready(false);
  if (!is_another_view) refinement_.forget();
  in_flight_ = 0;
  refinement_.called_off();
  SceneJob sample = job_of(std::move(loaded.sample));
  sample_scene_id_ = sample.id;
  sample_->show(std::move(sample));
  whole_scene_id_ = 0;
  if (loaded.is_sample) return;
  SceneJob whole = job_of(std::move(loaded.whole));
  whole_scene_id_ = whole.id;
  if (!loaded.is_coarse) whole.settle = start_.settle;
  // The view is shown before the technique has measured its points.
  whole.measures = !is_another_view;
  stand_in_is_due_ = is_another_view && wishes_.technique != stand_in_technique;
  whole_->show(std::move(whole));
}

void Workbench::take_loaded(Loaded loaded) {
  if (loaded.id != load_id_) return;
  const bool is_another_view = reading_view_;
  if (!loaded.is_coarse) reading_view_ = false;
  if (loaded.is_shown) return;
  if (loaded.failure) {
    loading_ = false;
    load_failed_ = !is_another_view;
    shots.drop_waiting();
    if (!scene_) fatal_ = loaded.failure;
    say(loaded.failure->message, true);
    if (has_sample_only()) say("what is shown is a sample of what could be read");
    return;
  }
  // What more was read of a sample waits while a hand turns what there is.
  if (loaded.is_sample && !loaded.is_first && refinement_.moving(now_ms_)) return;
  for (const std::string& note : loaded.notes)
    if (notes_said_.insert(note).second) say(note);  // not again for every slice of the same files
  if (!is_another_view) picks.clear(), picks.close_profile();
  navigator_.set_scene(loaded.pose.upright.up, loaded.pose.subject, loaded.pose.vertical());
  if (wishes_.frame_on_load && width_ > 0 && loaded.is_first) {
    ViewCamera first;
    try {
      first = ViewCamera::from(start_.first_camera && !had_whole_
                                   ? start_.first_camera(loaded.pose, width_, height_)
                                   : first_view(loaded.pose, width_, height_));
    } catch (const Error& error) {
      if (!loaded.is_sample) say(error.what(), true);
      first = ViewCamera::from(first_view(loaded.pose, width_, height_));
    }
    const auto place = [&](Wishes& each) {
      if (!each.frame_on_load || each.files != wishes_.files) return;
      each.home = first;
      // A hand that has turned the sample goes on from there.
      if (!sample_camera_ || each.camera == *sample_camera_) each.camera = first;
      each.frame_on_load = loaded.is_sample;  // the whole says where it is, exactly
      // The other frames stand as the first does.
      if (!loaded.is_sample && sequence.holds(each.files) && !each.points.up)
        each.points.up = loaded.pose.upright.up;
    };
    const bool is_wanted = wishes_.scene_key() == loaded_key_;
    amend(place);
    if (is_wanted) loaded_key_ = wanted_key_ = wishes_.scene_key();
    sample_camera_.reset();
    if (loaded.is_sample) sample_camera_ = first;
    if (!scene_) history_ = History<Wishes>(wishes_);  // nothing was there that a step could go back to
  }
  had_whole_ = had_whole_ || !loaded.is_sample;
  if (on_message)
    on_message({loaded.is_sample
                    ? "a sample of " + counted(loaded.points_shown, "point") + ", while the files are read"
                    : are(loaded.points_shown, "point") + " read",
                false});
  send_scene(loaded, is_another_view);
  scene_ = std::move(loaded);
  if (known_)
    shared_scene_ = std::exchange(known_, nullptr);
  else if (start_.shared && loaded_key_ && !scene_->is_sample && !scene_->follows_view)
    shared_scene_ = start_.shared->keep(*loaded_key_, *scene_);
  // The picture of the view stays until there is a better one.
  if (!is_another_view || refinement_.moving(now_ms_)) touched();
}

void Workbench::watch_files() {
  if (!watch || is_to_read_anew_ || now_ms_ - watched_ms_ < 500) return;
  watched_ms_ = now_ms_;
  std::vector<std::pair<std::string, std::int64_t>> times;
  for (const std::string& file : wishes_.files) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    if (error) return;  // being written: later
    times.emplace_back(file, std::int64_t(time.time_since_epoch().count()));
  }
  if (!file_times_.empty() && times != file_times_) {
    say("files changed: reading them again");
    is_to_read_anew_ = true;
  }
  file_times_ = std::move(times);
}

/// A shader that does not compile is said, and the last picture stays.
void Workbench::watch_shaders() {
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
    touched();
  }
  shader_times_ = std::move(times);
}

}  // namespace sfumato::view
