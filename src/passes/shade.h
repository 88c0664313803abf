// Deferred shading shared by every technique: Phong with the per-point shadow factor.
#pragma once

#include <map>

#include "gl/texture.h"
#include "passes/light.h"
#include "passes/screen_pass.h"
#include "passes/view.h"

namespace sfumato {

/// What a pass leaves behind for shading, all of one size.
struct Surface {
  const gl::Texture& albedo;  ///< RGBA32F: linear colour premultiplied by coverage, coverage in alpha
  const gl::Texture& depth;   ///< R32F: eye depth, +inf where nothing
  const gl::Texture&
      normal;  ///< RGBA32F: world normal or 0 (then the light falls straight on); w = shadow factor m
};

/// As shaders/lighting.glsl has it.
vec4 light_in_eye(const View& view, const Light& light, const dvec3& cloud_origin);

/// Sets the uniforms of shaders/lighting.glsl (`light_eye`, `phong`) and shaders/shading.glsl (`palette`) for
/// a program that lights points itself.
void set_light_uniforms(gl::Program& program, const View& view, const RenderSettings& settings,
                        const Light& light, const dvec3& cloud_origin);

/// By the processor where OpenGL is software.
class Shade {
 public:
  /// Writes the shaded colour, premultiplied, into `color` (RGBA32F).
  void run(const View& view, const RenderSettings& settings, const Light& light, const dvec3& cloud_origin,
           const Surface& surface, gl::Texture& color);

 private:
  std::map<int, ScreenPass> passes_;  ///< by shading
};

}  // namespace sfumato
