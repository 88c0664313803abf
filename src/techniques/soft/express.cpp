#include "techniques/soft/express.h"

#include <algorithm>
#include <cmath>

#include "gl/commands.h"

namespace sfumato::soft {

vec3 axis_shares(const dvec3& direction) {
  // Squared, so that a share leaves 0 without a step. With this band one degree changes a share by at most
  // 0.12 (found by going over all directions).
  constexpr double band = 0.16;
  const dvec3 size = glm::abs(direction);
  const double most = std::max({size.x, size.y, size.z});
  dvec3 shares = glm::max(size - (most - band), dvec3(0));
  shares *= shares;
  return vec3(shares / (shares.x + shares.y + shares.z));
}

void Express::blend(SoftPoints& points, const Order& order, const View& view, const gl::Texture& solid_t,
                    gl::Texture& color, bool as_quads) {
  // The pictures agree but for rounding.
  if (gl::place_of_work(gl::preferences().soft_blend) == gl::Place::cpu)
    return cpu_.draw(points, order, view, solid_t, color);
  gl::Program& program = programs_[as_quads];
  if (!program) {
    gl::Defines defines{"SPLAT_SPHERE", "SOFT_ORDERED"};
    if (as_quads) defines.push_back("SPLAT_QUADS");
    program = gl::Program::raster("techniques/soft/sphere.vert", "techniques/soft/express.frag", defines);
  }
  view.bind();
  gl::Framebuffer framebuffer({&color});
  framebuffer.bind();
  points.draw(program, as_quads, solid_t, {.blend = gl::State::Blend::premultiplied_over}, &order);
}

void Express::draw(SoftPoints& points, const View& view, const gl::Texture& solid_t, gl::Texture& color,
                   DrawOrder order, bool as_quads, gl::Timers& timers) {
  if (order == DrawOrder::exact) {
    Order far_to_near;
    {
      auto timing = timers.scope("sort");
      far_to_near = points.far_to_near(view);
    }
    auto timing = timers.scope("blend");
    blend(points, far_to_near, view, solid_t, color, as_quads);
    return;
  }
  const dvec3 direction = view.camera().direction();
  const vec3 shares = axis_shares(direction);
  auto timing = timers.scope("blend");
  for (int axis = 0; axis < 3; ++axis)
    if (shares[axis] == 1)
      return blend(points, points.along_axis(axis, direction[axis] > 0), view, solid_t, color, as_quads);

  // Between two orders: their pictures are mixed.
  const int width = color.width(), height = color.height();
  for (gl::Texture* texture : {&one_order_, &mixed_, &sum_})
    gl::ensure(*texture, "order of an axis", GL_RGBA32F, width, height);
  if (!mix_) mix_ = ScreenPass("techniques/soft/add_share.glsl", {GL_RGBA32F});
  sum_.clear(vec4(0));
  for (int axis = 0; axis < 3; ++axis) {
    if (shares[axis] == 0) continue;
    gl::copy(color, ivec2(0), one_order_, ivec2(0), ivec2(width, height));
    blend(points, points.along_axis(axis, direction[axis] > 0), view, solid_t, one_order_, as_quads);
    mix_.set("share", shares[axis]);
    mix_.run({&sum_, &one_order_}, {&mixed_});
    std::swap(sum_, mixed_);
  }
  gl::copy(sum_, ivec2(0), color, ivec2(0), ivec2(width, height));
}

}  // namespace sfumato::soft
