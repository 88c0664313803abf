#include "view/navigator.h"

#include <gtest/gtest.h>

namespace sfumato::view {
namespace {

Subject cube() {
  Subject subject{{dvec3(-1), dvec3(1)}, {}};
  for (const dvec3& corner : subject.box.corners()) subject.points.push_back(corner);
  return subject;
}

class NavigatorTest : public ::testing::Test {
 protected:
  NavigatorTest() {
    hand_.set_scene(UpAxis::pos_z, cube());
    hand_.set_camera({{3, -6, 2}, {0.2, 0.1, 0}, {0, 0, 1}, 45, false});
  }
  dvec3 seen(const dvec3& world) const { return project(hand_.camera().to_camera(800, 600), world); }

  Navigator hand_;
  const dvec3 place_{0.7, -0.9, 0.4};
};

// What rounding leaves of positions about 10 units away, in pixels.
constexpr double rounding = 1e-6;

// The first picture of tilted ground turns about its vertical, other views about the axis: neither rolls.
TEST_F(NavigatorTest, RotationDoesNotRollAViewOfTiltedGround) {
  const dvec3 vertical = glm::normalize(dvec3(0.4, 0.2, 1)), axis(0, 0, 1);
  const auto right = [&] { return dvec3(hand_.camera().to_camera(8, 6).inverse_view()[0]); };
  hand_.set_scene(UpAxis::pos_z, cube(), vertical);
  hand_.set_camera({{3, -6, 2}, {0.2, 0.1, 0}, vertical, 45, false});
  hand_.rotate(10, 5, 600, place_);
  EXPECT_EQ(hand_.camera().up, vertical);
  EXPECT_NEAR(glm::dot(right(), vertical), 0, 1e-12);
  hand_.show({"front", 0, 0}, 800, 600);
  hand_.rotate(10, 5, 600, place_);
  EXPECT_EQ(hand_.camera().up, axis);
  EXPECT_NEAR(glm::dot(right(), axis), 0, 1e-12);
}

TEST_F(NavigatorTest, RotationKeepsThePivotWhereItIsSeen) {
  const dvec3 before = seen(place_);
  for (const auto& [dx, dy] : {std::pair(120, 0), {0, -70}, {-33, 51}}) {
    hand_.rotate(dx, dy, 600, place_);
    EXPECT_NEAR(seen(place_).x, before.x, rounding);
    EXPECT_NEAR(seen(place_).y, before.y, rounding);
    EXPECT_NEAR(seen(place_).z, before.z, rounding);
  }
  EXPECT_EQ(hand_.camera().up, dvec3(0, 0, 1));
}

TEST_F(NavigatorTest, RotationIsHalfATurnOverTheHeightAndBackAgain) {
  const ViewCamera before = hand_.camera();
  hand_.rotate(600, 0, 600, before.target);
  EXPECT_NEAR(hand_.camera().position.x, 2 * before.target.x - before.position.x, 1e-9);
  EXPECT_NEAR(hand_.camera().position.y, 2 * before.target.y - before.position.y, 1e-9);
  hand_.rotate(-600, 0, 600, before.target);
  EXPECT_NEAR(glm::length(hand_.camera().position - before.position), 0, 1e-9);
}

TEST_F(NavigatorTest, DraggingDownLiftsTheCameraAndStopsAtThePole) {
  const double before = hand_.camera().position.z;
  hand_.rotate(0, 30, 600, hand_.camera().target);
  EXPECT_GT(hand_.camera().position.z, before);
  for (int i = 0; i < 50; ++i) hand_.rotate(0, 100, 600, hand_.camera().target);
  EXPECT_LT(hand_.camera().direction().z, -0.999);
  EXPECT_GT(hand_.camera().direction().z, -1);  // not over it
  const dvec3 right(hand_.camera().to_camera(8, 6).inverse_view()[0]);
  EXPECT_NEAR(right.z, 0, 1e-9);
}

TEST_F(NavigatorTest, PanMovesWhatWasGrabbedWithTheCursor) {
  for (const bool parallel : {false, true}) {
    ViewCamera camera = hand_.camera();
    camera.orthographic = parallel;
    hand_.set_camera(camera);
    const dvec3 before = seen(place_);
    hand_.pan(37, -21, 600, place_);
    EXPECT_NEAR(seen(place_).x, before.x + 37, rounding) << parallel;
    EXPECT_NEAR(seen(place_).y, before.y - 21, rounding) << parallel;
  }
}

TEST_F(NavigatorTest, ZoomKeepsThePlaceUnderTheCursorAndComesNearer) {
  for (const bool parallel : {false, true}) {
    ViewCamera camera = hand_.camera();
    camera.orthographic = parallel;
    hand_.set_camera(camera);
    const dvec3 before = seen(place_);
    const double reach = camera.distance();
    hand_.zoom(2, place_);
    EXPECT_NEAR(seen(place_).x, before.x, rounding) << parallel;
    EXPECT_NEAR(seen(place_).y, before.y, rounding) << parallel;
    EXPECT_NEAR(hand_.camera().distance(), 0.85 * 0.85 * reach, 1e-9);
    hand_.zoom(-2, place_);
    EXPECT_NEAR(hand_.camera().distance(), reach, 1e-9);
  }
}

TEST_F(NavigatorTest, ZoomEndsBeforeItLosesTheScene) {
  for (int i = 0; i < 500; ++i) hand_.zoom(3, place_);
  EXPECT_GT(hand_.camera().distance(), 0);
  EXPECT_TRUE(std::isfinite(hand_.camera().position.x));
  for (int i = 0; i < 500; ++i) hand_.zoom(-3, place_);
  EXPECT_LT(hand_.camera().distance(), 1000 * hand_.scene_size());
}

TEST_F(NavigatorTest, FliesAheadAndSideways) {
  const ViewCamera before = hand_.camera();
  hand_.fly({0, 0, 1}, 2);
  const dvec3 way = hand_.camera().position - before.position;
  EXPECT_NEAR(glm::length(way), 0.5 * hand_.scene_size(), 1e-9);  // four seconds across
  EXPECT_NEAR(glm::dot(glm::normalize(way), before.direction()), 1, 1e-9);
  EXPECT_NEAR(glm::length(hand_.camera().direction() - before.direction()), 0, 1e-12);
}

TEST_F(NavigatorTest, SidesAreThoseOfTheCommand) {
  hand_.show(find_view("front", ""), 800, 600);
  EXPECT_NEAR(glm::dot(hand_.camera().direction(), dvec3(0, 1, 0)), 1, 1e-12);
  hand_.show(find_view("right", ""), 800, 600);
  EXPECT_NEAR(glm::dot(hand_.camera().direction(), dvec3(-1, 0, 0)), 1, 1e-12);
  hand_.show(find_view("top", ""), 800, 600);
  EXPECT_NEAR(glm::dot(hand_.camera().direction(), dvec3(0, 0, -1)), 1, 1e-12);
  EXPECT_NEAR(hand_.camera().up.y, 1, 1e-12);  // north is up on a plan
  for (const dvec3& corner : cube().points) {
    const dvec3 p = seen(corner);
    EXPECT_TRUE(p.x > 0 && p.x < 800 && p.y > 0 && p.y < 600);
  }
}

TEST_F(NavigatorTest, LooksAtAPlaceFromTheSameDistance) {
  const double before = hand_.camera().distance();
  hand_.look_at(place_);
  EXPECT_NEAR(seen(place_).x, 400, rounding);
  EXPECT_NEAR(seen(place_).y, 300, rounding);
  EXPECT_NEAR(hand_.camera().distance(), before, 1e-9);
}

TEST_F(NavigatorTest, TheAngleKeepsTheSizeOfTheTarget) {
  const double before = seen(hand_.camera().target + dvec3(0, 0, 0.1)).y;
  hand_.set_angle(20);
  EXPECT_EQ(hand_.camera().fov_deg, 20);
  // A tenth of a unit near the target, of which a part is depth.
  EXPECT_NEAR(seen(hand_.camera().target + dvec3(0, 0, 0.1)).y, before, 0.3);
}

TEST(ViewCamera, RaysAndProjectionAreInverse) {
  for (const bool parallel : {false, true}) {
    const Camera camera = ViewCamera{{4, -3, 2}, {0, 0, 0.5}, {0, 0, 1}, 50, parallel}.to_camera(640, 480);
    const Ray ray = ray_through(camera, 123.5, 400.25);
    const dvec3 p = project(camera, ray.origin + 3.0 * ray.direction);
    EXPECT_NEAR(p.x, 123.5, rounding);
    EXPECT_NEAR(p.y, 400.25, rounding);
  }
}

TEST(ViewCamera, ComesBackFromACamera) {
  for (const bool parallel : {false, true}) {
    const ViewCamera view{{4, -3, 2}, {0, 0, 0.5}, {0, 0, 1}, 45, parallel};
    const ViewCamera back = ViewCamera::from(view.to_camera(640, 480));
    EXPECT_EQ(back.fov_deg, 45);
    EXPECT_NEAR(glm::length(back.position - view.position), 0, 1e-12);
    EXPECT_EQ(back.orthographic, parallel);
  }
}

}  // namespace
}  // namespace sfumato::view
