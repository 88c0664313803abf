#include "view/view_model.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "core/counted.h"
#include "core/error.h"
#include "view/light_hand.h"

namespace sfumato::view {

ViewModel::ViewModel(Start start)
    : watch(start.watch),
      sequence(start.frames),
      start_(std::move(start)),
      request_(start_.request),
      history_(request_),
      sample_(start_.shared ? std::make_unique<RenderClient>(start_.shared->sample, start_.wake)
                            : std::make_unique<RenderClient>(gate_, start_.wake)),
      whole_(start_.shared ? std::make_unique<RenderClient>(start_.shared->whole, start_.wake)
                           : std::make_unique<RenderClient>(gate_, start_.wake)),
      loader_(std::make_unique<Loader>(start_.wake)) {
  sequence.follow(request_.files);
  if (request_.files.empty())
    scene.key_ = scene.wanted_key_ = request_.scene_key();  // until some are opened
  else
    load(false);
}

void ViewModel::change(const std::string& what, const std::function<void(ViewRequest&)>& edit) {
  ViewRequest next = request_;
  try {
    edit(next);
    const SessionOptions options = next.session_options();
    // A number that the scan lacks is named at once, not when the scene has been taken apart for it.
    if (scene.loaded_ && scene.loaded_->near && next.scene_key() != request_.scene_key())
      for (const DrawRule& rule : options.draw) (void)rule.selector.matches(*scene.loaded_->near);
    if (!next.technique.empty()) {
      Look look(next.technique);
      for (const auto& [name, value] : next.parameters_of(next.technique)) look.set(name, value);
      look.check();
    }
  } catch (const Error& error) {
    say(error.what(), true);
    return;
  }
  if (next.files != request_.files) scene.sample_camera_.reset(), sequence.play(false);
  request_ = std::move(next);
  sequence.follow(request_.files);
  history_.record(request_, what, now_ms_);
}

void ViewModel::move(const std::string& what, const std::function<void(Navigator&)>& edit) {
  navigator_.set_camera(request_.camera);
  edit(navigator_);
  if (navigator_.camera() == request_.camera) return;
  play(false);  // a hand takes over
  request_.camera = navigator_.camera();
  history_.record(request_, what, now_ms_);
  repaint();
}

void ViewModel::drag(Drag kind, const dvec3& grabbed, double dx_px, double dy_px) {
  if (kind == Drag::light)
    change("light", [&](ViewRequest& next) {
      next.set("light", drag_light(next.settings(), camera(), navigator_.up_axis(), dx_px, dy_px, height_));
    });
  if (kind == Drag::rotate)
    move("rotate", [&](Navigator& hand) { hand.rotate(dx_px, dy_px, height_, grabbed); });
  if (kind == Drag::pan) move("pan", [&](Navigator& hand) { hand.pan(dx_px, dy_px, height_, grabbed); });
}

void ViewModel::show_class(int id, bool shown) {
  if (!scene.loaded()) return;  // which classes there are is not known yet
  change("classes", [&](ViewRequest& next) {
    // Noise that this scan lacks stays hidden by default, so that the command stays short.
    std::vector<int> hidden = next.hide_classes;
    for (const ClassShare& each : scene.loaded()->classes) {
      std::erase(hidden, each.id);
      if (!next.shows_class(each.id)) hidden.push_back(each.id);
    }
    std::erase(hidden, id);
    if (!shown) hidden.push_back(id);
    std::sort(hidden.begin(), hidden.end());
    next.points.selection.show_classes.clear();
    next.hide_classes = std::move(hidden);
  });
}

std::optional<std::string> ViewModel::resolved(const std::string& parameter) const {
  if (shown_ && shown_->technique == request_.technique)
    for (const auto& [name, value] : shown_->resolved)
      if (name == parameter) return value;
  return std::nullopt;
}

void ViewModel::undo() {
  play(false);
  if (!history_.can_undo()) return say("nothing to undo");
  request_ = history_.undo();
  sequence.follow(request_.files);
  repaint();
}

void ViewModel::redo() {
  if (!history_.can_redo()) return say("nothing to redo");
  play_began_ms_.reset();  // a step of its own would leave nothing to redo
  request_ = history_.redo();
  sequence.follow(request_.files);
  repaint();
}

void ViewModel::say(const std::string& text, bool is_error) {
  messages_.push_back({text, is_error});
  if (on_message) on_message(messages_.back());
}

std::vector<std::string> ViewModel::take_driver_messages() {
  std::vector<std::string> all = sample_->take_driver_messages();
  for (std::string& each : whole_->take_driver_messages()) all.push_back(std::move(each));
  return all;
}

Memory ViewModel::memory() const {
  Memory memory;
  memory.points = whole_->point_bytes();
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    const auto kilobytes = [&] {
      return 1024 * std::strtoull(line.c_str() + line.find(':') + 1, nullptr, 10);
    };
    if (line.starts_with("VmRSS:")) memory.process = kilobytes();
    if (line.starts_with("VmHWM:")) memory.process_peak = kilobytes();
  }
  return memory;
}

void ViewModel::repaint() { refinement_.changed(now_ms_); }

void ViewModel::open(const std::vector<std::string>& files, bool add) {
  std::vector<std::string> expanded;
  try {
    expanded = scene::expand_inputs(files);
  } catch (const Error& error) {
    return say(error.what(), true);
  }
  ViewRequest next = request_;
  if (!add) {
    next.files.clear();
    next.placed.clear();
    next.points.selection.crop.reset();
  }
  for (const std::string& file : expanded)
    if (std::find(next.files.begin(), next.files.end(), file) == next.files.end()) next.files.push_back(file);
  if (next.scene_key() == request_.scene_key()) {
    scene.is_to_read_anew_ = true;
    return;
  }
  next.frame_on_load = true;
  change("open", [&](ViewRequest& request) { request = next; });
}

void ViewModel::set_size(int width, int height) {
  width = std::max(16, width), height = std::max(16, height);
  if (width == width_ && height == height_) return;
  width_ = width, height_ = height;
  refinement_.forget();
  repaint();
}

std::optional<dvec3> ViewModel::point_at(const Camera& seen, double x_px, double y_px) const {
  if (scene.loaded_ && scene.loaded_->near)
    if (const auto index =
            nearest_point(*scene.loaded_->near, seen, x_px, y_px, 24, 0.02, scene.loaded_->pose.subject.room))
      return scene.loaded_->near->world(*index);
  return std::nullopt;
}

dvec3 ViewModel::pivot_at(double x_px, double y_px) const {
  return point_at(camera(), x_px, y_px).value_or(request_.camera.target);
}

dvec3 ViewModel::place_at(double x_px, double y_px) const {
  const Camera seen = camera();
  if (const auto point = point_at(seen, x_px, y_px)) return *point;
  const Ray ray = ray_through(seen, x_px, y_px);
  return ray.origin + ray.direction * (request_.camera.distance() /
                                       std::max(0.05, glm::dot(ray.direction, seen.direction())));
}

void ViewModel::cut_profile(double width) {
  if (scene.has_sample_only()) return say("a profile is of all points: they are still being read", true);
  std::vector<dvec3> line = picks.line();
  if (horizontal_length(line, navigator_.up_axis()) <= 0)
    return say("a profile needs a line: click two points that do not stand above each other", true);
  picks.asked_profile_ = next_id_++;
  whole_->profile({picks.asked_profile_, std::move(line), width});
}

void ViewModel::pick(double x_px, double y_px, bool add) {
  if (scene.has_sample_only()) return say("points are picked among all of them: they are still being read");
  picks.asked_point_ = next_id_++;
  picks.is_line_ = add;
  whole_->pick({picks.asked_point_, camera(), x_px, y_px});
}

void ViewModel::save_picture(const ViewRequest& request, int width, int height) {
  if (scene.load_state_ == LoadState::refused || request.files.empty())
    return say("there is no picture to save", true);
  if (scene.has_sample_only() && !scene.loading())
    return say("only a sample could be read: there is no picture of the whole to save", true);
  if (scene.load_state_ == LoadState::unreadable)
    return say("the files could not be read: there is no picture to save", true);
  if (is_loading_request()) {
    saved_pictures.after_loading_.push_back({width, height, request});
    return say("the picture is saved once everything is loaded");
  }
  if (scene.follows_view()) return saved_pictures.of_view_.push_back({width, height, request});
  render_saved(request, width, height);
}

void ViewModel::render_saved(const ViewRequest& request, int width, int height) {
  PictureJob job = job_for(request, Refinement::ladder[0], width, height);
  job.id = next_id_++;
  SavedPicture picture{{}, request.words(width, height), request.furniture};
  if (scene.loaded_) {
    picture.up = scene.loaded_->pose.upright.up, picture.crs = scene.loaded_->crs;
    picture.cutaway = note_on_cutaway(scene.loaded_->pose, {&job.camera, 1});
  }
  saved_pictures.rendering_.emplace_back(job.id, std::move(picture));
  whole_->render_to_keep(std::move(job));
}

/// Saves what was asked for while files were read.
void ViewModel::save_what_is_loaded() {
  if (saved_pictures.after_loading_.empty() || is_loading_request()) return;
  for (const SavedPictures::Order& each : std::exchange(saved_pictures.after_loading_, {})) {
    // From where it was asked for, unless other points were asked for since.
    const bool are_its_points = each.request.scene_key() == scene.key_;
    save_picture(are_its_points ? each.request : request_, each.width, each.height);
  }
}

void ViewModel::amend(const std::function<void(ViewRequest&)>& edit) {
  history_.amend(edit);
  for (SavedPictures::Order& each : saved_pictures.after_loading_) edit(each.request);
  for (SavedPictures::Order& each : saved_pictures.of_view_) edit(each.request);
  edit(request_);
}

void ViewModel::show_frame(std::size_t i) {
  if (i >= sequence.frames().size() || i == sequence.frame()) return;
  const scene::SceneFile& file = sequence.frames()[i];
  const auto show = [&](ViewRequest& each) {
    if (sequence.holds(each.files)) each.files = {file.name}, each.placed = {file.transform};
  };
  history_.amend(show);  // nobody undoes the time that went by
  show(request_);
  sequence.show(i, now_ms_);
}

void ViewModel::play(bool on) {
  if (on && path.keys().size() < 2)
    return say("a path needs two keys at least: K adds the present view", true);
  // Where it was left is somewhere to come back to.
  if (playing()) history_.record(request_, "play", now_ms_);
  play_began_ms_ = on ? std::optional(now_ms_) : std::nullopt;
}

void ViewModel::take_answer(Answer answer, bool of_whole) {
  if (auto* ready = std::get_if<SceneReady>(&answer)) {
    if (!of_whole) {
      scene.sample_.is_ready = ready->id == scene.sample_.id;
      return;
    }
    if (ready->id != scene.whole_.id) return;
    scene.whole_.is_ready = true;
    if (scene.load_state_ == LoadState::preparing || scene.load_state_ == LoadState::refused)
      scene.load_state_ = LoadState::idle;
    scene.left_out_ = ready->left_out;
    for (const std::string& note : ready->notes) say(note);
    refinement_.set_whole_ready(true);
    if (!scene.loaded_->is_coarse) {
      if (request_.technique.empty()) scene.reason_ = ready->choice.reason;
      const auto resolve = [&](ViewRequest& each) {
        if (each.technique.empty())
          each.technique = ready->choice.technique.empty() ? stand_in_technique : ready->choice.technique;
      };
      amend(resolve);  // nothing chooses again where a hand goes back to
    }
    repaint();
  } else if (auto* picture = std::get_if<Picture>(&answer)) {
    if (saved_pictures.finish(*picture) || picture->id != in_flight_) return;
    in_flight_ = 0;
    refinement_.done(in_flight_quality_, picture->draw_ms);
    const bool in_motion = !(in_flight_quality_ == Refinement::ladder[0]);
    if (in_motion || refinement_.moving(now_ms_)) {
      const double since = now_ms_ - last_motion_ms_;
      if (last_motion_ms_ >= 0 && since < 1000)
        motion_ms_ = motion_ms_ == 0 ? since : 0.8 * motion_ms_ + 0.2 * since;
      last_motion_ms_ = now_ms_;
    }
    if (!shown_) first_picture_ms_ = now_ms_ - began_ms_;
    shown_quality_ = in_flight_quality_;
    shown_ = std::make_shared<const Picture>(std::move(*picture));
  } else if (auto* pick = std::get_if<PickAnswer>(&answer)) {
    if (pick->id != picks.asked_point_) return;
    if (!pick->picked) return say("no point there");
    picks.add(std::move(*pick->picked));
    if (on_message) {
      const double size = navigator_.scene_size();
      const std::vector<Picked>& points = picks.points();
      const dvec3 at = points.back().world;
      std::string text = "picked point " + std::to_string(points.back().source) + ": " +
                         coordinate_text(at.x, size) + " " + coordinate_text(at.y, size) + " " +
                         coordinate_text(at.z, size);
      if (points.size() == 2) {
        const Measure m = measure(points[0].world, at, navigator_.up_axis());
        text +=
            ", distance " + coordinate_text(m.distance, size) + ", height " + coordinate_text(m.height, size);
      }
      on_message({text, false});
    }
  } else if (auto* profile = std::get_if<Profile>(&answer)) {
    if (profile->id != picks.asked_profile_) return;
    if (profile->points.empty()) return say("no point within the corridor: make it wider", true);
    say("profile of " + counted(profile->points.size(), "point"));
    picks.profile_ = std::make_shared<const Profile>(std::move(*profile));
  } else if (auto* cancelled = std::get_if<JobCancelled>(&answer)) {
    if (cancelled->id == in_flight_ && in_flight_) {
      in_flight_ = 0;
      refinement_.cancel();
    }
  } else if (auto* failure = std::get_if<Failure>(&answer)) {
    if (failure->id == scene.sample_.id && failure->id != 0) {
      scene.sample_.is_refused = true;  // rules may leave nothing of it: the whole cloud is drawn then
      return;
    }
    const bool of_scene = failure->id == scene.whole_.id && scene.load_state_ != LoadState::reading;
    // Once another scene is asked for, what waits is of that.
    const bool is_wanted = of_scene && scene.key_ == request_.scene_key();
    if (failure->id == 0 || (is_wanted && !shown_)) {
      fatal_ = *failure;
    } else if (of_scene) {
      if (scene.load_state_ != LoadState::unreadable) scene.load_state_ = LoadState::refused;
      if (is_wanted) saved_pictures.drop_waiting();
    } else if (failure->id == in_flight_) {
      in_flight_ = 0;
      refinement_.failed();
    }
    saved_pictures.drop_rendering(failure->id);
    say(failure->message, true);
  }
}

PictureJob ViewModel::job_for(const ViewRequest& request, const Quality& quality, int width,
                              int height) const {
  PictureJob job;
  const bool known = !request.technique.empty() && !quality.stand_in;
  job.technique = known ? request.technique : stand_in_technique;
  if (known)
    job.parameters = request.parameters_of(job.technique);
  else
    job.parameters = NamesAndValues(request.shared.begin(), request.shared.end());
  if (!(quality == Refinement::ladder[0])) {
    // In motion one sample a pixel does, and a few of the light.
    const auto set = [&](const std::string& name, const std::string& value) {
      std::erase_if(job.parameters, [&](const auto& each) { return each.first == name; });
      job.parameters.emplace_back(name, value);
    };
    set("samples", "1");
    if (quality.divisor > 1) set("smooth_outlines", "false");  // magnified, nobody sees it
    if (quality.fast && known)
      for (const auto& [name, value] : request.make_look()->technique->in_motion()) set(name, value);
    if (!quality.whole_cloud && request.settings().shadows == Shadows::soft) set("light_samples", "2");
  }
  // What only some techniques can show is of no use to the one that stands in.
  if (!known) std::erase_if(job.parameters, [](const auto& each) { return each.first == "shading"; });
  job.camera =
      request.camera.to_camera(std::max(1, width / quality.divisor), std::max(1, height / quality.divisor));
  job.color = request.color;
  job.background = request.background;
  job.depth_step = start_.depth_step;
  job.timings = timings && quality == Refinement::ladder[0];
  return job;
}

void ViewModel::ask() {
  if (width_ <= 0 || !scene.can_draw()) return;
  refinement_.set_subject(request_.technique);
  auto quality = refinement_.next(now_ms_);
  if (!quality) return;
  if (*quality == Refinement::ladder[0] && std::exchange(stand_in_is_due_, false)) quality->stand_in = true;
  PictureJob job = job_for(request_, *quality, width_, height_);
  job.id = in_flight_ = next_id_++;
  in_flight_quality_ = *quality;
  refinement_.begun(*quality, now_ms_);
  if (!quality->whole_cloud) whole_->cancel();
  (quality->whole_cloud || scene.sample_.is_refused ? *whole_ : *sample_).render(std::move(job));
}

void ViewModel::tick(double now_ms) {
  now_ms_ = now_ms;
  if (began_ms_ < 0) began_ms_ = now_ms;
  if (play_began_ms_) {
    const double time = 1e-3 * (now_ms - *play_began_ms_);
    const bool is_over = time > path.duration_s();
    if (!path.empty()) request_.camera = is_over ? path.keys().back() : path.at(time);
    if (is_over) play(false);
    repaint();
  }
  if (width_ > 0 && scene.known_) {
    Loaded loaded = *scene.known_;
    loaded.id = scene.load_id_, loaded.is_first = true;
    take_loaded(std::move(loaded));
  } else if (width_ > 0) {
    if (auto loaded = loader_->take()) take_loaded(std::move(*loaded));
  }
  for (Answer& each : sample_->take_answers()) take_answer(std::move(each), false);
  for (Answer& each : whole_->take_answers()) take_answer(std::move(each), true);
  watch_files();
  watch_shaders();

  sequence.set_stands(settled(), now_ms);
  if (const auto due = sequence.due_ms(); due && *due <= now_ms) {
    show_frame((sequence.frame() + 1) % sequence.frames().size());
    scene.want(request_.scene_key(), -SceneState::rest_ms);  // at once: nobody drags a slider here
  }

  if (ViewRequest look = request_.look(); look != look_) {
    look_ = std::move(look);
    repaint();
    // Another colour source may be what the scene was refused for.
    if (scene.load_state_ == LoadState::refused) scene.key_.reset(), scene.wanted_since_ms_ = now_ms;
  }
  scene.want(request_.scene_key(), now_ms);
  if (const auto due = load_due_ms(); due && *due <= now_ms && !request_.files.empty())
    load(scene.is_to_read_anew_);
  save_what_is_loaded();
  follow_view();
  ask();

  activity_ = loader_->activity();
  if (activity_.text.empty()) activity_ = whole_->activity();
}

std::optional<double> ViewModel::wait_ms(double now_ms) const {
  if (play_began_ms_ || scene.known_) return 0;
  if (const auto due = sequence.due_ms()) return std::max(0.0, *due - now_ms);
  std::optional<double> wait = scene.can_draw() ? refinement_.wait_ms(now_ms) : std::nullopt;
  if (const auto due = load_due_ms()) {
    const double until = std::max(0.0, *due - now_ms);
    wait = std::min(wait.value_or(until), until);
  }
  if (scene.may_follow_view() && scene.read_view_ != wanted_view())
    wait = std::min(wait.value_or(Refinement::rest_ms), Refinement::rest_ms);
  if (watch || !start_.shader_folder.empty()) wait = std::min(wait.value_or(500), 500.0);
  return wait;
}

}  // namespace sfumato::view
