// Roots of a quartic by nested derivatives: between two neighbouring roots of the derivative a polynomial is
// monotone, so that a bracketed Newton iteration finds the one root there or proves that there is none.
// Slower than Ferrari's formula and without its cancellation.
#include <algorithm>
#include <cmath>

#include "synth/shapes.h"

namespace sfumato::synth {
namespace {

double evaluate(const std::array<double, 5>& c, int degree, double t) {
  double sum = c[std::size_t(degree)];
  for (int i = degree - 1; i >= 0; --i) sum = sum * t + c[std::size_t(i)];
  return sum;
}

double root_between(const std::array<double, 5>& c, int degree, double lo, double hi, double f_lo) {
  double t = 0.5 * (lo + hi);
  for (int step = 0; step < 100; ++step) {
    double f = c[std::size_t(degree)], slope = 0;
    for (int i = degree - 1; i >= 0; --i) {
      slope = slope * t + f;
      f = f * t + c[std::size_t(i)];
    }
    if (f == 0) return t;
    ((f < 0) == (f_lo < 0) ? lo : hi) = t;
    double next = t - f / slope;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::abs(next - t) <= 1e-15 * (std::abs(t) + 1e-3)) return next;
    t = next;
  }
  return t;
}

}  // namespace

Roots polynomial_roots(const std::array<double, 5>& c, int degree, double lo, double hi) {
  Roots roots;
  while (degree > 0 && c[std::size_t(degree)] == 0) --degree;
  if (degree == 0) return roots;
  if (degree == 1) {
    const double t = -c[0] / c[1];
    if (t >= lo && t <= hi) roots.add(t);
    return roots;
  }
  std::array<double, 5> derivative{};
  for (int i = 1; i <= degree; ++i) derivative[std::size_t(i - 1)] = i * c[std::size_t(i)];
  const Roots turns = polynomial_roots(derivative, degree - 1, lo, hi);
  double left = lo, f_left = evaluate(c, degree, lo);
  for (int i = 0; i <= turns.count; ++i) {
    const double right = i < turns.count ? turns.t[std::size_t(i)] : hi;
    const double f_right = evaluate(c, degree, right);
    if ((f_left < 0) != (f_right < 0) && roots.count < 4)
      roots.add(root_between(c, degree, left, right, f_left));
    left = right;
    f_left = f_right;
  }
  return roots;
}

}  // namespace sfumato::synth
