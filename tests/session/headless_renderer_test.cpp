// The library's own way from files to pictures.
#include "sfumato/renderer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "copc/build.h"
#include "core/error.h"
#include "io/io.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class HeadlessRendererTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    folder_ = std::filesystem::temp_directory_path() / ("sfumato_headless_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    GlTest::TearDown();
  }
  /// A point is a paraboloid as deep as its radius, 1.25 spacings of a plane().
  static constexpr double bulge = 1.25 * 0.0142;
  /// A plane of scattered points at height `z`, all of one class; x from `left` on, 2 wide.
  std::string plane(const std::string& name, double left, double z, int kind) const {
    const std::filesystem::path path = folder_ / name;
    std::ofstream out(path);
    out << "x,y,z,classification\n";
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, 2);
    for (int i = 0; i < 20'000; ++i)
      out << left + place(random) << ',' << place(random) << ',' << z << ',' << kind << '\n';
    return path;
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  static std::string value_of(const Pictures& p, const std::string& name) {
    for (const auto& [key, value] : p.parameters)
      if (key == name) return value;
    return "no such parameter";
  }

  std::filesystem::path folder_;
};

Camera above(double x) {
  Camera camera;
  camera.position = {x, 1, 5}, camera.target = {x, 1, 0}, camera.up = {0, 1, 0};
  camera.projection = Projection::orthographic;
  camera.height_world = 2;
  camera.width = 120, camera.height = 60;
  return camera;
}

TEST_F(HeadlessRendererTest, OpensFilesAsOneScene) {
  HeadlessRenderer renderer;
  renderer.open({{plane("a.csv", 0, 0, 2), plane("b.csv", 2, 0, 6)}});
  const Pictures p = renderer.render("points", above(2));
  for (int x : {10, 50, 70, 110})
    EXPECT_NEAR(p.depth.at(x, 30), 5, bulge) << x;  // files left and right of x = 2
  EXPECT_EQ(p.technique, "points");
  EXPECT_EQ(p.reason, "");
}

// More points than may be held: each picture has the points that it shows, as near as it stands.
TEST_F(HeadlessRendererTest, ReadsWhatViewsShowOfFilesWithLevels) {
  PointCloud cloud;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0, 10);
  for (int i = 0; i < 200'000; ++i) cloud.positions.push_back({place(random), place(random), 0});
  io::write(folder_ / "scan.las", cloud);
  copc::build({folder_ / "scan.las"}, folder_ / "scan.copc.laz");
  Camera near = above(5);
  near.position.y = near.target.y = 5;
  near.height_world = 0.5;
  const auto covered = [&](std::optional<std::uint64_t> most) {
    HeadlessRenderer renderer;
    renderer.open({.files = {folder_ / "scan.copc.laz"}, .max_points = most});
    renderer.render("points", renderer.first_view(120, 60));  // another view before
    const Pictures p = renderer.render("points", near, {{"point_size", "1"}});
    return std::count_if(p.depth.begin(), p.depth.end(), [](float depth) { return std::isfinite(depth); });
  };
  const std::ptrdiff_t of_all = covered({});
  EXPECT_GT(of_all, 500);
  EXPECT_GT(covered(20'000), of_all / 5);  // of a tenth of the points it would be a tenth

  HeadlessRenderer renderer;
  renderer.open({.files = {folder_ / "scan.copc.laz"}, .max_points = 20'000});
  const std::string reason = renderer.render("auto", renderer.first_view(120, 60)).reason;
  EXPECT_NE(reason, "");
  EXPECT_EQ(renderer.render("auto", near).reason, reason) << "that of the whole";
}

TEST_F(HeadlessRendererTest, RulesDrawPartsByTechniquesOfTheirOwn) {
  HeadlessRenderer renderer;
  const std::vector<std::string> files{plane("a.csv", 0, 0, 2), plane("b.csv", 2, 0, 6)};
  renderer.open({files, {"classification 6: none"}});
  const Pictures p = renderer.render("points", above(2));
  EXPECT_NEAR(p.depth.at(20, 30), 5, bulge);
  EXPECT_TRUE(std::isinf(p.depth.at(100, 30)));
  EXPECT_THROW(renderer.open({files, {"classification 6 surface"}}), Error);
}

TEST_F(HeadlessRendererTest, AutoSaysWhatItChoseAndWhatValuesItHas) {
  HeadlessRenderer renderer;
  renderer.open({{plane("a.csv", 0, 0, 2)}});
  const Pictures p = renderer.render("auto", renderer.first_view(120, 80));
  const std::vector<std::string> all = HeadlessRenderer::techniques();
  EXPECT_NE(std::find(all.begin(), all.end(), p.technique), all.end()) << p.technique;
  EXPECT_NE(p.reason, "");
  EXPECT_NE(value_of(p, "light"), "auto");
  EXPECT_EQ(
      value_of(renderer.render("points", renderer.first_view(120, 80), {{"point_size", "3"}}), "point_size"),
      "3");
}

TEST_F(HeadlessRendererTest, PresetsOfTheCommandHold) {
  const std::string file = write("look.json", R"({"technique": "points",
    "parameters": {"shading": "albedo", "points": {"point_size": 4}, "splats": {"radius_scale": 2}}})");
  const PresetLook look = read_preset(file);
  EXPECT_EQ(look.technique, "points");
  const Parameters expected{{"shading", "albedo"}, {"point-size", "4"}};
  EXPECT_TRUE(
      std::is_permutation(look.parameters.begin(), look.parameters.end(), expected.begin(), expected.end()));
  EXPECT_EQ(read_preset(file, "splats").parameters.size(), 2u);
  EXPECT_THROW(read_preset(write("bad.json", "{")), Error);
}

TEST_F(HeadlessRendererTest, ReadsBackWhatIsAskedFor) {
  HeadlessRenderer renderer;
  renderer.set_cloud(sphere_cloud(2000));
  renderer.set_outputs({.color = true, .linear = false, .depth = true, .normal = false});
  const Pictures p = renderer.render("points", renderer.first_view(40, 30));
  EXPECT_EQ(p.color.size(), 1200u);
  EXPECT_EQ(p.depth.size(), 1200u);
  EXPECT_TRUE(p.linear.empty() && p.normal.empty());
}

// Tables by the points' places are as long as the sample, not as the file it is of.
TEST_F(HeadlessRendererTest, DrawsASampleOfAnyFile) {
  PointCloud cloud = sphere_cloud(2000);
  HeadlessRenderer renderer;
  renderer.set_cloud(cloud);
  const Camera camera = renderer.first_view(40, 30);
  const Pictures of_all = renderer.render("points", camera);
  for (std::uint32_t i = 0; i < 2000; ++i) cloud.source_index.push_back(2'000'000 * i);
  renderer.set_cloud(cloud);
  const Pictures of_sample = renderer.render("points", camera);
  EXPECT_TRUE(std::equal(of_all.color.begin(), of_all.color.end(), of_sample.color.begin()));
}

TEST_F(HeadlessRendererTest, NamesWhatIsMissing) {
  HeadlessRenderer renderer;
  EXPECT_THROW(renderer.render("points", above(0)), Error);
  EXPECT_THROW(renderer.open({}), Error);
  try {
    renderer.open({{(folder_ / "none.laz").string()}});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("none.laz"), std::string::npos) << e.what();
  }
}

}  // namespace
