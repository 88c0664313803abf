// Strokes against strokes painted over a picture (dos Anjos 2017, Figure 6), and how calm both are in motion:
//
//   eval_strokes CLOUD CAMERA.json OUT_DIR [--part figure6|coherence|likeness]
//
// `likeness`: what each style keeps of the unpainted picture, that of `splats` without light
// (bench/likeness.h). Writes {points,image,strokes}_{all,40000}.png at the size of the camera, and prints the
// mean change of a pixel from frame to frame (bench/frame_difference.h) along a slow orbit.
#include <cstdio>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/coloring.h"
#include "core/error.h"
#include "frame_difference.h"
#include "image_strokes.h"
#include "likeness.h"
#include "options.h"
#include "io/camera_json.h"
#include "io/image_png.h"
#include "io/io.h"
#include "techniques/renderer.h"

using namespace sfumato;

namespace {

/// As long and as wide as the strokes of the default style paint.
bench::ImageStrokes like_ours(const Camera& camera) {
  bench::ImageStrokes s;
  s.length_px = 0.032f * float(camera.height);
  s.width_px = s.length_px / 3.2f;
  return s;
}

void show(Renderer& renderer, const PointCloud& cloud) {
  PreparedCloud prepared =
      analysis::prepare(cloud, Attribute::normal | Attribute::radius | Attribute::cluster, {});
  std::vector<Rgba8> colors = color_points(prepared.cloud, {}).colors;
  renderer.set_cloud(std::move(prepared), std::move(colors));
}

std::unique_ptr<Technique> made(const std::string& name, const std::string& parameter,
                                const std::string& value) {
  auto technique = find_technique(name).create();
  ParamList params;
  technique->describe(params);
  if (!parameter.empty()) params.find(parameter)->set(value);
  return technique;
}

void figure_6(Renderer& renderer, const PointCloud& cloud, const Camera& camera, const std::string& folder) {
  for (std::size_t most : {std::size_t(0), std::size_t(40'000)}) {
    show(renderer, most ? subsample(cloud, most) : cloud);
    const std::string end = most ? "_40000.png" : "_all.png";
    for (const char* name : {"points", "strokes"}) {
      auto technique = made(name, "", "");
      const Image<Rgba8> picture = renderer.render(*technique, camera, RenderSettings{}).rgba8;
      io::write_png(folder + "/" + name + end, picture, false);
      if (name == std::string("points"))
        io::write_png(folder + "/image" + end, bench::paint_over(picture, like_ours(camera)), false);
    }
  }
}

/// `degrees` a frame about the camera's target.
void coherence(Renderer& renderer, const PointCloud& cloud, Camera camera, int frames, double degrees) {
  struct Row {
    const char *label, *technique, *parameter, *value;
    bool over;
    bench::FrameDifferenceMeter meter;
  };
  std::vector<Row> rows = {
      {"points", "points", "", "", false, {}},
      {"splats", "splats", "", "", false, {}},
      {"strokes, a_buffer", "strokes", "", "", false, {}},
      {"strokes, a_buffer, detail 0", "strokes", "detail", "0", false, {}},
      {"strokes, a_buffer by fragment", "strokes", "stroke_order", "fragment", false, {}},
      {"strokes, blur", "strokes", "blend", "blur", false, {}},
      {"strokes over the picture of points", "points", "", "", true, {}},
      {"strokes over the picture of splats", "splats", "", "", true, {}}};
  camera.width /= 2, camera.height /= 2;
  const dvec3 start = camera.position;
  show(renderer, cloud);
  for (Row& row : rows) {
    auto technique = made(row.technique, row.parameter, row.value);
    for (int frame = 0; frame < frames; ++frame) {
      const double angle = glm::radians(degrees * frame);
      const dvec3 from = start - camera.target, up = glm::normalize(camera.up);
      camera.position = camera.target + from * std::cos(angle) + glm::cross(up, from) * std::sin(angle) +
                        up * glm::dot(up, from) * (1 - std::cos(angle));
      const Image<Rgba8> picture = renderer.render(*technique, camera, RenderSettings{}).rgba8;
      row.meter.add(row.over ? bench::paint_over(picture, like_ours(camera)) : picture);
    }
    const bench::FrameDifference d = row.meter.result();
    std::printf("| %s | %.2f | %.2f |\n", row.label, d.mean, d.worst);
    std::fflush(stdout);
  }
}

/// Every style against the unpainted picture, at the scale of a stroke of the default style; of headlights
/// neither knows.
void likeness_table(Renderer& renderer, const PointCloud& cloud, const Camera& camera) {
  show(renderer, cloud);
  RenderSettings settings;
  settings.transparent = true;
  auto picture_of = [&](const char* technique, const char* style, Shading shading) {
    settings.shading = shading;
    return renderer.render(*made(technique, style ? "style" : "", style ? style : ""), camera, settings)
        .rgba8;
  };
  const float sigma = 0.5f * like_ours(camera).width_px;
  const Image<Rgba8> unlit = picture_of("splats", nullptr, Shading::albedo);
  const Image<Rgba8> lit = picture_of("splats", nullptr, Shading::lit);
  const Image<Rgba8> points = picture_of("points", nullptr, Shading::albedo);
  std::printf("| style | gradients | structure | colour | lightness | specks (groups) | overshoot |\n");
  auto row = [&](const char* style, const Image<Rgba8>& painting, const Image<Rgba8>& picture) {
    const bench::Likeness l = bench::likeness(painting, picture, points, sigma);
    std::printf("| %s | %.3f | %.3f | %.1f | %+.1f | %zu (%zu) | %.2f %% |\n", style, l.gradients,
                l.structure, l.color, l.lightness, l.specks, l.speck_groups, 100 * l.overshoot);
    std::fflush(stdout);
  };
  row("points", points, unlit);
  for (const char* style : {"oil", "impressionist", "pointillist", "watercolor", "charcoal", "figure_4b",
                            "figure_4c", "figure_4d"})
    row(style, picture_of("strokes", style, Shading::lit), cloud.colors.empty() ? lit : unlit);
  row("oil, colours alone", picture_of("strokes", "oil", Shading::albedo), unlit);
}

}  // namespace

int main(int count, char** words) try {
  std::string part = "all";
  const std::vector<std::string> files = bench::Options().value("part", part).parse(count, words);
  if (files.size() != 3)
    throw Error(ErrorCode::usage, "CLOUD CAMERA.json OUT_DIR [--part figure6|coherence|likeness]");
  auto context = gl::Context::create_headless();
  Renderer renderer(*context);
  const PointCloud cloud = io::read(files[0]).cloud;
  const Camera camera = io::read_camera(files[1]);
  if (part == "figure6" || part == "all") figure_6(renderer, cloud, camera, files[2]);
  if (part == "coherence" || part == "all") coherence(renderer, cloud, camera, 25, 0.25);
  if (part == "likeness" || part == "all") likeness_table(renderer, cloud, camera);
} catch (const std::exception& error) {
  std::fprintf(stderr, "eval_strokes: %s\n", error.what());
  return 1;
}
