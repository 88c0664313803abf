// See-through surfaces and shadows through the built command.
#include <cmath>
#include <sstream>

#include "cli/command.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

struct Sheet {
  double height;
  int red, green, blue, code;  ///< sRGB, and the scalar `classification`
};

class LayersCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write("above.json",
          R"({"position": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "projection": "orthographic",
                            "height_world": 1, "width": 16, "height": 16})");
  }

  /// An ascii PLY of horizontal sheets |x|, |y| <= 1, z up, with normals.
  void write_sheets(const std::string& name, const std::vector<Sheet>& sheets, double extent = 1) {
    constexpr int side = 80;
    std::ostringstream file;
    file << "ply\nformat ascii 1.0\ncomment up +Z\nelement vertex " << sheets.size() * side * side
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
            "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property uchar classification\nend_header\n";
    for (const Sheet& s : sheets)
      for (int i = 0; i < side * side; ++i)
        file << extent * ((i % side + 0.5) / side * 2 - 1) << ' '
             << extent * ((i / side + 0.5) / side * 2 - 1) << ' ' << s.height << " 0 0 1 " << s.red << ' '
             << s.green << ' ' << s.blue << ' ' << s.code << '\n';
    write(name, file.str());
  }

  /// Linear premultiplied colour in the middle of the picture that these words make.
  std::vector<float> middle(Words words) {
    for (const char* word : {"-t", "layers", "-o", "c.npy", "--camera", "above.json", "--no-background",
                             "--shading", "albedo", "--edl", "off"})
      words.push_back(word);
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (outcome.code != 0) return {0, 0, 0, 0};
    const std::vector<float> values = read_npy("c.npy").values;
    const auto at = values.begin() + 4 * (8 * 16 + 8);
    return {at, at + 4};
  }
  static void expect_color(const std::vector<float>& actual, const std::vector<double>& expected,
                           const std::string& what) {
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(actual[k], expected[k], 1e-5) << what << ", channel " << k;
  }
};

// 0.3 of red over 0.5 of green over all of blue, whatever the order of the files, when the list follows it.
TEST_F(LayersCommand, OpacitiesFollowTheOrderOfTheFiles) {
  write_sheets("top.ply", {{0, 255, 0, 0, 0}});
  write_sheets("middle.ply", {{-0.4, 0, 255, 0, 0}});
  write_sheets("bottom.ply", {{-0.8, 0, 0, 255, 0}});
  const std::vector<double> expected{0.3, 0.7 * 0.5, 0.7 * 0.5, 1};
  expect_color(middle({"top.ply", "middle.ply", "bottom.ply", "--opacity", "0.3,0.5,1"}), expected,
               "top to bottom");
  expect_color(middle({"bottom.ply", "top.ply", "middle.ply", "--opacity", "1,0.3,0.5"}), expected,
               "bottom first");
  expect_color(middle({"middle.ply", "bottom.ply", "top.ply", "--opacity", "1,0.3,0.5"}), {0.5, 0.5, 0, 1},
               "the list does not follow the heights");
  expect_color(middle({"top.ply", "middle.ply", "bottom.ply", "--opacity", "0.3"}),
               {0.3, 0.21, 0.147, 1 - 0.343}, "one number");
  expect_color(middle({"top.ply", "middle.ply", "bottom.ply"}), {0.5, 0.25, 0.25, 1},
               "none: the last one is opaque");

  const Outcome wrong =
      run({"top.ply", "middle.ply", "bottom.ply", "-t", "layers", "-o", "a.png", "--opacity", "0.3,0.5"});
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("opacity lists 2 values, but scalar file has 3"));
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(LayersCommand, OpacitiesOfClasses) {
  write_sheets("classes.ply", {{0, 255, 0, 0, 6}, {-0.4, 0, 255, 0, 2}, {-0.8, 0, 0, 255, 9}});
  // Ascending: 2 (green), 6 (red), 9 (blue).
  expect_color(middle({"classes.ply", "--opacity", "0.6,0.2,1"}), {0.2, 0.8 * 0.6, 0.8 * 0.4, 1},
               "found by itself");
  expect_color(middle({"classes.ply", "--opacity", "0.6,0.2,1", "--opacity-by", "classification"}),
               {0.2, 0.8 * 0.6, 0.8 * 0.4, 1}, "named");
  // Two files of the same classes: files come first unless classes are asked for.
  write_sheets("more.ply", {{-1.2, 255, 255, 255, 9}});
  expect_color(middle({"classes.ply", "more.ply", "--opacity", "0.5,1"}),
               {0.5 + 0.125, 0.25 + 0.125, 0.125 + 0.125, 1}, "by file");
  expect_color(
      middle({"classes.ply", "more.ply", "--opacity", "0.6,0.2,1", "--opacity-by", "classification"}),
      {0.2, 0.8 * 0.6, 0.8 * 0.4, 1}, "by class");
}

TEST_F(LayersCommand, ShownLayerHasColourDepthAndNormals) {
  write_sheets("two.ply", {{0, 255, 0, 0, 0}, {-0.4, 0, 255, 0, 0}});
  for (int n : {1, 2, 3}) {
    const std::vector<float> color = middle({"two.ply", "--show-layer", std::to_string(n), "--opacity", "0.2",
                                             "--output-depth", "d.npy", "--output-normal", "n.npy"});
    const Array depth = read_npy("d.npy"), normal = read_npy("n.npy");
    ASSERT_EQ(depth.shape, (std::vector<int>{16, 16}));
    ASSERT_EQ(normal.shape, (std::vector<int>{16, 16, 3}));
    const std::size_t at = 8 * 16 + 8;
    expect_color(color, {double(n == 1), double(n == 2), 0, double(n < 3)}, "layer " + std::to_string(n));
    if (n < 3)
      EXPECT_NEAR(depth.values[at], n == 1 ? 5 : 5.4, 0.026) << "a disc is as deep as its radius, 1/40";
    else
      EXPECT_TRUE(std::isinf(depth.values[at]));
    EXPECT_NEAR(normal.values[3 * at + 2], n < 3, 1e-4) << "up, in 16-bit octahedral coordinates";
  }
}

// A figure on a white page: the page is darker where the light does not reach it, by as much as the caster is
// opaque.
TEST_F(LayersCommand, GroundCatchesTheShadow) {
  write_sheets("table.ply", {{1, 200, 50, 50, 0}}, 0.5);
  write_sheets("foot.ply", {{0, 200, 50, 50, 0}}, 0.02);
  write("page.json", R"({"position": [0, -4, 4], "target": [0, 0, 0.4], "up": [0, 0, 1], "fov_y_deg": 45,
                         "width": 120, "height": 90})");
  auto grey = [&](const Words& more) {
    Words words{"table.ply", "foot.ply", "-o", "a.png", "--camera", "page.json", "--light", "dir:1,0,1"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    // The ground at (-1, 0, 0): the table's shadow is moved there by its height.
    const double f = 45 / std::tan(22.5 * M_PI / 180), d = std::hypot(4, 3.6), depth = (4 * 4 + 3.6 * 4) / d;
    const double up = (4 * 3.6 - 4 * 4) / d;  // along the camera's up, of (0,0,0) seen from (0,-4,4)
    const Rgba8 c = read_png("a.png").at(int(60 - f / depth), int(45 - f * up / depth));
    EXPECT_EQ(c.r, c.b) << "no colour of the table";
    return int(c.r);
  };
  EXPECT_EQ(grey({"-t", "points", "--shadows", "hard"}), 255);
  const int dark = grey({"-t", "points", "--shadows", "hard", "--ground"});
  EXPECT_LT(dark, 150);
  const int half = grey({"-t", "layers", "--opacity", "0.5", "--shadows", "hard", "--ground"});
  EXPECT_GT(half, dark + 30);
  EXPECT_LT(half, 240);
  // Linear: 1 - darkness m.
  auto linear = [](int code) { return std::pow((code / 255.0 + 0.055) / 1.055, 2.4); };
  EXPECT_NEAR(1 - linear(half), 0.5 * (1 - linear(dark)), 0.02) << "8-bit codes around 0.4 are 0.005 apart";
}

TEST_F(LayersCommand, GroundAsksForShadows) {
  write_sheets("table.ply", {{1, 200, 50, 50, 0}}, 0.5);
  const Outcome outcome = run({"table.ply", "-o", "a.png", "--ground"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("--shadows soft"));
}

// The light of the first frame is that of all, and automatic sizes are told as numbers.
TEST_F(LayersCommand, ShadowsStayWhereTheyAreOnAPath) {
  write_sheets("table.ply", {{0, 200, 50, 50, 0}, {1, 200, 50, 50, 0}}, 0.5);
  auto parameters = [&](const Words& more) {
    Words words{"table.ply", "-o",   "a_{n:02}.png", "-t",    "points",
                "--shadows", "hard", "--resolution", "64x48", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json::parse(outcome.out).at("parameters");
  };
  const Json path = parameters({"--path", "orbit", "--frames", "3"});
  EXPECT_EQ(path.at("light").get<std::string>().substr(0, 4), "dir:");
  EXPECT_NEAR(path.at("light_size").get<double>(), 0.1 * std::sqrt(3.0),
              0.01);  // 1 x 1 x 1, less half a spacing
  EXPECT_NEAR(path.at("shadow_distance").get<double>(), 3.0 / 80, 0.6 / 80);  // a lattice: 20 % from its step
}

}  // namespace
