// What people reach for: views, selections, colours, batches, help. Answers are known from the unit cube's
// geometry.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>

#include "cli/command.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

using Json = nlohmann::json;

class ReachTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write_cube("cube.ply");
  }
  Outcome ok(std::vector<std::string> words) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }
  /// The camera of a small picture of the cube.
  Json camera(std::vector<std::string> words) {
    words.insert(words.begin(), {"cube.ply", "-t", "points", "--output-camera", "k.json", "--quiet"});
    ok(words);
    return Json::parse(text("k.json"));
  }
  static double component(const Json& json, const char* key, int k) {
    return json[key][std::size_t(k)].get<double>();
  }
};

TEST_F(ReachTest, NamedViewsLookFromTheirSide) {
  struct Side {
    const char* name;
    int axis, sign;
  };
  for (const Side& side : {Side{"front", 1, -1},
                           {"back", 1, 1},
                           {"left", 0, -1},
                           {"right", 0, 1},
                           {"top", 2, 1},
                           {"bottom", 2, -1}}) {
    const Json json = camera({"--view", side.name});
    for (int k = 0; k < 3; ++k) {
      const double along = component(json, "position", k) - component(json, "target", k);
      if (k == side.axis)
        EXPECT_GT(along * side.sign, 1) << side.name;
      else
        EXPECT_NEAR(along, 0, 1e-9) << side.name;
    }
  }
  EXPECT_NEAR(component(camera({"--view", "top"}), "up", 1), 1, 1e-9) << "north is up in a plan";
  const Json iso = camera({"--view", "iso"});
  const double dx = component(iso, "position", 0) - component(iso, "target", 0);
  EXPECT_NEAR(dx, component(iso, "position", 1) - component(iso, "target", 1), 1e-6)
      << "three sides at equal angles";
  EXPECT_NEAR(-dx, component(iso, "position", 2) - component(iso, "target", 2), 1e-6);
}

TEST_F(ReachTest, ZoomRollAndLookAt) {
  const Json plain = camera({}), twice = camera({"--zoom", "2"});
  EXPECT_EQ(plain["position"], twice["position"]);
  const auto tangent = [](const Json& json) {
    return std::tan(json["fov_y_deg"].get<double>() * M_PI / 360);
  };
  EXPECT_NEAR(tangent(plain) / tangent(twice), 2, 1e-9);
  const Json narrow = camera({"--camera-view-angle", "20"});
  EXPECT_EQ(plain["position"], narrow["position"]) << "a smaller angle zooms in: the camera stays";
  EXPECT_NEAR(narrow["fov_y_deg"].get<double>(), 20, 1e-9);
  const Json flat = camera({"--camera-orthographic"}),
             flat_twice = camera({"--camera-orthographic", "--zoom", "2"});
  EXPECT_NEAR(flat["height_world"].get<double>(), 2 * flat_twice["height_world"].get<double>(), 1e-9);

  const Json rolled = camera({"--view", "front", "--roll", "90"});
  EXPECT_NEAR(component(rolled, "up", 0), -1, 1e-9) << "counter-clockwise from +z, seen from -y";
  EXPECT_NEAR(component(rolled, "up", 2), 0, 1e-9);

  const Json near = camera({"--view", "right", "--look-at", "0.5,0.25,0.75", "--distance", "3"});
  EXPECT_NEAR(component(near, "position", 0), 3.5, 1e-9);
  EXPECT_NEAR(component(near, "position", 1), 0.25, 1e-9);
  EXPECT_NEAR(component(near, "position", 2), 0.75, 1e-9);
}

// From the middle of a unit cube a wall is 0.5 away straight ahead, and 0.5 / cos of the angle to its axis
// elsewhere.
TEST_F(ReachTest, PanoramaShowsDistancesAllAround) {
  write_cube("fine.ply", 150);
  ok({"fine.ply", "-t", "points", "--panorama", "--camera-position", "0.5,0.5,0.5", "--camera-direction",
      "0,1,0", "--resolution", "128x64", "--output-depth", "d.npy", "-o", "p.png", "--size-mode", "world",
      "--point-size", "0.012"});
  const Image<Rgba8> picture = read_png("p.png");
  EXPECT_EQ(picture.width(), 128);
  EXPECT_EQ(picture.height(), 64);
  const Array depth = read_npy("d.npy");
  double worst = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) {
      const double latitude = M_PI * (0.5 - (y + 0.5) / 64), longitude = M_PI * (2 * (x + 0.5) / 128 - 1);
      const double d[3] = {std::abs(std::cos(latitude) * std::sin(longitude)),
                           std::abs(std::cos(latitude) * std::cos(longitude)), std::abs(std::sin(latitude))};
      const double expected = 0.5 / std::max({d[0], d[1], d[2]});
      worst = std::max(worst, std::abs(depth.values[std::size_t(y * 128 + x)] - expected));
    }
  // A pixel is 0.05 rad wide; at a corner of the cube the wall is seen at 55 degrees: 0.5 px x 0.05 x 0.87 x
  // tan 55 = 0.03, and points are squares of 0.012 that stand a little before the wall.
  EXPECT_LT(worst, 0.05);
  EXPECT_GT(picture.at(64, 20).g, picture.at(64, 20).r) << "green above";
  EXPECT_GT(picture.at(64, 44).r, picture.at(64, 44).g) << "red below: rows are level";
}

TEST_F(ReachTest, SelectionsKeepWhatWasAskedFor) {
  const auto count = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"convert", "cube.ply", "-o", "c.ply", "--quiet"});
    ok(words);
    return run_json({"info", "c.ply", "--json"})["points"].get<int>();
  };
  EXPECT_EQ(count({}), 5400);
  // Below 0.5: half of each of the four walls, and the floor.
  EXPECT_EQ(count({"--crop", "-1,-1,-1,2,2,0.499"}), 4 * 450 + 900);
  EXPECT_EQ(count({"--crop-relative", "0,0,0,1,1,0.499"}), 4 * 450 + 900);
  EXPECT_EQ(count({"--crop-relative", "0,0,0,1,1,1"}), 5400) << "the last points count";
  EXPECT_EQ(count({"--filter", "row 3"}), 6 * 30);
  EXPECT_EQ(count({"--filter", "row 3..5", "--filter", "z 1.."}), 3 * 30) << "all of them hold";
  EXPECT_EQ(count({"--filter", "red 200.."}), 4 * 450 + 900);
  EXPECT_EQ(count({"--crop-relative", "0,0,0,1,1,0.499", "--max-points", "1k"}), 1000)
      << "a thousand of the box";
  write("classes.csv", "x,y,z,classification\n0,0,0,2\n1,0,0,6\n0,1,0,7\n0,0,1,2\n");
  ok({"convert", "classes.csv", "--show-classes", "2,6", "-o", "c.csv", "--quiet"});
  EXPECT_EQ(text("c.csv"), "x,y,z,classification\n0,0,0,2\n1,0,0,6\n0,0,1,2\n");
  EXPECT_THAT(
      ok({"classes.csv", "-t", "points", "--show-classes", "2,9", "-o", "a.png", "--resolution", "32x32"})
          .err,
      HasSubstr("class 9 (water) does not occur; there are: 2 ground, 6 building, 7 low noise"));
}

TEST_F(ReachTest, ConvertPutsFilesTogetherAndWritesWhatItReads) {
  for (const char* name : {"m.pcd", "m.csv", "m.xyz", "m.ply", "m.las"}) {
    ok({"convert", "cube.ply", "cube.ply", "-o", name, "--quiet"});
    const Json info = run_json({"info", name, "--json", "--quiet"});
    EXPECT_EQ(info["points"], 10800) << name;
    EXPECT_EQ(info["attributes"]["file"]["max"], 2) << name;
    EXPECT_NEAR(info["attributes"]["row"]["mean"].get<double>(), 14.5, 1e-9) << name;
    EXPECT_NEAR(info["bounds_max"][2].get<double>(), 1, 1e-9) << name;
  }
  EXPECT_EQ(run_json({"info", "m.pcd", "--json"})["attributes"]["green"]["max"], 255);
  ok({"convert", "cube.ply", "-o", "c.npy", "--quiet"});
  const std::string bytes = text("c.npy");
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x02\x00", 8));
  EXPECT_THAT(bytes.substr(12, 300),
              HasSubstr("('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('red', '|u1'), ('green', '|u1'), "
                        "('blue', '|u1'), ('row', '<f4'), ], 'fortran_order': False, 'shape': (5400,)"));
  const std::size_t header =
      12 + std::size_t(static_cast<unsigned char>(bytes[8])) + 256u * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ(header % 64, 0u);
  EXPECT_EQ(bytes.size(), header + 5400u * 19u);
}

// The reader leaves out dimensions of LAS that are zero in all of a file; another file brings them back.
TEST_F(ReachTest, ConvertPutsLasDimensionsWhereTheyBelong) {
  write("a.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
  write("b.csv", "x,y,z,scan_angle,withheld,classification\n0,0,1,20,1,2\n1,0,1,5,0,2\n");
  for (const std::string name : {"a", "b"}) ok({"convert", name + ".csv", "-o", name + ".las", "--quiet"});
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"a.las", "b.las"}, std::vector<std::string>{"b.las", "a.las"}}) {
    EXPECT_THAT(ok({"convert", order[0], order[1], "-o", "two.las"}).err, Not(HasSubstr("points have no")));
    EXPECT_EQ(text("two.las").substr(105, 2), std::string("\x16\0", 2)) << "20 bytes, and 2 of the file";
    EXPECT_EQ(run_json({"info", "two.las", "--json"})["attributes"]["withheld"]["mean"], 0.2);
    ok({"convert", order[0], order[1], "--filter", "scan_angle -10..10", "-o", "c.las", "--quiet"});
    EXPECT_EQ(run_json({"info", "c.las", "--json"})["points"], 4) << "three of 0 degrees, and one of 5";
  }
  // A file of another format knows no scan angle.
  ok({"convert", "b.las", "a.csv", "--filter", "scan_angle -10..10", "-o", "c.las", "--quiet"});
  EXPECT_EQ(run_json({"info", "c.las", "--json"})["points"], 1);
  EXPECT_THAT(ok({"convert", "b.las", "a.csv", "-o", "two.las"}).err,
              HasSubstr("3 points have no classification: it is written as 0"));
  EXPECT_EQ(text("two.las").substr(105, 2), std::string("\x16\0", 2));
}

TEST_F(ReachTest, ConvertToPlyKeepsColumnsOfZeros) {
  write("p.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
  ok({"convert", "p.csv", "-o", "p.las", "--quiet"});
  ok({"convert", "p.las", "-o", "p.ply", "--quiet"});
  const Json las = run_json({"info", "p.las", "--json"}), ply = run_json({"info", "p.ply", "--json"});
  for (const auto& [name, values] : las["attributes"].items())
    EXPECT_EQ(ply["attributes"][name], values) << name;
}

TEST_F(ReachTest, ColumnsAreThoseOfTextAndOfRowsOfNumbers) {
  const std::string head = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 4), }\n";
  write("rows.npy",
        std::string("\x93NUMPY\x01\x00", 8) + char(head.size()) + '\0' + head + "\1\2\3\4\5\6\7\10");
  write("p.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
  ok({"convert", "p.csv", "-o", "records.npy", "--quiet"});
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"info"}, std::vector<std::string>{"convert", "-o", "out.csv"}}) {
    const auto said_of = [&](const std::string& file) {
      std::vector<std::string> all = words;
      all.insert(all.end(), {file, "--columns", "x,y,z,weight"});
      return ok(all).err;
    };
    EXPECT_THAT(said_of("rows.npy"), Not(HasSubstr("--columns has no effect")));
    EXPECT_THAT(said_of("records.npy"), HasSubstr("--columns has no effect"));
  }
  ok({"convert", "rows.npy", "--columns", "x,y,z,weight", "-o", "out.csv", "--quiet"});
  EXPECT_EQ(text("out.csv"), "x,y,z,weight\n1,2,3,4\n5,6,7,8\n");
}

TEST_F(ReachTest, ColoursHaveNames) {
  const auto middle = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "64x48",
                                 "--shading", "albedo", "--no-edl"});
    ok(words);
    return read_png("a.png").at(32, 24);
  };
  EXPECT_EQ(middle({"--color", "steelblue"}), (Rgba8{0x46, 0x82, 0xb4, 255}));
  EXPECT_EQ(middle({"--color", "#4682b4"}), (Rgba8{0x46, 0x82, 0xb4, 255}));
  EXPECT_EQ(middle({"--color", "#f80"}), (Rgba8{0xff, 0x88, 0x00, 255}));
  EXPECT_EQ(middle({"--color", "0,0,1"}), (Rgba8{0, 0, 255, 255}));
  middle({"--background-color", "Light-Grey"});
  EXPECT_EQ(read_png("a.png").at(0, 0), (Rgba8{0xd3, 0xd3, 0xd3, 255}));
  EXPECT_THAT(
      ok({"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "32x32", "--colormap", "turbo"}).err,
      HasSubstr("--colormap turbo has no effect"));
}

TEST_F(ReachTest, SeveralFilesAreSwatchesInTheLegend) {
  ok({"cube.ply", "cube.ply", "-t", "points", "--color-by", "file", "-o", "a.png", "--resolution", "160x120",
      "--legend"});
  const Image<Rgba8> image = read_png("a.png");
  int first = 0, second = 0;  // of the colours of Okabe and Ito, right of the cube
  for (int y = 60; y < 120; ++y)
    for (int x = 80; x < 160; ++x) {
      first += image.at(x, y) == Rgba8{0x00, 0x72, 0xb2, 255};
      second += image.at(x, y) == Rgba8{0xe6, 0x9f, 0x00, 255};
    }
  EXPECT_GE(first, 64) << "a square of 9 pixels";
  EXPECT_GE(second, 64);
}

TEST_F(ReachTest, EachFileIsAPictureAndABadOneDoesNotStopTheRest) {
  std::filesystem::create_directory(path("scans"));
  std::filesystem::copy_file(path("cube.ply"), path("scans/a.ply"));
  std::filesystem::copy_file(path("cube.ply"), path("scans/b.ply"));
  write("scans/bad.ply", "ply\nnonsense\n");
  write("scans/readme.md", "no scan");
  const Outcome outcome =
      run({"scans", "--each", "-t", "points", "-o", "{stem}_{n}.png", "--resolution", "32x32"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("scans/bad.ply"));
  EXPECT_THAT(outcome.err, HasSubstr("1 of 3 files failed"));
  EXPECT_TRUE(exists("a_0.png") && exists("b_1.png"));
  const Outcome pattern = run({"scans/[ab].ply", "--each", "-t", "points,splats", "-o",
                               "{stem}_{technique}.png", "--resolution", "32x32"});
  EXPECT_EQ(pattern.code, 0) << pattern.err;
  for (const char* name : {"a_points.png", "a_splats.png", "b_points.png", "b_splats.png"})
    EXPECT_TRUE(exists(name)) << name;
  const Outcome table = run({"info", "scans", "--quiet"});
  EXPECT_EQ(table.code, 3);
  EXPECT_THAT(table.out, HasSubstr("scans/b.ply"));
  // Nor does one that is too large.
  ok({"synth", "spheres", "--points", "200000", "-o", "scans/large.las", "--quiet"});
  ::setenv("SFUMATO_MEMORY", "1000000", 1);
  const Outcome large = run({"info", "scans/a.ply", "scans/large.las", "scans/b.ply"});
  ::unsetenv("SFUMATO_MEMORY");
  EXPECT_EQ(large.code, 3) << large.err;
  EXPECT_THAT(large.err, HasSubstr("scans/large.las"));
  EXPECT_THAT(large.out, HasSubstr("scans/b.ply"));
  EXPECT_THAT(
      run({"scans/a.ply", "scans/b.ply", "--each", "-o", "{stem}.png", "--save-preset", "a.json"}).err,
      HasSubstr("leave out --each"));
  EXPECT_EQ(run({"scans/bad.ply", "--each", "-o", "{stem}.png"}).code, 2)
      << "of one file it is what it always is";
}

TEST_F(ReachTest, TheFolderOfAReconstructionIsItsPoints) {
  std::filesystem::create_directory(path("0"));
  write("0/points3D.txt", "1 0 0 5 9 9 9 .5 1 2\n2 1 0 5 9 9 9 .5 1 3\n3 0 1 6 9 9 9 .5 1 4\n");
  write("0/cameras.txt", "1 SIMPLE_PINHOLE 640 480 500 320 240\n");
  write("0/images.txt", "1 1 0 0 0 0 0 0 1 a.jpg\n10 10 1\n");
  const Outcome table = run({"info", "0"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("points3D.txt"));
  EXPECT_THAT(table.out, Not(HasSubstr("images.txt")));
}

TEST_F(ReachTest, EachFileHasTheTechniqueThatSuitsIt) {
  write_cube("few.ply", 5);  // 150 points: too few for normals
  ok({"synth", "spheres", "--points", "20000", "-o", "many.ply", "--quiet"});
  const std::string told =
      ok({"few.ply", "many.ply", "few.ply", "--each", "-o", "{stem}_{n}.png", "--resolution", "32x24"}).err;
  const std::size_t first = told.find("technique: points"), second = told.find("technique: splats");
  EXPECT_LT(first, second) << told;
  EXPECT_NE(told.find("technique: points", second), std::string::npos) << told;
}

TEST_F(ReachTest, ASubsampleOfSeveralFilesIsAsDenseInEach) {
  ok({"synth", "spheres", "--points", "50000", "-o", "many.ply", "--quiet"});
  ok({"synth", "spheres", "--points", "5000", "-o", "few.ply", "--quiet"});
  const double many = run_json({"info", "many.ply", "--json"})["points"],
               few = run_json({"info", "few.ply", "--json"})["points"];
  ok({"convert", "many.ply", "few.ply", "--max-points", "4400", "-o", "both.csv", "--quiet"});
  std::ifstream in(path("both.csv"));
  std::string row;
  double of_few = -1, rows = -1;  // the header is no row
  for (; std::getline(in, row); ++rows) of_few += rows < 0 || row.ends_with(",2");
  EXPECT_EQ(rows, 4400);
  EXPECT_NEAR(of_few, 4400 * few / (many + few), 1);
}

TEST_F(ReachTest, StandardInputAndOutput) {
  const std::string sfumato = SFUMATO_BINARY, folder = path("").string();
  const std::string line = "cd '" + folder + "' && '" + sfumato +
                           "' - -t points --resolution 32x32 -o - < cube.ply > out.png 2> err.txt && '" +
                           sfumato + "' convert - -o - < cube.ply 2> err.txt | '" + sfumato +
                           "' info - --json --quiet > info.json";
  ASSERT_EQ(std::system(line.c_str()), 0) << text("err.txt");
  EXPECT_EQ(read_png("out.png").width(), 32);
  EXPECT_EQ(Json::parse(text("info.json"))["points"], 5400);
}

TEST_F(ReachTest, PicturesAndDepthInOtherFormats) {
  ok({"cube.ply", "-t", "points", "-o", "a.jpg", "--resolution", "64x48", "--output-depth", "d.png",
      "--quality", "95"});
  EXPECT_EQ(text("a.jpg").substr(0, 3), "\xff\xd8\xff");
  EXPECT_EQ(text("d.png")[24], 16) << "bits a channel";
  EXPECT_EQ(text("d.png")[25], 0) << "grey";
  const auto texts = png_texts("d.png");
  EXPECT_LT(std::stod(texts.at("DepthNear")), std::stod(texts.at("DepthFar")));
  ok({"cube.ply", "-t", "points", "-o", "a.webp", "--resolution", "64x48", "--output-depth", "d.exr",
      "--no-background"});
  EXPECT_EQ(text("a.webp").substr(0, 4) + text("a.webp").substr(8, 4), "RIFFWEBP");
  EXPECT_EQ(text("d.exr").substr(0, 4), std::string("\x76\x2f\x31\x01", 4));
  EXPECT_THAT(text("d.exr").substr(0, 400), HasSubstr("Z"));
}

TEST_F(ReachTest, PresetsKeepParametersByTechnique) {
  const std::vector<std::string> small = {"cube.ply", "-o", "a.png", "--resolution", "32x32"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), small.begin(), small.end());
    more.push_back("--json");
    return run_json(more);
  };
  with({"-t", "points,splats", "--points.point-size", "2", "--shading", "albedo", "--save-preset",
        "look.json"});
  EXPECT_EQ(with({"--preset", "look.json", "-t", "points"})["parameters"]["point_size"], 2);
  EXPECT_EQ(with({"--preset", "look.json", "-t", "splats"})["parameters"]["shading"], "albedo");
  EXPECT_EQ(with({"--preset", "look.json", "-t", "surface"})["parameters"]["shading"], "albedo")
      << "shared, though saved by others";
  EXPECT_EQ(with({"--preset", "look.json", "-t", "points", "--point-size", "4"})["parameters"]["point_size"],
            4)
      << "the command line wins, also over a qualified name";
}

TEST_F(ReachTest, DefaultsOfOnesOwn) {
  write("config.json",
        R"({"technique": "points", "parameters": {"point_size": 3, "splats": {"normal_mode": "x"}},
                           "options": {"resolution": "40x30"}})");
  write("config.json",
        R"({"technique": "points", "parameters": {"point_size": 3}, "options": {"resolution": "40x30"}})");
  setenv("SFUMATO_CONFIG", path("config.json").c_str(), 1);
  const Json json = run_json({"cube.ply", "-o", "a.png", "--json"});
  setenv("SFUMATO_CONFIG", "", 1);
  EXPECT_EQ(json["technique"], "points");
  EXPECT_EQ(json["parameters"]["point_size"], 3);
  EXPECT_EQ(read_png("a.png").width(), 40);
}

TEST_F(ReachTest, SwitchesCountsAndThreads) {
  const Json json = run_json({"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "32x32", "--no-edl",
                              "--max-points", "1e3", "--threads", "1", "--json"});
  EXPECT_EQ(json["parameters"]["edl"], false);
  EXPECT_EQ(json["points_rendered"], 1000);
  EXPECT_THAT(ok({"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "32x32", "--verbose"}).err,
              HasSubstr("read cube.ply: ply, 5400 points"));
  const Json all = run_json({"cube.ply", "-t", "all", "-o", "a.png", "--resolution", "32x24", "--json"});
  EXPECT_EQ(all["technique"].size(), run_json({"techniques", "--json"}).size());
}

TEST_F(ReachTest, AViewThatSeesNothingSaysWhatWouldShowIt) {
  const Outcome away = ok({"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "32x32",
                           "--camera-position", "9,9,9", "--camera-direction", "1,1,1"});
  EXPECT_THAT(away.err, HasSubstr("nothing is in view. The points lie around 0.5,0.5,0.5; --look-at"));
}

TEST_F(ReachTest, ClassesThatDoNotOccurAreTold) {
  write("classes.csv", "x,y,z,classification\n0,0,0,2\n1,0,0,2\n0,1,0,2\n1,1,0,2\n");
  const Outcome outcome = ok({"classes.csv", "-t", "soft", "--field", "class", "--field-classes", "99", "-o",
                              "a.png", "--resolution", "32x32"});
  EXPECT_THAT(outcome.err,
              HasSubstr("none has a class of --field-classes; --color-by classification --legend shows"));
}

TEST_F(ReachTest, HelpFitsTheTerminal) {
  for (const int width : {40, 80, 120}) {
    setenv("COLUMNS", std::to_string(width).c_str(), 1);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"--help"}, {"--help", "all"}, {"help", "views"}, {"help", "convert"}}) {
      const Outcome help = ok(words);
      std::istringstream lines(help.out);
      int count = 0;
      for (std::string line; std::getline(lines, line); ++count)
        // A word that is longer than the line stays whole.
        EXPECT_TRUE(int(line.size()) <= width ||
                    line.find(' ', line.find_first_not_of(' ')) == std::string::npos)
            << width << ": " << line;
      if (words == std::vector<std::string>{"--help"} && width == 80) EXPECT_LE(count, 50);
    }
  }
  unsetenv("COLUMNS");
  EXPECT_THAT(ok({"help", "info"}).out, HasSubstr("usage: sfumato info FILE..."));
  EXPECT_THAT(ok({"help", "points"}).out, HasSubstr("--point-size"));
  EXPECT_EQ(ok({"help"}).out, ok({"--help"}).out);
}

TEST_F(ReachTest, OneListOfOptionsFeedsHelpManualAndCompletions) {
  const std::string all = ok({"--help", "all"}).out, manual = ok({"manual"}).out;
  EXPECT_THAT(manual, ::testing::StartsWith(".TH SFUMATO 1"));
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const std::string completion = ok({"completion", shell}).out;
    for (const char* option : {"crop-relative", "panorama", "no-edl", "point-size"})
      EXPECT_THAT(completion, HasSubstr(option)) << shell;
    write(std::string("completion.") + shell, completion);
  }
  EXPECT_EQ(std::system(("bash -n '" + path("completion.bash").string() + "'").c_str()), 0);
  const std::string list =
      "bash -c 'source \"" + path("completion.bash").string() +
      "\"; COMP_WORDS=(sfumato --vi); COMP_CWORD=1; _sfumato; echo \"${COMPREPLY[@]}\"' > '" +
      path("list.txt").string() + "'";
  ASSERT_EQ(std::system(list.c_str()), 0);
  EXPECT_THAT(text("list.txt"), HasSubstr("--view"));
  // Other shells read theirs where they are installed.
  for (const char* shell : {"zsh", "fish"}) {
    if (std::system((std::string("command -v ") + shell + " > /dev/null").c_str()) != 0) {
      std::printf("skipped: %s is not installed, which would read its completion\n", shell);
      continue;
    }
    EXPECT_EQ(
        std::system(
            (std::string(shell) + " -n '" + path(std::string("completion.") + shell).string() + "'").c_str()),
        0)
        << shell;
  }
  EXPECT_THAT(manual, HasSubstr("crop\\-relative"));
  EXPECT_THAT(all, HasSubstr("--crop-relative"));
}

TEST_F(ReachTest, FormatsInfoAndDoctor) {
  EXPECT_THAT(ok({"formats"}).out, HasSubstr(".copc.laz"));
  EXPECT_GT(run_json({"formats", "--json"}).size(), 6u);
  const Json doctor = run_json({"doctor", "--json"});
  EXPECT_TRUE(doctor.contains("renderer"));
  const Outcome info = ok({"info", "cube.ply"});
  EXPECT_THAT(info.out, HasSubstr("extent          1 x 1 x 1"));
}

TEST_F(ReachTest, ASceneKeepsFilesRulesTransformsAndCamera) {
  std::filesystem::create_directory(path("elsewhere"));
  ok({"cube.ply", "cube.ply", "--draw", "file 2 and z 0.5..: points point_size=2", "-t", "splats", "-o",
      "a.png", "--resolution", "96x72", "--zoom", "1.5", "--shadows", "hard", "--save-scene",
      "elsewhere/scene.json", "--quiet"});
  ok({"--scene", "elsewhere/scene.json", "-o", "b.png", "--quiet"});
  EXPECT_TRUE(std::ranges::equal(read_png("a.png"), read_png("b.png"))) << "the zoom must not count twice";

  // The second cube stands one unit to the right of where it was: the scene is as wide as two.
  Json scene = Json::parse(text("elsewhere/scene.json"));
  EXPECT_EQ(scene["files"], Json({"../cube.ply", "../cube.ply"}));
  scene["files"][1] = {{"file", "../cube.ply"},
                       {"transform", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}};
  scene["options"]["draw"] = "x 1.01..: points";
  write("elsewhere/moved.json", scene.dump());
  const Json moved = run_json({"--scene", "elsewhere/moved.json", "-o", "c.png", "--output-camera",
                               "seen.json", "--json", "--quiet"});
  ASSERT_EQ(moved["draw"].size(), 1u);
  EXPECT_EQ(moved["draw"][0]["technique"], "points");
  EXPECT_NEAR(moved["draw"][0]["points"].get<double>(), 5 * 30 * 30, 30 * 30)
      << "five faces of the second cube and more";

  // The same said on the line.
  ok({"cube.ply", "cube.ply", "--transform", "2: 1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1", "--draw",
      "x 1.01..: points", "-t", "splats", "-o", "e.png", "--shadows", "hard", "--camera", "seen.json",
      "--quiet"});
  EXPECT_TRUE(std::ranges::equal(read_png("e.png"), read_png("c.png")));
  // As other programs copy a matrix.
  ok({"cube.ply", "cube.ply", "--transform", "2:\n1 0 0 1\n0 1 0 0\n0, 0, 1, 0\n0 0 0 1\n", "-o", "g.png"});
  EXPECT_THAT(run({"cube.ply", "--transform", "2: 1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1", "-o", "f.png"}).err,
              HasSubstr("there is 1 file;"));
  EXPECT_THAT(run({"cube.ply", "--transform", "1: 1,0,0,1,0,1,0,0,0,0,1,0,1,0,0,1", "-o", "f.png"}).err,
              HasSubstr("the last row"));
  // What a rule with none selects is not there.
  ok({"cube.ply", "--draw", "z 0.5..: none", "-t", "splats", "-o", "g.png", "--camera", "seen.json",
      "--quiet"});
  ok({"cube.ply", "--filter", "z ..0.5", "-t", "splats", "-o", "h.png", "--camera", "seen.json", "--quiet"});
  EXPECT_TRUE(std::ranges::equal(read_png("g.png"), read_png("h.png")));
  EXPECT_THAT(run({"cube.ply", "--draw", "*: none", "-o", "f.png"}).err, HasSubstr("leave out every point"));
  EXPECT_FALSE(exists("f.png"));
  scene["files"][1]["transform"] = {1, 0, 0};
  write("elsewhere/broken.json", scene.dump());
  const Outcome broken = run({"--scene", "elsewhere/broken.json", "-o", "d.png"});
  EXPECT_EQ(broken.code, 2);
  EXPECT_THAT(broken.err, HasSubstr("transform: 16 numbers"));
  EXPECT_THAT(run({"cube.ply", "--preset", "elsewhere/scene.json", "-o", "d.png"}).err, HasSubstr("--scene"));
}

TEST_F(ReachTest, ATerminalShowsProgress) {
  if (std::system("script -qec true /dev/null > /dev/null 2>&1") != 0)
    GTEST_SKIP()
        << "no terminal: the program `script` (Debian: bsdutils) is missing, or /dev/pts is not mounted";
  const std::string words = std::string(SFUMATO_BINARY) + " '" + path("cube.ply").string() +
                            "' -t points --path orbit --frames 200 --resolution 32x24 -o '" +
                            path("frame_{n:03}.png").string() + "'";
  ASSERT_EQ(
      std::system(("script -qec \"" + words + "\" '" + path("shown.txt").string() + "' > /dev/null").c_str()),
      0);
  const std::string shown = text("shown.txt");
  // The share is that of all frames, whichever of them were told.
  const std::regex told("frame ([0-9]+)/200: [a-z ]* +([0-9]+) %");
  int lines = 0;
  for (std::sregex_iterator at(shown.begin(), shown.end(), told), end; at != end; ++at, ++lines)
    EXPECT_NEAR(std::stoi((*at)[2]), std::stoi((*at)[1]) / 2.0, 1) << at->str();
  EXPECT_GT(lines, 0) << shown;
  EXPECT_THAT(shown, HasSubstr("(200 pictures)"));
  // Elsewhere nothing but lines.
  ASSERT_EQ(std::system((words + " --frames 2 2> '" + path("lines.txt").string() + "'").c_str()), 0);
  EXPECT_EQ(text("lines.txt").find('\r'), std::string::npos);
}

}  // namespace
