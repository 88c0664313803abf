// Two sessions over one cloud that stands in memory once: each draws as it would alone.
#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>
#include <unistd.h>

#include "reference/gl_fixture.h"
#include "session/session.h"

namespace sfumato::testing {
namespace {

const std::vector<std::string> techniques{"points", "splats", "surface", "soft", "layers", "denoise"};

void set_scene(Session& session, std::size_t points, bool with_normals = false) {
  scene::Scene scene;
  scene.cloud = sphere_cloud(points);
  if (!with_normals) scene.cloud.normals.clear();  // techniques have them measured
  ScalarField heights{"height", 0, {}, StoredType::float32};
  for (const vec3& p : scene.cloud.positions) heights.values.push_back(p.z);
  scene.cloud.set_scalar(std::move(heights));
  Pose pose = stand_upright(scene);
  session.set_scene(std::move(scene), std::move(pose), {});
  session.measure({});
}

void color_by_height(Session& session) {
  ColorSettings color;
  color.color_by = "height";
  session.set_color(color);
}

Image<Rgba8> picture(Session& session, const std::string& technique, double from_x) {
  Look look(technique);
  look.set("shadows", technique == "surface" ? "hard" : "off");
  return session.render(look, camera_at({from_x, -4, 0.3}, 96, 72)).rgba8;
}

using Pictures = std::map<std::string, Image<Rgba8>>;

Pictures pictures_of(Session& session, double from_x) {
  Pictures all;
  for (const std::string& technique : techniques) all[technique] = picture(session, technique, from_x);
  return all;
}

void expect_same(const Pictures& pictures, const Pictures& expected, const std::string& whose) {
  for (const auto& [technique, image] : expected)
    EXPECT_TRUE(std::ranges::equal(pictures.at(technique), image)) << technique << " of the " << whose;
}

class SharedCloudTest : public GlTest {
 protected:
  /// By sessions that have their clouds to themselves.
  Pictures alone(bool by_height, double from_x) {
    Session session(context());
    set_scene(session, 6000);
    if (by_height) color_by_height(session);
    return pictures_of(session, from_x);
  }
  const Pictures first_alone_ = alone(false, 0), second_alone_ = alone(true, 2);
};

TEST_F(SharedCloudTest, InterleavedOnOneThread) {
  Session first(context()), second(context());
  set_scene(first, 6000);
  second.share_scene(first);
  EXPECT_EQ(&first.cloud().positions, &second.cloud().positions);
  color_by_height(second);
  Pictures of_first, of_second;
  for (const std::string& technique : techniques) {
    of_first[technique] = picture(first, technique, 0);
    of_second[technique] = picture(second, technique, 2);
  }
  expect_same(of_first, first_alone_, "first");
  expect_same(of_second, second_alone_, "second");
  EXPECT_EQ(&first.cloud().normals, &second.cloud().normals) << "measured by one, there for both";
}

TEST_F(SharedCloudTest, SideBySideOnTwoThreads) {
  const auto other = gl::Context::create_headless(gl::Preferences::from_environment(), &context());
  Pictures of_first, of_second;
  {
    Session first(context());
    set_scene(first, 6000);
    Session second(*other);
    second.share_scene(first);
    std::thread beside([&] {
      color_by_height(second);
      of_second = pictures_of(second, 2);
    });
    of_first = pictures_of(first, 0);
    beside.join();
  }
  expect_same(of_first, first_alone_, "first");
  expect_same(of_second, second_alone_, "second");
}

TEST_F(SharedCloudTest, NoneSeesACloudThatIsBeingCompleted) {
  Renderer first(context()), second(context());
  show(first, sphere_cloud(500), {});
  const auto points = find_technique("points").create();
  const auto complete = [&](Attribute attribute, const auto& look) {
    first.complete(
        0, [](const PreparedCloud&) { return true; },
        [&](PreparedCloud& cloud) {
          look(cloud);
          cloud.available = cloud.available | attribute;
        });
  };
  const PreparedCloud* const alone = &first.prepared();
  complete(Attribute::cluster,
           [&](const PreparedCloud& cloud) { EXPECT_EQ(&cloud, alone) << "a copy for nobody"; });
  second.share_clouds(first);
  // The second time the other one still draws the first set of attributes.
  for (const Attribute attribute : {Attribute::support, Attribute::uncertainty}) {
    complete(attribute, [&](const PreparedCloud& cloud) {
      EXPECT_NE(&second.prepared(), &cloud);
      if (attribute == Attribute::support) return;
      second.render(*points, camera_at({0, -4, 0.3}, 32, 24), {});
      EXPECT_NE(&second.prepared(), &cloud);
    });
  }
  EXPECT_FALSE(second.prepared().available.has(Attribute::uncertainty));
}

TEST_F(SharedCloudTest, TheFirstMayGo) {
  auto first = std::make_unique<Session>(context());
  set_scene(*first, 6000);
  Session second(context());
  second.share_scene(*first);
  first.reset();
  color_by_height(second);
  expect_same(pictures_of(second, 2), second_alone_, "second");
}

std::size_t resident_bytes() {
  glFinish();
  malloc_trim(0);
  std::size_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

TEST_F(SharedCloudTest, TheSecondTakesATenthAtMost) {
  for (const char* technique : {"points", "splats"}) {  // programs and targets are there
    Session small(context());
    set_scene(small, 6000, true);
    picture(small, technique, 0);
  }
  const std::size_t before = resident_bytes();
  Session first(context());
  set_scene(first, 1'500'000, true);
  picture(first, "points", 0), picture(first, "splats", 0);
  const std::size_t one = resident_bytes() - before;
  Session second(context());
  second.share_scene(first);
  picture(second, "points", 2), picture(second, "splats", 2);
  const std::size_t both = resident_bytes() - before;
  EXPECT_LT(both, one + one / 10) << one << " bytes of one, " << both << " of both";
  RecordProperty("share", std::to_string(double(both) / double(one)));
}

}  // namespace
}  // namespace sfumato::testing
