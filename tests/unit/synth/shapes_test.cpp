#include "synth/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "synth/scene.h"

using namespace sfumato;
using namespace sfumato::synth;

namespace {

dvec3 random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

Primitive tilted(Shape shape, double a, double b, double c, double d) {
  Primitive p;
  p.shape = shape;
  p.a = a, p.b = b, p.c = c, p.d = d;
  p.center = {0.3, -0.2, 0.1};
  p.z = glm::normalize(dvec3(0.3, -0.5, 0.8));
  p.x = glm::normalize(glm::cross(p.z, dvec3(0, 1, 0)));
  p.y = glm::cross(p.z, p.x);
  return p;
}

/// A surface as the zero of a function and a region, typed independently of the code under test.
struct Implicit {
  Primitive primitive;
  std::function<double(dvec3)> value;
  std::function<bool(dvec3)> inside_region;
};

std::vector<Implicit> implicit_surfaces() {
  const auto anywhere = [](dvec3) { return true; };
  const auto flat = [](dvec3 q) { return q.z; };
  std::vector<Implicit> all;
  all.push_back(
      {tilted(Shape::sphere, 0.8, -1, 1, 0), [](dvec3 q) { return glm::length(q) - 0.8; }, anywhere});
  all.push_back({tilted(Shape::sphere, 0.8, -0.5, 0.25, 0), [](dvec3 q) { return glm::length(q) - 0.8; },
                 [](dvec3 q) { return q.z >= -0.4 && q.z <= 0.2; }});
  all.push_back({tilted(Shape::torus, 0.7, 0.25, M_PI, 0),
                 [](dvec3 q) { return std::hypot(std::hypot(q.x, q.y) - 0.7, q.z) - 0.25; }, anywhere});
  all.push_back({tilted(Shape::torus, 0.7, 0.25, 1.0, 0),
                 [](dvec3 q) { return std::hypot(std::hypot(q.x, q.y) - 0.7, q.z) - 0.25; },
                 [](dvec3 q) { return std::abs(std::atan2(q.y, q.x)) <= 1; }});
  all.push_back({tilted(Shape::cone, 0.6, 0.3, 0.9, M_PI),
                 [](dvec3 q) { return std::hypot(q.x, q.y) - (0.6 - 0.3 * q.z / 0.9); },
                 [](dvec3 q) { return q.z >= 0 && q.z <= 0.9; }});
  all.push_back({tilted(Shape::cone, 0.5, 0.5, 0.9, 2.0), [](dvec3 q) { return std::hypot(q.x, q.y) - 0.5; },
                 [](dvec3 q) { return q.z >= 0 && q.z <= 0.9 && std::abs(std::atan2(q.y, q.x)) <= 2; }});
  all.push_back({tilted(Shape::disc, 0.9, 0.4, 0, 0), flat,
                 [](dvec3 q) { return std::hypot(q.x, q.y) <= 0.9 && std::hypot(q.x, q.y) >= 0.4; }});
  Primitive wall = tilted(Shape::quad, 0.9, 0.7, 0.5, 0);
  wall.openings = {{-0.3, 0.2, -0.7, 0.0, true}};
  all.push_back({wall, flat, [](dvec3 q) {
                   const bool frame = std::abs(q.y) <= 0.7 && std::abs(q.x) <= 0.9 - 0.4 * (q.y + 0.7) / 1.4;
                   const bool door = q.x > -0.3 && q.x < 0.2 && q.y < 0;
                   const bool arch = q.y >= 0 && std::hypot(q.x + 0.05, q.y) < 0.25;
                   return frame && !door && !arch;
                 }});
  return all;
}

TEST(Shapes, CrossingsAreTheZerosFoundByMarching) {
  const double step = 1e-3, reach = 6;
  std::size_t found_in_all = 0;
  for (const Implicit& surface : implicit_surfaces()) {
    const Primitive& p = surface.primitive;
    Random random(5, Stream::area, std::size_t(p.shape));
    for (int trial = 0; trial < 40; ++trial) {
      const dvec3 origin = random_point(random, 2), target = p.center + random_point(random, 0.6);
      const Ray ray{origin, glm::normalize(target - origin)};
      const auto local = [&](double t) { return p.to_local(ray.origin + t * ray.direction - p.center); };
      const Roots roots = crossings(p, ray);
      found_in_all += std::size_t(roots.count);
      for (int i = 0; i < roots.count; ++i) {
        // Double precision: lengths of about 3, a few ulps lost in the quartic's coefficients.
        EXPECT_LT(std::abs(surface.value(local(roots.t[std::size_t(i)]))), 1e-10);
        EXPECT_TRUE(surface.inside_region(local(roots.t[std::size_t(i)])));
      }
      int marched = 0;
      for (double t = -reach; t < reach; t += step) {
        double lo = t, hi = t + step;
        const double f_lo = surface.value(local(lo));
        if ((f_lo < 0) == (surface.value(local(hi)) < 0)) continue;
        for (int k = 0; k < 60; ++k) {
          const double middle = 0.5 * (lo + hi);
          ((surface.value(local(middle)) < 0) == (f_lo < 0) ? lo : hi) = middle;
        }
        if (!surface.inside_region(local(lo))) continue;
        ++marched;
        double nearest = 1e9;
        for (int i = 0; i < roots.count; ++i)
          nearest = std::min(nearest, std::abs(roots.t[std::size_t(i)] - lo));
        // A grazing ray divides the residual of 1e-10 by the sine of its angle.
        EXPECT_LT(nearest, 1e-7) << "shape " << int(p.shape) << " trial " << trial;
      }
      // What marching missed are pairs of crossings closer than its step.
      int close_pairs = 0;
      for (int i = 1; i < roots.count; ++i)
        close_pairs += roots.t[std::size_t(i)] - roots.t[std::size_t(i - 1)] < step;
      EXPECT_GE(marched + 2 * close_pairs, roots.count);
    }
  }
  EXPECT_GT(found_in_all, 200u);
}

TEST(Shapes, PolynomialRootsOfKnownFactors) {
  // (t + 2)(t + 0.5)(t - 0.25)(t - 3) expanded by hand.
  const Roots roots = polynomial_roots({0.75, -1.375, -6.375, -0.75, 1}, 4, -10, 10);
  ASSERT_EQ(roots.count, 4);
  const double expected[] = {-2, -0.5, 0.25, 3};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(roots.t[i], expected[i], 1e-14);
  EXPECT_EQ(polynomial_roots({1, 0, 2, 0, 1}, 4, -10, 10).count, 0);
  EXPECT_EQ(polynomial_roots({0.75, -1.375, -6.375, -0.75, 1}, 4, 0, 1).count, 1);
}

TEST(Shapes, NormalsAreTheGradient) {
  for (const Implicit& surface : implicit_surfaces()) {
    Random random(9, Stream::area, 0);
    for (int i = 0; i < 50; ++i) {
      const SurfacePoint s = sample(surface.primitive, random);
      const double h = 1e-5;
      dvec3 gradient(0);
      for (int axis = 0; axis < 3; ++axis) {
        dvec3 e(0);
        e[axis] = h;
        const auto at = [&](dvec3 q) {
          return surface.value(surface.primitive.to_local(q - surface.primitive.center));
        };
        gradient[axis] = (at(s.position + e) - at(s.position - e)) / (2 * h);
      }
      // Central differences: error h^2 times a third derivative of order 1 / tube radius^2.
      EXPECT_LT(glm::length(glm::normalize(gradient) - s.normal), 1e-7);
    }
  }
}

/// Pearson's statistic for equal expectations; its mean is `cells - 1`, its deviation sqrt(2 (cells - 1)).
double chi_square(const std::vector<int>& cells, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    sum += (cells[i] - expected[i]) * (cells[i] - expected[i]) / expected[i];
  return sum;
}

double chi_square_bound(std::size_t cells) {  // five deviations above the mean
  return double(cells - 1) + 5 * std::sqrt(2 * double(cells - 1));
}

TEST(Shapes, SamplesAreUniformByArea) {
  const int count = 40000, side = 8;
  // Areas of the cells of a grid in (u, v), both in [0, 1), by the surface's own parameters.
  struct Case {
    Primitive primitive;
    std::function<glm::dvec2(dvec3)> parameters;
    std::function<double(double, double)> area_up_to;  // of v alone, as a share
  };
  const auto turn = [](dvec3 q) { return (std::atan2(q.y, q.x) + M_PI) / (2 * M_PI); };
  const std::vector<Case> cases = {
      {tilted(Shape::sphere, 0.8, -1, 1, 0),
       [&](dvec3 q) { return glm::dvec2(turn(q), (q.z / 0.8 + 1) / 2); },
       [](double lo, double hi) { return hi - lo; }},
      {tilted(Shape::torus, 0.7, 0.45, M_PI, 0),
       [&](dvec3 q) {
         return glm::dvec2(turn(q), (std::atan2(q.z, std::hypot(q.x, q.y) - 0.7) + M_PI) / (2 * M_PI));
       },
       [](double lo, double hi) {  // integral of (a + b cos w) over w
         const double w0 = (2 * lo - 1) * M_PI, w1 = (2 * hi - 1) * M_PI;
         return (0.7 * (w1 - w0) + 0.45 * (std::sin(w1) - std::sin(w0))) / (0.7 * 2 * M_PI);
       }},
      {tilted(Shape::cone, 0.6, 0.1, 0.9, M_PI), [&](dvec3 q) { return glm::dvec2(turn(q), q.z / 0.9); },
       [](double lo, double hi) {
         return ((0.6 * hi - 0.25 * hi * hi) - (0.6 * lo - 0.25 * lo * lo)) / 0.35;
       }},
      {tilted(Shape::disc, 0.9, 0, 0, 0),
       [&](dvec3 q) { return glm::dvec2(turn(q), std::hypot(q.x, q.y) / 0.9); },
       [](double lo, double hi) { return hi * hi - lo * lo; }},
  };
  for (const Case& one : cases) {
    std::vector<int> cells(side * side);
    std::vector<double> expected(side * side);
    for (int i = 0; i < count; ++i) {
      Random random(3, Stream::area, std::uint64_t(i));
      const SurfacePoint s = sample(one.primitive, random);
      const glm::dvec2 uv = one.parameters(one.primitive.to_local(s.position - one.primitive.center));
      const int u = std::clamp(int(uv.x * side), 0, side - 1), v = std::clamp(int(uv.y * side), 0, side - 1);
      ++cells[std::size_t(v * side + u)];
    }
    for (int v = 0; v < side; ++v)
      for (int u = 0; u < side; ++u)
        expected[std::size_t(v * side + u)] =
            count * one.area_up_to(double(v) / side, double(v + 1) / side) / side;
    EXPECT_LT(chi_square(cells, expected), chi_square_bound(cells.size())) << int(one.primitive.shape);
  }
}

TEST(Shapes, AreaAgreesWithSampling) {
  // Share of uniform points of the bounding rectangle that a ray through them meets.
  Primitive wall = tilted(Shape::quad, 0.9, 0.7, 0.5, 0);
  wall.openings = {{-0.3, 0.2, -0.7, 0.0, true}, {-0.2, 0.1, 0.3, 0.5, false}};
  Random random(4, Stream::area, 0);
  const int count = 40000;
  int hits = 0;
  for (int i = 0; i < count; ++i) {
    const dvec3 q(random.uniform(-0.9, 0.9), random.uniform(-0.7, 0.7), 1);
    hits += crossings(wall, {wall.center + wall.to_world(q), -wall.z}).count;
  }
  const double share = area(wall) / (1.8 * 1.4);
  EXPECT_NEAR(double(hits) / count, share, 5 * std::sqrt(share * (1 - share) / count));
  EXPECT_NEAR(area(tilted(Shape::torus, 1, 0.45, M_PI, 0)), 4 * M_PI * M_PI * 0.45, 1e-12);
  EXPECT_NEAR(area(tilted(Shape::cone, 0.5, 0, 1.2, M_PI)), M_PI * 0.5 * 1.3, 1e-12);
}

TEST(Shapes, BoundsHoldTheSurface) {
  for (const Implicit& surface : implicit_surfaces()) {
    const Bounds box = bounds(surface.primitive);
    Random random(6, Stream::area, 0);
    for (int i = 0; i < 500; ++i) {
      const dvec3 p = sample(surface.primitive, random).position;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[axis], box.min[axis] - 1e-12);
        EXPECT_LE(p[axis], box.max[axis] + 1e-12);
      }
    }
  }
}

}  // namespace
