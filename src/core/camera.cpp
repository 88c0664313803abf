#include "core/camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace sfumato {

dvec3 Camera::direction() const { return glm::normalize(target - position); }

dmat4 Camera::view(const dvec3& origin) const {
  dvec3 upward = up;
  // Looking along the up vector has no upright picture: any other axis will do, but always the same one.
  if (glm::length(glm::cross(glm::normalize(upward), direction())) < 1e-9)
    upward = std::abs(direction().y) < 0.9 ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  return glm::lookAt(position - origin, target - origin, upward);
}

dmat4 Camera::inverse_view(const dvec3& origin) const { return glm::inverse(view(origin)); }

Intrinsics Camera::whole_intrinsics() const {
  if (custom_intrinsics) return *custom_intrinsics;
  const int w = whole_width(), h = whole_height();
  const double f = orthographic() ? h / height_world : 0.5 * h / std::tan(0.5 * fov_y);
  return {f, f, 0.5 * w, 0.5 * h};
}

Intrinsics Camera::intrinsics() const {
  Intrinsics k = whole_intrinsics();
  k.cx -= tile_origin().x;
  k.cy -= tile_origin().y;
  return k;
}

Camera Camera::tile(int x, int y, int tile_width, int tile_height) const {
  Camera out = *this;
  out.whole = Whole{tile_origin().x + x, tile_origin().y + y, whole_width(), whole_height()};
  out.width = tile_width;
  out.height = tile_height;
  return out;
}

Camera Camera::whole_picture() const {
  Camera out = *this;
  out.width = whole_width();
  out.height = whole_height();
  out.whole.reset();
  return out;
}

dmat4 Camera::projection_matrix() const {
  const Intrinsics k = intrinsics();
  const double w = width, h = height, n = near_plane, f = far_plane;
  dmat4 m(0.0);  // column-major: m[column][row]
  // x_px = fx x/w + cx and x_ndc = 2 x_px / width - 1; y_px = -fy y/w + cy, y_ndc = 2 y_px / height - 1 (y
  // down).
  m[0][0] = 2 * k.fx / w;
  m[1][1] = -2 * k.fy / h;
  if (orthographic()) {
    m[3][0] = 2 * k.cx / w - 1;
    m[3][1] = 2 * k.cy / h - 1;
    m[2][2] = -2 / (f - n);
    m[3][2] = -(f + n) / (f - n);
    m[3][3] = 1;
  } else {
    m[2][0] = 1 - 2 * k.cx / w;  // times z = -w_clip
    m[2][1] = 1 - 2 * k.cy / h;
    m[2][2] = -(f + n) / (f - n);
    m[3][2] = -2 * f * n / (f - n);
    m[2][3] = -1;
  }
  return m;
}

Camera Camera::resized(int new_width, int new_height) const {
  Camera out = *this;
  if (custom_intrinsics) {
    const double s = double(new_height) / height;
    out.custom_intrinsics =
        Intrinsics{custom_intrinsics->fx * s, custom_intrinsics->fy * s,
                   (custom_intrinsics->cx - 0.5 * width) * s + 0.5 * new_width, custom_intrinsics->cy * s};
  }
  out.width = new_width;
  out.height = new_height;
  return out;
}

Camera Camera::with_guard_band(int margin) const {
  Camera out = *this;
  Intrinsics k = whole_intrinsics();
  k.cx += margin;
  k.cy += margin;
  out.custom_intrinsics = k;
  out.width += 2 * margin;
  out.height += 2 * margin;
  if (out.whole) {  // begins as far before the tile as the whole picture's band before that picture
    out.whole->width += 2 * margin;
    out.whole->height += 2 * margin;
  }
  return out;
}

void Camera::fit_depth_range(const Bounds& box) {
  const dmat4 v = view();
  double lo = 1e300, hi = -1e300;
  for (const dvec3& p : box.corners()) {
    const double z = -(v * glm::dvec4(p, 1)).z;
    lo = std::min(lo, z);
    hi = std::max(hi, z);
  }
  const double room = std::max(1e-3 * box.diagonal(), 1e-9);
  far_plane = std::max(hi + room, 1e-6);
  // A camera inside the cloud still needs a positive near plane; 1e-4 of the depth keeps float depth useful.
  near_plane = std::max(lo - room, 1e-4 * far_plane);
  if (far_plane <= near_plane) far_plane = 2 * near_plane;
}

Camera camera_of_matrices(const dmat4& view, const dmat4& projection, int width, int height) {
  const glm::dmat3 turn(view);
  const glm::dmat3 rest = turn * glm::transpose(turn) - glm::dmat3(1);
  bool is_rigid = glm::determinant(turn) > 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      is_rigid = is_rigid && std::abs(rest[i][j]) < 1e-4;  // floats are off by 1e-6 or so
  if (!is_rigid)
    throw Error(ErrorCode::usage,
                "the view matrix scales, shears or mirrors: give one that only turns and moves");
  const dmat4& p = projection;
  const bool is_orthographic = p[2][3] == 0;
  const double scale = is_orthographic ? p[3][3] : -p[2][3];
  bool is_known = scale > 0 && p[0][0] > 0 && p[1][1] > 0 && width > 0 && height > 0;
  for (const auto& [column, row] : {std::pair(1, 0), {0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}})
    is_known = is_known && p[column][row] == 0;
  if (!is_known)
    throw Error(ErrorCode::usage,
                "the projection matrix is neither a perspective nor an orthographic one that looks along -z");

  Camera camera;
  camera.width = width, camera.height = height;
  camera.position = -(glm::transpose(turn) * dvec3(view[3]));
  camera.up = glm::normalize(dvec3(turn[0][1], turn[1][1], turn[2][1]));
  camera.target = camera.position - glm::normalize(dvec3(turn[0][2], turn[1][2], turn[2][2]));
  camera.projection = is_orthographic ? Projection::orthographic : Projection::perspective;
  // x_ndc = p00 x/w - p20, of which a pixel's x is (x_ndc + 1) width / 2; y runs the other way. Orthographic:
  // + p30.
  Intrinsics k;
  k.fx = 0.5 * width * p[0][0] / scale;
  k.fy = 0.5 * height * p[1][1] / scale;
  k.cx = 0.5 * width * (1 + (is_orthographic ? p[3][0] : -p[2][0]) / scale);
  k.cy = 0.5 * height * (1 - (is_orthographic ? p[3][1] : -p[2][1]) / scale);
  camera.custom_intrinsics = k;
  camera.fov_y = 2 * std::atan(0.5 * height / k.fy);
  camera.height_world = height / k.fy;
  return camera;
}

Camera frame(const Bounds& subject, UpAxis up_axis, int width, int height, double azimuth, double elevation,
             double fov_y, Projection projection) {
  // Points in one place have a spacing of 1 (analysis/spacing.cpp): they are seen as a dot, not from within.
  Bounds box = subject;
  if (box.diagonal() == 0) box = {subject.min - dvec3(25), subject.max + dvec3(25)};
  const dvec3 up = up_vector(up_axis);
  // Front: the direction one looks from at azimuth 0. Z up: from -Y; Y up: from +Z; X up: from -Y.
  const dvec3 front = std::abs(up.y) > 0.5 ? dvec3(0, 0, 1) : dvec3(0, -1, 0);
  const dvec3 right = glm::cross(up, front);
  const dvec3 horizontal = std::cos(azimuth) * front + std::sin(azimuth) * right;
  const dvec3 from = std::cos(elevation) * horizontal + std::sin(elevation) * up;

  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.up = up;
  camera.fov_y = fov_y;
  camera.projection = projection;
  camera.target = box.center();
  const double size = std::max(box.diagonal(), 1e-9);
  camera.position = camera.target + from * size;

  // Pull the camera back until every corner is inside the picture with a margin of 6 %.
  const dmat4 v = camera.view();
  const double tan_y = std::tan(0.5 * fov_y) * 0.94, tan_x = tan_y * width / height;
  double back = 0, half_height = 1e-9;
  for (const dvec3& p : box.corners()) {
    const dvec3 eye(v * glm::dvec4(p, 1));
    const double depth = -eye.z - size;  // relative to the target plane
    back = std::max({back, std::abs(eye.x) / tan_x - depth, std::abs(eye.y) / tan_y - depth});
    half_height = std::max({half_height, std::abs(eye.y), std::abs(eye.x) * height / width});
  }
  camera.height_world = 2 * half_height / 0.94;
  const double distance = projection == Projection::orthographic ? 2 * size : std::max(back, 0.05 * size);
  camera.position = camera.target + from * distance;
  camera.fit_depth_range(box);
  return camera;
}

}  // namespace sfumato
