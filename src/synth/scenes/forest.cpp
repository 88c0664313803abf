// A wood on rolling ground, as airborne surveys see it: broad-leaved trees and undergrowth over terrain whose
// height is known everywhere, and a clearing.
#include <cmath>

#include "synth/builder.h"

namespace sfumato::synth {
namespace {

constexpr double half_side = 24;      // of the square plot, m
constexpr double tree_spacing = 6;    // of the jittered grid that trees stand on, m
constexpr double ground_cell = 0.75;  // of the terrain's triangles, m: a fifteenth of its shortest wave

double ground_height(double x, double y) {
  return 2.2 * std::sin(x / 8.5 + 0.6) * std::cos(y / 11.0) + 0.5 * std::sin(x / 3.1 - y / 2.3) + 0.06 * y;
}

bool in_clearing(double x, double y) { return std::hypot((x - 9) / 7, (y + 8) / 5) < 1; }

/// The terrain as triangles, so that rays meet exactly what is sampled.
void add_ground(Scene& scene) {
  const int cells = int(std::lround(2 * half_side / ground_cell));
  const auto vertex = [&](int column, int row) { return std::uint32_t(row * (cells + 1) + column); };
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column) {
      const double x = column * ground_cell - half_side, y = row * ground_cell - half_side, step = 1e-4;
      scene.mesh.positions.emplace_back(x, y, ground_height(x, y));
      scene.mesh_normals.emplace_back(
          glm::normalize(dvec3((ground_height(x - step, y) - ground_height(x + step, y)) / (2 * step),
                               (ground_height(x, y - step) - ground_height(x, y + step)) / (2 * step), 1)));
    }
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const std::uint32_t a = vertex(column, row), b = vertex(column + 1, row), c = vertex(column, row + 1),
                          d = vertex(column + 1, row + 1);
      scene.mesh.triangles.push_back({a, b, d});
      scene.mesh.triangles.push_back({a, d, c});
    }
  scene.mesh_class = class_ground;
}

}  // namespace

Scene make_forest() {
  Builder b("forest");
  const auto make = [&](Pattern pattern, vec3 color, vec3 second, double size, double contrast, ClassId id) {
    return Finish{b.material({pattern, color, second, size, contrast}), id};
  };
  // The first material is the ground's.
  make(Pattern::grass, from_srgb(150, 128, 92), from_srgb(112, 118, 66), 0.9, 0.16, class_ground);
  const Finish bark = make(Pattern::plain, from_srgb(104, 84, 66), vec3(0), 0.1, 0.3, class_high_vegetation);
  const Finish leaf =
      make(Pattern::leaf, from_srgb(126, 164, 58), from_srgb(58, 112, 48), 2.5, 0.25, class_high_vegetation);
  const Finish shrub =
      make(Pattern::leaf, from_srgb(96, 132, 66), from_srgb(44, 84, 46), 0.8, 0.25, class_low_vegetation);
  add_ground(b.scene);

  const int across = int(2 * half_side / tree_spacing);
  for (int i = 0; i < across * across; ++i) {
    Random random(7, Stream::layout, std::uint64_t(i));
    const double x = (i % across + random.uniform(0.2, 0.8)) * tree_spacing - half_side;
    const double y = (i / across + random.uniform(0.2, 0.8)) * tree_spacing - half_side;
    TreeShape tree;
    tree.height = random.uniform(8, 15);
    tree.crown_radius = random.uniform(0.24, 0.3) * tree.height;
    tree.trunk_radius = 0.02 * tree.height;
    tree.leaf_radius = 0.11;
    tree.cluster_radius = 0.06 * tree.height;
    // Two and a half square metres of leaves over each square metre that the crown covers.
    tree.leaves = int(2.5 * std::pow(tree.crown_radius / tree.leaf_radius, 2));
    tree.seed = std::uint64_t(100 + i);
    const double shrub_x = x + random.uniform(1, 2.5), shrub_y = y + random.uniform(1, 2.5);
    const double size = random.uniform(0.4, 0.9);
    if (!in_clearing(x, y)) {
      b.place({x, y, ground_height(x, y)});
      add_tree(b, tree, bark, leaf);
    }
    if (i % 2 == 0) {
      b.place({shrub_x, shrub_y, ground_height(shrub_x, shrub_y)});
      add_bush(b, {0, 0, 0.7 * size}, {size, size, 0.8 * size}, 300, 0.06, tree.seed, shrub);
    }
  }
  b.place({});

  // Two strips 150 m over the plot, one on either side of it.
  for (double y : {-40.0, 40.0}) b.scene.flight_lines.push_back({{-half_side, y, 150}, {half_side, y, 150}});
  b.scene.natural = Sampling::airborne;
  return std::move(b.scene);
}

}  // namespace sfumato::synth
