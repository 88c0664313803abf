// Express model: one pass of blended spheres, far ones first (Seemann 2018, Sec. 3.3).
#pragma once

#include "passes/screen_pass.h"
#include "techniques/soft/express_cpu.h"

namespace sfumato::soft {

enum class DrawOrder { exact, axis };

/// Shares of the orders along x, y and z in the picture of a camera that looks in `direction` (cloud space):
/// 1 for the axis it looks along, and a cross-fade where two or three are about equal. Steps of one degree
/// change a share by at most 1/8. They sum to 1.
vec3 axis_shares(const dvec3& direction);

class Express {
 public:
  /// Blends the soft points over `color`.
  void draw(SoftPoints& points, const View& view, const gl::Texture& solid_t, gl::Texture& color,
            DrawOrder order, bool as_quads, gl::Timers& timers);

 private:
  void blend(SoftPoints& points, const Order& order, const View& view, const gl::Texture& solid_t,
             gl::Texture& color, bool as_quads);
  gl::Program programs_[2];
  ExpressCpu cpu_;
  ScreenPass mix_;
  gl::Texture one_order_, mixed_, sum_;
};

}  // namespace sfumato::soft
