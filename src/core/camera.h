// A pinhole or orthographic camera in world coordinates, double precision.
//
// Spaces. Eye space: camera at the origin, +x right, +y up, looking down -z; eye depth z_e = -z is positive
// in front. Pixel space: x right, y DOWN, pixel centres at half integers, first row on top. All images and
// all textures of sfumato store the top row first, so `projection()` flips y.
#pragma once

#include <optional>

#include "core/point_cloud.h"
#include "core/vec.h"

namespace sfumato {

enum class Projection { perspective, orthographic };

/// Pinhole parameters in pixels: x_px = fx * x_eye / z_e + cx, y_px = fy * -y_eye / z_e + cy.
/// Orthographic cameras leave out the division.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  bool operator==(const Intrinsics&) const = default;
};

/// The picture that a tile is cut from.
struct Whole {
  int x = 0, y = 0;           ///< where the tile begins in it, px; negative where a guard band reaches beyond
  int width = 0, height = 0;  ///< of all of it, px
  bool operator==(const Whole&) const = default;
};

struct Camera {
  dvec3 position{0, -1, 0}, target{0}, up{0, 0, 1};
  Projection projection = Projection::perspective;
  double fov_y = glm::radians(45.0);  ///< full vertical angle, radians (perspective)
  double height_world = 1;            ///< scene height covered by the image (orthographic)
  int width = 1280, height = 720;
  std::optional<Intrinsics> custom_intrinsics;  ///< wins over fov_y / height_world; of the whole picture
  /// Of a tile, whose own size are `width` and `height`. What is given in shares of a picture's height
  /// (angle, stroke lengths) is that of the whole.
  std::optional<Whole> whole;
  double near_plane = 0.01, far_plane = 1000;  ///< eye depth; set by `fit_depth_range`

  bool operator==(const Camera&) const = default;

  /// World to eye, relative to `origin`: multiply cloud positions (world - origin) with it.
  dmat4 view(const dvec3& origin = dvec3(0)) const;
  dmat4 inverse_view(const dvec3& origin = dvec3(0)) const;
  /// Eye to clip with y down (row 0 of the image is on top), GL depth range -1..1.
  dmat4 projection_matrix() const;
  /// In pixels of this picture, tile or not.
  Intrinsics intrinsics() const;
  /// In pixels of the whole picture.
  Intrinsics whole_intrinsics() const;
  int whole_width() const { return whole ? whole->width : width; }
  int whole_height() const { return whole ? whole->height : height; }
  /// Where this picture begins in the whole one, px.
  glm::ivec2 tile_origin() const { return whole ? glm::ivec2(whole->x, whole->y) : glm::ivec2(0); }
  /// The part of this picture that begins at a pixel of it; may reach beyond its borders. Points fall on the
  /// same places of the same pixels as in the whole, bit by bit.
  Camera tile(int x, int y, int tile_width, int tile_height) const;
  /// The picture that this is a tile of, or this one.
  Camera whole_picture() const;
  /// Unit direction of view, world.
  dvec3 direction() const;
  bool orthographic() const { return projection == Projection::orthographic; }
  /// Pixels per scene unit at eye depth 1 (perspective) or anywhere (orthographic): notes k_px = h / (2 tan
  /// theta).
  double pixels_per_unit() const { return intrinsics().fy; }

  /// The same view at another size; the vertical angle stays (custom intrinsics scale with the height).
  Camera resized(int new_width, int new_height) const;
  /// The same view with `margin` more pixels on each side: a guard band for screen-space operators. That of a
  /// tile is the tile of the whole picture with its guard band.
  Camera with_guard_band(int margin) const;
  /// Near and far around the box, with room; keeps near positive.
  void fit_depth_range(const Bounds& world_box);
};

/// The camera of two matrices of OpenGL (world to eye, eye to clip; column by column as glm has them) for an
/// image of so many pixels. Throws Error(usage) where `view` does more than turn and move, or `projection` is
/// neither a perspective nor an orthographic one that looks along -z.
Camera camera_of_matrices(const dmat4& view, const dmat4& projection, int width, int height);

/// The camera that frames `box` from the direction given by azimuth and elevation (radians; azimuth turns
/// counter-clockwise about `up`, 0 looks from the front).
Camera frame(const Bounds& box, UpAxis up, int width, int height, double azimuth, double elevation,
             double fov_y = glm::radians(45.0), Projection projection = Projection::perspective);

}  // namespace sfumato
