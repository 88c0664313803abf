// Points made by a program, looked at through known intrinsics: how far away is what each pixel sees?
#include <cmath>
#include <cstdio>
#include <sfumato/renderer.h>

int main() {
  // A bowl over the unit disc, z = r^2 / 2, in coordinates that a float could not hold.
  sfumato::PointCloud cloud;
  cloud.origin = {500'000, 5'400'000, 300};
  for (int i = 0; i < 200'000; ++i) {
    const double r = std::sqrt((i + 0.5) / 200'000), angle = 2.399963229728653 * i;
    cloud.positions.push_back({float(r * std::cos(angle)), float(r * std::sin(angle)), float(r * r / 2)});
  }
  sfumato::Camera camera;
  camera.position = cloud.origin + sfumato::dvec3(0, 0, 5);
  camera.target = cloud.origin;
  camera.up = {0, 1, 0};
  camera.width = 96, camera.height = 64;
  camera.custom_intrinsics = sfumato::Intrinsics{150, 150, 48, 32};

  try {
    sfumato::HeadlessRenderer renderer;
    renderer.set_cloud(std::move(cloud));
    const sfumato::Pictures pictures = renderer.render("points", camera, {{"point_size", "1.5"}});
    const double centre = pictures.depth.at(48, 32);
    std::printf("depth at the centre: %.3f (5 expected)\n", centre);
    // Half a point's footprint of the bowl's slope, and the discs' own thickness.
    return std::abs(centre - 5) < 0.01 && std::isinf(pictures.depth.at(0, 0)) ? 0 : 1;
  } catch (const sfumato::Error& error) {
    std::fprintf(stderr, "depth_of_points: %s\n", error.what());
    return int(error.code());
  }
}
