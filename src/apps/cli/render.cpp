// sfumato FILE... -o OUT: files to pictures.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "batch.h"
#include "commands.h"
#include "console.h"
#include "core/counted.h"
#include "gl/preferences.h"
#include "help.h"
#include "io/camera_json.h"
#include "io/file_names.h"
#include "passes/light.h"
#include "publish.h"
#include "render_options.h"
#include "render_request.h"
#include "report.h"
#include "session/notes.h"
#include "session/opening.h"
#include "session/preset.h"
#include "picture_writer.h"
#include "video.h"
#ifdef SFUMATO_VIEWER
#include "../viewer/viewer.h"
#endif

namespace sfumato::cli {
namespace {

/// Says what came of reading, and counts it.
scene::Scene tell_reading(scene::Scene scene, const RenderOptions& options, RenderReport& report,
                          Console& console) {
  for (const std::string& note : scene.notes) console.note(note);
  console.note(unused_columns(scene.files, options.scene_options().read));
  for (const io::ReadReport& file : scene.files)
    console.tell(
        fmt::format("read {}: {}, {}", file.file.string(), file.format, counted(file.points, "point")));
  report.points_read += scene.points_read;
  report.points_hidden += scene.selected.hidden;
  console.note(note_on_hidden(scene, options.hide_classes, FrontEnd::command));
  report.points_left_out +=
      scene.selected.cropped + scene.selected.of_other_classes + scene.selected.filtered;
  report.points_rendered = scene.cloud.size();
  for (const std::string& part : scene.damage) console.complain("sfumato: " + part);
  if (scene.points_missing > 0)
    console.complain("sfumato: " + missing_points(scene.points_missing, scene.points_read));
  report.points_missing += scene.points_missing;
  report.is_partial |= !scene.damage.empty();
  if ((report.levels = scene.levels)) {
    const scene::LevelsReport& levels = *scene.levels;
    console.tell(fmt::format("levels: read {} of {} points, {} of {} nodes", levels.points,
                             levels.points_in_files, levels.nodes, levels.nodes_in_files));
    console.note(note_on_levels(scene, FrontEnd::command));
  }
  return scene;
}

using SceneFiles = std::vector<scene::SceneFile>;

/// Of points that the first view leaves out of the picture.
constexpr double worth_telling = 0.01;

/// Which way is up, and from where to look.
void tell_pose(const Pose& pose, const RenderOptions& options, RenderReport& report, Console& console) {
  if (options.view.print_scale && pose.unit.metres == 0 && pose.unit.symbol != "°")
    console.note("the file does not say its unit, --scale takes it for metres; --unit ft says otherwise");
  report.cutaway = pose.subject.room.has_value();
  report.up = to_string(pose.upright.up), report.up_reason = pose.upright.reason;
  report.up_is_noted = pose.upright.other.has_value();
}

/// Refuses outputs that would replace an input or each other, before anything is read.
void check_names(const RenderOptions& options, const Choice& choice) {
  io::FileNames names;
  for (const std::string& file : options.files)
    if (file != "-") names.input("the input", file);
  if (!options.camera_file.empty()) names.input("--camera", options.camera_file);
  if (!options.preset.empty()) names.input("--preset", options.preset);
  if (!options.scene.empty()) names.input("--scene", options.scene);
  if (!options.path.empty() && options.path != "orbit") names.input("--path", options.path);
  if (!options.save_preset.empty()) names.output("--save-preset", options.save_preset);
  if (!options.save_scene.empty()) names.output("--save-scene", options.save_scene);
  for (int n = 0; n < options.picture_count(); ++n) {
    for (const auto& [option, pattern] :
         {std::pair("-o", options.output), std::pair("--output-depth", options.output_depth),
          std::pair("--output-index", options.output_index),
          std::pair("--output-normal", options.output_normal),
          std::pair("--output-camera", options.output_camera)})
      if (!pattern.empty() && !(n > 0 && is_video(pattern)))
        names.output(option, file_name(pattern, options.parts(n)));
    if (options.world_file)
      names.output("--world-file", io::world_file_name(file_name(options.output, options.parts(n))).string());
    if (!options.output_panels.empty())
      for (const auto& chosen : choice.techniques)
        names.output("--output-panels", file_name(options.output_panels, options.parts(n, chosen->name)));
  }
}

std::vector<Camera> cameras_of(const RenderOptions& options, const Camera& first, const Pose& pose) {
  const Subject& subject = pose.subject;
  const dvec3 up = options.camera_file.empty() ? vertical_of(pose, options.view) : up_vector(pose.upright.up);
  if (options.publication) {
    Camera start = first;  // its views are by azimuth and elevation about the axis
    if (up != up_vector(pose.upright.up)) look_from(start, pose.upright.up, {}, {}, true);
    return options.publication->cameras(start, pose.upright.up, subject, !options.stands_somewhere());
  }
  if (options.path.empty()) return {first};
  if (options.path == "orbit") {
    Camera start = first;
    if (!options.stands_somewhere()) step_back(start, up, subject);
    return orbit(start, up, options.frame_count(), options.degrees.value_or(360));
  }
  std::vector<Camera> keys = options.poses.seen_as(first);
  if (!options.shows_poses() || options.view.size)
    for (Camera& key : keys) key = key.resized(first.width, first.height);
  if (!options.shows_poses()) return interpolate(keys, options.frame_count());
  if (is_video(options.output))
    for (const Camera& key : keys)
      if (key.width != keys[0].width || key.height != keys[0].height)
        throw Error(ErrorCode::usage, options.path +
                                          ": its pictures are not of one size; a video needs "
                                          "--resolution");
  return keys;
}

/// A scene and from where it is seen.
struct OpenedScene {
  Opening opening;
  scene::Scene scene = {};
  Camera camera = {};
  std::vector<Camera> cameras = {};
  bool by_camera = false;  ///< one cloud for all cameras would lack detail: each picture has its own
};

bool has_shadows(const Choice& choice) {
  return std::any_of(choice.techniques.begin(), choice.techniques.end(),
                     [](const auto& chosen) { return casts_shadows(chosen->settings.shadows); });
}

/// Points from everywhere in the files of a sequence: what follows from the whole is the same for all of its
/// pictures.
PointCloud overview_of(const SceneFiles& files, const RenderOptions& options, Console& console) {
  constexpr std::size_t points_of_all = 300'000, least_of_a_file = 2'000;
  const std::size_t points = std::max(least_of_a_file, points_of_all / files.size());
  PointCloud all;
  for (std::size_t i = 0; i < files.size(); ++i) {
    console.set_step("looking at file", i, files.size());
    std::optional<scene::Scene> part =
        scene::read_sample({files[i]}, options.scene_options(), points, console);
    if (!part) part = scene::read_scene(std::vector{files[i]}, options.scene_options(), console);
    append(all, subsample(part->cloud, points));
  }
  all.grid_index.clear(), all.grids.clear();
  return all;
}

/// The view follows from the points, of files with levels from the coarse ones; what is read of those follows
/// from the view.
OpenedScene open_scene(const SceneFiles& files, RenderOptions& options, const Choice& choice,
                       RenderReport& report, Console& console) {
  OpenedScene opened{Opening(options, files, console)};
  Opening& opening = opened.opening;
  const Pose& pose = opening.pose();
  if (!opening.has_levels()) opened.scene = tell_reading(opening.take(), options, report, console);
  tell_pose(pose, options, report, console);
  opened.camera = opening.camera();
  opened.cameras = options.sequence || options.each ? std::vector{opened.camera}
                                                    : cameras_of(options, opened.camera, pose);
  // A panorama sees what is behind it as well.
  for (const Note& note : notes_on(pose, options.panorama ? std::vector<Camera>() : opened.cameras))
    console.note(worded(note, FrontEnd::command));
  if (!opening.has_levels()) return opened;
  opening.take();
  std::vector<Camera> first = opened.cameras;
  if (first.size() > 1 && !opening.holds(first, has_shadows(choice))) {
    first.resize(1);
    opened.by_camera = true;
    opening.keep_nodes();
  }
  opened.scene = tell_reading(opening.read(first, has_shadows(choice), console), options, report, console);
  return opened;
}

/// The share of the points that a picture from there does not hold.
double share_outside(const PointCloud& cloud, const Camera& camera) {
  constexpr std::size_t asked = 200'000;
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / asked);
  const dmat4 to_eye = camera.view(cloud.origin);
  const Intrinsics k = camera.intrinsics();
  std::size_t all = 0, outside = 0;
  for (std::size_t i = 0; i < cloud.size(); i += stride, ++all) {
    const dvec3 eye(to_eye * glm::dvec4(cloud.positions[i], 1));
    const double depth = camera.orthographic() ? 1 : -eye.z;
    const glm::dvec2 pixel(k.fx * eye.x / depth + k.cx, k.cy - k.fy * eye.y / depth);
    outside +=
        !(depth > 0 && pixel.x >= 0 && pixel.y >= 0 && pixel.x < camera.width && pixel.y < camera.height);
  }
  return all == 0 ? 0 : double(outside) / double(all);
}

std::string timings_text(const RenderReport& report, const Choice& choice) {
  std::string text;
  for (std::size_t i = 0; i < report.techniques.size(); ++i) {
    const TechniqueReport& one = report.techniques[i];
    text += fmt::format("{}:\n", choice.techniques[i]->name);
    for (const PassTiming& pass : one.passes)
      text += fmt::format("  {:<32}{:>10.2f} ms\n", pass.name, pass.ms);
    text += fmt::format("  {:<32}{:>10.2f} ms\n", "total", one.total_ms);
  }
  for (const auto& [stage, ms] : report.stages_ms)
    text += fmt::format("{:<34}{:>10.2f} ms\n", stage + ", wall time", ms);
  text.pop_back();
  return text;
}

/// What automatic values became.
std::string resolved_text(const RenderReport& report, const Choice& choice) {
  std::string text;
  for (const auto& chosen : choice.techniques)
    for (const auto& [param, value] : last_values(report, *chosen))
      if (param.can_be_auto && param.get() == "auto")
        text += fmt::format("{}{}: {} is {}", text.empty() ? "" : "\n", chosen->name, with_dashes(param.name),
                            value);
  return text;
}

/// What was written, by which choice, and what else the techniques say: the last line.
void tell(const RenderReport& report, const RenderOptions& options, const Choice& choice,
          const std::string& technique, const Bounds& box, Console& console) {
  if (options.publication) {
    console.note("wrote " + options.publication->summary());
  } else if (!report.outputs.empty()) {
    const std::string& first = report.outputs.front();
    if (is_video(first))
      console.note(
          fmt::format("wrote {} ({} of 1/25 s)", first, counted(std::uint64_t(report.frames), "frame")));
    else if (report.frames > 1)
      console.note(fmt::format("wrote {} ... {} ({} pictures)", first, report.outputs.back(), report.frames));
    else
      console.note(fmt::format("wrote {} ({}, coloured by {}{})", first,
                               counted(report.points_rendered, "point"), report.color_by,
                               report.up_is_noted ? "" : ", " + report.up + " up"));
    if (report.share_outside.value_or(0) >= worth_telling)
      console.note(fmt::format("{:.0f} % of the points lie outside the picture, --whole shows them",
                               100 * *report.share_outside));
  }
  if (!technique.empty()) console.note(technique);
  for (std::size_t i = 0; i < report.techniques.size(); ++i)
    for (const std::string& note : report.techniques[i].notes)
      console.note(report.draw.empty() ? choice.techniques[i]->name + ": " + note : note);
  if (report.blank_pictures > 0) {
    const dvec3 c = box.center();
    console.note(fmt::format(
        "{} empty: nothing is in view. The points lie around {:.7g},{:.7g},{:.7g}; --look-at shows that "
        "place{}",
        report.frames == 1 ? "the picture is"
                           : fmt::format("{} of {} pictures are", report.blank_pictures, report.frames),
        c.x, c.y, c.z,
        options.moves_camera() || options.view.start ? ", and no camera options show all of it" : ""));
  }
  console.tell(resolved_text(report, choice));
  if (options.timings) console.say(timings_text(report, choice));
  console.say_notes({});
}

/// Several files, one picture each: what is wrong with one file is told, and the others are made.
int render_each(RenderOptions& options, Choice& choice, const std::string& command, RenderReport& report,
                Stopwatch& watch, Console& console) {
  std::unique_ptr<PictureWriter> writer;
  Batch batch(options.files.size() > 1, console);
  Bounds box;
  Camera camera;
  report.frames = 0;
  for (std::size_t n = 0; n < options.files.size(); ++n)
    batch.run(options.files[n], [&] {
      console.set_step("file", n, options.files.size());
      OpenedScene opened = open_scene({options.placed(n)}, options, choice, report, console);
      watch.lap("read");
      box = bounds(opened.scene.cloud);
      camera = opened.camera;
      if (!writer) writer = std::make_unique<PictureWriter>(options, choice, report, command, console);
      choice.reopen();  // what suits one scan need not suit the next
      console.note(writer->set_scene(std::move(opened.scene), opened.opening.pose()));
      console.say_notes({options.files[n]});
      watch.lap("prepare");
      writer->render_picture(camera, int(n), watch);
      ++report.frames;
    });
  const int code = batch.exit_code();
  tell(report, options, choice, {}, box, console);
  if (options.json) print(render_json(report, choice, io::camera_to_json(camera)));
  return code == 0 && report.is_partial ? int(ErrorCode::partial) : code;
}

#ifdef SFUMATO_VIEWER
/// Without -o: the same scene, look and first view in a window.
int view_command(RenderOptions& options, Choice& choice) {
  viewer::Settings settings;
  settings.verbose = options.common.verbose;
  if (options.view.size) std::tie(settings.width, settings.height) = *options.view.size;
  const Console interrupts(true);
  settings.cancelled = [&] { return interrupts.cancelled(); };
  return viewer::run(view_start(options, choice), settings);
}
#endif

}  // namespace

int render_command(const Words& words) {
  RenderRequest request(words);
  Choice& choice = request.choice;
  RenderOptions& options = request.options;
  CommandLine& line = request.line;
  line.usage("sfumato FILE... [-t TECHNIQUE] [-o PICTURE]");
  // Who asks about a technique wants its parameters.
  if (peek(words, 't', "technique").empty()) line.short_help(short_help);
  if (!request.parse(words)) return 0;
  request.check();
  check_names(options, choice);
  if (!options.shader_folder.empty()) {
    if (!std::filesystem::is_directory(std::filesystem::path(options.shader_folder) / "shaders"))
      throw Error(ErrorCode::usage, "--shader-dir " + options.shader_folder +
                                        ": there is no folder shaders/ in it; name a checkout of sfumato");
    gl::Preferences::take_shaders_from(options.shader_folder);
  }
#ifdef SFUMATO_VIEWER
  if (!options.has_output()) return view_command(options, choice);
#endif

  Words command = words;
  command.insert(command.begin(), "sfumato");
  return draw_pictures(request, quote(command));
}

int draw_pictures(RenderRequest& request, const std::string& command) {
  Choice& choice = request.choice;
  RenderOptions& options = request.options;
  Console console(options.common);
  RenderReport report;
  Stopwatch watch(report);
  for (const std::string& note : options.poses.notes) console.note(options.path + ": " + note);
  if (options.each) return render_each(options, choice, command, report, watch, console);

  // The files of a sequence are read one by one, and seen by the camera that suits the first.
  auto [opening, scene, camera, cameras, by_camera] = open_scene(
      options.sequence ? SceneFiles{options.placed(0)} : options.placed(), options, choice, report, console);
  const Pose& pose = opening.pose();
  watch.lap("read");
  std::shared_ptr<const scene::Overview> overview;
  options.points.metres = scene.metres;
  if (options.sequence && options.files.size() > 1) {
    PointCloud all = overview_of(options.placed(), options, console);
    all.up = scene.cloud.up;
    scene.overview = overview = std::make_shared<const scene::Overview>(scene::Overview{std::move(all)});
  }
  const Bounds box = bounds(scene.cloud);
  report.frames = options.sequence ? int(options.files.size()) : int(cameras.size());
  const bool is_framed = !options.moves_camera() && !options.stands_somewhere() && !options.view.pixel_size &&
                         !options.view.print_scale;
  if (is_framed && report.frames == 1 && !options.whole && !report.levels)
    report.share_outside = share_outside(scene.cloud, cameras[0]);
  if (report.frames > 1)
    for (const auto& chosen : choice.techniques) fix_light(chosen->settings, cameras.front(), scene.cloud.up);

  const std::string crs = scene.cloud.crs;
  const std::vector<io::ReadReport> files = scene.files;
  PictureWriter writer(options, choice, report, command, console);
  const std::string technique = writer.set_scene(std::move(scene), pose);
  console.say_notes(options.files);
  watch.lap("prepare");
  for (int n = 0; n < report.frames; ++n) {
    console.set_step("frame", std::size_t(n), std::size_t(report.frames));
    const Camera& seen = options.sequence ? camera : cameras[std::size_t(n)];
    if (n > 0 && (by_camera || options.sequence)) {
      scene::Scene next = tell_reading(
          by_camera ? opening.read({&seen, 1}, has_shadows(choice), console)
                    : opening.read_next({options.placed(std::size_t(n))}, seen, has_shadows(choice), console),
          options, report, console);
      if (overview) next.overview = overview;
      writer.set_scene(std::move(next), pose);
      console.say_notes(options.files);
      watch.lap("prepare");
    }
    writer.render_picture(seen, n, watch);
  }
  writer.finish();
  if (options.publication)
    options.publication->finish(facts_to_publish(options, choice, report, command, {pose, box, crs, files}));
  std::optional<Camera> kept = request.preset.camera;
  if (!options.camera_file.empty()) kept = options.view.start;
  for (const std::string& name : {options.save_preset, options.save_scene}) {
    if (name.empty()) continue;
    const SceneFiles placed = name == options.save_scene ? options.placed() : SceneFiles();
    // A scene is seen from where it was seen.
    save_preset(name, choice.looks(), choice.prepare_parameters, request.line.given(),
                placed.empty() ? kept : camera, placed);
    report.outputs.push_back(name);
  }
  tell(report, options, choice, technique, box, console);
  if (options.json) print(render_json(report, choice, io::camera_to_json(camera)));
  return report.is_partial ? int(ErrorCode::partial) : 0;
}

}  // namespace sfumato::cli
