#include "passes/evidence.h"

#include <cmath>

#include "gl/preferences.h"
#include "passes/evidence_cpu.h"
#include "passes/view.h"

namespace sfumato {

namespace {

/// An empty disc that reaches a pixel has its centre as far away, and no point within as far again.
int band_of(const EvidenceReach& reach) { return 2 * int(std::ceil(reach.between)); }

}  // namespace

const gl::Texture& Evidence::find(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                                  const EvidenceReach& reach, gl::Timers& timers) {
  auto timing = timers.scope("evidence");
  const View wide(camera.with_guard_band(band_of(reach)), origin);
  if (const auto* here = to_pixels_.depth_here(cloud, wide, {SizeMode::pixels, 1}))
    return find(*here, camera.width, camera.height, reach);
  const gl::Texture& bits = draw_points(cloud, camera, origin, reach);
  return find(bits, band_of(reach), camera.width, camera.height, reach);
}

const gl::Texture& Evidence::draw_points(GpuCloud& cloud, const Camera& camera, const dvec3& origin,
                                         const EvidenceReach& reach) {
  const View wide(camera.with_guard_band(band_of(reach)), origin);
  to_pixels_.draw_depth(cloud, wide, {SizeMode::pixels, 1}, bits_);
  return bits_;
}

const gl::Texture& Evidence::find(const Image<std::uint32_t>& depth_bits, int width, int height,
                                  const EvidenceReach& reach) {
  if (gl::place_of_work(gl::preferences().evidence) == gl::Place::cpu) {
    gl::ensure(mask_, "evidence", GL_R8, width, height);
    mask_.upload(evidence_by_rows(depth_bits, band_of(reach), width, height, reach));
    return mask_;
  }
  gl::ensure(bits_, "depth bits", GL_R32UI, depth_bits.width(), depth_bits.height());
  bits_.upload(depth_bits);
  return find(bits_, band_of(reach), width, height, reach);
}

const gl::Texture& Evidence::find(const gl::Texture& depth_bits, int band, int width, int height,
                                  const EvidenceReach& reach) {
  gl::ensure(mask_, "evidence", GL_R8, width, height);
  if (gl::place_of_work(gl::preferences().evidence) == gl::Place::cpu) {
    mask_.upload(evidence_by_rows(depth_bits.download<std::uint32_t>(), band, width, height, reach));
    return mask_;
  }
  gl::ensure(along_rows_, "distances along rows", GL_R32F, depth_bits.width(), depth_bits.height());
  gl::ensure(distance_, "distance to points", GL_R32F, depth_bits.width(), depth_bits.height());
  const auto make = [](ScreenPass& pass, const char* step, GLenum format) -> ScreenPass& {
    if (!pass) pass = ScreenPass("passes/evidence.glsl", {format}, {step});
    return pass;
  };
  make(rows_, "ROWS", GL_R32F).set("between", reach.between).run({&depth_bits}, {&along_rows_});
  make(columns_, "COLUMNS", GL_R32F).set("between", reach.between).run({&along_rows_}, {&distance_});
  make(open_rows_, "OPEN_ROWS", GL_R32F).set("between", reach.between).run({&distance_}, {&along_rows_});
  make(surrounded_, "SURROUNDED", GL_R8).set("between", reach.between).set("beside", reach.beside);
  surrounded_.set("band", band).run({&distance_, &along_rows_}, {&mask_});
  return mask_;
}

void Evidence::apply(const gl::Texture& albedo, const gl::Texture& depth, const gl::Texture& normal) {
  if (!apply_) apply_ = ScreenPass("passes/evidence_apply.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F});
  apply_.run({&mask_}, {&albedo, &depth, &normal});
}

}  // namespace sfumato
