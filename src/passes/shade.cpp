#include "passes/shade.h"

#include <string>

namespace sfumato {

void set_light_uniforms(gl::Program& program, const View& view, const RenderSettings& settings,
                        const Light& light, const dvec3& cloud_origin) {
  // As shaders/lighting.glsl has it.
  vec4 light_eye(0, 0, 0, 1);
  if (light.kind == Light::Kind::point)
    light_eye = vec4(view.eye_from_cloud() * glm::dvec4(light.vector - cloud_origin, 1));
  else if (light.kind == Light::Kind::directional)
    light_eye = vec4(view.eye_from_cloud() * glm::dvec4(light.vector, 0));
  else if (light.kind == Light::Kind::shoulder)
    light_eye = vec4(over_shoulder, -1);
  else if (view.camera().orthographic())
    light_eye = vec4(0, 0, 1, 0);
  program.set("light_eye", light_eye);
  const Phong& phong = settings.phong;
  program.set("phong",
              vec4(phong.ambient.value(), phong.diffuse.value(), phong.specular.value(), phong.shininess));
  if (!program.has("palette_size")) return;
  program.set("palette_size", int(settings.palette.size()))
      .set("palette", std::span<const vec3>(settings.palette));
}

void Shade::run(const View& view, const RenderSettings& settings, const Light& light,
                const dvec3& cloud_origin, const Surface& surface, const gl::Texture& color) {
  const int shading = int(settings.shading);
  ScreenPass& pass = passes_[shading];
  if (!pass) pass = ScreenPass("passes/shade.glsl", {GL_RGBA32F}, {"SHADING " + std::to_string(shading)});
  view.bind();
  set_light_uniforms(pass.program(), view, settings, light, cloud_origin);
  pass.run({&surface.albedo, &surface.depth, &surface.normal}, {&color});
}

}  // namespace sfumato
