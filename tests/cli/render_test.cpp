// Files to pictures through the built command.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "cli/command.h"
#include "core/color.h"
#include "reference/png.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

using Json = nlohmann::json;

class RenderTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write_cube("cube.ply");
    first_words_ = {"-t", "points"};  // what these tests look at does not change with the default technique
  }
  /// The cube from the front (-y), 2 units before its face, 64x48.
  std::string write_front_camera() {
    return write("front.json", R"({"position": [0.5, -2, 0.5], "target": [0.5, 0, 0.5], "up": [0, 0, 1],
                                   "fov_y_deg": 45, "width": 64, "height": 48})");
  }
};

bool is_white(const Rgba8& c) { return c.r == 255 && c.g == 255 && c.b == 255; }

TEST_F(RenderTest, MeshesAreDrawnByTheirFaces) {
  write("square.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n");
  const auto filled = [&](const std::vector<std::string>& more, const std::string& says) {
    std::vector<std::string> words = {"square.obj", "-o",   "a.png", "--resolution", "64x48", "--view",
                                      "front",      "--up", "+Y"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err + outcome.out, HasSubstr(says));
    const Image<Rgba8> image = read_png("a.png");
    int count = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) count += image.at(x, y) != image.at(0, 0);
    return count;
  };
  EXPECT_GT(filled({}, "1 face sampled to 259200 points (--vertices: the vertices alone)"), 1000);
  EXPECT_LT(filled({"--vertices"}, "4 points, coloured by elevation"), 300) << "too few for light to show";
}

TEST_F(RenderTest, FirstViewFramesTheCloudInItsColours) {
  const Json json = run_json({"cube.ply", "-o", "a.png", "--resolution", "128x96", "--shading", "albedo",
                              "--background-color", "white", "--json"});
  const Image<Rgba8> image = read_png("a.png");
  ASSERT_EQ(image.width(), 128);
  ASSERT_EQ(image.height(), 96);
  int covered = 0, edge = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 128; ++x) {
      if (is_white(image.at(x, y))) continue;
      ++covered;
      edge += x == 0 || y == 0 || x == 127 || y == 95;
    }
  EXPECT_GT(covered, 128 * 96 / 8) << "a cube framed with a margin covers more than an eighth";
  EXPECT_EQ(edge, 0) << "nothing is cut";
  const Rgba8 low = image.at(64, 86), high = image.at(64, 25);
  EXPECT_GT(low.r, low.g + 50) << "red below";
  EXPECT_GT(high.g, high.r + 50) << "green above: z is up and the first row on top";
  // What stands is seen from azimuth -30, elevation 14: the camera is at -x, farther at -y, a little above.
  const Json eye = json["camera"]["position"], target = json["camera"]["target"];
  const auto way = [&](int axis) { return eye[axis].get<double>() - target[axis].get<double>(); };
  EXPECT_LT(way(0), 0);
  EXPECT_NEAR(way(0) / way(1), std::tan(glm::radians(30.0)), 1e-6);
  EXPECT_NEAR(way(2) / std::hypot(way(0), way(1)), std::tan(glm::radians(14.0)), 1e-6);
}

TEST_F(RenderTest, ReportHasItsFields) {
  const Json json =
      run_json({"cube.ply", "-o", "a.png", "--resolution", "64,48", "--json", "--point-size", "3"});
  EXPECT_EQ(json["outputs"], Json{"a.png"});
  EXPECT_EQ(json["technique"], "points");
  EXPECT_EQ(json["parameters"]["point_size"], 3);
  EXPECT_EQ(json["parameters"]["edl"], true) << "resolved, not auto";
  EXPECT_EQ(json["points_read"], 5400);
  EXPECT_EQ(json["points_drawn"], 5400);
  EXPECT_GT(json["timings_ms"]["total"].get<double>(), 0);
  EXPECT_GT(json["timings_ms"].size(), 1u);
}

// What has no colours of its own shows its small shapes by a little eye-dome lighting.
TEST_F(RenderTest, SplatsWithoutColorsShowTheirRelief) {
  const auto edl = [&](std::vector<std::string> more) {
    std::vector<std::string> line{"cube.ply", "-t",           "splats", "-o",
                                  "a.png",    "--resolution", "64,48",  "--json"};
    line.insert(line.end(), more.begin(), more.end());
    const Json json = run_json(line)["parameters"];
    return std::pair(json["edl"].get<bool>(), json["edl_strength"].get<double>());
  };
  EXPECT_EQ(edl({"--color-by", "elevation"}), std::pair(true, 0.12));
  EXPECT_EQ(edl({"--color-by", "clay"}), std::pair(true, 0.12));
  EXPECT_EQ(edl({"--color-by", "rgb"}), std::pair(true, 0.12)) << "a few colours are no photograph";
  EXPECT_EQ(edl({"--color-by", "clay", "--edl", "false"}).first, false);
  EXPECT_EQ(edl({"--color-by", "clay", "-t", "points"}), std::pair(true, 0.12));
}

TEST_F(RenderTest, PictureNamesTheCommandThatMadeIt) {
  ASSERT_EQ(run({"cube.ply", "-o", "it's.png", "--resolution", "32x32"}).code, 0);
  const auto texts = png_texts("it's.png");
  EXPECT_EQ(texts.at("Command"), "sfumato -t points cube.ply -o 'it'\\''s.png' --resolution 32x32");
  EXPECT_THAT(texts.at("Software"), ::testing::StartsWith("sfumato "));
  EXPECT_TRUE(texts.contains("sRGB"));
  EXPECT_TRUE(Json::parse(texts.at("Camera")).contains("position"));
}

TEST_F(RenderTest, SameCommandGivesTheSameBytes) {
  ASSERT_EQ(run({"cube.ply", "-o", "a.png", "--resolution", "64x48"}).code, 0);
  const std::string first = text("a.png");
  ASSERT_EQ(run({"cube.ply", "-o", "a.png", "--resolution", "64x48"}).code, 0);
  EXPECT_EQ(text("a.png"), first);
}

TEST_F(RenderTest, BackgroundAndTransparency) {
  ASSERT_EQ(run({"cube.ply", "-o", "a.png", "--resolution", "32x32", "--background-color", "0,0.6,1"}).code,
            0);
  EXPECT_EQ(read_png("a.png").at(0, 0), (Rgba8{0, 153, 255, 255}));
  ASSERT_EQ(run({"cube.ply", "-o", "b.png", "--resolution", "32x32", "--no-background"}).code, 0);
  EXPECT_EQ(read_png("b.png").at(0, 0).a, 0);
  EXPECT_EQ(read_png("b.png").at(16, 16).a, 255);
}

// What is laid on paper, and shadows on a ground, are on white, though the colours of the points are on dark.
TEST_F(RenderTest, PaperIsWhite) {
  std::string ball;
  for (int i = 0; i < 3000; ++i) {
    const double z = (i + 0.5) / 1500 - 1, turn = 2.4 * i, radius = std::sqrt(1 - z * z);
    const double x = radius * std::cos(turn), y = radius * std::sin(turn);
    ball += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " " +
            std::to_string(120 + i % 100) + " " + std::to_string(140 + i % 70) + " 120\n";
  }
  write("ball.xyz", ball);
  const auto corner = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"ball.xyz", "-o", "p.png", "--resolution", "64x48"});
    EXPECT_EQ(run(words).code, 0);
    return read_png("p.png").at(0, 0);
  };
  const Rgba8 white{255, 255, 255, 255};
  const Rgba8 slate{59, 71, 94, 255};  // of photographs, which more than 64 colours are
  EXPECT_EQ(corner({"-t", "points"}), slate);
  EXPECT_EQ(corner({"-t", "strokes"}), slate);
  EXPECT_LT(luma(corner({"-t", "points", "--color-by", "elevation"})), 50);
  EXPECT_GT(luma(corner({"-t", "strokes", "--style", "charcoal"})), 200);
  EXPECT_EQ(corner({"-t", "splats", "--shadows", "hard", "--ground"}), white);
  EXPECT_EQ(corner({"-t", "points", "--background-color", "white"}), white);
  EXPECT_LT(luma(corner({"-t", "strokes", "--style", "charcoal", "--background-color", "#101010"})), 50);
  // The names of a transparent sheet are to be read on a page.
  ASSERT_EQ(
      run({"ball.xyz", "-t", "points,splats", "--no-background", "-o", "s.png", "--resolution", "160x120"})
          .code,
      0);
  const Image<Rgba8> sheet = read_png("s.png");
  double darkest = 255;
  for (int x = 0; x < sheet.width(); ++x)
    for (int y = 0; y < 16; ++y)
      if (sheet.at(x, y).a > 200) darkest = std::min(darkest, luma(sheet.at(x, y)));
  EXPECT_LT(darkest, 60);
}

TEST_F(RenderTest, DepthNormalAndLinearArrays) {
  write_front_camera();
  write_cube("fine.ply", 60);  // at least one point in each of the 29 x 29 pixels of the face
  const Outcome outcome =
      run({"fine.ply",       "-o",          "c.npy",           "--camera",        "front.json",
           "--output-depth", "d.npy",       "--output-normal", "n.npy",           "--output-camera",
           "k.json",         "--shading",   "albedo",          "--no-background", "--edl",
           "false",          "--size-mode", "pixels",          "--point-size",    "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Array color = read_npy("c.npy"), depth = read_npy("d.npy"), normal = read_npy("n.npy");
  EXPECT_EQ(color.shape, (std::vector<int>{48, 64, 4}));
  EXPECT_EQ(depth.shape, (std::vector<int>{48, 64}));
  EXPECT_EQ(normal.shape, (std::vector<int>{48, 64, 3}));
  const std::size_t centre = 20 * 64 + 32;
  EXPECT_NEAR(depth.values[centre], 2.0, 1e-4) << "float32 in 24 bits of depth range 2..3.5";
  EXPECT_TRUE(std::isinf(depth.values[0]));
  EXPECT_EQ(color.values[4 * centre + 1], 1.0f) << "linear green";
  EXPECT_EQ(color.values[4 * centre + 3], 1.0f);
  EXPECT_EQ(color.values[3], 0.0f);
  const Json camera = Json::parse(text("k.json"));
  EXPECT_EQ(camera["width"], 64);
  EXPECT_EQ(camera["position"], (Json{0.5, -2.0, 0.5}));
}

// Points whose colours are their numbers: the picture says which is seen where.
TEST_F(RenderTest, IndexSaysWhichPointIsSeen) {
  const auto file = [&](const std::string& name, int first) {
    std::string text = "x y z r g b\n";
    for (int i = first; i < first + 2000; ++i)
      text += std::to_string(i * 7919 % 1009 / 1009.0) + " " + std::to_string(i * 104729 % 2003 / 2003.0) +
              " " + std::to_string(i * 15487 % 997 / 997.0) + " " + std::to_string(i & 63) + " " +
              std::to_string(i >> 6) + " 200\n";
    return write(name, text);
  };
  file("a.txt", 0), file("b.txt", 2000), write_front_camera();
  const auto check = [&](std::vector<std::string> words) {
    const std::string plain =
        "-o a.png --camera front.json --output-index i.npy --output-depth d.npy --shading albedo --edl false "
        "--ambient-occlusion 0 --smooth-outlines false --size-mode pixels --point-size 1 --exposure 1";
    std::stringstream more(plain);
    for (std::string word; more >> word;) words.push_back(word);
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Array index = read_npy("i.npy"), depth = read_npy("d.npy");
    const Image<Rgba8> image = read_png("a.png");
    EXPECT_EQ(index.type, "<i8");
    ASSERT_EQ(index.shape, (std::vector<int>{48, 64}));
    std::size_t seen = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
      const Rgba8 c = image.data()[i];
      EXPECT_EQ(index.indices[i], std::isinf(depth.values[i]) ? -1 : (c.g << 6) + c.r) << i;
      seen += index.indices[i] >= 0;
    }
    EXPECT_GT(seen, 300u);
  };
  check({"a.txt"});
  check({"a.txt", "b.txt"});
  check({"a.txt", "b.txt", "--crop", "0,0,0,1,1,0.7"});
  ::setenv("SFUMATO_TILE", "64", 1);
  check({"a.txt", "b.txt", "--draw", "z 0..0.3: points size_mode=pixels point_size=1"});
  ::unsetenv("SFUMATO_TILE");
  EXPECT_THAT(run({"a.txt", "--output-index", "i.png"}).err, HasSubstr(".npy"));
}

TEST_F(RenderTest, DepthAsPngInAUnit) {
  write_front_camera();
  const auto words = [](const std::string& unit, const std::string& file) {
    return std::vector<std::string>{
        "cube.ply", "--camera", "front.json", "--depth-unit", unit, "--output-depth", file, "--unit", "m"};
  };
  ASSERT_EQ(run({"cube.ply", "--camera", "front.json", "--output-depth", "d.npy"}).code, 0);
  const Array depth = read_npy("d.npy");
  for (const auto& [unit, steps] : {std::pair("mm", 1000.0), {"cm", 100.0}, {"0.0002", 5000.0}}) {
    const Outcome outcome = run(words(unit, "d.png"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("beyond")));
    const Image<std::uint16_t> gray = read_gray(path("d.png"));
    for (std::size_t i = 0; i < gray.size(); ++i)
      ASSERT_NEAR(gray.data()[i], std::isinf(depth.values[i]) ? 0 : double(depth.values[i]) * steps, 0.51)
          << i;
    EXPECT_THAT(png_texts("d.png").at("DepthUnit"), HasSubstr(unit));
  }
  const Outcome outcome = run(words("0.00003", "d.png"));
  EXPECT_THAT(outcome.err, HasSubstr("beyond 65535"));
  const Image<std::uint16_t> gray = read_gray(path("d.png"));
  EXPECT_EQ(gray.at(32, 24), 65535);
  EXPECT_EQ(gray.at(0, 0), 0);
  EXPECT_THAT(run(words("mm", "d.npy")).err, HasSubstr("--depth-unit"));
  EXPECT_THAT(run(words("parsec", "d.png")).err, HasSubstr("parsec"));
}

TEST_F(RenderTest, DepthAloneNeedsNoPicture) {
  const Outcome outcome = run({"cube.ply", "--resolution", "32x32", "--output-depth", "d.npy", "--shading",
                               "albedo", "--edl", "false", "--quiet"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "") << "GL objects are deleted before their context";
  EXPECT_EQ(files(), (std::vector<std::string>{"cube.ply", "d.npy"}));
}

TEST_F(RenderTest, ExrHoldsColourDepthAndNormals) {
  write_front_camera();
  write_cube("fine.ply", 60);
  ASSERT_EQ(run({"fine.ply", "-o", "a.exr", "--camera", "front.json", "--shading", "albedo", "--size-mode",
                 "pixels", "--point-size", "1", "--edl", "false", "--background-color", "white"})
                .code,
            0);
  Imf::InputFile file(path("a.exr").c_str());
  for (const char* name : {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z"}) {
    const Imf::Channel* channel = file.header().channels().findChannel(name);
    ASSERT_NE(channel, nullptr) << name;
    EXPECT_EQ(channel->type, Imf::FLOAT);
  }
  EXPECT_THAT(Imf::comments(file.header()), HasSubstr("sfumato -t points fine.ply"));
  Image<float> green(64, 48), depth(64, 48);
  Imf::FrameBuffer buffer;
  buffer.insert("G", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(green.data()), 4, 4 * 64));
  buffer.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data()), 4, 4 * 64));
  file.setFrameBuffer(buffer);
  file.readPixels(0, 47);
  EXPECT_EQ(green.at(32, 20), 1.0f);
  EXPECT_NEAR(depth.at(32, 20), 2.0, 1e-4);
  EXPECT_EQ(green.at(0, 0), 1.0f) << "white background";
}

// Pictures that are larger than a canvas are drawn and written in tiles; the files are the same.
TEST_F(RenderTest, TilesWriteTheSameFiles) {
  const auto pictures = [&](const std::string& name) {
    for (const std::vector<std::string>& outputs :
         {std::vector<std::string>{"-o", name + ".png", "--output-depth", name + "_depth.npy",
                                   "--output-normal", name + "_normal.npy", "--output-camera",
                                   name + ".json"},
          {"-o", name + ".exr", "--output-depth", name + "_depth.png"},
          {"-o", name + ".npy", "--output-depth", name + "_depth.exr"},
          {"-o", name + ".jpg", "--quality", "90"}}) {
      std::vector<std::string> words{"cube.ply", "--resolution", "300x210",   "--edl",
                                     "true",     "--color-by",   "elevation", "--quiet"};
      if (outputs[1].ends_with("g")) words.push_back("--legend");
      words.insert(words.end(), outputs.begin(), outputs.end());
      const Outcome outcome = run(words);
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
    }
  };
  pictures("whole");
  ::setenv("SFUMATO_TILE", "64", 1);
  pictures("tiles");
  const Outcome blank = run({"cube.ply", "-o", "sky.png", "--resolution", "200x100", "--camera-position",
                             "0,0,50", "--camera-direction", "0,0,1"});
  ::unsetenv("SFUMATO_TILE");
  EXPECT_THAT(blank.err, HasSubstr("the picture is empty"));
  for (const char* ending : {"_depth.npy", "_normal.npy", ".json", ".npy", ".jpg"})
    EXPECT_EQ(text(std::string("tiles") + ending), text(std::string("whole") + ending)) << ending;
  // Those keep the command.
  const Image<Rgba8> whole = read_png("whole.png"), tiles = read_png("tiles.png");
  for (std::size_t i = 0; i < whole.size(); ++i) ASSERT_EQ(tiles.data()[i], whole.data()[i]) << i;
  for (const char* name : {".exr", "_depth.exr"}) {
    const auto planes = [&](const std::string& file_name) {
      Imf::InputFile file(path(file_name).c_str());
      std::vector<float> all;
      for (auto channel = file.header().channels().begin(); channel != file.header().channels().end();
           ++channel) {
        Image<float> plane(300, 210);
        Imf::FrameBuffer buffer;
        buffer.insert(channel.name(),
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), 4, 4 * 300));
        file.setFrameBuffer(buffer);
        file.readPixels(0, 209);
        all.insert(all.end(), plane.begin(), plane.end());
      }
      return all;
    };
    EXPECT_EQ(planes(std::string("tiles") + name), planes(std::string("whole") + name)) << name;
  }
}

TEST_F(RenderTest, CameraFileAndSingleOptions) {
  write_front_camera();
  auto camera = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"cube.ply", "--output-camera", "k.json"});
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json::parse(text("k.json"));
  };
  EXPECT_EQ(camera({"--camera", "front.json", "--resolution", "20x10"})["width"], 20);
  EXPECT_EQ(camera({"--camera", "front.json", "--camera-position", "0.5,-4,0.5"})["position"][1], -4.0);
  EXPECT_NEAR(camera({"--camera", "front.json", "--camera-view-angle", "30"})["fov_y_deg"].get<double>(), 30,
              1e-9);
  EXPECT_EQ(camera({"--camera", "front.json", "--camera-orthographic"})["projection"], "orthographic");
  const Json turned = camera({"--camera", "front.json", "--camera-azimuth-angle", "90"});
  EXPECT_NEAR(turned["position"][0].get<double>(), 2.5, 1e-9) << "counter-clockwise about +z: from -y to +x";
  EXPECT_NEAR(turned["position"][1].get<double>(), 0.0, 1e-9);
  const Json down = camera({"--camera-direction", "0,0,-1"});
  EXPECT_NEAR(down["position"][0].get<double>(), 0.5, 1e-3);
  EXPECT_GT(down["position"][2].get<double>(), 2);
  EXPECT_GT(camera({"--up", "+Y"})["position"][1].get<double>(), 0.5 + 0.2);

  write("pinhole.json", R"({"position": [0.5, -2, 0.5], "target": [0.5, 0, 0.5], "up": [0, 0, 1],
                            "fx": 50, "fy": 50, "cx": 30, "cy": 24, "width": 64, "height": 48})");
  EXPECT_EQ(camera({"--camera", "pinhole.json"})["cx"], 30.0);
  const Outcome refused =
      run({"cube.ply", "-o", "a.png", "--camera", "pinhole.json", "--resolution", "20x10"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("intrinsics"));
}

TEST_F(RenderTest, SeveralFilesAreOneScene) {
  const Json one = run_json({"cube.ply", "-o", "a.png", "--resolution", "32x32", "--json"});
  const Json two = run_json({"cube.ply", "cube.ply", "-o", "b.png", "--resolution", "32x32", "--json"});
  EXPECT_EQ(two["points_read"].get<int>(), 2 * one["points_read"].get<int>());
  const Json few = run_json(
      {"cube.ply", "cube.ply", "-o", "b.png", "--resolution", "32x32", "--json", "--max-points", "100"});
  EXPECT_EQ(few["points_drawn"], 100);
}

TEST_F(RenderTest, ContactSheetShowsEveryTechniqueWithItsLabel) {
  const Json json =
      run_json({"cube.ply", "-t", "points,points", "-o", "sheet.png", "--resolution", "96x64", "--json"});
  const Image<Rgba8> sheet = read_png("sheet.png");
  EXPECT_GE(sheet.width(), 2 * 96);
  EXPECT_GT(sheet.height(), 64);
  int label = 0;
  for (int x = 0; x < 96; ++x)
    for (int y = 0; y < sheet.height() - 64; ++y) label += sheet.at(x, y).r < 128;
  EXPECT_GT(label, 20) << "letters of the word 'points' above the first panel";
  EXPECT_EQ(json["technique"], (Json{"points", "points"}));
}

TEST_F(RenderTest, PanelsOfTheSheetAreThePicturesOfEachTechnique) {
  const Json json = run_json({"cube.ply", "-t", "points,splats", "-o", "sheet.png", "--output-panels",
                              "cube_{technique}.png", "--resolution", "96x64", "--json"});
  for (const std::string technique : {"points", "splats"}) {
    run_json({"cube.ply", "-t", technique, "-o", "alone.png", "--resolution", "96x64", "--json"});
    const Image<Rgba8> panel = read_png("cube_" + technique + ".png"), alone = read_png("alone.png");
    ASSERT_EQ(panel.width(), alone.width());
    ASSERT_EQ(panel.height(), alone.height());
    EXPECT_TRUE(std::equal(panel.data(), panel.data() + 96 * 64, alone.data())) << technique;
  }
  EXPECT_EQ(json["outputs"], (Json{"cube_points.png", "cube_splats.png", "sheet.png"}));
}

TEST_F(RenderTest, QualifiedParametersReachOneTechnique) {
  const Json json = run_json({"cube.ply", "-o", "a.png", "--resolution", "32x32", "--points.point-size", "2",
                              "--point-size", "5", "--json"});
  EXPECT_EQ(json["parameters"]["point_size"], 2) << "the qualified name wins";
}

// One picture a file, all from the camera of the first.
TEST_F(RenderTest, ASequenceIsOnePictureAFile) {
  write_cube("a.ply");
  write_cube("b.ply", 20);
  const Json json = run_json({"a.ply", "b.ply", "a.ply", "--sequence", "-o", "f_{n:04}.png", "--resolution",
                              "48x32", "-t", "points", "--json"});
  EXPECT_EQ(json["outputs"].size(), 3u);
  const Image<Rgba8> first = read_png("f_0000.png"), other = read_png("f_0001.png"),
                     again = read_png("f_0002.png");
  EXPECT_TRUE(std::equal(first.begin(), first.end(), again.begin()));
  EXPECT_FALSE(std::equal(first.begin(), first.end(), other.begin()));
  EXPECT_NE(run({"a.ply", "b.ply", "--sequence", "-o", "f.png"}).err.find("{n:04}"), std::string::npos);
  EXPECT_NE(run({"a.ply", "--sequence", "--path", "orbit", "-o", "f_{n}.png"}).err.find("leave out --path"),
            std::string::npos);
}

// Nothing of the cloud before is left in a frame. 20 and 23 points a side: their spacings lie on either side
// of where the steps that strokes round places to would change.
TEST_F(RenderTest, AFrameOfASequenceIsThePictureOfItsFile) {
  write_cube("a.ply", 20);
  write_cube("b.ply", 23);
  write("camera.json", R"({"position": [2.5, -3, 2], "target": [0.5, 0.5, 0.5]})");
  for (const char* technique : {"strokes", "surface", "soft"}) {
    SCOPED_TRACE(technique);
    const std::vector<std::string> look{"-t",           technique, "--camera", "camera.json",
                                        "--resolution", "64x48",   "--json"};
    std::vector<std::string> sequence{"a.ply", "b.ply", "--sequence", "-o", "f_{n}.png"},
        alone{"b.ply", "-o", "b.png"};
    sequence.insert(sequence.end(), look.begin(), look.end());
    // What stands still is held where it was, which is another cloud.
    if (technique == std::string("strokes")) sequence.insert(sequence.end(), {"--hold-still", "false"});
    alone.insert(alone.end(), look.begin(), look.end());
    run_json(sequence);
    run_json(alone);
    const Image<Rgba8> frame = read_png("f_1.png"), picture = read_png("b.png");
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), picture.begin()));
  }
}

// A wall measured twice, with noise of a twentieth of its spacing.
TEST_F(RenderTest, NoiseOfASequenceMovesNoStrokes) {
  for (int file = 0; file < 2; ++file) {
    std::mt19937 random(unsigned(file + 1));
    std::uniform_real_distribution<double> noise(-0.001, 0.001);
    std::ostringstream text;
    for (int i = 0; i < 3600; ++i)
      text << 0.02 * (i % 60) << " " << noise(random) << " " << 0.02 * (i / 60) << " " << 60 + 3 * (i % 60)
           << " " << i / 600 % 2 * 120 + 60 << " 90\n";
    write(file == 0 ? "a.xyz" : "b.xyz", text.str());
  }
  write("camera.json", R"({"position": [0.6, -2, 0.6], "target": [0.6, 0, 0.6]})");
  auto change = [&](const char* hold) {
    run_json({"a.xyz", "b.xyz", "--sequence", "-t", "strokes", "--hold-still", hold, "--camera",
              "camera.json", "--resolution", "160x120", "-o", "f_{n}.png", "--json"});
    const Image<Rgba8> a = read_png("f_0.png"), b = read_png("f_1.png");
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a.data()[i].g - b.data()[i].g);
    return sum / double(a.size());
  };
  EXPECT_LT(change("true"), 0.1);
  EXPECT_GT(change("false"), 0.5);
}

TEST_F(RenderTest, OrbitWritesOnePictureAFrame) {
  const Json json = run_json({"cube.ply", "-o", "f_{n:04}.png", "--path", "orbit", "--frames", "4",
                              "--resolution", "48x32", "--output-camera", "c_{n}.json", "--json"});
  EXPECT_EQ(json["frames"], 4);
  for (const char* name : {"f_0000.png", "f_0001.png", "f_0002.png", "f_0003.png"})
    EXPECT_TRUE(exists(name)) << name;
  EXPECT_FALSE(exists("f_0004.png"));
  const Json first = Json::parse(text("c_0.json")), opposite = Json::parse(text("c_2.json"));
  for (int k = 0; k < 3; ++k) {  // half a turn: mirrored at the target, at the same height
    const double a = first["position"][k], b = opposite["position"][k], t = first["target"][k];
    EXPECT_NEAR(b, k == 2 ? a : 2 * t - a, 1e-9);
  }
}

TEST_F(RenderTest, PathGoesThroughItsCameras) {
  write("path.json", R"({"cameras": [
    {"position": [0.5, -3, 0.5], "target": [0.5, 0, 0.5]}, {"position": [3.5, -3, 0.5], "target": [0.5, 0, 0.5]},
    {"position": [3.5, 3, 0.5], "target": [0.5, 0, 0.5]}]})");
  ASSERT_EQ(run({"cube.ply", "--path", "path.json", "--frames", "3", "--output-camera", "c_{n}.json"}).code,
            0);
  EXPECT_EQ(Json::parse(text("c_0.json"))["position"], (Json{0.5, -3.0, 0.5}));
  EXPECT_EQ(Json::parse(text("c_1.json"))["position"], (Json{3.5, -3.0, 0.5}));
  EXPECT_EQ(Json::parse(text("c_2.json"))["position"], (Json{3.5, 3.0, 0.5}));
}

// Blurred while the camera moves, sorted on while it stands still (dos Anjos 2017, Alg. 2).
TEST_F(RenderTest, StrokesOfAPathAreSortedWhileTheCameraStandsStill) {
  write("path.json", R"({"cameras": [{"position": [0.5, -3, 0.5], "target": [0.5, 0, 0.5]},
                                     {"position": [0.5, -3, 0.5], "target": [0.5, 0, 0.5]}]})");
  write("camera.json", R"({"position": [0.5, -3, 0.5], "target": [0.5, 0, 0.5]})");
  const std::vector<std::string> look{"cube.ply", "-t", "strokes", "--resolution", "96x64", "--json"};
  auto shoot = [&](std::vector<std::string> words) {
    words.insert(words.begin(), look.begin(), look.end());
    run_json(words);
  };
  shoot({"--camera", "camera.json", "-o", "sorted.png"});
  shoot({"--camera", "camera.json", "--blend", "blur", "-o", "blurred.png"});
  shoot({"--path", "path.json", "--frames", "6", "--refine", "per_frame", "--min-sorted", "0", "--sort-steps",
         "64", "-o", "f_{n}.png"});
  const auto same = [](const Image<Rgba8>& a, const Image<Rgba8>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
  };
  EXPECT_TRUE(same(read_png("f_0.png"), read_png("blurred.png")));
  EXPECT_TRUE(same(read_png("f_5.png"), read_png("sorted.png")));
  EXPECT_FALSE(same(read_png("f_0.png"), read_png("sorted.png")));
}

TEST_F(RenderTest, PresetReproducesThePicture) {
  write_front_camera();
  ASSERT_EQ(run({"cube.ply",
                 "-o",
                 "a.npy",
                 "--resolution",
                 "64x48",
                 "--color-by",
                 "row",
                 "--colormap",
                 "turbo",
                 "--point-size",
                 "2.5",
                 "--edl",
                 "--camera",
                 "front.json",
                 "--camera-view-angle",
                 "35",
                 "--background-color",
                 "0.2,0.3,0.4",
                 "--save-preset",
                 "look.json"})
                .code,
            0);
  ASSERT_EQ(run({"cube.ply", "-o", "b.npy", "--preset", "look.json"}).code, 0);
  EXPECT_EQ(text("a.npy"), text("b.npy"));
  // Options beside a preset win over it.
  const Json json =
      run_json({"cube.ply", "-o", "b.png", "--preset", "look.json", "--point-size", "4", "--json"});
  EXPECT_EQ(json["parameters"]["point_size"], 4);
  EXPECT_EQ(json["color_by"], "row");
}

TEST_F(RenderTest, LegendExplainsTheColours) {
  const std::vector<std::string> words = {"cube.ply", "--resolution", "160x120", "--color-by", "row", "-o"};
  auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(run(all).code, 0);
    return read_png(more[0]);
  };
  const Image<Rgba8> plain = with({"a.png"}), legend = with({"b.png", "--legend"});
  int changed = 0, yellow = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      if (plain.at(x, y) == legend.at(x, y)) continue;
      ++changed;
      EXPECT_GT(x, 80) << "it stands in the right half";
      yellow += legend.at(x, y).r > 200 && legend.at(x, y).g > 200 && legend.at(x, y).b < 80;
    }
  EXPECT_GT(changed, 200);
  EXPECT_GT(yellow, 3) << "the upper end of viridis";
}

TEST_F(RenderTest, NothingIsLeftBehindOnErrors) {
  EXPECT_EQ(run({"cube.ply", "-o", "missing/a.png", "--resolution", "32x32"}).code, 6);
  EXPECT_EQ(run({"cube.ply", "-o", "/proc/a.png", "--resolution", "32x32"}).code, 6);
  EXPECT_EQ(run({"cube.ply", "-o", "a.png", "--resolution", "70000x32"}).code, 1);
  // Wider than its format holds, which is seen only when the picture is there.
  EXPECT_EQ(
      run({"cube.ply", "-o", "a.webp", "--output-depth", "d.npy", "--resolution", "16400x16", "-t", "points"})
          .code,
      1);
  EXPECT_EQ(files(), std::vector<std::string>{"cube.ply"});
}

TEST_F(RenderTest, InterruptEndsWith130AndWholeFilesOnly) {
  const Outcome outcome = run(
      {"cube.ply", "-o", "f_{n:05}.png", "--path", "orbit", "--frames", "100000", "--resolution", "64x48"},
      1500);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(outcome.err, "sfumato: interrupted\n");
  for (const std::string& name : files())
    if (name != "cube.ply")
      EXPECT_EQ(read_png(name).width(), 64) << name << " is a whole picture, not a temporary";
}

TEST_F(RenderTest, StrayPointsDoNotDecideTheFirstView) {
  // One point in a hundred lies far above: outside the 2-98 % box.
  std::string file = text("cube.ply");
  file.replace(file.find("vertex 5400"), 11, "vertex 5454");
  for (int i = 0; i < 54; ++i) file += "0.5 0.5 500 0 0 255 0\n";
  write("noisy.ply", file);
  const Json clean = run_json({"cube.ply", "-o", "a.png", "--resolution", "64x48", "--json"});
  const Json noisy = run_json({"noisy.ply", "-o", "a.png", "--resolution", "64x48", "--json"});
  for (int k = 0; k < 3; ++k)  // a unit cube seen from about 3: the same view within a tenth
    EXPECT_NEAR(noisy["camera"]["position"][k].get<double>(), clean["camera"]["position"][k].get<double>(),
                0.3);
}

TEST_F(RenderTest, WithoutGlExitCode4SaysWhatToInstall) {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/none", 1);  // libglvnd then finds no driver
  first_words_ = {};
  const Outcome outcome = run({"cube.ply", "-o", "a.png"}), doctor = run({"doctor"});
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_EQ(doctor.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("install"));
  EXPECT_EQ(outcome.err, doctor.err) << "and doctor does not advise to run doctor";
  EXPECT_THAT(doctor.err, Not(HasSubstr("doctor")));
  EXPECT_EQ(std::count(doctor.err.begin(), doctor.err.end(), '\n'), 1) << doctor.err;
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(RenderTest, TheDefaultTechniqueSuitsTheScanAndSaysWhy) {
  first_words_ = {};
  const Outcome said = run({"cube.ply", "-o", "a.png", "--resolution", "48x32"});
  EXPECT_THAT(said.err, HasSubstr("technique: "));
  const Json json = run_json({"cube.ply", "-o", "a.png", "--resolution", "48x32", "--json"});
  EXPECT_EQ(json["technique"], json["automatic_technique"]["technique"]);
  EXPECT_NE(json["automatic_technique"]["reason"], "");
  EXPECT_TRUE(json["automatic_technique"]["surface_share"].is_number());
  const Json list =
      run_json({"cube.ply", "-t", "auto,layers", "-o", "a.png", "--resolution", "48x32", "--json"});
  EXPECT_EQ(list["technique"][0], json["technique"]);
  EXPECT_EQ(list["technique"][1], "layers");
  // A parameter that one technique alone has asks for that one.
  const Json own =
      run_json({"cube.ply", "--hash-bits", "5", "-o", "a.png", "--resolution", "48x32", "--json"});
  EXPECT_EQ(own["technique"], "denoise");
  EXPECT_THAT(own["automatic_technique"]["reason"].get<std::string>(), HasSubstr("--hash-bits"));
}

// A dense block and a row far from it, of a fiftieth of the points.
TEST_F(RenderTest, WhatTheFirstViewLeavesOutIsTold) {
  std::string text;
  for (int i = 0; i < 5000; ++i)
    text += std::to_string(0.1 * (i % 17)) + " " + std::to_string(0.1 * (i / 17 % 17)) + " " +
            std::to_string(0.1 * (i / 289)) + "\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(40 + 0.1 * i) + " 1 0\n";
  write("far.xyz", text);
  const Outcome said = run({"far.xyz", "-o", "a.png", "--resolution", "48x32"});
  EXPECT_THAT(said.err, HasSubstr("2 % of the points lie outside the picture, --whole shows them"));
  const Json json = run_json({"far.xyz", "-o", "a.png", "--resolution", "48x32", "--json"});
  EXPECT_NEAR(json["share_outside"].get<double>(), 100.0 / 5100, 1e-9);
  for (const std::vector<std::string>& asked : {std::vector<std::string>{"--whole"}, {"--zoom", "2"}}) {
    std::vector<std::string> words{"far.xyz", "-o", "a.png", "--resolution", "48x32"};
    words.insert(words.end(), asked.begin(), asked.end());
    EXPECT_THAT(run(words).err, Not(HasSubstr("outside"))) << asked[0];
  }
}

TEST_F(RenderTest, UpIsReportedAndGivenBack) {
  const Json json = run_json({"cube.ply", "-o", "a.png", "--resolution", "48x32", "--json"});
  EXPECT_TRUE(json["up"].is_string());
  EXPECT_NE(json["up_reason"], "");
  EXPECT_EQ(run_json({"cube.ply", "--up=-x", "-o", "a.png", "--resolution", "48x32", "--json"})["up"], "-X");
  EXPECT_EQ(run_json({"cube.ply", "--up", "-Y", "-o", "a.png", "--resolution", "48x32", "--json"})["up"],
            "-Y")
      << "a word of its own that begins with a minus sign";
  EXPECT_EQ(run_json({"cube.ply", "--up", "auto", "-o", "a.png", "--resolution", "48x32", "--json"})["up"],
            json["up"]);
}

TEST_F(RenderTest, QuietSaysNothing) {
  const Outcome outcome = run({"cube.ply", "-o", "a.png", "--resolution", "32x32", "--quiet", "--timings"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
  EXPECT_THAT(run({"cube.ply", "-o", "a.png", "--resolution", "32x32", "--timings"}).err, HasSubstr("total"));
}

TEST_F(RenderTest, DoctorNamesTheDriver) {
  first_words_ = {};
  const Outcome outcome = run({"doctor"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* word : {"GL version", "renderer", "largest texture", "fast:"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

}  // namespace
