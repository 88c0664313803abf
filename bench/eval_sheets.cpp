// Thin sheets that were sampled on both sides: `make eval-sheets`.
//
//   eval_sheets [--technique NAME] [--shape plate|leaf|blade] [--picture FOLDER]
//
// Upper and lower sides are triangles sampled by area at random, red above and blue below, and drawn from
// above without light. Rays through the middles of pixels tell which side is seen. Of the pixels in which
// that is the upper one, two spacings inside its outline: the share in which the picture is more blue than
// red ("wrong"), the mean share of blue ("mixed"), and the share that shows the background ("holes"), in %.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/image_png.h"
#include "options.h"
#include "processor_time.h"
#include "synth/random.h"
#include "synth/scene.h"
#include "techniques/renderer.h"

using namespace sfumato;

namespace {

constexpr double spacing = 1.0 / 200;
constexpr int width = 800, height = 600;
constexpr Rgba8 above{255, 0, 0, 255}, below{0, 0, 255, 255};

struct Shape {
  std::string name;
  double gap;  ///< spacings, where it is thickest
};

/// Where the parameters u, v of [-1, 1] lie between both sides, and how thick it is there, in `gap`s.
std::pair<dvec3, double> middle_of(const Shape& shape, double u, double v) {
  if (shape.name == "plate") return {{0.5 * u, 0.5 * v, 0}, 1};
  if (shape.name == "leaf") {  // curved both ways, of one thickness
    const double half = 0.3 * std::cos(1.5 * u) + 0.02;
    return {{0.6 * u, half * v, 0.1 * std::cos(2 * u) + 0.05 * v * v}, 1};
  }
  // A blade: twisted, from its back to no thickness at all at its edge.
  return {{0.6 * u, 0.4 * v, 0.15 * u * v}, 0.5 * (1 - v)};
}

struct Sheet {
  synth::Scene scene;
  std::size_t above = 0;  ///< the first so many triangles
};

Sheet make_sheet(const Shape& shape) {
  constexpr int across = 120;
  Mesh mesh;
  const double step = 1e-4;
  for (int side : {1, -1}) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (int j = 0; j <= across; ++j)
      for (int i = 0; i <= across; ++i) {
        const double u = 2.0 * i / across - 1, v = 2.0 * j / across - 1;
        const auto [place, thick] = middle_of(shape, u, v);
        const dvec3 normal = glm::normalize(glm::cross(middle_of(shape, u + step, v).first - place,
                                                       middle_of(shape, u, v + step).first - place));
        mesh.positions.emplace_back(place + 0.5 * side * thick * shape.gap * spacing * normal);
      }
    for (std::uint32_t j = 0; j < across; ++j)
      for (std::uint32_t i = 0; i < across; ++i) {
        const std::uint32_t a = first + j * (across + 1) + i, b = a + 1, c = a + across + 1, d = c + 1;
        if (side > 0)
          mesh.triangles.push_back({a, b, d}), mesh.triangles.push_back({a, d, c});
        else
          mesh.triangles.push_back({a, d, b}), mesh.triangles.push_back({a, c, d});
      }
  }
  const std::size_t count = mesh.triangles.size() / 2;
  return {synth::make_mesh_scene(std::move(mesh)), count};
}

/// One point a square of `spacing` on either side, `noise` spacings off it.
PointCloud sample(const Sheet& sheet, bool with_normals, double noise) {
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  synth::Random random(5, synth::Stream::area, 0);
  std::vector<double> areas(1, 0.0);  // of all triangles before each
  for (std::size_t t = 0; t < sheet.scene.surface_count(); ++t)
    areas.push_back(areas.back() + sheet.scene.surface_area(t));
  for (auto n = std::size_t(areas.back() / (spacing * spacing)); n > 0; --n) {
    const auto after = std::upper_bound(areas.begin(), areas.end() - 1, areas.back() * random.uniform());
    const auto t = std::size_t(after - areas.begin()) - 1;
    const synth::SurfacePoint point = sheet.scene.sample_surface(t, random);
    cloud.positions.emplace_back(point.position + noise * spacing * random.gaussian() * point.normal);
    if (with_normals) cloud.normals.emplace_back(point.normal);
    cloud.colors.push_back(t < sheet.above ? above : below);
  }
  return cloud;
}

struct SensorView {
  Camera camera;
  Image<std::uint8_t> upper;  ///< the pixel shows the upper side, well inside its outline
};

SensorView look(const Sheet& sheet, double elevation_deg) {
  SensorView sight;
  sight.camera =
      frame(sheet.scene.box, UpAxis::pos_z, width, height, glm::radians(-30.0), glm::radians(elevation_deg));
  sight.camera.fov_y *= 0.7;
  const Intrinsics k = sight.camera.intrinsics();
  const dmat4 world_from_eye = glm::inverse(sight.camera.view());
  Image<std::uint8_t> seen(width, height), rows(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const dvec3 slope((x + 0.5 - k.cx) / k.fx, -(y + 0.5 - k.cy) / k.fy, -1);
      const auto hit = sheet.scene.intersect(
          {sight.camera.position, glm::normalize(dvec3(world_from_eye * glm::dvec4(slope, 0)))});
      seen.at(x, y) = hit && hit->surface < sheet.above;
    }
  const int margin = int(std::ceil(2 * spacing * sight.camera.pixels_per_unit() /
                                   glm::length(sight.camera.position - sight.camera.target)));
  const auto erode = [&](const Image<std::uint8_t>& from, Image<std::uint8_t>& to, int dx, int dy) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        bool all = true;
        for (int s = -margin; s <= margin && all; ++s) {
          const int i = x + s * dx, j = y + s * dy;
          all = i >= 0 && j >= 0 && i < width && j < height && from.at(i, j);
        }
        to.at(x, y) = all;
      }
  };
  erode(seen, rows, 1, 0), erode(rows, seen, 0, 1);
  sight.upper = seen;
  return sight;
}

struct Shares {
  double wrong = 0, mixed = 0, holes = 0, pixels = 0, cpu_ms = 0;
};

void judge(const SensorView& sight, const RenderOutput& out, Shares& shares) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!sight.upper.at(x, y)) continue;
      ++shares.pixels;
      const vec4 color = out.color_linear.at(x, y);
      if (color.a < 0.5f) {
        ++shares.holes;
        continue;
      }
      const double blue = color.b / std::max(color.r + color.b, 1e-6f);
      shares.mixed += blue, shares.wrong += blue > 0.5;
    }
}

void run(gl::Context& context, const Shape& shape, const std::vector<std::string>& techniques,
         const std::string& folder) {
  const Sheet sheet = make_sheet(shape);
  const SensorView sights[] = {look(sheet, 65), look(sheet, 25)};
  for (bool with_normals : {true, false})
    for (double noise : {0.0, 0.1}) {
      const PointCloud cloud = sample(sheet, with_normals, noise);
      for (const std::string& name : techniques) {
        const auto technique = find_technique(name).create();
        Renderer renderer(context);
        Shares shares;
        const double before = bench::cpu_ms();
        PreparedCloud prepared = analysis::prepare(cloud, technique->needs(), {});
        shares.cpu_ms = bench::cpu_ms() - before;
        std::vector<Rgba8> colors = prepared.cloud.colors;
        renderer.set_cloud(std::move(prepared), std::move(colors));
        RenderSettings settings;
        settings.transparent = true;
        settings.shading = Shading::albedo;
        settings.edl.user = false, settings.ambient_occlusion.user = 0;
        RenderWants wants;
        wants.color_linear = true;
        for (const SensorView& sight : sights) {
          const RenderOutput out = renderer.render(*technique, sight.camera, settings, wants);
          judge(sight, out, shares);
          if (folder.empty()) continue;
          std::filesystem::create_directories(folder);
          char file[200];
          std::snprintf(file, sizeof file, "%s/%s_%g_%s_%g_%s_%d.png", folder.c_str(), shape.name.c_str(),
                        shape.gap, with_normals ? "normals" : "none", noise, name.c_str(),
                        int(&sight - sights));
          io::write_png(file, out.rgba8, true);
        }
        const double each = 100 / shares.pixels;
        std::printf("%-6s %3g  %-7s %3.1f  %-8s  wrong %7.3f  mixed %7.3f  holes %7.3f  %6.0f ms\n",
                    shape.name.c_str(), shape.gap, with_normals ? "normals" : "-", noise, name.c_str(),
                    each * shares.wrong, each * shares.mixed, each * shares.holes, shares.cpu_ms);
        std::fflush(stdout);
      }
    }
}

}  // namespace

int main(int count, char** words) try {
  std::vector<std::string> techniques{"splats", "surface", "denoise", "soft"};
  std::string shape, folder;
  bench::Options options;
  options.value("technique", [&](const std::string& name) { techniques = {name}; });
  options.value("shape", shape).value("picture", folder);
  options.parse(count, words);
  const auto context = gl::Context::create_headless();
  for (const char* name : {"plate", "leaf", "blade"})
    for (double gap : {1.0, 2.0, 3.0, 5.0, 10.0})
      if (shape.empty() || shape == name) run(*context, {name, gap}, techniques, folder);
  return 0;
} catch (const Error& error) {
  std::fprintf(stderr, "eval_sheets: %s\n", error.what());
  return 1;
}
