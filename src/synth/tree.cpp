// Trees and bushes: branches are cones, leaves are discs.
#include <cmath>

#include "synth/builder.h"

namespace sfumato::synth {
namespace {

dvec3 random_direction(Random& random) {
  const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * M_PI), ring = std::sqrt(1 - z * z);
  return {ring * std::cos(angle), ring * std::sin(angle), z};
}

struct Growth {
  Builder& builder;
  Random random;
  Finish bark;
  std::vector<dvec3> tips;  // where leaves gather

  /// A branch of three straight pieces that bends upwards, with side branches; the thinnest end in leaves.
  void branch(dvec3 base, dvec3 direction, double length, double radius, int generation) {
    const int pieces = 3;
    for (int piece = 0; piece < pieces; ++piece) {
      const double step = length / pieces, next_radius = radius * 0.8;
      builder.cone(base, direction, step, radius, next_radius, bark);
      base += step * direction;
      radius = next_radius;
      if (generation == 0) {
        tips.push_back(base);
      } else if (piece > 0 || generation < 3) {
        const int sides = generation == 3 ? 4 : 2;
        const double first = random.uniform(0, 2 * M_PI);
        for (int side = 0; side < sides; ++side) {
          const double angle = first + (side + 0.4 * random.uniform()) * 2 * M_PI / sides;
          const dvec3 u = any_normal_to(direction), v = glm::cross(direction, u);
          const dvec3 out = std::cos(angle) * u + std::sin(angle) * v;
          const double spread = random.uniform(0.7, 1.1);
          branch(base,
                 glm::normalize(std::cos(spread) * direction + std::sin(spread) * out + dvec3(0, 0, 0.12)),
                 length * random.uniform(0.5, 0.68), radius * 0.6, generation - 1);
        }
      }
      direction = glm::normalize(direction + 0.16 * random_direction(random) + dvec3(0, 0, 0.08));
    }
    if (generation > 0) tips.push_back(base);
  }
};

}  // namespace

void add_tree(Builder& b, const TreeShape& shape, Finish bark, Finish leaf) {
  Growth growth{b, Random(shape.seed, Stream::layout, 0), bark, {}};
  const double trunk = 0.52 * shape.height;
  b.cone({0, 0, -0.05}, {0, 0, 1}, 0.35, 1.6 * shape.trunk_radius, 1.12 * shape.trunk_radius, bark);
  growth.branch({0, 0, 0.3}, glm::normalize(dvec3(0.03, -0.05, 1)), trunk, 1.12 * shape.trunk_radius, 3);

  // Leaves: clusters around the ends of twigs, kept inside the crown's ellipsoid, tilted like a canopy that
  // seeks the light: partly outwards, partly up.
  const dvec3 crown(0, 0, 0.66 * shape.height);
  const dvec3 half(shape.crown_radius, shape.crown_radius, 0.36 * shape.height);
  for (int i = 0; i < shape.leaves; ++i) {
    Random random(shape.seed, Stream::layout_leaf, std::uint64_t(i));
    dvec3 p(0);
    for (int attempt = 0; attempt < 8; ++attempt) {
      const dvec3 tip = growth.tips[std::size_t(random.uniform() * double(growth.tips.size()))];
      p = tip + shape.cluster_radius * std::cbrt(random.uniform()) * random_direction(random);
      const dvec3 q = (p - crown) / half;
      if (glm::dot(q, q) < 1) break;
    }
    const dvec3 outward = glm::normalize(p - crown + dvec3(0, 0, 1e-9));
    const dvec3 normal = glm::normalize(0.7 * random_direction(random) + 0.5 * outward + dvec3(0, 0, 0.5));
    b.disc(p, normal, shape.leaf_radius * random.uniform(0.7, 1.2), leaf);
  }
}

void add_bush(Builder& b, dvec3 center, dvec3 size, int leaves, double leaf_radius, std::uint64_t seed,
              Finish leaf) {
  for (int i = 0; i < leaves; ++i) {
    Random random(seed, Stream::layout_leaf, std::uint64_t(i));
    const dvec3 direction = random_direction(random);
    const double lumps =
        0.9 + 0.1 * std::sin(5 * direction.x + 3 * direction.z) * std::sin(6 * direction.y + 1);
    const dvec3 p = center + size * direction * lumps * std::pow(random.uniform(0.5, 1), 0.4);
    b.disc(p, glm::normalize(direction / size + 0.6 / size.z * random_direction(random)), leaf_radius, leaf);
  }
}

}  // namespace sfumato::synth
