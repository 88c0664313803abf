// Pixels around one of a layer. Include after `depth_image`.

// Beyond the border the border goes on: it is empty, or farther out than the picture's operators look
// (ScreenExtent).
ivec2 clamped(ivec2 at) { return clamp(at, ivec2(0), textureSize(depth_image, 0) - 1); }
float depth_at(ivec2 at) { return texelFetch(depth_image, clamped(at), 0).x; }

const ivec2 cross_of_four[4] = ivec2[4](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
