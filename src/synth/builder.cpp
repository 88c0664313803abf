#include "synth/builder.h"

#include <cmath>

namespace sfumato::synth {

dvec3 any_normal_to(dvec3 axis) {
  return glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(0, 1, 0)));
}

void Builder::place(dvec3 origin, double yaw) {
  origin_ = origin;
  // Right angles stay exact, so that walls meet.
  const double quarter = yaw / (0.5 * M_PI);
  const bool exact = std::abs(quarter - std::round(quarter)) < 1e-9;
  cos_ = exact ? std::round(std::cos(yaw)) : std::cos(yaw);
  sin_ = exact ? std::round(std::sin(yaw)) : std::sin(yaw);
}

dvec3 Builder::turn(dvec3 v) const { return {cos_ * v.x - sin_ * v.y, sin_ * v.x + cos_ * v.y, v.z}; }

Primitive& Builder::add(Primitive p, Finish finish) {
  p.center = to_world(p.center);
  p.x = turn(p.x), p.y = turn(p.y), p.z = turn(p.z);
  p.material = finish.material;
  p.class_id = finish.class_id;
  scene.primitives.push_back(std::move(p));
  return scene.primitives.back();
}

Primitive& Builder::quad(dvec3 center, dvec3 x, dvec3 y, double half_x, double half_y, Finish finish) {
  Primitive p;
  p.shape = Shape::quad;
  p.center = center;
  p.x = x, p.y = y, p.z = glm::cross(x, y);
  p.a = p.c = half_x;
  p.b = half_y;
  return add(p, finish);
}

Primitive& Builder::wall(double x0, double x1, double z0, double z1, double y, int facing, Finish finish,
                         const std::vector<Opening>& openings) {
  const double side = facing > 0 ? -1 : 1, x = 0.5 * (x0 + x1), z = 0.5 * (z0 + z1);
  Primitive& p = quad({x, y, z}, {side, 0, 0}, {0, 0, 1}, 0.5 * (x1 - x0), 0.5 * (z1 - z0), finish);
  for (Opening o : openings) {
    const double left = side * (o.x_min - x), right = side * (o.x_max - x);
    o.x_min = std::min(left, right), o.x_max = std::max(left, right);
    o.y_min -= z, o.y_max -= z;
    p.openings.push_back(o);
  }
  return p;
}

Primitive& Builder::floor(double x0, double x1, double y0, double y1, double z, Finish finish, int facing) {
  return quad({0.5 * (x0 + x1), 0.5 * (y0 + y1), z}, {1, 0, 0}, {0, facing > 0 ? 1.0 : -1.0, 0},
              0.5 * (x1 - x0), 0.5 * (y1 - y0), finish);
}

void Builder::box(dvec3 lo, dvec3 hi, Finish finish) {
  const dvec3 c = 0.5 * (lo + hi), h = 0.5 * (hi - lo), up(0, 0, 1);
  quad({c.x, lo.y, c.z}, {1, 0, 0}, up, h.x, h.z, finish);
  quad({c.x, hi.y, c.z}, {-1, 0, 0}, up, h.x, h.z, finish);
  quad({lo.x, c.y, c.z}, {0, -1, 0}, up, h.y, h.z, finish);
  quad({hi.x, c.y, c.z}, {0, 1, 0}, up, h.y, h.z, finish);
  floor(lo.x, hi.x, lo.y, hi.y, hi.z, finish);
  floor(lo.x, hi.x, lo.y, hi.y, lo.z, finish, -1);
}

Primitive& Builder::sphere(dvec3 center, double radius, Finish finish, double low, double high) {
  Primitive p;
  p.shape = Shape::sphere;
  p.center = center;
  p.a = radius, p.b = low, p.c = high;
  return add(p, finish);
}

Primitive& Builder::torus(dvec3 center, dvec3 axis, double ring, double tube, Finish finish) {
  Primitive p;
  p.shape = Shape::torus;
  p.center = center;
  p.z = axis, p.x = any_normal_to(axis), p.y = glm::cross(p.z, p.x);
  p.a = ring, p.b = tube, p.c = M_PI;
  return add(p, finish);
}

Primitive& Builder::disc(dvec3 center, dvec3 normal, double radius, Finish finish) {
  Primitive p;
  p.shape = Shape::disc;
  p.center = center;
  p.z = normal, p.x = any_normal_to(normal), p.y = glm::cross(p.z, p.x);
  p.a = radius, p.b = 0;
  return add(p, finish);
}

Primitive& Builder::cone(dvec3 base, dvec3 axis, double height, double radius, double top_radius,
                         Finish finish) {
  Primitive p;
  p.shape = Shape::cone;
  p.center = base;
  p.z = axis, p.x = any_normal_to(axis), p.y = glm::cross(p.z, p.x);
  p.a = radius, p.b = top_radius, p.c = height, p.d = M_PI;
  return add(p, finish);
}

void Builder::reveal(const Opening& o, double y, double thickness, Finish finish) {
  const double half = 0.5 * thickness, middle = y + half, height = 0.5 * (o.y_max - o.y_min);
  const double center = 0.5 * (o.x_min + o.x_max), radius = 0.5 * (o.x_max - o.x_min);
  if (height > 0) {
    quad({o.x_min, middle, o.y_min + height}, {0, 1, 0}, {0, 0, 1}, half, height, finish);
    quad({o.x_max, middle, o.y_min + height}, {0, -1, 0}, {0, 0, 1}, half, height, finish);
    floor(o.x_min, o.x_max, y, y + thickness, o.y_min, finish);
  }
  if (!o.arched) {
    floor(o.x_min, o.x_max, y, y + thickness, o.y_max, finish, -1);
    return;
  }
  Primitive& vault = cone({center, y, o.y_max}, {0, 1, 0}, thickness, radius, radius, finish);
  vault.x = dvec3(0, 0, 1);
  vault.y = glm::cross(vault.z, vault.x);
  vault.d = 0.5 * M_PI;
  vault.inward = true;
}

}  // namespace sfumato::synth
