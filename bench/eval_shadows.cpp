// What light maps let through, and their resolution against the analytic shadow of a sphere over a plane:
// `make eval-shadows`.
//
//   eval_shadows penumbra        its table alone
//   eval_shadows [PICTURE.png]   the tables on standard output; the plane's points from above at three
//   resolutions
//
// Points are scattered at random. The light shines straight down, so that the shadow is a disc.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "gl/context.h"
#include "io/image_png.h"
#include "passes/shadows.h"

using namespace sfumato;

namespace {

constexpr float radius = 0.5f, height = 1;
constexpr double extent = 1;  // of the plane, to each side

struct Scene {
  PreparedCloud prepared;
  std::vector<bool> is_plane;  ///< of the prepared points
};

/// `density` points a unit of area on plane and caster; the caster is a sphere, or its upper half alone.
Scene make_scene(double density, bool half, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointCloud cloud;
  const std::size_t plane = std::size_t(4 * extent * extent * density);
  for (std::size_t i = 0; i < plane; ++i) {
    cloud.positions.push_back(vec3(extent * uniform(random), extent * uniform(random), 0));
    cloud.normals.push_back({0, 0, 1});
  }
  const std::size_t caster = std::size_t((half ? 2 : 4) * M_PI * radius * radius * density);
  for (std::size_t i = 0; i < caster; ++i) {
    const double z = half ? std::abs(uniform(random)) : uniform(random), angle = M_PI * uniform(random);
    const double ring = std::sqrt(1 - z * z);
    const vec3 n(float(ring * std::cos(angle)), float(ring * std::sin(angle)), float(z));
    cloud.positions.push_back(vec3(0, 0, height) + radius * n);
    cloud.normals.push_back(n);
  }
  Scene scene{analysis::prepare(std::move(cloud), {}, {}), {}};
  for (std::uint32_t source : scene.prepared.cloud.source_index) scene.is_plane.push_back(source < plane);
  return scene;
}

/// `light_size` > 0: soft shadows of a disc of that diameter.
std::vector<float> factors(const PreparedCloud& prepared, double texel, int fills,
                           const char* light = "dir:0,0,1", double light_size = 0) {
  GpuCloud gpu(prepared, std::vector<Rgba8>(prepared.cloud.size()));
  RenderSettings settings;
  settings.shadows = light_size > 0 ? Shadows::soft : Shadows::hard;
  if (light_size > 0) settings.light_size.user = float(light_size);
  resolve_shadow_sizes(settings, bounds(prepared.cloud), prepared.median_spacing);
  gl::Timers timers(false);
  ShadowMaps maps;
  maps.set_resolution(texel, fills);
  maps.update(std::array{&gpu}, settings, Light::parse(light), timers, no_progress());
  std::vector<float> all;
  for (GpuCloud::Chunk& chunk : gpu.chunks()) {
    std::vector<float> values(chunk.count);
    chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

struct Errors {
  double leaks = 0;   ///< share of the points inside the shadow that are lit, 5 spacings (or 2 texels) and
                      ///< more from its outline
  double specks = 0;  ///< share of the points outside, as far from it, that are dark
  double offset =
      0;  ///< mean distance between the two outlines, in spacings: wrong area by length of the outline
  double outwards = 0;  ///< the same, signed: positive where the shadow is too large
};

Errors measure(const Scene& scene, double texel, int fills, double density) {
  const PointCloud& cloud = scene.prepared.cloud;
  const std::vector<float> m = factors(scene.prepared, texel, fills);
  const double spacing = scene.prepared.median_spacing, far = std::max(5.0, 2 * texel) * spacing;
  std::size_t inside = 0, outside = 0, leaks = 0, specks = 0, lit_within = 0, dark_beyond = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    if (!scene.is_plane[i]) continue;
    const double beyond = std::hypot(cloud.positions[i].x, cloud.positions[i].y) - radius;
    const bool dark = m[i] < 0.5f;
    if (beyond < -far)
      ++inside, leaks += !dark;
    else if (beyond > far)
      ++outside, specks += dark;
    else if (beyond < 0)
      lit_within += !dark;
    else
      dark_beyond += dark;
  }
  const double unit =
      density * 2 * M_PI * radius * spacing;  // points in a band of one spacing along the outline
  return {double(leaks) / double(inside), double(specks) / double(outside),
          double(lit_within + dark_beyond) / unit, (double(dark_beyond) - double(lit_within)) / unit};
}

/// Ground under a caster of random points, lit from above.
struct Caster {
  const char* name;
  double nearness;  ///< of the caster to a point light: its distance by the ground's; 0: parallel light
  double spacing;   ///< of the caster, by that of the ground
};

/// Share of the points in shadow that are lit; of those that are not, far from the rim, that are dark.
std::pair<double, double> leaks(const Caster& caster, unsigned seed) {
  const double spacing = 0.01, rim = caster.nearness > 0 ? 0.8 * caster.nearness : 1;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointCloud cloud;
  auto add = [&](const dvec3& p, const dvec3& n) {
    cloud.positions.push_back(vec3(p));
    cloud.normals.push_back(vec3(n));
  };
  const double light = 8, above = caster.nearness > 0 ? light * (1 - caster.nearness) : 1;
  for (int i = 0; i < int(16 / (spacing * spacing)); ++i)
    add({2 * uniform(random), 2 * uniform(random), 0}, {0, 0, 1});
  const std::size_t receivers = cloud.size();
  const double apart = spacing * caster.spacing;
  const double wide = caster.nearness > 0 ? 3 * caster.nearness : 4;
  for (int i = 0; i < int(2 * wide * (wide + rim) / (apart * apart)); ++i)
    add({rim - 0.5 * (wide + rim) * (1 + uniform(random)), wide * uniform(random), above}, {0, 0, 1});
  const PreparedCloud prepared = analysis::prepare(std::move(cloud), {}, {});
  const char* from = caster.nearness > 0 ? "0,0,8" : "dir:0,0,1";
  const std::vector<float> m = factors(prepared, ShadowMaps::texel_spacings, 1, from);
  std::size_t dark = 0, lit = 0, beside = 0, shadowed = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    if (prepared.cloud.source_index[i] >= receivers) continue;
    const double edge = caster.nearness > 0 ? rim / caster.nearness : rim;
    const double band = 2 * apart / (caster.nearness > 0 ? caster.nearness : 1);
    const double x = prepared.cloud.positions[i].x + prepared.cloud.origin.x;
    if (x < edge - band) ++dark, lit += m[i] > 0.5f;
    if (x > edge + band) ++beside, shadowed += m[i] < 0.5f;
  }
  return {double(lit) / double(dark), double(shadowed) / double(std::max<std::size_t>(beside, 1))};
}

void print_leaks() {
  std::printf(
      "| caster | points in its shadow that are lit, goal 1 %% | points beside it that are dark "
      "|\n|---|---|---|\n");
  const Caster casters[] = {
      {"at half the distance to a point light", 0.5, 1}, {"at a third", 1.0 / 3, 1}, {"at a tenth", 0.1, 1},
      {"twice the spacing, parallel light", 0, 2},       {"five times", 0, 5},       {"ten times", 0, 10}};
  for (const Caster& caster : casters) {
    constexpr int seeds = 5;
    double lit = 0, shadowed = 0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const auto [in_shadow, beside] = leaks(caster, seed);
      lit += in_shadow / seeds, shadowed += beside / seeds;
    }
    std::printf("| %s | %.2f %% | %.2f %% |\n", caster.name, 100 * lit, 100 * shadowed);
    std::fflush(stdout);
  }
  std::printf("\n");
}

/// The edge of a half plane in the light of a disc: from where a tenth of the light arrives to where nine
/// tenths do, against the share of the disc that the edge leaves.
void print_penumbra() {
  std::printf(
      "| penumbra by its optics, spacings | measured, of that | shifted, spacings |\n|---|---|---|\n");
  const double spacing = 0.015, light = 8;
  for (const auto& [above, size] :
       {std::pair(1.0, 0.5), {1.0, 1.0}, {2.0, 0.5}, {2.0, 1.0}, {4.0, 0.5}, {4.0, 1.0}}) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    PointCloud cloud;
    const auto add = [&](double x, double y, double z) {
      cloud.positions.push_back(vec3(dvec3(x, y, z)));
      cloud.normals.push_back({0, 0, 1});
    };
    const int count = int(16 / (spacing * spacing));
    for (int i = 0; i < count; ++i) add(2 * uniform(random), 2 * uniform(random), 0);
    for (int i = 0; i < count / 2; ++i) add(-1 + uniform(random), 2 * uniform(random), above);
    const PreparedCloud prepared = analysis::prepare(std::move(cloud), {}, {});
    const std::vector<float> m = factors(prepared, ShadowMaps::texel_spacings, 1, "0,0,8", size);
    // Within the middle of the edge, light by the distance from it.
    constexpr int bins = 400;
    std::array<double, bins> sum{}, number{};
    for (std::size_t i = 0; i < m.size(); ++i) {
      const dvec3 p = prepared.cloud.world(i);
      if (prepared.cloud.source_index[i] >= std::uint32_t(count) || std::abs(p.y) > 1) continue;
      const int bin = int((p.x + 1) / 2 * bins);
      if (bin >= 0 && bin < bins) sum[std::size_t(bin)] += double(m[i]), ++number[std::size_t(bin)];
    }
    const auto crossing = [&](double share) {  // of the mean over three bins, interpolated
      double before = 0;
      for (std::size_t k = 1; k + 1 < bins; ++k) {
        const double now =
            (sum[k - 1] + sum[k] + sum[k + 1]) / std::max(number[k - 1] + number[k] + number[k + 1], 1.0);
        if (k > 1 && before < share && now >= share)
          return -1 + 2 * (double(k) - (now - share) / (now - before) + 0.5) / bins;
        before = now;
      }
      return 0.0;
    };
    // .5 + (asin(2u) + 2u sqrt(1 - 4u^2)) / pi is 0.9 at u = 0.3436 of the diameter.
    const double width = size * above / (light - above), expected = 2 * 0.3436 * width;
    const double low = crossing(0.1), high = crossing(0.9);
    std::printf("| %.1f | %.2f | %+.1f |\n", width / spacing, (high - low) / expected,
                0.5 * (low + high) / spacing);
    std::fflush(stdout);
  }
  std::printf("\n");
}

/// A corner of the shadow from above: every pixel shows whether the plane's point nearest to it is lit.
void draw(Image<Rgba8>& picture, int x0, int side, const Scene& scene, const std::vector<float>& m) {
  const double from = 0.12, to = 0.56, pixel = (to - from) / side;
  struct Point {
    float x, y;
    bool dark;
  };
  std::vector<Point> points;
  for (std::size_t i = 0; i < m.size(); ++i) {
    const vec3& p = scene.prepared.cloud.positions[i];
    if (scene.is_plane[i] && std::abs(p.x - 0.34) < 0.3 && std::abs(p.y - 0.34) < 0.3)
      points.push_back({p.x, p.y, m[i] < 0.5f});
  }
  for (int v = 0; v < side; ++v)
    for (int u = 0; u < side; ++u) {
      const float x = float(from + (u + 0.5) * pixel), y = float(to - (v + 0.5) * pixel);
      const auto away = [&](const Point& p) { return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y); };
      const auto nearest = std::min_element(
          points.begin(), points.end(), [&](const Point& a, const Point& b) { return away(a) < away(b); });
      const bool on_circle = std::abs(std::hypot(x, y) - radius) < pixel;
      const std::uint8_t grey = nearest->dark ? 90 : 225;
      picture.at(x0 + u, v) = on_circle ? Rgba8{200, 40, 40, 255} : Rgba8{grey, grey, grey, 255};
    }
}

}  // namespace

int main(int argc, char** argv) {
  const auto context = gl::Context::create_headless();
  std::string part = argc > 1 ? argv[1] : "";
  if (part != "penumbra") print_leaks();
  print_penumbra();
  if (part == "penumbra") return 0;
  const double density = 40'000;  // spacing 0.005: 200 along the shadow
  const std::vector<double> texels{0.5, 0.75, 1, 1.25, 1.5, 2, 3, 4, 6};
  for (const bool half : {true, false}) {
    std::printf(
        "%s\n\n| texel, spacings | empty texels of one surface | leaks, passes 0 / 1 / 2 | specks, passes 0 "
        "/ 1 / 2 | "
        "outline off by, spacings, 0 / 1 / 2 | of it outwards, 0 / 1 / 2 |\n|---|---|---|---|---|---|\n",
        half ? "upper half of a sphere: one surface" : "whole sphere: two surfaces");
    for (double texel : texels) {
      Errors e[3];
      constexpr int seeds = 3;
      for (int seed = 0; seed < seeds; ++seed) {
        const Scene scene = make_scene(density, half, unsigned(seed + 1));
        for (int fills = 0; fills < 3; ++fills) {
          const Errors one = measure(scene, texel, fills, density);
          e[fills].leaks += one.leaks / seeds, e[fills].specks += one.specks / seeds;
          e[fills].offset += one.offset / seeds, e[fills].outwards += one.outwards / seeds;
        }
      }
      std::printf(
          "| %g | %.1f %% | %.2f / %.2f / %.2f %% | %.2f / %.2f / %.2f %% | %.2f / %.2f / %.2f | %+.2f / "
          "%+.2f / %+.2f |\n",
          texel, 100 * std::exp(-texel * texel), 100 * e[0].leaks, 100 * e[1].leaks, 100 * e[2].leaks,
          100 * e[0].specks, 100 * e[1].specks, 100 * e[2].specks, e[0].offset, e[1].offset, e[2].offset,
          e[0].outwards, e[1].outwards, e[2].outwards);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  if (argc > 1) {
    constexpr int side = 200, gap = 8;
    const Scene scene = make_scene(density / 4, true, 1);
    Image<Rgba8> picture(3 * side + 2 * gap, side, Rgba8{255, 255, 255, 255});
    int x0 = 0;
    for (double texel : {0.5, ShadowMaps::texel_spacings, 6.0}) {
      draw(picture, x0, side, scene, factors(scene.prepared, texel, 1));
      x0 += side + gap;
    }
    io::write_png(argv[1], picture, false);
  }
}
