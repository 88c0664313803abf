#include "picture_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "../publish/publication.h"
#include "core/counted.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/image_exr.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "labels/furniture.h"
#include "session/notes.h"
#include "../picture/saved_picture.h"

namespace sfumato::cli {

void Stopwatch::lap(const char* stage) {
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

PictureWriter::PictureWriter(const RenderOptions& options, Choice& choice, RenderReport& report,
                             std::string command, Console& console)
    : options_(options),
      choice_(choice),
      report_(report),
      command_(std::move(command)),
      console_(console),
      context_(gl::Context::create_headless()),
      session_(*context_) {
  report_.techniques.resize(choice_.count);
  const std::string extension = extension_of(options_.output);
  wants_.color_linear = extension == ".exr" || extension == ".npy";
  wants_.color = (!options_.output.empty() && !wants_.color_linear) || !options_.output_panels.empty();
  wants_.depth = extension == ".exr" || !options_.output_depth.empty() || !options_.output_index.empty();
  wants_.normal = extension == ".exr" || !options_.output_normal.empty();
  if (options_.publication) wants_.color = wants_.depth = true;
  wants_.timings = options_.timings || options_.json;
  for (const auto& chosen : choice_.techniques) chosen->settings.transparent = options_.no_background;
}

// What techniques hold on the GPU goes before its context does.
PictureWriter::~PictureWriter() {
  for (const auto* each : {&choice_.techniques, &choice_.passed_over})
    for (const auto& chosen : *each) chosen->technique.reset();
}

std::string PictureWriter::set_scene(scene::Scene scene, Pose pose) {
  crs_ = scene.cloud.crs;
  const bool holds_still =
      options_.sequence && std::all_of(choice_.techniques.begin(), choice_.techniques.end(),
                                       [](const auto& each) { return each->technique->holds_still(); });
  if (holds_still) still_.hold(scene.cloud, choice_.prepare.strokes.clusters.point_threshold, console_);
  SessionOptions wanted{choice_.prepare, options_.color, {}, options_.draw};
  wanted.background = options_.background;
  session_.open(std::move(scene), std::move(pose), wanted, &choice_, console_);
  report_.draw.clear();
  for (const Session::Part& part : session_.parts())
    for (const std::string& rule : part.rules) report_.draw.push_back({rule, part.look->name, part.points});
  if (!options_.output_index.empty()) index_.emplace(session_);
  for (const std::string& note : session_.notes()) console_.note(note);
  console_.note(note_on_left_out(session_.left_out(), FrontEnd::command));
  const Coloring& coloring = session_.coloring();
  report_.color_by = coloring.source;
  report_.exposure = coloring.exposure;
  for (const std::string& note : coloring.notes) console_.note(note);
  if (options_.furniture.legend) console_.note(note_on_legend(coloring, FrontEnd::command));
  if (session_.parts().front().rules.empty())
    for (const auto& chosen : choice_.techniques)
      if (!chosen->reason.empty())
        return worded(note_on_technique(chosen->name, chosen->reason), FrontEnd::command);
  return {};
}

void PictureWriter::draw_furniture(Image<Rgba8>& rows, const Camera& camera, int first_row) const {
  labels::draw_furniture(rows, first_row, options_.furniture,
                         {camera, session_.pose().upright.up, crs_, session_.coloring(),
                          session_.background(), options_.panorama, session_.pose().vertical_exaggeration});
}

/// Where the picture lies on the map, when somebody asks for that. A TIFF of any other view is a picture.
std::optional<io::Georeference> PictureWriter::place_of(const Camera& camera) const {
  const UpAxis up = session_.pose().upright.up;
  if (options_.world_file) return io::georeference(camera, up, crs_, "--world-file");
  const std::string extension = extension_of(options_.output);
  if (extension != ".tif" && extension != ".tiff") return std::nullopt;
  if (options_.panorama || up != UpAxis::pos_z || !labels::is_plan(camera, up)) return std::nullopt;
  return io::georeference(camera, up, crs_, "-o");
}

RenderOutput PictureWriter::render(ChosenTechnique& chosen, const Camera& camera) {
  if (options_.panorama) return session_.render_panorama(chosen, camera, wants_, console_);
  return session_.render(chosen, camera, wants_, console_);
}

void PictureWriter::report(std::size_t i, const RenderOutput& out) {
  report_.techniques[i] = {out.timings, out.total_ms, out.points_drawn, out.outliers, out.notes};
  report_.settings.insert_or_assign(choice_.techniques[i]->name, out.settings);
  report_.background = session_.background();
}

void PictureWriter::render_picture(const Camera& camera, int n, Stopwatch& watch) {
  if (std::max(camera.width, camera.height) > Renderer::largest_side)
    throw Error(ErrorCode::usage, fmt::format("{}x{} is beyond the largest picture ({} px a side): "
                                              "lower --resolution",
                                              camera.width, camera.height, Renderer::largest_side));
  labels::check(options_.furniture, camera, session_.pose().upright.up, options_.panorama);
  if (const auto place = place_of(camera); place && options_.world_file)
    world_ = {io::world_file_name(file_name(options_.output, options_.parts(n))), *place};
  const bool is_one = choice_.techniques.size() == 1 && options_.output_panels.empty() &&
                      !options_.panorama && !is_video(options_.output) && !options_.publication;
  if (is_one && session_.is_tiled(camera)) return write_rows(camera, n, watch);
  std::vector<labels::Panel> panels;
  RenderOutput out;
  bool blank = true;
  for (std::size_t i = 0; i < choice_.techniques.size(); ++i) {
    ChosenTechnique& chosen = *choice_.techniques[i];
    console_.check();
    console_.update(double(i) / double(choice_.techniques.size()), "rendering " + chosen.name);
    out = render(chosen, camera);
    report(i, out);
    blank = blank && (out.points_drawn == 0 || (wants_.color && is_blank(out.rgba8, out.rgba8.at(0, 0))));
    if (choice_.techniques.size() > 1)
      panels.push_back({chosen.name, std::move(out.rgba8)});
    else if (!options_.output_panels.empty())
      panels.push_back({chosen.name, out.rgba8});
  }
  report_.blank_pictures += blank;
  console_.check();
  watch.lap("render");
  if (!options_.output_panels.empty()) write_panels(panels, camera, n);
  if (panels.size() > 1) {
    draw_furniture(panels.back().image, camera);
    if (wants_.color)
      out.rgba8 = labels::contact_sheet(panels, session_.background(), options_.no_background);
  } else if (wants_.color) {
    draw_furniture(out.rgba8, camera);
  }
  write(out, camera, n);
  watch.lap("write");
}

/// The files of one picture, written as its rows come. Formats that need all of it get it at the end.
struct PictureWriter::Rows {
  std::optional<io::PngRows> png;
  std::optional<io::TiffRows> tiff;
  std::optional<io::ExrRows> exr, depth_exr;
  std::optional<io::NpyRows> npy, depth_npy, index_npy, normal_npy;
  std::string whole_name, depth_name, camera_name;
  std::vector<std::string> names;  ///< of all
  Image<Rgba8> whole;
  Image<float> depth;
};

void PictureWriter::open(Rows& rows, const Camera& camera, int width, int height, int n) {
  const auto name_of = [&](const std::string& pattern) {
    return rows.names.emplace_back(file_name(pattern, options_.parts(n)));
  };
  if (!options_.output.empty() && !is_video(options_.output)) {
    const std::string name = name_of(options_.output), extension = extension_of(name);
    if (extension == ".exr")
      rows.exr.emplace(name, width, height, true, true, true, command_);
    else if (extension == ".npy")
      rows.npy.emplace(name, width, height, 4);
    else if (extension == ".jpg" || extension == ".jpeg" || extension == ".webp")
      rows.whole_name = name, rows.whole = Image<Rgba8>(width, height);
    else if (extension == ".tif" || extension == ".tiff")
      rows.tiff.emplace(name, width, height, options_.no_background, options_.dpi(), place_of(camera),
                        command_);
    else
      rows.png.emplace(name, width, height, options_.no_background, texts_of(camera), options_.dpi());
  }
  if (!options_.output_depth.empty()) {
    const std::string name = name_of(options_.output_depth), extension = extension_of(name);
    if (extension == ".exr")
      rows.depth_exr.emplace(name, width, height, false, true, false, command_);
    else if (extension == ".png")
      rows.depth_name = name, rows.depth = Image<float>(width, height);
    else
      rows.depth_npy.emplace(name, width, height, 1);
  }
  if (!options_.output_index.empty())
    rows.index_npy.emplace(name_of(options_.output_index), width, height, 0);
  if (!options_.output_normal.empty())
    rows.normal_npy.emplace(name_of(options_.output_normal), width, height, 3);
  if (!options_.output_camera.empty()) rows.camera_name = name_of(options_.output_camera);
}

namespace {

template <class T>
void put(Image<T>& whole, Image<T>& rows, int first_row) {
  if (rows.size() == whole.size())
    whole = std::move(rows);
  else
    std::copy(rows.begin(), rows.end(), &whole.at(0, first_row));
}

}  // namespace

/// Takes the images of the strip.
void PictureWriter::add(Rows& rows, RenderOutput& strip, int first_row, const Camera& camera) {
  if (rows.png) rows.png->write(strip.rgba8);
  if (rows.tiff) rows.tiff->write(strip.rgba8);
  if (rows.exr) rows.exr->write(strip.color_linear, strip.depth, strip.normal);
  if (rows.npy) rows.npy->write(strip.color_linear);
  if (rows.index_npy) rows.index_npy->write(index_->of(camera, strip.depth, first_row));
  if (rows.depth_exr) rows.depth_exr->write({}, strip.depth, {});
  if (rows.depth_npy) rows.depth_npy->write(strip.depth);
  if (rows.normal_npy) rows.normal_npy->write(strip.normal);
  if (!rows.whole.empty()) put(rows.whole, strip.rgba8, first_row);
  if (!rows.depth.empty()) put(rows.depth, strip.depth, first_row);
}

void PictureWriter::close(Rows& rows, const Camera& camera) {
  // What only now meets its file goes first: where that fails, files that are open do not appear.
  const int quality = options_.quality.value_or(90);
  if (extension_of(rows.whole_name) == ".webp")
    io::write_webp(rows.whole_name, rows.whole, options_.no_background, quality);
  else if (!rows.whole_name.empty())
    io::write_jpeg(rows.whole_name, rows.whole, quality, options_.dpi());
  if (!rows.depth.empty()) write_depth_png(rows.depth_name, rows.depth);
  if (rows.png) rows.png->finish();
  if (rows.tiff) rows.tiff->finish();
  for (auto* exr : {&rows.exr, &rows.depth_exr})
    if (*exr) (*exr)->finish();
  for (auto* npy : {&rows.npy, &rows.depth_npy, &rows.index_npy, &rows.normal_npy})
    if (*npy) (*npy)->finish();
  if (!rows.camera_name.empty()) io::write_camera(rows.camera_name, camera);
  report_.outputs.insert(report_.outputs.end(), rows.names.begin(), rows.names.end());
  if (!world_) return;
  io::write_world_file(world_->first, world_->second);
  report_.outputs.push_back(world_->first.string());
  world_.reset();
}

/// A picture in tiles: rows of them are written as soon as they are drawn, and forgotten.
void PictureWriter::write_rows(const Camera& camera, int n, Stopwatch& watch) {
  Rows rows;
  open(rows, camera, camera.width, camera.height, n);
  std::optional<Rgba8> corner;  // of what there is no more than one colour
  bool blank = true;
  ChosenTechnique& chosen = *choice_.techniques.front();
  console_.check();
  const RenderOutput out = session_.render_rows(
      chosen, camera, wants_,
      [&](RenderOutput& strip, int first_row) {
        watch.lap("render");
        if (wants_.color) {
          if (!corner) corner = strip.rgba8.at(0, 0);
          blank = blank && is_blank(strip.rgba8, *corner);
          draw_furniture(strip.rgba8, camera, first_row);
        }
        add(rows, strip, first_row, camera);
        watch.lap("write");
      },
      console_);
  watch.lap("render");
  report(0, out);
  report_.blank_pictures += out.points_drawn == 0 || (wants_.color && blank);
  close(rows, camera);
  watch.lap("write");
}

/// Nothing but background: points may lie in the view and yet be too small or too far to be seen.
bool PictureWriter::is_blank(const Image<Rgba8>& image, const Rgba8& corner) const {
  if (options_.no_background)
    return std::all_of(image.begin(), image.end(), [](const Rgba8& c) { return c.a == 0; });
  return std::all_of(image.begin(), image.end(), [&](const Rgba8& c) { return c == corner; });
}

io::PngTexts PictureWriter::texts_of(const Camera& camera) const {
  return sfumato::texts_of(command_, camera, note_on_cutaway(session_.pose(), {&camera, 1}));
}

void PictureWriter::write_panels(const std::vector<labels::Panel>& panels, const Camera& camera, int n) {
  for (const labels::Panel& panel : panels) {
    const std::string name = file_name(options_.output_panels, options_.parts(n, panel.label));
    Image<Rgba8> image = panel.image;
    draw_furniture(image, camera);
    io::write_png(name, image, options_.no_background, texts_of(camera), options_.dpi());
    report_.outputs.push_back(name);
  }
}

void PictureWriter::write_depth_png(const std::string& name, const Image<float>& depth) {
  const io::PngTexts texts{{"Software", std::string("sfumato ") + version()}, {"Command", command_}};
  const LengthUnit& step = options_.depth_unit;
  if (step.metres == 0) return io::write_depth_png(name, depth, texts);
  const LengthUnit& unit = session_.pose().unit;
  if (unit.metres == 0 && !tells_unit_) {
    console_.say("--depth-unit: the file does not say its unit, taken for metres; --unit ft says otherwise");
    tells_unit_ = true;
  }
  const double metres = unit.metres > 0 ? unit.metres : 1;
  if (const std::size_t beyond = io::write_depth_png(name, depth, step.metres / metres, step.symbol, texts))
    console_.say(
        fmt::format("{}: {} beyond 65535 {}, the most that 16 bits hold: written as 65535; a larger "
                    "--depth-unit holds them",
                    name, are(beyond, "pixel"), step.symbol));
}

void PictureWriter::finish() {
  if (video_) video_->finish();
}

/// A picture that is there as a whole.
void PictureWriter::write(RenderOutput& out, const Camera& camera, int n) {
  if (options_.publication) return options_.publication->add(out.rgba8, out.depth, camera);
  if (is_video(options_.output)) {
    if (!video_) {
      report_.outputs.push_back(options_.output);
      video_ = std::make_unique<Video>(options_.output, out.rgba8.width(), out.rgba8.height());
    }
    video_->add(out.rgba8);
  }
  const bool is_sheet = choice_.techniques.size() > 1 && wants_.color;
  Rows rows;
  open(rows, camera, is_sheet ? out.rgba8.width() : camera.width,
       is_sheet ? out.rgba8.height() : camera.height, n);
  add(rows, out, 0, camera);
  close(rows, camera);
}

}  // namespace sfumato::cli
