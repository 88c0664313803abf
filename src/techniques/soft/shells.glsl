// Nested spheres of the Concentric model (Seemann 2018, Sec. 3.2), i = 0 is the outermost; lengths in radii of the point.
#include "techniques/soft/sphere.glsl"

struct Shells {
  int number;
  float first, step;  // radii are first - i step
  float density;      // optical depth of a chord of length 2 L through one of them is 2 L times this, or over its radius
};

// Eqs. 13 and 15: r_i = r - i r/N, mu = r/N over r_i, Eq. 15 times (1 - d/r_i); these sum up to 2 through the centre,
// so that they are halved.
// `exact`: the steps of N, a real number, that are nearest to the density 1 - R: at R = 1 - (i + 1/2)/N, where that is
// above 0, so that the innermost begins as a point. They are scaled until depth through the centre and mass (the
// integral over the ball) are those of the Base model for every N.
uniform int normalization;
Shells shells_of(float count) {
  if (normalization != 0) return Shells(int(count), 1.0, 1.0 / floor(count), 0.5 / floor(count));
  float m = ceil(count - 0.5), sum = m - 0.5 * m * m / count;  // of the radii before scaling
  float cubes = m - 1.5 * m * m / count + 0.25 * m * (4.0 * m * m - 1.0) / (count * count)
      - 0.125 * m * m * (2.0 * m * m - 1.0) / (count * count * count);
  float scale = sqrt(0.5 * sum / cubes);
  return Shells(int(m), scale * (1.0 - 0.5 / count), scale / count, 0.5 / (scale * sum));
}
float shell_radius(Shells shells, int i) { return shells.first - float(i) * shells.step; }
float shell_density(Shells shells, int i, float delta) {
  if (normalization == 0) return shells.density;
  float radius = shell_radius(shells, i), density = shells.density / radius;
  return normalization == 2 ? density * (1.0 - delta / radius) : density;
}
float chord_through(float radius, float delta) { return sqrt(max(radius * radius - delta * delta, 0.0)); }
float shells_depth(Shells shells, float delta) {
  float depth = 0.0;
  for (int i = 0; i < shells.number && shell_radius(shells, i) > delta; ++i)
    depth += 2.0 * chord_through(shell_radius(shells, i), delta) * shell_density(shells, i, delta);
  return depth;
}
// Where Eq. 22 applies the outermost is as large as the point, as far as its cone reaches.
float drawn_radius(Shells shells, int i, float share) {
  return i == 0 && share < 1.0 ? 1.0 : shell_radius(shells, i);
}
