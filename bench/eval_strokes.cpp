// Strokes against strokes painted over a picture (dos Anjos 2017, Figure 6), and how calm both are in motion:
//
//   eval_strokes CLOUD CAMERA.json OUT_DIR [--part figure6|coherence|likeness]
//   eval_strokes --part still   a wall that stands still, measured anew in every frame: `make eval-strokes`
//
// `likeness`: what each style keeps of the unpainted picture, that of `splats` without light
// (bench/likeness.h). Writes {points,image,strokes}_{all,40000}.png at the size of the camera, and prints the
// mean change of a pixel from frame to frame (bench/frame_difference.h) along a slow orbit.
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "analysis/still.h"
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

/// A wall of random points in patches of colour, with noise of so many spacings towards the camera and, half
/// as much, within the wall; colours too have the noise of a camera, two levels, where `colors`.
PointCloud wall(double noise, bool colors, unsigned frame) {
  constexpr double spacing = 0.01;
  std::mt19937 places(1), random(100 + frame);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 1);
  PointCloud cloud;
  for (int i = 0; i < int(3.2 * 1.8 / (spacing * spacing)); ++i) {
    const double x = 1.6 * uniform(places), z = 0.9 * uniform(places), step = noise * spacing;
    cloud.positions.push_back(
        vec3(dvec3(x + 0.5 * step * normal(random), step * normal(random), z + 0.5 * step * normal(random))));
    const double patch = std::fmod(std::floor(4 * x) + std::floor(4 * z) + 100, 2);
    auto level = [&](double v) {
      return std::uint8_t(std::clamp(v + (colors ? 2 * normal(random) : 0), 0.0, 255.0));
    };
    const std::uint8_t r = level(120 + 60 * std::sin(3 * x) * std::cos(4 * z)), g = level(110 + 80 * patch),
                       b = level(90 + 50 * std::cos(5 * x + 2 * z));
    cloud.colors.push_back({r, g, b, 255});
  }
  return cloud;
}

/// How much changes where nothing moves.
void stillness(Renderer& renderer) {
  std::printf(
      "| noise, spacings | splats | strokes, each frame for itself | strokes in a sequence |\n"
      "|---|---|---|---|\n");
  for (const auto& [noise, colors] :
       {std::pair(0.05, false), {0.1, false}, {0.2, false}, {0.5, false}, {0.05, true}}) {
    double mean[3] = {};
    for (int way = 0; way < 3; ++way) {
      const auto technique = made(way == 0 ? "splats" : "strokes", "", "");
      analysis::StillPoints still;
      bench::FrameDifferenceMeter meter;
      Camera camera;
      camera.position = dvec3(0, -2.2, 0), camera.target = dvec3(0), camera.up = dvec3(0, 0, 1);
      camera.width = 640, camera.height = 360;
      for (unsigned n = 0; n < 6; ++n) {
        PointCloud cloud = wall(noise, colors, n);
        if (way == 2) still.hold(cloud, analysis::ClusterOptions{}.point_threshold);
        show(renderer, cloud);
        meter.add(renderer.render(*technique, camera, RenderSettings{}).rgba8);
      }
      mean[way] = meter.result().mean;
    }
    std::printf("| %g%s | %.2f | %.2f | %.2f |\n", noise, colors ? ", colours too" : "", mean[0], mean[1],
                mean[2]);
    std::fflush(stdout);
  }
}

/// Every style against the unpainted picture, at the scale of a stroke of the default style; of light
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
  if (files.size() != (part == "still" ? 0 : 3))
    throw Error(ErrorCode::usage,
                "CLOUD CAMERA.json OUT_DIR [--part figure6|coherence|likeness], or --part still");
  auto context = gl::Context::create_headless();
  Renderer renderer(*context);
  if (part == "still") {
    stillness(renderer);
    return 0;
  }
  const PointCloud cloud = io::read(files[0]).cloud;
  const Camera camera = io::read_camera(files[1]);
  if (part == "figure6" || part == "all") figure_6(renderer, cloud, camera, files[2]);
  if (part == "coherence" || part == "all") coherence(renderer, cloud, camera, 25, 0.25);
  if (part == "likeness" || part == "all") likeness_table(renderer, cloud, camera);
} catch (const std::exception& error) {
  std::fprintf(stderr, "eval_strokes: %s\n", error.what());
  return 1;
}
