// The camera as a hand moves it: turned about a point of the scene, dragged, brought nearer to what is under
// the cursor, flown. No window in it: pixels come in, cameras come out.
#pragma once

#include "core/camera.h"
#include "session/first_view.h"

namespace sfumato::view {

/// A camera in the words of the command line, so that what is seen can be said there exactly: the height of a
/// parallel view follows from distance and angle.
struct ViewCamera {
  dvec3 position{0, -1, 0}, target{0}, up{0, 0, 1};
  double fov_deg = 45;
  bool orthographic = false;

  static ViewCamera from(const Camera& camera);
  Camera to_camera(int width, int height) const;
  dvec3 direction() const { return glm::normalize(target - position); }
  double distance() const { return glm::length(target - position); }
  bool operator==(const ViewCamera&) const = default;
};

/// A ray through the middle of a pixel's place (x, y), world; `direction` is a unit vector.
struct Ray {
  dvec3 origin{0}, direction{0, 0, 1};
};
Ray ray_through(const Camera& camera, double x_px, double y_px);
/// Where a world position is seen, and its eye depth in z (at most 0: behind the camera).
dvec3 project(const Camera& camera, const dvec3& world);

class Navigator {
 public:
  /// Another scene: `up` is its axis, `subject` what views frame, `vertical` what rotation keeps upright, of
  /// length 1; 0: the axis.
  void set_scene(UpAxis up, const Subject& subject, const dvec3& vertical = dvec3(0));
  void set_camera(const ViewCamera& camera) { camera_ = camera; }
  const ViewCamera& camera() const { return camera_; }

  /// Turns the camera by a drag of so many pixels about `pivot`, which stays where it is in the picture. The
  /// up axis stays upright and the camera does not go over the poles. A drag over the height of the picture
  /// is half a turn.
  void rotate(double dx_px, double dy_px, int height_px, const dvec3& pivot);
  /// What lies at the depth of `grabbed` follows the cursor.
  void pan(double dx_px, double dy_px, int height_px, const dvec3& grabbed);
  /// Brings `place` nearer by `steps` notches of a wheel (away when negative); it stays where it is in the
  /// picture.
  void zoom(double steps, const dvec3& place);
  /// Along the camera's own axes: right, up, forward in -1..1, for `seconds`; `fast` times the usual speed,
  /// which crosses the scene in four seconds.
  void fly(const dvec3& way, double seconds, double fast = 1);
  /// The place comes to the middle of the picture, seen from the same side and distance.
  void look_at(const dvec3& place);
  /// The whole subject from one of its sides.
  void show(const NamedView& side, int width_px, int height_px);
  /// The whole subject from where the camera looks.
  void frame(int width_px, int height_px);
  void toggle_orthographic() { camera_.orthographic = !camera_.orthographic; }
  /// Full vertical angle, kept in 1..120 degrees; the plane through the target keeps its size in the picture.
  void set_angle(double fov_deg);

  UpAxis up_axis() const { return up_; }
  double scene_size() const { return size_; }

 private:
  /// What rotation keeps upright: the vertical of the scene, or the axis for views about that.
  dvec3 upright() const;

  ViewCamera camera_;
  UpAxis up_ = UpAxis::pos_z;
  dvec3 vertical_{0, 0, 1};
  Subject subject_;
  double size_ = 1;
};

}  // namespace sfumato::view
