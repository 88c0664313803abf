// The commands that need no GL: what they print, what they refuse, their exit codes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

using Json = nlohmann::json;

TEST_F(CommandTest, VersionAndHelp) {
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out, ::testing::ContainsRegex("^sfumato [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  for (const char* word : {"commit ", "OpenGL ", "libraries ", "libpng", "OpenEXR"})
    EXPECT_THAT(version.out, HasSubstr(word));
  EXPECT_THAT(run({"-V"}).out, ::testing::MatchesRegex("sfumato [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  const Outcome help = run({"-t", "points", "--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* word : {"--resolution WxH", "--camera-azimuth-angle DEG", "--point-size FLOAT",
                           "--color-by NAME", "(shoulder)", "px"})
    EXPECT_THAT(help.out, HasSubstr(word));
  EXPECT_EQ(help.err, "");
}

// Commands that draw by the same options list and take only those that have an effect there.
TEST_F(CommandTest, PublishAndServeLeaveOutWhatTheyDoNotDo) {
  write_cube("cube.ply", 4);
  for (const std::string command : {"publish", "serve"}) {
    const Outcome help = run({command, "--help"});
    if (command == "serve" && help.code != 0) continue;  // built without it
    EXPECT_THAT(help.out, HasSubstr("--color-by NAME"));
    for (const std::string option :
         {"--output-depth=d.npy", "--path=orbit", "--quality=90", "--each", "--watch"}) {
      EXPECT_THAT(help.out, ::testing::Not(HasSubstr("  " + option.substr(0, option.find('='))))) << command;
    }
    const Outcome refused = run({command, "cube.ply", "--quality", "90", command == "publish" ? "-o" : "-t",
                                 command == "publish" ? "folder" : "points"});
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr("--quality does not go with " + command));
  }
  EXPECT_THAT(run({"publish", "--help"}).out, HasSubstr("-o, --output FOLDER"));
  // What a preset holds for pictures has no effect.
  write("look.json", R"({"sfumato": "1.0.0", "technique": "points", "options": {"quality": "90"}})");
  const Outcome published = run({"publish", "cube.ply", "-o", "folder", "--preset", "look.json", "--views",
                                 "3", "--resolution", "64x48"});
  EXPECT_EQ(published.code, 0) << published.err;
}

TEST_F(CommandTest, WithoutADisplayAWindowNamesTheWayOut) {
  write_cube("cube.ply", 4);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"cube.ply"}, {"-t", "points", "--", "cube.ply"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("-o OUT.png"));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST_F(CommandTest, MistakesAreOneLineAndExitCode1) {
  write_cube("cube.ply", 4);
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  for (const Case& c : std::vector<Case>{
           {{}, "no file given"},
           {{"cube.ply", "-t", "points,surface"}, "a window shows one technique"},
           {{"cube.ply", "--path", "orbit"}, "goes with pictures, not with the window"},
           {{"cube.ply", "-o", "a.png", "--watch"}, "--watch belongs to the window"},
           {{"cube.ply", "-t", "points", "-o", "a.png", "--camera-view-angle", "0"},
            "0 degrees is outside [0.001, 179]"},
           {{"cube.ply", "-t", "points", "-o", "a.png", "--pont-size", "3"}, "did you mean --point-size?"},
           {{"cube.ply", "-t", "points", "-o", "a.png", "--point-size", "-3"},
            "'-3' is not in range [0.01, 1000000]; the nearest is 0.01"},
           {{"cube.ply", "-t", "points", "-o", "a.png", "--size-mode", "pixel"}, "did you mean pixels?"},
           {{"cube.ply", "-o", "a.png", "-t", "pointz"}, "points"},
           {{"cube.ply", "-o", "a.png", "--color-by", "rows"}, "did you mean 'row'?"},
           {{"cube.ply", "-o", "a.png", "--colormap", "turbu"}, "did you mean 'turbo'?"},
           {{"cube.ply", "-o", "a.bmp"}, ".png, .jpg, .webp, .tif, .exr or .npy"},
           {{"cube.ply", "-o", "a.png", "--resolution", "64"}, "WIDTHxHEIGHT"},
           {{"cube.ply", "-o", "a.png", "--camera-position", "1,2"}, "3 numbers"},
           {{"cube.ply", "-o", "a.png", "--camera-position", "1,2,3", "--camera-azimuth-angle", "3"},
            "contradict"},
           {{"cube.ply", "-o", "a.png", "--background-color", "1,1,255"}, "0..1"},
           {{"cube.ply", "-o", "a.png", "--up", "north"}, "+X -X +Y -Y +Z -Z"},
           {{"cube.ply", "-o", "a.png", "--light", "lamp"}, "headlight"},
           {{"cube.ply", "-o", "a.png", "--path", "orbit"}, "{n:04}"},
           {{"cube.ply", "-o", "a_{n:q}.png", "--path", "orbit"}, "template"},
           {{"cube.ply", "-o", "a.png", "--frames", "3"}, "--path"},
           {{"cube.ply", "-o", "a.exr", "-t", "points,points"}, "contact sheet"},
           {{"cube.ply", "-o", "a.png", "--output-panels", "b.png"}, "{technique}"},
           {{"cube.ply", "-o", "a.png", "--output-depth", "d.jpg"}, ".npy"},
           {{"info"}, "info needs a file"},
           {{"techniques", "points", "splats"}, "unexpected argument 'splats'"},
           {{"techniques", "pointz"}, "points"},
           {{"synth", "courtyart", "-o", "a.ply"}, "courtyard"},
           {{"synth", "spheres", "-o", "a.ply", "--pints", "3"}, "--points"},
           {{"convert", "cube.ply"}, "usage: sfumato convert IN... -o OUT"},
           {{"convert", "cube.ply", "-o", "cube.jpg"}, "cube.jpg"},
       }) {
    const Outcome outcome = run(c.words);
    EXPECT_EQ(outcome.code, 1) << c.says << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(c.says));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(files(), std::vector<std::string>{"cube.ply"});
}

TEST_F(CommandTest, BadInputIsExitCode2) {
  write("empty.ply", "");
  write("points_only.xyz", "no numbers here\n");
  write("short.ply",
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n");
  write("none.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n");
  for (const char* name : {"empty.ply", "points_only.xyz", "short.ply", "none.ply"}) {
    const Outcome outcome = run({name, "-o", "a.png"});
    EXPECT_EQ(outcome.code, 2) << name << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(name));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  write_cube("cube.ply", 4);
  write("broken.json", "{\"position\": [0, 0,");
  write("odd.json", R"({"position": [0, 0, 5], "target": [0, 0, 0], "zoom": 2})");
  EXPECT_EQ(run({"cube.ply", "-o", "a.png", "--camera", "broken.json"}).code, 2);
  EXPECT_THAT(run({"cube.ply", "-o", "a.png", "--camera", "odd.json"}).err, HasSubstr("'zoom'"));
  EXPECT_EQ(run({"cube.ply", "-o", "a.png", "--preset", "broken.json"}).code, 2);
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(CommandTest, MissingFilesAndFoldersAreExitCode6) {
  write_cube("cube.ply", 4);
  const Outcome missing = run({"nothing.ply", "-o", "a.png"});
  EXPECT_EQ(missing.code, 6);
  EXPECT_THAT(missing.err, HasSubstr("nothing.ply"));
  const Outcome folder = run({"convert", "cube.ply", "-o", "no/such/folder.ply"});
  EXPECT_EQ(folder.code, 6);
  EXPECT_THAT(folder.err, HasSubstr("no/such/folder.ply"));
  EXPECT_EQ(run({"cube.ply", "-o", "a.png", "--camera", "none.json"}).code, 6);
}

TEST_F(CommandTest, InfoSaysWhatTheFileHolds) {
  write_cube("cube.ply", 20);
  const Json info = run_json({"info", "cube.ply", "--json"});
  for (const char* key : {"file", "format", "points", "points_finite", "points_dropped", "bounds_min",
                          "bounds_max", "attributes", "crs", "median_spacing", "density", "classes"})
    EXPECT_TRUE(info.contains(key)) << key;
  EXPECT_EQ(info["format"], "ply");
  EXPECT_EQ(info["points"], 2400);
  EXPECT_EQ(info["bounds_min"], (Json{0.0, 0.0, 0.0}));
  EXPECT_EQ(info["bounds_max"], (Json{1.0, 1.0, 1.0}));
  EXPECT_EQ(info["attributes"]["red"]["max"], 255);
  EXPECT_NEAR(info["attributes"]["row"]["mean"].get<double>(), 9.5, 1e-9);
  // R_8 sqrt(pi/8), and the eighth neighbour on a square grid of 1/20 lies on the diagonal. Float positions:
  // 1e-5.
  EXPECT_NEAR(info["median_spacing"].get<double>(), 0.05 * std::sqrt(2.0 * std::numbers::pi / 8), 1e-5);
  EXPECT_NEAR(info["density"].get<double>(), 400 * 8 / (2 * std::numbers::pi), 0.2);

  const Outcome text = run({"info", "cube.ply"});
  EXPECT_EQ(text.code, 0);
  EXPECT_THAT(text.out, HasSubstr("median_spacing"));
  EXPECT_THAT(text.out, HasSubstr("2400"));
  EXPECT_EQ(text.err, "") << "no progress where there is no terminal";
}

TEST_F(CommandTest, InfoOfAFileWithoutPoints) {
  write("none.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n");
  const Json info = run_json({"info", "none.ply", "--json"});
  EXPECT_EQ(info["points"], 0);
  EXPECT_TRUE(info["median_spacing"].is_null());
}

TEST_F(CommandTest, TechniquesListsParameters) {
  const Json all = run_json({"techniques", "--json"});
  ASSERT_GE(all.size(), 1u);
  EXPECT_EQ(all[0]["name"], "points");
  const Json one = run_json({"techniques", "points", "--json"});
  bool found = false;
  for (const Json& parameter : one["parameters"]) {
    for (const char* key : {"name", "kind", "default", "unit", "help", "paper"})
      EXPECT_TRUE(parameter.contains(key)) << key;
    if (parameter["name"] == "size_mode") {
      found = true;
      EXPECT_EQ(parameter["kind"], "choice");
      EXPECT_EQ(parameter["choices"], (Json{"adaptive", "pixels", "world"}));
      EXPECT_EQ(parameter["default"], "adaptive");
    }
  }
  EXPECT_TRUE(found);
  EXPECT_THAT(run({"techniques"}).out, ::testing::StartsWith("points "));
  EXPECT_THAT(run({"techniques", "points"}).out, HasSubstr("--size-mode"));
}

TEST_F(CommandTest, SynthAndConvertRoundTrip) {
  EXPECT_EQ(run({"synth", "spheres", "--points", "500", "-o", "a.ply", "--quiet"}).code, 0);
  EXPECT_EQ(run({"synth", "spheres", "--points", "500", "-o", "b.ply", "--quiet"}).code, 0);
  EXPECT_EQ(text("a.ply"), text("b.ply")) << "seeded";
  EXPECT_EQ(run({"convert", "a.ply", "-o", "c.ply"}).code, 0);
  const Json a = run_json({"info", "a.ply", "--json"}), c = run_json({"info", "c.ply", "--json"});
  EXPECT_EQ(a["points"], 500);
  EXPECT_EQ(a["attributes"], c["attributes"]);
  EXPECT_EQ(a["bounds_max"], c["bounds_max"]);
}

TEST_F(CommandTest, SynthWritesTheTruth) {
  write("camera.json", R"({"position": [0, -9, 3], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 45,
                           "width": 32, "height": 20})");
  const Outcome outcome = run({"synth", "spheres", "--truth", "truth", "--camera", "camera.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_npy("truth/depth.npy").shape, (std::vector<int>{20, 32}));
  const Array normal = read_npy("truth/normal.npy");
  EXPECT_EQ(normal.type, "<f4");
  EXPECT_EQ(normal.shape, (std::vector<int>{20, 32, 3}));
  EXPECT_EQ(read_npy("truth/class.npy").type, "|u1");
}

TEST_F(CommandTest, OneIsNotSpokenOfAsMany) {
  write("one.xyz", "1 2 3\n");
  const Outcome converted = run({"convert", "one.xyz", "-o", "one.ply"});
  EXPECT_THAT(converted.err, HasSubstr("from the first line: x,y,z"));
  EXPECT_THAT(converted.err, HasSubstr("wrote one.ply (1 point)"));
  const Outcome drawn = run({"one.ply", "-o", "one.png", "--resolution", "64x48"});
  EXPECT_THAT(drawn.err, HasSubstr("points (only 1 point)"));
  EXPECT_THAT(drawn.err, HasSubstr("wrote one.png (1 point, coloured by elevation, +Z up)"));
}

}  // namespace
