// The light on its ball, against directions worked out by hand.
#include "view/light_hand.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace sfumato::view {
namespace {

/// Looks along +y from the front: right is +x, above is +z.
Camera from_front() {
  Camera camera;
  camera.position = {0, -10, 0}, camera.target = {0, 0, 0}, camera.up = {0, 0, 1};
  camera.width = 800, camera.height = 600;
  return camera;
}

RenderSettings lit_by(const std::string& light, Shadows shadows = Shadows::off) {
  RenderSettings settings;
  settings.light_text = light, settings.shadows = shadows;
  return settings;
}

void expect_direction(const std::string& light, const dvec3& wanted) {
  ASSERT_EQ(light.substr(0, 4), "dir:");
  dvec3 way{0};
  ASSERT_EQ(std::sscanf(light.c_str(), "dir:%lf,%lf,%lf", &way.x, &way.y, &way.z), 3) << light;
  EXPECT_LT(glm::length(way - wanted), 2e-4) << light;
}

TEST(LightHand, TheBallFollowsTheCursor) {
  const auto drag = [](const std::string& light, double dx, double dy) {
    return drag_light(lit_by(light), from_front(), UpAxis::pos_z, dx, dy, 600);
  };
  // A quarter of a turn is half the height of the picture.
  expect_direction(drag("headlight", 0, 0), {0, -1, 0});
  // 25 degrees from there, as far left as up.
  expect_direction(drag("shoulder", 0, 0), {-std::sin(0.43633) * std::sqrt(0.5), -std::cos(0.43633),
                                            std::sin(0.43633) * std::sqrt(0.5)});
  expect_direction(drag("headlight", 300, 0), {1, 0, 0});
  expect_direction(drag("headlight", -300, 0), {-1, 0, 0});
  expect_direction(drag("headlight", 0, 300), {0, 0, -1});
  expect_direction(drag("headlight", 0, -300), {0, 0, 1});
  expect_direction(drag("headlight", 150, 0), {std::sqrt(0.5), -std::sqrt(0.5), 0});
  expect_direction(drag("dir:1,0,0", 300, 0), {0, 1, 0});
  expect_direction(drag("dir:0,0,2", 200, 0), {0, 0, 1});  // about itself
  EXPECT_EQ(drag("dir:0,0,2", 200, 0).find("-0.0000"), std::string::npos);
}

TEST(LightHand, ManyStepsAreOneDrag) {
  std::string light = "headlight";
  for (int i = 0; i < 300; ++i) light = drag_light(lit_by(light), from_front(), UpAxis::pos_z, 1, 0, 600);
  dvec3 way{0};
  ASSERT_EQ(std::sscanf(light.c_str(), "dir:%lf,%lf,%lf", &way.x, &way.y, &way.z), 3);
  EXPECT_LT(glm::length(way - dvec3(1, 0, 0)), 0.02);
}

TEST(LightHand, ALightAtAPlaceKeepsItsDistance) {
  Camera camera = from_front();
  camera.target = {500'000, 4'000'000, 100}, camera.position = camera.target + dvec3(0, -10, 0);
  const std::string light = drag_light(lit_by("500000,3999980,100"), camera, UpAxis::pos_z, 300, 0, 600);
  dvec3 place{0};
  ASSERT_EQ(std::sscanf(light.c_str(), "%lf,%lf,%lf", &place.x, &place.y, &place.z), 3) << light;
  EXPECT_LT(glm::length(place - dvec3(500'020, 4'000'000, 100)), 1e-6) << light;
}

// With shadows the light of the eye stands over the left shoulder, and is dragged from there.
TEST(LightHand, BeginsWhereTheLightIs) {
  const RenderSettings shadowed = lit_by("headlight", Shadows::hard);
  const dvec3 shoulder = towards_light(shadowed, from_front(), UpAxis::pos_z);
  EXPECT_LT(shoulder.x, 0);
  EXPECT_LT(shoulder.y, 0);
  EXPECT_GT(shoulder.z, 0);
  expect_direction(drag_light(shadowed, from_front(), UpAxis::pos_z, 0, 0, 600), shoulder);
  EXPECT_THROW(towards_light(lit_by("nowhere"), from_front(), UpAxis::pos_z), Error);
}

}  // namespace
}  // namespace sfumato::view
