#include "passes/shadows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "gl/context.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

/// Two unit vectors perpendicular to `n` and to each other.
std::pair<dvec3, dvec3> perpendicular(const dvec3& n) {
  const dvec3 other = std::abs(n.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0);
  const dvec3 u = glm::normalize(glm::cross(other, n));
  return {u, glm::cross(n, u)};
}

int map_side(double texels) {
  const int largest = std::min(gl::limits().max_texture_size, 4096);  // 64 MiB of depth and its copy
  return std::clamp(int(std::ceil(texels)), 16, largest);
}

}  // namespace

std::vector<Camera> ShadowMaps::light_cameras(const Light& light, const Bounds& box, double texel) {
  const dvec3 center = box.center();
  const double radius = std::max(0.5 * box.diagonal(), 1e-9);
  Camera camera;
  if (light.kind == Light::Kind::directional) {
    camera.projection = Projection::orthographic;
    camera.position = center + light.vector * (2 * radius);
    camera.target = center;
    camera.up = perpendicular(light.vector).first;
    camera.height_world = 2.02 * radius;
    camera.width = camera.height = map_side(camera.height_world / texel);
    camera.fit_depth_range(box);
    return {camera};
  }
  camera.position = light.vector;
  const double distance = glm::length(center - light.vector);
  // From outside one camera sees the bounding sphere; beyond 120 degrees its texels get too uneven.
  if (distance > radius * 1.155) {
    camera.target = center;
    camera.up = perpendicular((center - light.vector) / distance).first;
    camera.fov_y = 2 * std::asin(radius / distance) * 1.01;
    camera.width = camera.height = map_side(2 * std::tan(0.5 * camera.fov_y) * distance / texel);
    camera.fit_depth_range(box);
    return {camera};
  }
  std::vector<Camera> faces;
  camera.fov_y = glm::radians(90.0);
  camera.width = camera.height = map_side(2 * radius / texel);
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {1.0, -1.0}) {
      dvec3 direction(0), up(0);
      direction[axis] = sign;
      up[(axis + 1) % 3] = 1;
      camera.target = camera.position + direction;
      camera.up = up;
      camera.fit_depth_range(box);
      faces.push_back(camera);
    }
  return faces;
}

std::vector<Light> ShadowMaps::light_samples(const Light& light, const Bounds& box, double size, int count) {
  std::vector<Light> samples{light};
  // A directional light stands at one diagonal from the cloud: its disc turns the direction by size / diagonal.
  const dvec3 towards = light.kind == Light::Kind::directional ? light.vector
                                                                : glm::normalize(light.vector - box.center());
  const auto [u, v] = perpendicular(towards);
  std::mt19937 random(20100501);
  std::uniform_real_distribution<double> uniform(0, 1);
  // Stratified along the radius and turned by the golden angle: even cover of the disc for any count.
  const double turn = uniform(random) * 6.283185307179586;
  for (int i = 1; i < count; ++i) {
    const double r = 0.5 * size * std::sqrt((i + uniform(random) - 0.5) / count), angle = turn + 2.399963229728653 * i;
    const dvec3 offset = u * (r * std::cos(angle)) + v * (r * std::sin(angle));
    Light sample = light;
    if (light.kind == Light::Kind::directional)
      sample.vector = glm::normalize(light.vector + offset / std::max(box.diagonal(), 1e-9));
    else
      sample.vector = light.vector + offset;
    samples.push_back(sample);
  }
  return samples;
}

void ShadowMaps::clear(GpuCloud& cloud) {
  if (cloud.has_shadow()) cloud.set_shadow({});
  key_.clear();
}

void ShadowMaps::update(GpuCloud& cloud, const RenderSettings& settings, const Light& light, gl::Timers& timers,
                        Progress& progress, const View* ground_view, const Ground& ground,
                        gl::Texture* ground_factor) {
  const Bounds box = cloud.bounds();
  const int count = settings.shadows == Shadows::soft ? settings.light_samples : 1;
  const double size = settings.light_size.is_auto() ? 0.1 * box.diagonal() : settings.light_size.value();
  const float d_min =
      settings.shadow_distance.is_auto() ? 3 * cloud.median_spacing() : settings.shadow_distance.value();
  std::string key = std::to_string(int(light.kind)) + "/" + std::to_string(count) + "/" + std::to_string(size) + "/" +
                    std::to_string(d_min) + "/" + std::to_string(reinterpret_cast<std::uintptr_t>(&cloud)) + "/" +
                    std::to_string(cloud.has_normals());
  for (int axis = 0; axis < 3; ++axis) key += "/" + std::to_string(light.vector[axis]);
  // The ground depends on the camera as well, so it is always drawn anew.
  if (key == key_ && cloud.has_shadow() && !ground_view) return;
  key_ = key;

  cloud.begin_shadow();
  if (ground_factor) ground_factor->clear(vec4(0));
  const double texel = texel_spacings * std::max(double(cloud.median_spacing()), 1e-12);
  const std::vector<Light> samples = light_samples(light, box, size, count);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    progress.update(double(i) / double(samples.size()), "shadows");
    progress.check();
    for (const Camera& camera : light_cameras(samples[i], box, texel))
      accumulate(cloud, camera, d_min, 1.0f / float(samples.size()), timers, ground_view, ground, ground_factor);
  }
}

void ShadowMaps::accumulate(GpuCloud& cloud, const Camera& light_camera, float d_min, float share,
                            gl::Timers& timers, const View* ground_view, const Ground& ground,
                            gl::Texture* ground_factor) {
  const dvec3 origin = cloud.prepared().cloud.origin;
  const View view(light_camera, origin);
  {
    auto timing = timers.scope("light map");
    to_pixels_.draw_depth(cloud, view, {SizeMode::pixels, 1}, bits_);
  }
  {
    auto timing = timers.scope("light map fill");
    gl::ensure(map_, "light map", GL_R32F, view.width(), view.height());
    gl::ensure(closed_, "closed light map", GL_R32F, view.width(), view.height());
    if (!decode_) decode_ = ScreenPass("passes/depth_from_bits.glsl", {GL_R32F});
    decode_.run({&bits_}, {&map_});
    if (ground_view) {  // which shows empty texels inside a shadow; points never look into one
      fill_.run(FillKind::background, d_min, map_, closed_);
      std::swap(map_, closed_);
    }
    fill_.run(FillKind::occluded, d_min, map_, closed_);
  }
  auto timing = timers.scope("lit test");
  if (!lit_test_) lit_test_ = gl::Program::compute("passes/lit_test.comp");
  lit_test_.set("d_min", d_min).set("share", share).set("has_normals", cloud.has_normals());
  view.bind();
  closed_.bind(binding::input);
  for (GpuCloud::Chunk& chunk : cloud.chunks()) {
    cloud.bind_geometry(chunk);
    cloud.bind_normals(chunk);
    glBindImageTexture(0, chunk.shadow.texture(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32F);
    const unsigned groups = (chunk.count + 127) / 128;
    lit_test_.set("point_count", chunk.count).dispatch(std::min(groups, 32768u), (groups + 32767) / 32768);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  if (!ground_view || !ground_factor) return;

  if (!ground_pass_) ground_pass_ = ScreenPass("passes/ground_shadow.glsl", {GL_R32F});
  const dmat4 eye_from_cloud = ground_view->eye_from_cloud();
  const dvec3 point(eye_from_cloud * glm::dvec4(ground.point - origin, 1));
  const dvec3 normal(eye_from_cloud * glm::dvec4(ground.normal, 0));
  const Intrinsics k = light_camera.intrinsics();
  ground_pass_.set("plane_eye", vec4(vec3(normal), float(-glm::dot(normal, point))))
      .set("light_from_eye", mat4(view.eye_from_cloud() * glm::inverse(eye_from_cloud)))
      .set("light_intrinsics", vec4(k.fx, k.fy, k.cx, k.cy))
      .set("light_orthographic", light_camera.orthographic())
      .set("d_min", d_min)
      .set("share", share);
  gl::Texture next("ground shadow", GL_R32F, ground_view->width(), ground_view->height());
  ground_view->bind();
  ground_pass_.run({&closed_, ground_factor}, {&next});
  std::swap(next, *ground_factor);
}

}  // namespace sfumato
