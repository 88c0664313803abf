// sfumato build, as a user runs it.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <random>
#include <sstream>

#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

class Build : public CommandTest {};

TEST_F(Build, WritesAFileThatInfoConvertAndRenderingRead) {
  write_cube("cube.ply", 60);
  const Outcome built = run({"build", "cube.ply", "-o", "cube.copc.laz"});
  ASSERT_EQ(built.code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("wrote cube.copc.laz (21600 points, 1 node in 1 level,"));
  // Header and hierarchy answer; with --stats the points do.
  const nlohmann::json info = run_json({"info", "cube.copc.laz", "--json"});
  EXPECT_EQ(info["points"], 21600);
  EXPECT_TRUE(info["median_spacing"].is_null() && info["attributes"]["red"].is_null());
  ASSERT_EQ(info["levels"].size(), 1u);
  EXPECT_EQ(info["levels"][0]["points"], 21600);
  const nlohmann::json stats = run_json({"info", "cube.copc.laz", "--json", "--stats"});
  EXPECT_EQ(stats["bounds_max"], info["bounds_max"]);
  EXPECT_EQ(stats["attributes"]["red"]["max"], 65535);
  EXPECT_GT(stats["median_spacing"], 0);
  EXPECT_THAT(run({"info", "cube.copc.laz"}).out, HasSubstr("(--stats reads their"));
  ASSERT_EQ(run({"convert", "cube.copc.laz", "-o", "back.ply"}).code, 0);
  ASSERT_EQ(run({"cube.copc.laz", "-t", "points", "--resolution", "64x48", "-o", "cube.png"}).code, 0);
  // Built again of itself, and of two files.
  ASSERT_EQ(run({"build", "cube.copc.laz", "back.ply", "-o", "two.copc.laz", "--quiet"}).code, 0);
  EXPECT_EQ(run_json({"info", "two.copc.laz", "--json"})["points"], 43200);
}

TEST_F(Build, SaysWhatIsWrongInOneLine) {
  write_cube("cube.ply");
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "build");
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(refused({"cube.ply"}), HasSubstr("no output given"));
  EXPECT_THAT(refused({"-o", "a.copc.laz"}), HasSubstr("no input given"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.laz"}), HasSubstr("ends in .copc.laz"));
  EXPECT_THAT(refused({"cube.ply", "-o", "-"}), HasSubstr("ends in .copc.laz"));
  EXPECT_THAT(refused({"-", "-o", "a.copc.laz"}), HasSubstr("name a file"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.copc.laz", "--memory", "1M"}), HasSubstr("--memory"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.copc.laz", "--box", "0,0,0,1,1,-1"}), HasSubstr("empty along z"));
  write("far.xyz", "x y z\n1 2 3\n2 3 4\n1e9 2 3\n");
  EXPECT_THAT(refused({"far.xyz", "-o", "a.copc.laz"}), HasSubstr("far.xyz: outliers reach 1e+09 along x"));
  ASSERT_EQ(run({"build", "cube.ply", "-o", "a.copc.laz"}).code, 0);
  EXPECT_THAT(refused({"a.copc.laz", "-o", "a.copc.laz"}), HasSubstr("would replace the input"));
  EXPECT_EQ(files().size(), 3u);
}

TEST_F(Build, LeavesNothingBehindWhenItIsInterrupted) {
  ASSERT_EQ(run({"synth", "courtyard", "--points", "1000000", "-o", "scan.las", "--quiet"}).code, 0);
  const Outcome interrupted = run({"build", "scan.las", "-o", "scan.copc.laz"}, 150);
  EXPECT_EQ(interrupted.code, 130) << interrupted.err;
  EXPECT_EQ(files(), std::vector<std::string>{"scan.las"});
}

/// A street scene with levels, and pictures of it.
class Levels : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    ASSERT_EQ(run({"synth", "courtyard", "--points", "400000", "-o", "in.las", "--quiet"}).code, 0);
    ASSERT_EQ(run({"build", "in.las", "-o", "scan.copc.laz", "--quiet"}).code, 0);
    points_ = run_json({"info", "scan.copc.laz", "--json"})["points"];
    ASSERT_GT(points_, 390000);
  }
  bool is_same(const std::string& a, const std::string& b) const {
    const auto x = read_png(a), y = read_png(b);
    for (int row = 0; row < x.height(); ++row)
      for (int column = 0; column < x.width(); ++column)
        if (!(x.at(column, row) == y.at(column, row))) return false;
    return true;
  }
  Outcome picture(const std::string& name, std::vector<std::string> words) {
    words.insert(words.begin(), {"scan.copc.laz", "--resolution", "160x120", "-o", name});
    return run(words);
  }

  int points_ = 0;
};

TEST_F(Levels, ReadsWhatTheViewShowsAndTheBudgetHolds) {
  // All of it fits: read as ever.
  nlohmann::json all = nlohmann::json::parse(picture("all.png", {"-t", "points", "--json"}).out);
  EXPECT_FALSE(all.contains("levels"));
  EXPECT_EQ(all["points_read"], points_);
  picture("same.png", {"-t", "points", "--max-points", std::to_string(points_), "--memory",
                       std::to_string(100L * points_)});
  EXPECT_TRUE(is_same("all.png", "same.png"));

  // Small pictures need less than the file has.
  const nlohmann::json some = nlohmann::json::parse(
      picture("some.png", {"-t", "points", "--memory", std::to_string(100L * points_ - 1), "--json"}).out);
  ASSERT_TRUE(some.contains("levels"));
  EXPECT_EQ(some["levels"]["points_in_files"], points_);
  EXPECT_EQ(some["levels"]["points_needed"], some["levels"]["points_read"]);
  EXPECT_LT(some["levels"]["points_read"], points_);
  EXPECT_EQ(some["points_read"], some["levels"]["points_read"]);

  // The graphics card may have less room than the machine: a point takes 48 bytes there.
  const nlohmann::json on_card =
      nlohmann::json::parse(picture("card.png", {"-t", "points", "--gpu-memory", "2880000", "--json"}).out);
  EXPECT_LE(on_card["levels"]["points_read"], 60000);
  EXPECT_GT(on_card["levels"]["points_needed"], on_card["levels"]["points_read"]);
  EXPECT_EQ(picture("card.png", {"-t", "points", "--gpu-memory", "none"}).code, 1);

  // And less is said to be left out.
  const Outcome less = picture("less.png", {"-t", "points", "--max-points", "60k", "--json"});
  ASSERT_EQ(less.code, 0) << less.err;
  EXPECT_THAT(less.err, HasSubstr("that this view can show are left out"));
  const nlohmann::json report = nlohmann::json::parse(less.out)["levels"];
  EXPECT_LE(report["points_read"], 60000);
  EXPECT_GT(report["points_needed"], report["points_read"]);
  EXPECT_GT(report["widest_spacing_px"], 0.7);
}

TEST_F(Levels, ThePictureIsThatOfAllPoints) {
  ASSERT_EQ(picture("camera.png", {"-t", "points", "--output-camera", "camera.json"}).code, 0);
  for (const char* technique : {"points", "splats", "surface", "soft", "layers", "denoise", "strokes"}) {
    const auto shoot = [&](const std::string& name, const std::string& memory) {
      const Outcome outcome = picture(name, {"-t", technique, "--camera", "camera.json", "--background-color",
                                             "0,0,0", "--no-background", "--memory", memory, "--json"});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_EQ(nlohmann::json::parse(outcome.out).contains("levels"), memory != "4G");
      return read_png(name);
    };
    const auto whole = shoot("whole.png", "4G"), leveled = shoot("leveled.png", "39M");
    double covered = 0, uncovered = 0, difference = 0;
    for (int y = 0; y < whole.height(); ++y)
      for (int x = 0; x < whole.width(); ++x) {
        const auto a = whole.at(x, y), b = leveled.at(x, y);
        uncovered += (a.a > 127) != (b.a > 127);
        if (a.a <= 127 || b.a <= 127) continue;
        ++covered;
        difference += (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b)) / 3.0;
      }
    // Points less than a pixel from others are left out: which of them shows changes textures and lit edges,
    // and the outline, here some 5 % of the pixels, by a point's width. A node that lacks would open a hole.
    // Discs of `layers` end where their points' share of the surface ends: the outline moves by up to the 0.7
    // pixels that nodes are chosen by. Others draw points of a pixel at least in both pictures. `denoise`
    // also leaves out isolated points, and others are isolated where fewer are read: 2.01 % with, 1.90 %
    // without; `soft` makes haze of them: 2.05 %.
    const std::string name = technique;
    EXPECT_LT(uncovered, (name == "layers"                      ? 0.05 * 0.7
                          : name == "denoise" || name == "soft" ? 0.022
                                                                : 0.02) *
                             covered)
        << name;
    EXPECT_LT(difference / covered, 12) << technique;
  }
}

// A plane through many nodes of several levels, near and far in one picture: neither a gap nor a change of
// light shows where they meet.
TEST_F(Levels, NodesMeetWithoutSeams) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, 100);
  std::ostringstream rows;
  for (int i = 0; i < 400'000; ++i) {
    const double x = place(random), y = place(random);
    rows << x << ' ' << y << ' ' << 0.2 * x + 0.1 * y << " 150 150 150\n";
  }
  write("plane.txt", rows.str());
  ASSERT_EQ(run({"build", "plane.txt", "-o", "plane.copc.laz", "--attributes", "normal", "--quiet"}).code, 0);
  write("camera.json", R"({"position": [50, -20, 40], "target": [50, 60, 16]})");
  struct Looks {
    int holes = 0, darkest = 255, lightest = 0;
  };
  for (const char* technique : {"points", "splats", "surface"}) {
    SCOPED_TRACE(technique);
    const auto looks = [&](const std::string& memory) {
      const Outcome outcome =
          run({"plane.copc.laz", "-t", technique, "--camera", "camera.json", "--resolution", "320x240",
               "--memory", memory, "-o", "plane.png", "--no-background", "--edl", "false",
               "--smooth-outlines", "false", "--color-range", "0,30", "--json"});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_EQ(nlohmann::json::parse(outcome.out).contains("levels"), memory != "4G");
      const auto picture = read_png("plane.png");
      Looks found;
      for (int y = 120; y < 200; ++y)
        for (int x = 100; x < 220; ++x) {  // all plane
          const auto c = picture.at(x, y);
          if (c.a < 255) {
            ++found.holes;
            continue;
          }
          found.darkest = std::min(found.darkest, int(c.g)),
          found.lightest = std::max(found.lightest, int(c.g));
        }
      return found;
    };
    const Looks whole = looks("4G"), leveled = looks("39M");
    // Discs of twice the spacing leave exp(-pi) = 4 % of the places between random points open, where they
    // are wider than pixels; a missing node would open thousands.
    EXPECT_LE(leveled.holes, whole.holes + 9600 / 100);
    // The stored normals have steps of 1e-4, and 8 bits round.
    EXPECT_NEAR(leveled.darkest, whole.darkest, 2);
    EXPECT_NEAR(leveled.lightest, whole.lightest, 2);
    EXPECT_LT(whole.lightest - whole.darkest, 30) << "one plane in one light";
  }
  // Which technique suits is asked of the whole, whatever a view holds, and nothing is measured for a view
  // alone.
  for (const char* zoom : {"1", "60"}) {
    const auto chosen = [&](const std::string& memory) {
      const Outcome outcome = run({"plane.copc.laz", "--resolution", "160x120", "--zoom", zoom, "--memory",
                                   memory, "-o", "plane.png", "--json"});
      return nlohmann::json::parse(outcome.out).at("technique").get<std::string>();
    };
    EXPECT_EQ(chosen("4G"), "splats");
    EXPECT_EQ(chosen("39M"), "surface") << zoom;
  }
}

TEST_F(Levels, LeavesDamagedNodesOutAndSaysSo) {
  std::string bytes = text("scan.copc.laz");
  // The sizes of the layers of the first chunk, behind its first point: chunks begin 8 bytes behind the
  // records.
  std::uint32_t points_at = 0;
  std::memcpy(&points_at, bytes.data() + 96, 4);
  std::uint16_t record = 0;
  std::memcpy(&record, bytes.data() + 105, 2);
  std::memset(bytes.data() + points_at + 8 + record + 8, 0x7F, 4);
  write("scan.copc.laz", bytes);
  const Outcome outcome = picture(
      "a.png", {"-t", "points", "--max-points", "390k", "--zoom", "0.5", "--resolution", "1600x1200"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("it is left out"));
  EXPECT_TRUE(exists("a.png"));
}

TEST_F(Levels, StandardInputIsReadWhole) {
  const std::string command = std::string("cat '") + path("scan.copc.laz").string() +
                              "' | '" SFUMATO_BINARY
                              "' - -t points --max-points 100k --resolution 64x48 --quiet -o '" +
                              path("piped.png").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(exists("piped.png"));
}

TEST_F(Levels, AFlightOverMoreThanTheBudgetReadsEveryFrameForItself) {
  // Two places near the ground, far from each other.
  nlohmann::json path_of_two;
  for (const char* place : {"-8,-8,1", "8,8,1"}) {
    const std::string name = std::string("still_") + char('0' + path_of_two["cameras"].size());
    ASSERT_EQ(picture(name + ".png", {"-t", "points", "--max-points", "60k", "--look-at", place, "--zoom",
                                      "8", "--output-camera", path(name + ".json").string()})
                  .code,
              0);
    path_of_two["cameras"].push_back(nlohmann::json::parse(text(name + ".json")));
  }
  write("flight.json", path_of_two.dump());
  ASSERT_EQ(picture("flight_{n}.png", {"-t", "points", "--max-points", "60k", "--path",
                                       path("flight.json").string(), "--frames", "2"})
                .code,
            0);
  for (const char* n : {"0", "1"})
    EXPECT_TRUE(is_same(std::string("flight_") + n + ".png", std::string("still_") + n + ".png")) << n;
}

TEST_F(Levels, GoWithPathsBoxesAndSeveralFiles) {
  ASSERT_EQ(
      picture("orbit_{n}.png", {"-t", "points", "--path", "orbit", "--frames", "3", "--max-points", "300k"})
          .code,
      0);
  EXPECT_TRUE(exists("orbit_2.png"));
  const Outcome two = run({"scan.copc.laz", "scan.copc.laz", "-t", "points", "--max-points", "500k",
                           "--color-by", "file", "--resolution", "160x120", "-o", "two.png", "--json"});
  ASSERT_EQ(two.code, 0) << two.err;
  EXPECT_EQ(nlohmann::json::parse(two.out)["levels"]["points_in_files"], 2 * points_);
  const Outcome box = picture(
      "box.png", {"-t", "points", "--max-points", "300k", "--crop-relative", "0,0,0,0.3,0.3,1", "--json"});
  ASSERT_EQ(box.code, 0) << box.err;
  EXPECT_GT(nlohmann::json::parse(box.out)["points_rendered"], 1000);
  const Outcome nothing =
      picture("none.png", {"-t", "points", "--max-points", "300k", "--crop", "1e6,1e6,1e6,2e6,2e6,2e6"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_EQ(std::count(nothing.err.begin(), nothing.err.end(), '\n'), 1) << nothing.err;
}

}  // namespace
