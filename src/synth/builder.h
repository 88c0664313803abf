// Words to build scenes with: everything is placed in a local frame (x along a wall, y into it, z up) that
// can be moved and turned about z.
#pragma once

#include <numbers>

#include "synth/scene.h"

namespace sfumato::synth {

/// Material and class of what is being built.
struct Finish {
  std::uint8_t material = 0;
  std::uint8_t class_id = class_unassigned;
};

class Builder {
 public:
  explicit Builder(std::string name) { scene.name = std::move(name); }

  Scene scene;

  std::uint8_t material(const Material& m) {
    scene.materials.push_back(m);
    return std::uint8_t(scene.materials.size() - 1);
  }

  /// Everything that follows is turned by `yaw` (radians, counter-clockwise) and moved to `origin`.
  void place(dvec3 origin, double yaw = 0);
  dvec3 to_world(dvec3 p) const { return origin_ + turn(p); }

  /// Rectangle with axes `x` and `y` and normal x cross y.
  Primitive& quad(dvec3 center, dvec3 x, dvec3 y, double half_x, double half_y, Finish finish);
  /// Upright wall from (x0, y, z0) to (x1, y, z1), seen from -y; `facing` +1 turns it to +y. Openings are
  /// given in (x, z) of the local frame.
  Primitive& wall(double x0, double x1, double z0, double z1, double y, int facing, Finish finish,
                  const std::vector<Opening>& openings = {});
  /// Horizontal rectangle, seen from above or (facing -1) from below.
  Primitive& floor(double x0, double x1, double y0, double y1, double z, Finish finish, int facing = 1);
  void box(dvec3 lo, dvec3 hi, Finish finish);
  Primitive& sphere(dvec3 center, double radius, Finish finish, double low = -1, double high = 1);
  Primitive& torus(dvec3 center, dvec3 axis, double ring, double tube, Finish finish);
  Primitive& disc(dvec3 center, dvec3 normal, double radius, Finish finish);
  /// Side of a cylinder or cone from `base` along `axis`.
  Primitive& cone(dvec3 base, dvec3 axis, double height, double radius, double top_radius, Finish finish);
  /// Sides and inner roof of an opening that goes from y = 0 through a wall of that thickness.
  void reveal(const Opening& opening, double y, double thickness, Finish finish);

 private:
  dvec3 turn(dvec3 v) const;
  Primitive& add(Primitive p, Finish finish);
  dvec3 origin_{0};
  double cos_ = 1, sin_ = 0;
};

/// A unit vector at right angles to a unit vector.
dvec3 any_normal_to(dvec3 axis);

/// What a tree looks like.
struct TreeShape {
  double height = 6, crown_radius = 2.2, trunk_radius = 0.16, leaf_radius = 0.06;
  double cluster_radius = 0.36;  ///< of the leaves around the end of a twig
  int leaves = 20000;
  std::uint64_t seed = 1;
};
/// A tree with a trunk, three generations of branches and leaves as discs, at the local (0, 0, 0).
void add_tree(Builder& b, const TreeShape& shape, Finish bark, Finish leaf);
/// A ball or cone of leaves: half axes `size`, around `center`.
void add_bush(Builder& b, dvec3 center, dvec3 size, int leaves, double leaf_radius, std::uint64_t seed,
              Finish leaf);

}  // namespace sfumato::synth
