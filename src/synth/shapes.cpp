#include "synth/shapes.h"

#include <algorithm>
#include <cmath>

namespace sfumato::synth {
namespace {

bool within_angle(double x, double y, double limit) {
  return limit >= M_PI || std::abs(std::atan2(y, x)) <= limit;
}

double half_width(const Primitive& p, double y) { return p.a + (p.c - p.a) * (y + p.b) / (2 * p.b); }

bool on_quad(const Primitive& p, dvec2 q) {
  if (std::abs(q.y) > p.b || std::abs(q.x) > half_width(p, q.y)) return false;
  return std::none_of(p.openings.begin(), p.openings.end(), [q](const Opening& o) { return o.contains(q); });
}

void flat_crossing(const Primitive& p, dvec3 o, dvec3 d, Roots& roots) {
  if (d.z == 0) return;
  const double t = -o.z / d.z;
  const dvec2 q(o.x + t * d.x, o.y + t * d.y);
  const double r2 = glm::dot(q, q);
  if (p.shape == Shape::quad ? on_quad(p, q) : r2 <= p.a * p.a && r2 >= p.b * p.b) roots.add(t);
}

/// Both roots of a t^2 + 2 b t + c without cancellation (Numerical Recipes, Sec. 5.6), ascending.
Roots quadratic(double a, double b, double c) {
  Roots roots;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0) return roots;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (a == 0) {
    roots.add(c / q);
    return roots;
  }
  const double t0 = q / a, t1 = c / q;
  roots.add(std::min(t0, t1));
  roots.add(std::max(t0, t1));
  return roots;
}

void sphere_crossings(const Primitive& p, dvec3 o, dvec3 d, Roots& roots) {
  const Roots both = quadratic(1, glm::dot(o, d), glm::dot(o, o) - p.a * p.a);
  for (int i = 0; i < both.count; ++i) {
    const double height = (o.z + both.t[std::size_t(i)] * d.z) / p.a;
    if (height >= p.b && height <= p.c) roots.add(both.t[std::size_t(i)]);
  }
}

void cone_crossings(const Primitive& p, dvec3 o, dvec3 d, Roots& roots) {
  // x^2 + y^2 = (a + k z)^2
  const double k = (p.b - p.a) / p.c, radius = p.a + k * o.z;
  const Roots both =
      quadratic(d.x * d.x + d.y * d.y - k * k * d.z * d.z, o.x * d.x + o.y * d.y - k * radius * d.z,
                o.x * o.x + o.y * o.y - radius * radius);
  for (int i = 0; i < both.count; ++i) {
    const dvec3 q = o + both.t[std::size_t(i)] * d;
    if (q.z >= 0 && q.z <= p.c && within_angle(q.x, q.y, p.d)) roots.add(both.t[std::size_t(i)]);
  }
}

void torus_crossings(const Primitive& p, dvec3 o, dvec3 d, Roots& roots) {
  // Measured from the point of the ray nearest to the centre, so that coefficients stay of the torus' size.
  const double nearest = -glm::dot(o, d), reach2 = (p.a + p.b) * (p.a + p.b);
  const dvec3 m = o + nearest * d;
  const double m2 = glm::dot(m, m);
  if (m2 >= reach2) return;
  // (|q|^2 + a^2 - b^2)^2 = 4 a^2 (x^2 + y^2) with q = m + t d and m.d = 0
  const double g = m2 + p.a * p.a - p.b * p.b, a4 = 4 * p.a * p.a;
  const std::array<double, 5> c = {g * g - a4 * (m.x * m.x + m.y * m.y), -2 * a4 * (m.x * d.x + m.y * d.y),
                                   2 * g - a4 * (d.x * d.x + d.y * d.y), 0, 1};
  const double reach = 1.001 * std::sqrt(reach2 - m2);
  const Roots all = polynomial_roots(c, 4, -reach, reach);
  for (int i = 0; i < all.count; ++i) {
    const dvec3 q = m + all.t[std::size_t(i)] * d;
    if (within_angle(q.x, q.y, p.c)) roots.add(nearest + all.t[std::size_t(i)]);
  }
}

double quad_frame_area(const Primitive& p) { return 2 * p.b * (p.a + p.c); }

}  // namespace

bool Opening::contains(dvec2 p) const {
  if (p.x <= x_min || p.x >= x_max || p.y <= y_min) return false;
  if (p.y < y_max) return true;
  if (!arched) return false;
  const double radius = 0.5 * (x_max - x_min), dx = p.x - 0.5 * (x_min + x_max), dy = p.y - y_max;
  return dx * dx + dy * dy < radius * radius;
}

double Opening::area() const {
  const double radius = 0.5 * (x_max - x_min);
  return (x_max - x_min) * (y_max - y_min) + (arched ? 0.5 * M_PI * radius * radius : 0);
}

Roots crossings(const Primitive& p, const Ray& ray) {
  Roots roots;
  const dvec3 o = p.to_local(ray.origin - p.center), d = p.to_local(ray.direction);
  switch (p.shape) {
    case Shape::quad:
    case Shape::disc: flat_crossing(p, o, d, roots); break;
    case Shape::sphere: sphere_crossings(p, o, d, roots); break;
    case Shape::torus: torus_crossings(p, o, d, roots); break;
    case Shape::cone: cone_crossings(p, o, d, roots); break;
  }
  return roots;
}

double area(const Primitive& p) {
  switch (p.shape) {
    case Shape::quad: {
      double sum = quad_frame_area(p);
      for (const Opening& opening : p.openings) sum -= opening.area();
      return sum;
    }
    case Shape::disc: return M_PI * (p.a * p.a - p.b * p.b);
    case Shape::sphere: return 2 * M_PI * p.a * p.a * (p.c - p.b);
    case Shape::torus: return 4 * M_PI * p.a * p.b * p.c;
    case Shape::cone: return p.d * (p.a + p.b) * std::hypot(p.c, p.b - p.a);
  }
  return 0;
}

SurfacePoint sample(const Primitive& p, Random& random) {
  dvec3 q(0);
  switch (p.shape) {
    case Shape::quad: {
      const double widest = std::max(p.a, p.c);
      do {
        q.x = random.uniform(-widest, widest);
        q.y = random.uniform(-p.b, p.b);
      } while (!on_quad(p, dvec2(q)));
      break;
    }
    case Shape::disc: {
      const double radius = std::sqrt(random.uniform(p.b * p.b, p.a * p.a)),
                   angle = random.uniform(0, 2 * M_PI);
      q = dvec3(radius * std::cos(angle), radius * std::sin(angle), 0);
      break;
    }
    case Shape::sphere: {  // equal heights have equal areas (Archimedes)
      const double height = random.uniform(p.b, p.c), ring = std::sqrt(std::max(0.0, 1 - height * height));
      const double angle = random.uniform(0, 2 * M_PI);
      q = p.a * dvec3(ring * std::cos(angle), ring * std::sin(angle), height);
      break;
    }
    case Shape::torus: {
      const double ring = random.uniform(-p.c, p.c);
      double tube;
      do tube = random.uniform(0, 2 * M_PI);
      while (random.uniform() > (p.a + p.b * std::cos(tube)) / (p.a + p.b));
      const double radius = p.a + p.b * std::cos(tube);
      q = dvec3(radius * std::cos(ring), radius * std::sin(ring), p.b * std::sin(tube));
      break;
    }
    case Shape::cone: {
      // Area grows linearly with the radius along the side: invert its integral.
      const double radius = std::sqrt(p.a * p.a + (p.b * p.b - p.a * p.a) * random.uniform());
      const double along = p.a == p.b ? random.uniform() : (radius - p.a) / (p.b - p.a);
      const double angle = random.uniform(-p.d, p.d);
      q = dvec3(radius * std::cos(angle), radius * std::sin(angle), along * p.c);
      break;
    }
  }
  return describe_point(p, p.center + p.to_world(q));
}

SurfacePoint describe_point(const Primitive& p, dvec3 position) {
  SurfacePoint s;
  s.position = position;
  const dvec3 q = p.to_local(position - p.center);
  dvec3 normal(0, 0, 1);
  switch (p.shape) {
    case Shape::quad:
    case Shape::disc:
      // Coordinates continue from one panel of a wall to the next.
      s.uv = dvec2(glm::dot(position, p.x), glm::dot(position, p.y));
      break;
    case Shape::sphere:
      normal = q / p.a;
      s.uv = p.a * dvec2(std::atan2(q.y, q.x), std::asin(std::clamp(q.z / p.a, -1.0, 1.0)));
      break;
    case Shape::torus: {
      const double ring = std::hypot(q.x, q.y);
      normal = dvec3(q.x - p.a * q.x / ring, q.y - p.a * q.y / ring, q.z) / p.b;
      s.uv = dvec2(p.a * std::atan2(q.y, q.x), p.b * std::atan2(q.z, ring - p.a));
      break;
    }
    case Shape::cone: {
      const double ring = std::max(std::hypot(q.x, q.y), 1e-300), slope = (p.a - p.b) / p.c;
      normal = dvec3(q.x / ring, q.y / ring, slope);
      s.uv = dvec2(0.5 * (p.a + p.b) * std::atan2(q.y, q.x), q.z);
      break;
    }
  }
  s.normal = glm::normalize(p.to_world(normal)) * (p.inward ? -1.0 : 1.0);
  return s;
}

Bounds bounds(const Primitive& p) {
  // Half extents of the solid's box in its own frame, then the box of that box.
  dvec3 lo(-p.a), hi(p.a);
  switch (p.shape) {
    case Shape::quad: hi = dvec3(std::max(p.a, p.c), p.b, 0), lo = -hi; break;
    case Shape::disc: lo.z = hi.z = 0; break;
    case Shape::sphere: lo.z = p.a * p.b, hi.z = p.a * p.c; break;
    case Shape::torus: hi = dvec3(p.a + p.b, p.a + p.b, p.b), lo = -hi; break;
    case Shape::cone: {
      const double widest = std::max(p.a, p.b);
      lo = dvec3(-widest, -widest, 0), hi = dvec3(widest, widest, p.c);
      break;
    }
  }
  const dvec3 middle = p.center + p.to_world(0.5 * (lo + hi)), half = 0.5 * (hi - lo);
  const dvec3 reach = glm::abs(p.x) * half.x + glm::abs(p.y) * half.y + glm::abs(p.z) * half.z;
  return {middle - reach, middle + reach};
}

}  // namespace sfumato::synth
