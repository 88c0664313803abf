// Scenes with few surfaces, for tests and for the papers' figures.
#include "core/error.h"
#include "synth/builder.h"

namespace sfumato::synth {
namespace {

/// Three tori inside each other (Dobrev 2010): ring radius 1, tube radii 0.45, 0.30 and 0.15, equal point
/// counts.
Scene make_tori() {
  Builder b("tori");
  const double tubes[3] = {0.45, 0.30, 0.15};
  const Rgba8 colors[3] = {{60, 90, 220, 77}, {60, 190, 80, 128}, {150, 100, 50, 255}};
  for (std::size_t i = 0; i < 3; ++i) {
    Material m;
    m.color = from_srgb(colors[i].r, colors[i].g, colors[i].b);
    m.contrast = 0;  // one colour per layer, so that blended layers can be told apart
    m.alpha = colors[i].a;
    Primitive& torus = b.torus(dvec3(0), {0, 0, 1}, 1, tubes[i], {b.material(m), std::uint8_t(64 + i)});
    torus.x = {1, 0, 0}, torus.y = {0, 1, 0};
  }
  b.scene.equal_counts = true;
  b.scene.piece_scalar = "layer";
  return std::move(b.scene);
}

Material patterned(Pattern pattern, vec3 color, vec3 second, double size) {
  Material m{pattern, color, second, size};
  m.contrast = 0.1;
  return m;
}

Camera camera_at(dvec3 position, dvec3 target, double fov_deg) {
  Camera camera;
  camera.position = position;
  camera.target = target;
  camera.fov_y = glm::radians(fov_deg);
  camera.width = 640;
  camera.height = 480;
  return camera;
}

/// Spheres of several sizes, some in front of others, some touching the view's border of a common camera.
Scene make_spheres() {
  Builder b("spheres");
  const struct {
    dvec3 center;
    double radius;
    Pattern pattern;
    vec3 color, second;
    double size;
  } spheres[] = {
      {{0, 0, 1.0}, 1.0, Pattern::marble, from_srgb(236, 228, 214), from_srgb(150, 120, 100), 0.7},
      {{-1.55, -0.6, 0.62}, 0.62, Pattern::checker, from_srgb(206, 92, 62), from_srgb(240, 214, 180), 0.2},
      {{1.35, -0.95, 0.5}, 0.5, Pattern::checker, from_srgb(52, 110, 150), from_srgb(205, 224, 230), 0.16},
      {{0.35, -1.6, 0.3}, 0.3, Pattern::marble, from_srgb(92, 140, 74), from_srgb(34, 66, 40), 0.3},
      {{-0.6, -1.75, 0.22}, 0.22, Pattern::plain, from_srgb(232, 180, 64), from_srgb(0, 0, 0), 0.3},
      {{1.9, 0.7, 0.8}, 0.8, Pattern::marble, from_srgb(120, 78, 120), from_srgb(220, 200, 214), 0.6},
      {{-1.6, 1.1, 0.75}, 0.75, Pattern::plain, from_srgb(70, 120, 130), from_srgb(0, 0, 0), 0.5},
  };
  for (const auto& s : spheres)
    b.sphere(s.center, s.radius,
             {b.material(patterned(s.pattern, s.color, s.second, s.size)), class_furniture});
  b.scene.cameras = {camera_at({-3.2, -4.6, 2.6}, {0, 0, 0.7}, 45),
                     camera_at({3.4, -4.2, 2.0}, {0, 0, 0.7}, 45)};
  return std::move(b.scene);
}

/// A square of side 2 in the plane z = 0.
Scene make_plane() {
  Builder b("plane");
  const Finish squares{
      b.material(patterned(Pattern::checker, from_srgb(214, 206, 190), from_srgb(110, 128, 140), 0.25)),
      class_ground};
  b.floor(-1, 1, -1, 1, 0, squares);
  b.scene.cameras = {camera_at({0, -1.6, 1.6}, {0, 0, 0}, 50), camera_at({0, 0, 2.6}, {0, 0, 0}, 50)};
  return std::move(b.scene);
}

struct Entry {
  const char* name;
  Scene (*make)();
};
constexpr Entry scenes[] = {{"courtyard", make_courtyard}, {"room", make_room},       {"forest", make_forest},
                            {"tori", make_tori},           {"spheres", make_spheres}, {"plane", make_plane}};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& entry : scenes) names.emplace_back(entry.name);
  return names;
}

Scene make_scene(const std::string& name) {
  for (const Entry& entry : scenes) {
    if (name != entry.name) continue;
    Scene scene = entry.make();
    scene.build();
    return scene;
  }
  std::string known;
  for (const std::string& one : scene_names()) known += (known.empty() ? "" : ", ") + one;
  throw Error(ErrorCode::usage, "synth: no scene '" + name + "'; there are " + known + ", mesh");
}

}  // namespace sfumato::synth
