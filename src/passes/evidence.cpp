#include "passes/evidence.h"

#include <utility>

#include "gl/commands.h"
#include "gl/pace.h"
#include "gl/preferences.h"
#include "passes/bindings.h"
#include "passes/evidence_cpu.h"
#include "passes/view.h"

namespace sfumato {

const gl::Texture& Evidence::find(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                                  const EvidenceReach& reach, gl::Timers& timers) {
  auto timing = timers.scope("evidence");
  const View wide(camera.with_guard_band(reach.band()), origin);
  if (const auto* here = to_pixels_.depth_here(cloud, wide, {SizeMode::pixels, 1}))
    return find(*here, camera.width, camera.height, reach);
  const gl::Texture& bits = draw_points(cloud, camera, origin, reach);
  return find(bits, reach.band(), camera.width, camera.height, reach);
}

const gl::Texture& Evidence::draw_points(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                                         const EvidenceReach& reach) {
  const View wide(camera.with_guard_band(reach.band()), origin);
  to_pixels_.draw_depth(cloud, wide, {SizeMode::pixels, 1}, bits_);
  return bits_;
}

const gl::Texture& Evidence::find(const Image<std::uint32_t>& depth_bits, int width, int height,
                                  const EvidenceReach& reach) {
  if (gl::place_of_work(gl::preferences().evidence) == gl::Place::cpu) {
    gl::ensure(mask_, "evidence", GL_R8, width, height);
    mask_.give(evidence_mask(depth_bits, reach.band(), width, height, reach));
    return mask_;
  }
  gl::ensure(bits_, "depth bits", GL_R32UI, depth_bits.width(), depth_bits.height());
  bits_.upload(depth_bits);
  return find(bits_, reach.band(), width, height, reach);
}

const gl::Texture& Evidence::find(const gl::Texture& depth_bits, int band, int width, int height,
                                  const EvidenceReach& reach) {
  gl::ensure(mask_, "evidence", GL_R8, width, height);
  if (gl::place_of_work(gl::preferences().evidence) == gl::Place::cpu) {
    mask_.give(evidence_mask(depth_bits.peek<std::uint32_t>(), band, width, height, reach));
    return mask_;
  }
  const int wide = depth_bits.width(), high = depth_bits.height();
  gl::ensure(along_rows_, "distances along rows", GL_RG32F, wide, high);
  gl::ensure(nearest_, "nearest points", GL_R32UI, wide, high);
  gl::ensure(shape_, "complex of points", GL_R32UI, wide, high);
  const auto make = [](ScreenPass& pass, const char* step, GLenum format) -> ScreenPass& {
    if (!pass) pass = ScreenPass("passes/evidence.glsl", {format}, {step});
    return pass;
  };
  const vec2 to_circle(float(reach.to_circle())), to_shape(reach.beside, reach.around);
  make(rows_, "ROWS", GL_RG32F).set("reach", to_circle).run({&depth_bits}, {&along_rows_});
  make(nearest_of_rows_, "NEAREST", GL_R32UI).set("reach", to_circle).run({&along_rows_}, {&nearest_});

  if (!draw_shape_) draw_shape_ = gl::Program::compute("passes/evidence_shape.comp");
  shape_.clear_uint(0);
  nearest_.bind(binding::input);
  shape_.bind_image(0, GL_READ_WRITE);
  draw_shape_.set("radius", reach.between).dispatch(unsigned(wide + 15) / 16, unsigned(high + 7) / 8);
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);

  make(rows_of_shape_, "ROWS_OF_SHAPE", GL_RG32F).set("reach", to_shape).run({&shape_}, {&along_rows_});
  make(widened_, "WIDENED", GL_R8).set("reach", to_shape).set("between", reach.between);
  widened_.set("band", band).run({&along_rows_, &nearest_}, {&mask_});
  return mask_;
}

void Evidence::apply(gl::Texture& albedo, gl::Texture& depth, gl::Texture& normal) {
  if (gl::place_of_work(gl::preferences().evidence) == gl::Place::cpu) {
    gl::end_stretch();
    Image<vec4> colors = albedo.take<vec4>(), normals = normal.take<vec4>();
    Image<float> depths = depth.take<float>();
    apply_evidence(mask_.peek<std::uint8_t>(), colors, depths, normals);
    albedo.give(std::move(colors)), depth.give(std::move(depths)), normal.give(std::move(normals));
    return;
  }
  if (!apply_) apply_ = ScreenPass("passes/evidence_apply.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
  apply_.run({&mask_}, {&albedo, &depth, &normal});
}

}  // namespace sfumato
