// sfumato FILE... -o OUT: files to pictures.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "camera_options.h"
#include "commands.h"
#include "console.h"
#include "contact_sheet.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/file_names.h"
#include "io/image_exr.h"
#include "io/image_png.h"
#include "io/npy.h"
#include "legend.h"
#include "passes/shadows.h"
#include "preset.h"
#include "render_options.h"
#include "report.h"

namespace sfumato::cli {
namespace {

/// Wall time of the stages, for the report.
class Stopwatch {
 public:
  explicit Stopwatch(RenderReport& report) : report_(report) {}
  void lap(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    for (auto& [name, sum] : report_.stages_ms)
      if (name == stage) {
        sum += ms;
        return;
      }
    report_.stages_ms.emplace_back(stage, ms);
  }

 private:
  RenderReport& report_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// `files` as one scene with the origin of the first, less what is hidden.
PointCloud read_scene(const Words& files, const RenderOptions& options, RenderReport& report,
                      Console& console) {
  PointCloud scene;
  for (const std::string& file : files) {
    io::ReadResult result = io::read(file, options.read, console);
    for (const std::string& note : result.report.notes) console.say("sfumato: " + file + ": " + note);
    report.points_read += result.report.points;
    if (result.cloud.empty()) throw Error(ErrorCode::bad_input, file + ": there is no point to render in it");
    if (files.size() == 1) {
      scene = std::move(result.cloud);
      break;
    }
    // Tells the files of a scene apart (`--opacity 0.3,1`, `--color-by file`); counts from 1 in their order.
    const float number = float(&file - files.data() + 1);
    result.cloud.set_scalar({"file", 0, std::vector<float>(result.cloud.size(), number), StoredType::uint16});
    append(scene, result.cloud);
  }
  if (options.read.max_points && files.size() > 1)
    scene = subsample(scene, std::size_t(*options.read.max_points));
  if (options.up_axis) scene.up = *options.up_axis;
  report.points_hidden = hide_classes(scene, options.hidden_classes);
  if (scene.empty())
    throw Error(ErrorCode::bad_input, files[0] +
                                          ": every point is withheld or of a hidden class; show them "
                                          "with --hide-classes none");
  report.points_rendered = scene.size();
  return scene;
}

/// Everything from the prepared cloud to files; one instance a command.
class Studio {
 public:
  Studio(const RenderOptions& options, Choice& choice, RenderReport& report, std::string command,
         Console& console)
      : options_(options),
        choice_(choice),
        report_(report),
        command_(std::move(command)),
        console_(console),
        context_(gl::Context::create_headless()),
        renderer_(*context_) {
    report_.techniques.resize(choice_.techniques.size());
    const std::string extension = extension_of(options_.output);
    wants_.color = extension == ".png" || !options_.output_panels.empty();
    wants_.color_linear = extension == ".exr" || extension == ".npy";
    wants_.depth = extension == ".exr" || !options_.output_depth.empty();
    wants_.normal = extension == ".exr" || !options_.output_normal.empty();
    wants_.timings = options_.timings || options_.json;
    for (const auto& chosen : choice_.techniques) {
      chosen->settings.background = options_.background;
      chosen->settings.transparent = options_.no_background;
      chosen->settings.edl.resolve(chosen->technique->wants_edl());
      chosen->settings.smooth_outlines.resolve(chosen->settings.samples == 1 && !chosen->technique->has_soft_edges());
    }
  }

  // What techniques hold on the GPU goes before its context does.
  ~Studio() {
    for (const auto& chosen : choice_.techniques) chosen->technique.reset();
  }

  void set_scene(PointCloud scene) {
    Attributes needs;
    for (const auto& chosen : choice_.techniques) needs = needs | chosen->technique->needs();
    if (options_.color.color_by == "normal") needs = needs | Attribute::normal;
    PreparedCloud prepared = analysis::prepare(std::move(scene), needs, choice_.prepare, console_);
    for (const auto& chosen : choice_.techniques)
      resolve_shadow_sizes(chosen->settings, bounds(prepared.cloud), prepared.median_spacing);
    coloring_ = color_points(prepared.cloud, options_.color);
    report_.color_by = coloring_.source;
    renderer_.set_cloud(std::move(prepared), std::move(coloring_.colors));
  }

  /// Renders one frame with every technique and writes its files. `n` fills the names of a path's frames.
  void shoot(const Camera& camera, int n, Stopwatch& watch) {
    const int limit = context_->limits().max_texture_size;
    if (camera.width > limit || camera.height > limit)
      throw Error(ErrorCode::usage,
                  fmt::format("{}x{} is beyond the largest picture of this driver ({} px a side): "
                              "lower --resolution",
                              camera.width, camera.height, limit));
    std::vector<Panel> panels;
    RenderOutput out;
    for (std::size_t i = 0; i < choice_.techniques.size(); ++i) {
      ChosenTechnique& chosen = *choice_.techniques[i];
      console_.check();
      console_.update(double(i) / double(choice_.techniques.size()), "rendering " + chosen.name);
      out = renderer_.render(*chosen.technique, camera, chosen.settings, wants_, console_);
      report_.techniques[i] = {out.timings, out.total_ms, out.points_drawn, out.notes};
      if (choice_.techniques.size() > 1)
        panels.push_back({chosen.name, std::move(out.rgba8)});
      else if (!options_.output_panels.empty())
        panels.push_back({chosen.name, out.rgba8});
    }
    console_.check();
    watch.lap("render");
    if (!options_.output_panels.empty()) write_panels(panels, camera, n);
    if (panels.size() > 1) {
      if (options_.legend) draw_legend(panels.back().image, coloring_, options_.background);
      if (wants_.color) out.rgba8 = contact_sheet(panels, options_.background, options_.no_background);
    } else if (options_.legend && wants_.color) {
      draw_legend(out.rgba8, coloring_, options_.background);
    }
    write(out, camera, n);
    watch.lap("write");
  }

 private:
  std::string name_of(const std::string& pattern, int n, const std::string& technique = {}) {
    const bool fixed = options_.path.empty() && !options_.sequence && technique.empty();
    const std::string name = fixed ? pattern : frame_name(pattern, n, technique);
    report_.outputs.push_back(name);
    return name;
  }

  void write_png(const std::string& name, const Image<Rgba8>& image, const Camera& camera) {
    io::write_png(name, image, options_.no_background,
                  {{"Software", std::string("sfumato ") + version()},
                   {"Command", command_},
                   {"Camera", io::camera_to_json(camera)}});
  }

  void write_panels(const std::vector<Panel>& panels, const Camera& camera, int n) {
    for (const Panel& panel : panels) {
      const std::string name = name_of(options_.output_panels, n, panel.label);
      Image<Rgba8> image = panel.image;
      if (options_.legend) draw_legend(image, coloring_, options_.background);
      write_png(name, image, camera);
    }
  }

  void write(const RenderOutput& out, const Camera& camera, int n) {
    if (!options_.output.empty()) {
      const std::string name = name_of(options_.output, n), extension = extension_of(name);
      if (extension == ".png") {
        write_png(name, out.rgba8, camera);
      } else if (extension == ".exr") {
        io::write_exr(name, out.color_linear, out.depth, out.normal, command_);
      } else {
        io::write_npy(name, out.color_linear);
      }
    }
    if (!options_.output_depth.empty()) io::write_npy(name_of(options_.output_depth, n), out.depth);
    if (!options_.output_normal.empty()) io::write_npy(name_of(options_.output_normal, n), out.normal);
    if (!options_.output_camera.empty()) io::write_camera(name_of(options_.output_camera, n), camera);
  }

  const RenderOptions& options_;
  Choice& choice_;
  RenderReport& report_;
  std::string command_;
  Console& console_;
  std::unique_ptr<gl::Context> context_;
  Renderer renderer_;
  RenderWants wants_;
  Coloring coloring_;
};

/// Refuses outputs that would replace an input or each other, before anything is read.
void check_names(const RenderOptions& options, const Choice& choice, int frames) {
  io::FileNames names;
  for (const std::string& file : options.files) names.input("the input", file);
  if (options.camera.file) names.input("--camera", *options.camera.file);
  if (!options.preset.empty()) names.input("--preset", options.preset);
  if (!options.path.empty() && options.path != "orbit") names.input("--path", options.path);
  if (!options.save_preset.empty()) names.output("--save-preset", options.save_preset);
  const bool fixed = options.path.empty() && !options.sequence;
  for (int n = 0; n < frames; ++n) {
    for (const auto& [option, pattern] :
         {std::pair("-o", options.output), std::pair("--output-depth", options.output_depth),
          std::pair("--output-normal", options.output_normal), std::pair("--output-camera", options.output_camera)})
      if (!pattern.empty()) names.output(option, fixed ? pattern : frame_name(pattern, n));
    if (!options.output_panels.empty())
      for (const auto& chosen : choice.techniques)
        names.output("--output-panels", frame_name(options.output_panels, n, chosen->name));
  }
}

std::vector<Camera> cameras_of(const RenderOptions& options, const Camera& first, UpAxis up) {
  if (options.path.empty()) return {first};
  if (options.path == "orbit") return orbit(first, up_vector(up), options.frame_count, options.orbit_degrees);
  std::vector<Camera> keys = io::read_camera_path(options.path);
  for (Camera& key : keys) key = key.resized(first.width, first.height);
  return interpolate(keys, options.frame_count);
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

void tell(const RenderReport& report, const RenderOptions& options, const Choice& choice, Console& console) {
  for (std::size_t i = 0; i < report.techniques.size(); ++i)
    for (const std::string& note : report.techniques[i].notes)
      console.say(choice.techniques[i]->name + ": " + note);
  if (report.points_hidden > 0)
    console.say(fmt::format("{} points are withheld or of a hidden class (--hide-classes {})",
                            report.points_hidden, options.hide_classes));
  if (options.timings) console.say(timings_text(report, choice));
  if (std::all_of(report.techniques.begin(), report.techniques.end(),
                  [](const TechniqueReport& one) { return one.points_drawn == 0; }))
    console.say("the picture is empty: no point lies in view; --camera-focal-point or no camera options show the points");
  const std::string& first = report.outputs.front();
  console.say(report.frames > 1
                  ? fmt::format("wrote {} ... {} ({} frames)", first, report.outputs.back(), report.frames)
                  : fmt::format("wrote {} ({} points, coloured by {})", first, report.points_rendered,
                                report.color_by));
}

}  // namespace

int render_command(const Words& words) {
  Preset preset;
  if (const std::string file = peek(words, 0, "preset"); !file.empty()) preset = load_preset(file);
  std::string names = peek(words, 't', "technique");
  if (names.empty()) names = preset.technique.empty() ? default_technique() : preset.technique;

  Choice choice(names);
  RenderOptions options;
  CommandLine line("sfumato",
                   "Renders point clouds to pictures. Commands: info, techniques, synth, convert, doctor\n"
                   "(sfumato COMMAND --help).");
  options.declare(line);
  choice.declare(line);
  if (!preset.words.empty() && !line.parse(preset.words)) return 0;
  if (!line.parse(words)) return 0;
  if (options.version) {
    print("sfumato " + std::string(version()) + "\n");
    return 0;
  }
  options.camera.preset = preset.camera;
  options.check(choice.techniques.size());
  for (const auto& chosen : choice.techniques) {
    Light::parse(chosen->settings.light_text);
    if (chosen->settings.ground && chosen->settings.shadows == Shadows::off)
      throw Error(ErrorCode::usage, "--ground shows the shadow that falls on it: add --shadows soft, or hard");
  }
  // A wrong camera file should not cost the time of reading a large scan.
  options.camera.resolve({{dvec3(0), dvec3(1)}, {}}, UpAxis::pos_z);

  check_names(options, choice, options.sequence       ? int(options.files.size())
                               : options.path.empty() ? 1
                                                      : options.frame_count);

  Console console(options.quiet);
  RenderReport report;
  Stopwatch watch(report);
  // The files of a sequence are read one by one, and seen by the camera that suits the first.
  PointCloud scene =
      read_scene(options.sequence ? Words{options.files[0]} : options.files, options, report, console);
  watch.lap("read");
  const Camera camera = options.camera.resolve(subject_of(scene), scene.up);
  const std::vector<Camera> cameras = cameras_of(options, camera, scene.up);
  report.frames = options.sequence ? int(options.files.size()) : int(cameras.size());
  if (report.frames > 1)
    for (const auto& chosen : choice.techniques) fix_light(chosen->settings, cameras.front(), scene.up);

  Words command = words;
  command.insert(command.begin(), "sfumato");
  Studio studio(options, choice, report, quote(command), console);
  studio.set_scene(std::move(scene));
  watch.lap("prepare");
  for (int n = 0; n < report.frames; ++n) {
    if (report.frames > 1) console.set_stage(fmt::format("frame {}/{}", n + 1, report.frames));
    if (options.sequence && n > 0) {
      studio.set_scene(read_scene({options.files[std::size_t(n)]}, options, report, console));
      watch.lap("prepare");
    }
    studio.shoot(options.sequence ? camera : cameras[std::size_t(n)], n, watch);
  }
  if (!options.save_preset.empty()) {
    std::optional<Camera> kept = preset.camera;
    if (!options.camera.file.value_or("").empty()) kept = io::read_camera(*options.camera.file);
    save_preset(options.save_preset, choice, line.given(), kept);
    report.outputs.push_back(options.save_preset);
  }
  tell(report, options, choice, console);
  if (options.json) print(render_json(report, choice, io::camera_to_json(camera)));
  return 0;
}

}  // namespace sfumato::cli
