#include "core/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "core/error.h"

using namespace sfumato;

namespace {

// Pixel of a world point through the GL matrices, to be compared with the pinhole formula of the header.
glm::dvec2 project(const Camera& camera, dvec3 p) {
  const glm::dvec4 clip = camera.projection_matrix() * camera.view() * glm::dvec4(p, 1);
  return {(clip.x / clip.w + 1) * 0.5 * camera.width, (clip.y / clip.w + 1) * 0.5 * camera.height};
}

TEST(Camera, ProjectionAgreesWithIntrinsics) {
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera;
    camera.projection = projection;
    camera.position = {1, -5, 2};
    camera.target = {0.5, 0, 0.25};
    camera.width = 640;
    camera.height = 480;
    camera.height_world = 3;
    for (bool custom : {false, true}) {
      if (custom) camera.custom_intrinsics = Intrinsics{500, 510, 300, 250};
      const Intrinsics k = camera.intrinsics();
      const dvec3 p{0.3, 0.2, 0.7};
      const dvec3 eye(camera.view() * glm::dvec4(p, 1));
      const double w = camera.orthographic() ? 1 : -eye.z;
      const glm::dvec2 px = project(camera, p);
      EXPECT_NEAR(px.x, k.fx * eye.x / w + k.cx, 1e-9);
      EXPECT_NEAR(px.y, -k.fy * eye.y / w + k.cy, 1e-9);
      const glm::dvec2 guarded = project(camera.with_guard_band(16), p);
      EXPECT_NEAR(guarded.x, px.x + 16, 1e-9);
      EXPECT_NEAR(guarded.y, px.y + 16, 1e-9);
    }
  }
}

TEST(Camera, ATileSeesItsPartOfThePicture) {
  for (Projection projection : {Projection::perspective, Projection::orthographic})
    for (bool custom : {false, true}) {
      Camera camera;
      camera.projection = projection;
      camera.position = {1, -5, 2};
      camera.width = 640;
      camera.height = 480;
      camera.height_world = 3;
      if (custom) camera.custom_intrinsics = Intrinsics{500, 510, 300, 250};
      const Camera tile = camera.tile(128, 64, 200, 100), part = tile.tile(10, -20, 30, 40);
      const dvec3 p{0.3, 0.2, 0.7};
      const glm::dvec2 px = project(camera, p);
      // The projection of a tile goes over its own width, and its intrinsics are in its own pixels.
      const auto expect_moved = [&](const Camera& moved, int x, int y) {
        const glm::dvec2 place = project(moved, p);
        EXPECT_NEAR(place.x, px.x - x, 1e-9);
        EXPECT_NEAR(place.y, px.y - y, 1e-9);
        EXPECT_NEAR(moved.intrinsics().cx, camera.intrinsics().cx - x, 1e-9);
        EXPECT_EQ(moved.intrinsics().fy, camera.intrinsics().fy);
      };
      expect_moved(tile, 128, 64);
      expect_moved(part, 138, 44);
      // A guard band begins before the tile; the whole one of the picture does so before the picture.
      expect_moved(tile.with_guard_band(16), 112, 48);
      EXPECT_EQ(tile.with_guard_band(16).tile_origin(), glm::ivec2(128, 64));
      EXPECT_EQ(part.whole_height(), 480);
      EXPECT_EQ(part.whole_picture().width, 640);
      EXPECT_EQ(project(part.whole_picture(), p), px);
    }
}

TEST(Camera, FrameHoldsEveryCorner) {
  const Bounds box{{100, 200, 5}, {140, 210, 12}};
  for (UpAxis up : {UpAxis::pos_z, UpAxis::pos_y, UpAxis::neg_x})
    for (Projection projection : {Projection::perspective, Projection::orthographic})
      for (double azimuth : {-0.785, 0.0, 2.0}) {
        const Camera camera = frame(box, up, 320, 200, azimuth, 0.52, glm::radians(45.0), projection);
        for (const dvec3& p : box.corners()) {
          const glm::dvec2 px = project(camera, p);
          EXPECT_GT(px.x, 0);
          EXPECT_LT(px.x, 320);
          EXPECT_GT(px.y, 0);
          EXPECT_LT(px.y, 200);
          const double depth = -(camera.view() * glm::dvec4(p, 1)).z;
          EXPECT_GT(depth, camera.near_plane);
          EXPECT_LT(depth, camera.far_plane);
        }
      }
}

TEST(Camera, UpIsUpInTheImage) {
  const Camera camera = frame({{-1, -1, -1}, {1, 1, 1}}, UpAxis::pos_z, 100, 100, -0.785, 0.5);
  EXPECT_LT(project(camera, {0, 0, 1}).y, project(camera, {0, 0, -1}).y);
  EXPECT_LT(camera.position.y, 0);  // azimuth 0 looks from the front (-Y), -45 degrees from front left
  EXPECT_LT(camera.position.x, 0);
}

// A host's matrices, made by glm and not by us: every point falls on the pixel where OpenGL puts it (y up
// there).
TEST(Camera, MatricesOfAHostGiveItsPixels) {
  const int width = 320, height = 180;
  const dmat4 view = glm::lookAt(dvec3(3, -4, 2), dvec3(0.5, 0.2, 0.1), dvec3(0.1, 0, 1));
  for (const dmat4& projection :
       {glm::perspective(0.9, 16.0 / 9, 0.1, 100.0), glm::frustum(-0.05, 0.2, -0.1, 0.03, 0.1, 50.0),
        glm::ortho(-2.0, 3.0, -1.5, 1.0, 0.1, 50.0)}) {
    const Camera camera = camera_of_matrices(view, projection, width, height);
    for (const dvec3& p : {dvec3(0.3, 0.2, 0.7), dvec3(-1, 0.5, 0), dvec3(0.5, 0.2, 0.1)}) {
      const glm::dvec4 clip = projection * view * glm::dvec4(p, 1);
      const glm::dvec2 px = project(camera, p);
      EXPECT_NEAR(px.x, (clip.x / clip.w + 1) * 0.5 * width, 1e-9);
      EXPECT_NEAR(px.y, (1 - clip.y / clip.w) * 0.5 * height, 1e-9);
      EXPECT_NEAR((camera.view() * glm::dvec4(p, 1)).z, (view * glm::dvec4(p, 1)).z, 1e-12);
    }
  }
}

TEST(Camera, MatricesOfNoCameraAreRefused) {
  const dmat4 view = glm::lookAt(dvec3(3, -4, 2), dvec3(0), dvec3(0, 0, 1)),
              projection = glm::perspective(0.9, 1.0, 0.1, 9.0);
  EXPECT_THROW(camera_of_matrices(view * 2.0, projection, 10, 10), Error);
  EXPECT_THROW(camera_of_matrices(glm::scale(view, dvec3(-1, 1, 1)), projection, 10, 10), Error);
  EXPECT_THROW(camera_of_matrices(view, dmat4(1) - dmat4(1), 10, 10), Error);
  dmat4 skewed = projection;
  skewed[1][0] = 0.2;
  EXPECT_THROW(camera_of_matrices(view, skewed, 10, 10), Error);
  EXPECT_THROW(camera_of_matrices(dmat4(NAN), projection, 10, 10), Error);
  EXPECT_THROW(camera_of_matrices(view, projection, 0, 10), Error);
}

}  // namespace
