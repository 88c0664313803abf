#include "passes/shade.h"

#include <string>
#include <utility>

#include "gl/pace.h"
#include "gl/preferences.h"
#include "passes/finish_cpu.h"

namespace sfumato {

vec4 light_in_eye(const View& view, const Light& light, const dvec3& cloud_origin) {
  if (light.kind == Light::Kind::point)
    return view.eye_from_cloud() * glm::dvec4(light.vector - cloud_origin, 1);
  if (light.kind == Light::Kind::directional) return view.eye_from_cloud() * glm::dvec4(light.vector, 0);
  if (light.kind == Light::Kind::shoulder) return vec4(over_shoulder, -1);
  return view.camera().orthographic() ? vec4(0, 0, 1, 0) : vec4(0, 0, 0, 1);
}

void set_light_uniforms(gl::Program& program, const View& view, const RenderSettings& settings,
                        const Light& light, const dvec3& cloud_origin) {
  program.set("light_eye", light_in_eye(view, light, cloud_origin));
  const Phong& phong = settings.phong;
  program.set("phong",
              vec4(phong.ambient.value(), phong.diffuse.value(), phong.specular.value(), phong.shininess));
  if (!program.has("palette_size")) return;
  program.set("palette_size", int(settings.palette.size()))
      .set("palette", std::span<const vec3>(settings.palette));
}

void Shade::run(const View& view, const RenderSettings& settings, const Light& light,
                const dvec3& cloud_origin, const Surface& surface, gl::Texture& color) {
  if (gl::place_of_work(gl::preferences().finish) == gl::Place::cpu) {
    gl::end_stretch();
    Image<vec4> out = color.blank<vec4>();
    shade(view, settings, light_in_eye(view, light, cloud_origin), surface.albedo.peek<vec4>(),
          surface.depth.peek<float>(), surface.normal.peek<vec4>(), out);
    color.give(std::move(out));
    return;
  }
  const int shading = int(settings.shading);
  ScreenPass& pass = passes_[shading];
  if (!pass) pass = ScreenPass("passes/shade.glsl", {GL_RGBA32F}, {"SHADING " + std::to_string(shading)});
  view.bind();
  set_light_uniforms(pass.program(), view, settings, light, cloud_origin);
  pass.run({&surface.albedo, &surface.depth, &surface.normal}, {&color});
}

}  // namespace sfumato
