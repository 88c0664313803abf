// The disc that each cluster stands for: the plane of least squares through the clusters within a ball around it, and
// a radius that closes the surface. Where the points of the ball lie on a line, and where noise tilts the plane, the ball
// grows.
#include "techniques/surface/ball.glsl"
#include "techniques/surface/eigen.glsl"
#include "techniques/surface/least_spacing.glsl"

uniform float normal_scale;  // radius of the ball, point spacings
uniform float noise;         // of the points, scene units
uniform vec4 balls_of_noise; // Discs: little noise, deviations, most of noise, grown
uniform float disc_scale;    // radius of a disc, point spacings
uniform float gap_scale;     // how far apart points of one surface may be, point spacings

const float most_tilt = 0.0175;      // 1 degree, root mean square
// Noise is as thick in a ball of twice the size, an edge twice, a bend four times (analysis/surface_noise.h).
const float as_thick = 1.4142136;
const float lone_scale = 0.3;        // of a disc without a plane over one with
uniform float widest_px;     // radius of the widest disc; of what would be wider nothing but a dot remains
const float fill_scale = 0.8;        // as in disc.glsl
const float rim_scale = 0.65;        // of a disc that is seen edge-on over one that is not

bool filter_pixel(ivec2 pixel) {
  out_0 = vec4(0.0);
  out_1 = vec4(0.0);
  vec4 own = texelFetch(clusters, pixel, 0);
  if (own.w <= 0.0) return true;
  float spacing = told_apart(texelFetch(about, pixel, 0).x, -own.z);
  vec3 toward = to_camera(own.xyz), normal = toward;
  float radius = 0.0, reach = normal_scale * spacing, widest = reach;
  if (noise > balls_of_noise.x * spacing) {
    reach = clamp(balls_of_noise.y * noise, reach, balls_of_noise.z * reach);
    widest = balls_of_noise.w * reach;
  }
  Fit fit;
  bool found = false;
  float thickness = 0.0;
  vec3 values;
  // Coarsely; where that finds no plane or a steep one, finely; then in a ball of twice the size. Nothing is finer than
  // the finest squares.
  bool is_fine = window_around(own.xyz, reach, 4.5).side == window_around(own.xyz, reach, 6.0).side;
  for (int attempt = is_fine ? 1 : 0; attempt < 3 && !found; ++attempt) {
    if (attempt == 2) reach *= 2.0;
    fit = gather(window_around(own.xyz, reach, attempt == 0 ? 4.5 : 6.0));
    values = eigenvalues(fit.scatter);
    if (fit.neighbors < 5 || values.y < 0.06 * values.z) continue;
    if (attempt == 2 && length(fit.mean) > 0.25) break;  // nothing but the rim of a surface beside it
    normal = eigenvector(fit.scatter, values.x);
    if (attempt == 0 && abs(dot(normal, toward)) < 0.5) continue;
    found = true;
    thickness = values.x / values.y;
    // Mean of (1 - d^2)^2 over a disc: a third. 1 / s^2 points on a unit of area.
    float measured = clamp(reach * sqrt(1.0471976 / fit.support), 0.5 * spacing, 2.0 * spacing);
    radius = disc_scale * measured * mix(1.0, 0.8, smoothstep(0.1, 0.4, thickness));
  }
  // Each axis of a plane of least squares tilts by the variance of the residuals over that of the places times their
  // number: weights of (1 - d^2)^2 make 5/6 of what there is, three times the sum of the weights.
  if (!found) values = vec3(0.0, 1.0, 1.0);
  float support = fit.support, wide_reach = reach;
  while (2.0 * wide_reach <= 1.01 * widest &&
         values.x * (1.0 / values.y + 1.0 / values.z) > most_tilt * most_tilt * 2.5 * support) {
    wide_reach *= 2.0;
    Fit wider = gather(window_around(own.xyz, wide_reach, 4.5));
    vec3 of_wider = eigenvalues(wider.scatter);
    if (of_wider.y < 0.06 * of_wider.z || 4.0 * of_wider.x > as_thick * as_thick * values.x) break;
    normal = eigenvector(wider.scatter, of_wider.x);
    values = of_wider;
    support = wider.support;
  }
  if (!found && !fit.behind) radius = lone_scale * disc_scale * spacing;
  if (dot(normal, toward) < 0.0) normal = -normal;

  // The surface ends where all neighbours are on one side, and where it turns away from the camera.
  float filled = min(spacing, widest_px / (fill_scale * pixels_at(-own.z)));  // disc.vert
  out_1 = vec4(0.0, 0.0, infinity, found ? filled : -radius);
  bool tilted = dot(normal, toward) < 0.7;
  if (found && (tilted || bitCount(fit.octants) < 7 || length(fit.mean) > 0.15)) {
    float scale = pixels_at(-own.z);
    vec2 outwards = pixel_from_eye(own.xyz + (tilted ? normal : -fit.mean) * spacing) - pixel_from_eye(own.xyz);
    outwards /= max(length(outwards), 1e-6);
    Window wide = window_around(own.xyz, max(reach, gap_scale * spacing), 6.0);
    Surroundings around = look_around(wide, normal, outwards, spacing * scale, spacing);
    if (thickness < 0.1) radius = max(radius, 0.52 * around.gap);
    if (length(fit.mean) > 0.05) radius *= mix(rim_scale, 1.0, smoothstep(0.3, 0.8, dot(normal, toward)));
    if (around.end < max(radius * scale, 1.0) && (tilted || length(fit.mean) > 0.1)) {
      out_1 = vec4(outwards, around.end, filled);
    }
  }
  float wider = radius * pixels_at(-own.z) / widest_px;
  if (wider > 1.0) radius *= min(1.0, max(2.0 / wider, 0.5)) / wider;
  out_0 = vec4(normal, max(radius, 0.01 * spacing));
  return true;
}
