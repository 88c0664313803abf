// How far behind a hit others still count as the same surface: at least `shift`, scene units along the ray, or so many
// radii of the splat that was hit. 0 leaves it to the readers.
uniform float shift;
uniform float shift_radii;

float splat_shift(float radius) { return max(shift, shift_radii * radius); }
