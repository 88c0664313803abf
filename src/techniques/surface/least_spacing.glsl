// What is finer than the finest squares is not told apart.
#include "frame.glsl"

float told_apart(float spacing, float depth) { return max(spacing, 1.3 / pixels_at(depth)); }
