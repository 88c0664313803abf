// What a fragment of a soft point knows (sphere.vert).
#include "techniques/soft/sphere.glsl"

layout(binding = UNIT_INPUT + 2) uniform sampler2D solid_t_image;  // ray distance of the first solid hit, or infinity

flat in vec4 soft_shape;
flat in vec4 soft_color;
flat in vec2 soft_share;  // share and cone of Eq. 22
flat in float soft_shells;
flat in int soft_slot;

float solid_t() { return texelFetch(solid_t_image, ivec2(gl_FragCoord.xy), 0).x; }
