// A session that is set in two steps holds a whole scene or none, whatever stops one of them.
#include "session/session.h"

#include <algorithm>

#include "core/error.h"
#include "reference/gl_fixture.h"
#include "reference/patience.h"

namespace sfumato::testing {
namespace {

class SessionTest : public GlTest {
 protected:
  Session session_{context()};

  void sort(const SessionOptions& options = {}, Progress& progress = no_progress(),
            std::shared_ptr<const scene::Overview> overview = nullptr) {
    scene::Scene scene;
    scene.overview = std::move(overview);
    scene.cloud = sphere_cloud(6000);
    scene.cloud.normals.clear();  // which `measure` computes
    ScalarField heights{"height", 0, {}, StoredType::float32};
    for (const vec3& p : scene.cloud.positions) heights.values.push_back(p.z);
    scene.cloud.set_scalar(std::move(heights));
    Pose pose = stand_upright(scene, UpAxis::pos_z);
    session_.set_scene(std::move(scene), std::move(pose), options, progress);
  }
  Image<Rgba8> picture() {
    Look look("splats");
    return session_.render(look, camera_at({0, -4, 0.3}, 96, 72)).rgba8;
  }
  void expect_nothing() {
    EXPECT_TRUE(session_.empty());
    EXPECT_EQ(session_.prepared_points(), 0u);
    Look look("splats");
    session_.complete(look);
    EXPECT_FALSE(session_.has_needs(look));
    EXPECT_THROW(picture(), Error);
  }
  void expect_no_step_left() {
    expect_nothing();
    EXPECT_THROW(session_.suggest(), Error);
    EXPECT_THROW(session_.measure({}), Error);
  }
};

TEST_F(SessionTest, BetweenTheStepsItIsEmptyAndSuggests) {
  expect_no_step_left();
  sort();
  expect_nothing();
  const std::string suggested = session_.suggest().technique;
  session_.measure(Attribute::normal);
  EXPECT_FALSE(session_.empty());
  EXPECT_EQ(session_.suggest().technique, suggested);
  EXPECT_THROW(session_.measure({}), Error) << "once for each scene";
  EXPECT_FALSE(session_.empty());
}

TEST_F(SessionTest, ColorsThatAreSetBetweenTheStepsHold) {
  ColorSettings color;
  color.color_by = "height";
  sort();
  session_.set_color(color);
  session_.measure({});
  EXPECT_EQ(session_.coloring().source, "height");
}

TEST_F(SessionTest, AStepThatIsStoppedLeavesNothingBehind) {
  sort();
  session_.measure({});
  const Image<Rgba8> whole = picture();
  StopsAt at_once(1);
  EXPECT_THROW(sort({}, at_once), Cancelled);
  EXPECT_TRUE(std::ranges::equal(picture(), whole)) << "the last scene, before anything is gone";
  StopsAt in_sorting(2);
  EXPECT_THROW(sort({}, in_sorting), Cancelled);
  expect_no_step_left();
  sort();
  StopsAt in_measuring(1);
  EXPECT_THROW(session_.measure(Attribute::normal, in_measuring), Cancelled);
  expect_no_step_left();
  SessionOptions refused;
  refused.color.color_by = "intensity";
  sort(refused);
  EXPECT_THROW(session_.measure({}), Error) << "no such colours";
  expect_no_step_left();
  sort();
  session_.measure({});
  EXPECT_TRUE(std::ranges::equal(picture(), whole));
}

TEST_F(SessionTest, AnotherSceneFreesTheOverview) {
  auto overview = std::make_shared<scene::Overview>();
  static_cast<PointCloud&>(*overview) = sphere_cloud(6000);
  const std::weak_ptr<const scene::Overview> held = overview;
  sort({}, no_progress(), std::move(overview));
  session_.measure({});
  session_.suggest();
  EXPECT_FALSE(held.expired());
  sort();
  EXPECT_TRUE(held.expired());
}

TEST_F(SessionTest, ALookStaysAsItIsAndThePictureSaysWhatBecameOfIt) {
  sort();
  session_.measure({});
  Look look("splats");
  look.set("shadows", "hard"), look.set("edl_strength", "0.3");
  const auto values = [&] {
    std::vector<std::string> all;
    for (const Param& param : look.parameters.all())
      all.push_back(param.name + "=" + param.get() + "=" + param.resolved());
    all.erase(all.begin(), all.begin() + std::ptrdiff_t(look.own_count));  // the technique's own are its own
    return all;
  };
  const std::vector<std::string> before = values();
  look.settings.background = vec3(0.25f);
  const RenderOutput out = session_.render(look, camera_at({0, -4, 0.3}, 96, 72));
  EXPECT_EQ(values(), before);
  EXPECT_EQ(look.settings.background, vec3(0.25f));
  EXPECT_EQ(out.settings.background, session_.background());
  EXPECT_EQ(out.settings.edl_strength.value(), 0.3f);
  EXPECT_GT(out.settings.light_size.value(), 0);
  const ParamValues resolved = look.resolved(out.settings);
  ASSERT_EQ(resolved.size(), look.parameters.all().size());
  for (const auto& [param, value] : resolved) {
    if (param.name == "light_size") EXPECT_NE(value, param.resolved());
    if (param.name == "edl_strength") EXPECT_EQ(value, "0.3");
    if (param.name == "shadows") EXPECT_EQ(value, "hard");
  }
}

TEST_F(SessionTest, PointsThatRulesDrawAreStillChosenFor) {
  sort();
  session_.measure({});
  const TechniqueChoice of_all = session_.suggest();
  SessionOptions options;
  options.draw = {DrawRule::parse("z ..9: points")};
  sort(options);
  EXPECT_EQ(session_.suggest().reason, "every point is drawn by a rule");
  session_.measure({});
  EXPECT_EQ(session_.suggest().technique, of_all.technique);
  EXPECT_EQ(session_.suggest().reason, of_all.reason);
}

}  // namespace
}  // namespace sfumato::testing
