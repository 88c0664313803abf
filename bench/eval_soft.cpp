// `soft` against its closed forms, and the share of points that it takes for uncertain by density:
// `make eval-soft`.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "analysis/attributes.h"
#include "analysis/prepare.h"
#include "core/error.h"
#include "gl/context.h"
#include "set_parameter.h"
#include "synth/synth.h"
#include "techniques/renderer.h"
#include "techniques/soft/field.h"

using namespace sfumato;
using bench::set;

namespace {

/// Optical depth of a sphere whose density falls from the centre to nothing at the rim, on a chord at `delta`
/// of the radius, by that through the centre (Seemann 2018, Eqs. 4 to 10 along the ray).
double closed_form(double delta) {
  const double half = std::sqrt(std::max(1 - delta * delta, 0.0));
  return delta < 1e-12 ? 1 : half - delta * delta * std::log((1 + half) / delta);
}

std::unique_ptr<Technique> soft_of(const char* model, double opacity) {
  auto technique = find_technique("soft").create();
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", opacity);
  const std::pair<const char*, const char*> values[] = {
      {"field", "soft"},      {"field_threshold", "0.5"}, {"modulation_threshold", "0.5"},
      {"antialias", "false"}, {"clamp_radius", "false"},  {"radius_scale", "1"},
      {"epsilon", "0.01"},    {"model", model},           {"opacity", text}};
  for (const auto& [name, value] : values) set(*technique, name, value);
  return technique;
}

/// `count` spheres of radius 1/2 along the y axis, `apart` of each other, seen along it: 1.4 high.
struct Row {
  PointCloud cloud;
  Camera camera;
  Row(int count, float apart, int pixels) {
    ScalarField field{"soft", 0, {}};
    for (int i = 0; i < count; ++i) {
      cloud.positions.push_back({0, apart * float(i), 0});
      cloud.normals.push_back({0, -1, 0});
      cloud.radii.push_back(0.5f);
      cloud.colors.push_back({200, 100, 50, 255});
      field.values.push_back(1);
    }
    cloud.set_scalar(std::move(field));
    camera.position = dvec3(0, -3, 0), camera.target = dvec3(0), camera.up = dvec3(0, 0, 1);
    camera.width = camera.height = pixels;
    camera.projection = Projection::orthographic;
    camera.height_world = 1.4;
  }
  double delta(int x, int y) const {
    const double pixel = camera.height_world / camera.height;
    return 2 * pixel * std::hypot(x + 0.5 - 0.5 * camera.width, y + 0.5 - 0.5 * camera.height);
  }
};

Image<vec4> picture_of(Renderer& renderer, Technique& technique, const Row& row) {
  RenderSettings settings;
  settings.transparent = true;
  settings.shading = Shading::albedo;
  RenderWants wants;
  wants.color_linear = true;
  PreparedCloud prepared = analysis::prepare(row.cloud, technique.needs(), {});
  std::vector<Rgba8> colors = prepared.cloud.colors;
  renderer.set_cloud(std::move(prepared), std::move(colors));
  return renderer.render(technique, row.camera, settings, wants).color_linear;
}

/// Long lists: one opacity of the whole row, whatever the number of its spheres.
void lists(Renderer& renderer) {
  std::printf("| spheres in a pixel | base: largest error of the opacity | concentric |\n|---|---|---|\n");
  for (int count : {1, 30, 300, 1500, 2500, 5000}) {
    double worst[2] = {};
    for (int nested = 0; nested < 2; ++nested) {
      const Row row(count, 1.1f, 24);
      const double opacity = 0.3 / count;
      const auto technique = soft_of(nested ? "concentric" : "base", opacity);
      if (nested) set(*technique, "concentric_count", "32");
      const Image<vec4> picture = picture_of(renderer, *technique, row);
      for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x) {
          const double delta = row.delta(x, y);
          if (nested && delta > 0.7) continue;  // where 32 steps are not yet the integral
          const double depth = delta < 1 ? -count * std::log(1 - opacity) * closed_form(delta) : 0;
          worst[nested] = std::max(worst[nested], std::abs(picture.at(x, y).a - (1 - std::exp(-depth))));
        }
    }
    std::printf("| %d | %.5f | %.5f |\n", count, worst[0], worst[1]);
    std::fflush(stdout);
  }
  std::printf("\n");
}

/// What a model takes of the light behind a lone sphere, by what Base takes.
void mass(Renderer& renderer) {
  std::printf("| radius, px | concentric | eq13 | eq15 | express |\n|---|---|---|---|---|\n");
  for (int radius : {2, 4, 8, 16, 64}) {
    auto taken = [&](const char* model, const char* normalization) {
      Row row(1, 1, int(std::lround(2.8 * radius)));
      const auto technique = soft_of(model, 0.15);
      if (normalization) set(*technique, "normalization", normalization);
      double sum = 0;
      for (int k = 0; k < 16; ++k) {  // at places within a pixel
        const double pixel = row.camera.height_world / row.camera.height;
        const dvec3 aside(pixel * (k % 4) / 4, 0, pixel * (k / 4) / 4);
        row.camera.position = dvec3(0, -3, 0) + aside, row.camera.target = aside;
        for (const vec4& seen : picture_of(renderer, *technique, row)) sum -= std::log1p(-double(seen.a));
      }
      return sum;
    };
    const double base = taken("base", nullptr);
    std::printf("| %d | %.3f | %.3f | %.3f | %.3f |\n", radius, taken("concentric", "exact") / base,
                taken("concentric", "eq13") / base, taken("concentric", "eq15") / base,
                taken("express", nullptr) / base);
    std::fflush(stdout);
  }
  std::printf("\n");
}

double soft_share(const PreparedCloud& prepared) {
  soft::FieldSettings settings;
  analysis::Nearby nearby;
  const soft::Field field = soft::evaluate(prepared, settings, nearby);
  const auto above =
      std::count_if(field.values.begin(), field.values.end(), [&](float f) { return f > field.threshold; });
  return 100 * double(above) / double(field.values.size());
}

/// Levels of a cloud: computed from their own points, and from what `build` stores of all.
void levels() {
  const Attributes needs = Attribute::normal | Attribute::radius | Attribute::uncertainty;
  std::printf(
      "| scene | whole | a quarter, own | stored | a sixteenth, own | stored |\n"
      "|---|---|---|---|---|---|\n");
  for (const char* name : {"forest", "courtyard", "room"}) {
    synth::SampleOptions options;
    options.points = 400'000;
    options.normals.user = false;
    const PreparedCloud whole = analysis::prepare(synth::sample(synth::make_scene(name), options), needs, {});
    std::printf("| %s | %.1f %%", name, soft_share(whole));
    PointCloud stored = whole.cloud;
    std::erase_if(stored.scalars, [](const ScalarField& s) { return s.name == "uncertainty"; });
    const analysis::Nearby nearby(stored.positions, no_progress());
    stored.set_scalar({analysis::stored_uncertainty, 0, analysis::scale_free_uncertainty(whole, nearby)});
    stored.radii.clear();
    for (std::size_t part : {4, 16}) {
      PointCloud with = subsample(stored, stored.size() / part), without = with;
      std::erase_if(without.scalars,
                    [](const ScalarField& s) { return s.name == analysis::stored_uncertainty; });
      without.normals.clear();
      std::printf(" | %.1f %%", soft_share(analysis::prepare(std::move(without), needs, {})));
      std::printf(" | %.1f %%", soft_share(analysis::prepare(std::move(with), needs, {})));
      std::fflush(stdout);
    }
    std::printf(" |\n");
  }
}

}  // namespace

int main() try {
  const auto context = gl::Context::create_headless();
  Renderer renderer(*context);
  lists(renderer);
  mass(renderer);
  levels();
} catch (const std::exception& error) {
  std::fprintf(stderr, "eval_soft: %s\n", error.what());
  return 1;
}
