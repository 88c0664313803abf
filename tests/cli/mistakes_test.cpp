// What somebody may plausibly get wrong, and what the command then says: one line, exit code, and what to do.
#include <algorithm>

#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

struct Mistake {
  std::vector<std::string> words;
  int code;
  std::string advice;  ///< the part of the message that says what to do
};

class MistakesTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write_cube("cube.ply", 4);
    write("broken.json", "{\n  \"technique\": \"points\",\n  \"options\" {}\n}\n");
    write("odd.json", R"({"parameters": {"point_sizes": 2}})");
    write("wide.xyz", std::string("\xFF\xFE"
                                  "1\0 \0002\0 \0003\0\n\0",
                                  14));
    write("words.xyz", "no numbers here\n");
    write("far.xyz", "1000.0199531 0 0\n1300.7349 40.1 7\n1200 20 3\n");
  }
  void check(const std::vector<Mistake>& mistakes) {
    for (const Mistake& mistake : mistakes) {
      const Outcome outcome = run(mistake.words);
      std::string line;
      for (const std::string& word : mistake.words) line += " " + word;
      EXPECT_EQ(outcome.code, mistake.code) << line << ": " << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(mistake.advice)) << line;
      EXPECT_THAT(outcome.err, ::testing::StartsWith("sfumato: ")) << line;
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << line << ": " << outcome.err;
      EXPECT_EQ(outcome.out, "") << line;
    }
  }
};

TEST_F(MistakesTest, OfCommandsAndOptions) {
  check({
      {{}, 1, "sfumato FILE... -o OUT.png"},
      {{"cube.ply"}, 4, "sfumato FILE... -o OUT.png writes a picture without one"},
      {{"inf", "cube.ply"}, 1, "did you mean info?"},
      {{"convrt", "cube.ply", "-o", "b.ply"}, 1, "did you mean convert?"},
      {{"render", "cube.ply", "-o", "a.png"}, 1, "rendering needs none, sfumato FILE... -o OUT.png"},
      {{"view", "cube.ply"}, 1, "sfumato FILE... -o OUT.png writes a picture"},
      {{"frobnicate"}, 1, "the commands are info, convert"},
      {{"cube.ply", "--draw", "x 1..2", "-o", "a.png"},
       1,
       "there is no colon between selection and technique"},
      {{"cube.ply", "--draw", "*: point", "-o", "a.png"}, 1, "points"},
      {{"cube.ply", "--draw", "*: points point_sice=3", "-o", "a.png"}, 1, "did you mean"},
      {{"cube.ply", "--draw", "hight 3: points", "-o", "a.png"}, 1, "the points have no 'hight'"},
      {{"scan.laz"}, 6, "check the name"},
      {{"help", "vews"}, 1, "did you mean views?"},
      {{"completion", "tcsh"}, 1, "sfumato completion bash|zsh|fish"},
      {{"cube.ply", "-o", "a.png", "-t", "points", "--pointsize", "3"}, 1, "did you mean --point-size?"},
      {{"cube.ply", "-o", "a.png", "-t", "surface", "--pont-size", "3"},
       1,
       "--point-size of another technique (choose with -t)?"},
      {{"cube.ply", "-o", "a.png", "--azimuth", "30"}, 1, "did you mean --camera-azimuth-angle?"},
      {{"cube.ply", "-o", "a.png", "--elevation", "30"}, 1, "did you mean --camera-elevation-angle?"},
      {{"cube.ply", "-o", "a.png", "--fov", "30"}, 1, "did you mean --camera-view-angle?"},
      {{"cube.ply", "-o", "a.png", "--size", "640x480"}, 1, "did you mean --resolution?"},
      {{"cube.ply", "-o", "a.png", "--bbox", "0,0,0,1,1,1"}, 1, "did you mean --crop?"},
      {{"cube.ply", "-o", "a.png", "--section", "0,0,0,1,1,1"}, 1, "did you mean --crop?"},
      {{"cube.ply", "-o", "a.png", "--colour", "red"}, 1, "did you mean --color?"},
      {{"cube.ply", "-o", "a.png", "--gpu"}, 1, "(sfumato --help all lists all)"},
      {{"cube.ply", "-o", "a.png", "-z"}, 1, "unknown option -z (sfumato --help all lists all)"},
      {{"cube.ply", "-o"}, 1, "-o needs a value: -o FILE"},
      {{"cube.ply", "-o", "a.png", "--zoom"}, 1, "--zoom needs a value: --zoom F"},
      {{"cube.ply", "-o", "a.png", "--color-by", "--legend"}, 1, "--color-by needs a value: --color-by NAME"},
      {{"cube.ply", "-o", "a.png", "--up", "-o"}, 1, "--up needs a value: --up "},
      {{"cube.ply", "-o", "a.png", "--up", "-h"}, 1, "--up needs a value: --up "},
      {{"cube.ply", "-o", "a.png", "-t", "pointz"}, 1, "points"},
      {{"cube.ply", "-o", "a.png", "-t", "points", "--radius-scale", "2"}, 1, "choose with -t"},
      {{"cube.ply", "-o", "a.png", "--quiet", "--verbose"}, 1, "give one of them"},
      {{"cube.ply", "-o", "a.png", "--legend=maybe"}, 1, "not true or false"},
  });
}

TEST_F(MistakesTest, OfValues) {
  check({
      {{"cube.ply", "-o", "a.png", "--shadows", "on"}, 1, "say which: hard or soft"},
      {{"cube.ply", "-o", "a.png", "-t", "points", "--point-size", "big"}, 1, "is not a number"},
      {{"cube.ply", "-o", "a.png", "-t", "points", "--point-size", "-3"},
       1,
       "in range [0.01, 1000000]; the nearest is 0.01"},
      {{"cube.ply", "-o", "a.png", "--max-points", "many"}, 1, "(1000, 250k, 2M, 1e6)"},
      {{"cube.ply", "-o", "a.png", "--max-points", "0"}, 1, "at least 1"},
      {{"cube.ply", "-o", "a.png", "--resolution", "640"}, 1, "WIDTHxHEIGHT, such as 1920x1080"},
      {{"cube.ply", "-o", "a.png", "--resolution", "640*480"}, 1, "such as 1920x1080"},
      {{"cube.ply", "-o", "a.png", "--view", "frnt"}, 1, "did you mean front?"},
      {{"cube.ply", "-o", "a.png", "--view", "above"}, 1, "front, back, left, right, top, bottom, iso"},
      {{"cube.ply", "-o", "a.png", "--zoom", "0"}, 1, "not more than 0"},
      {{"cube.ply", "-o", "a.png", "--zoom", "1,5"}, 1, "write decimals with a point"},
      {{"cube.ply", "-o", "a.png", "--look-at", "1,2"}, 1, "3 numbers separated by commas; write X,Y,Z"},
      {{"cube.ply", "-o", "a.png", "--camera-position", "1,5,2,5,3,5"}, 1, "write decimals with a point"},
      {{"cube.ply", "-o", "a.png", "--view", "top", "--camera-azimuth-angle", "3"}, 1, "give one of them"},
      {{"cube.ply", "-o", "a.png", "--look-at", "0,0,0", "--camera-position", "1,1,1"},
       1,
       "give one of them"},
      {{"cube.ply", "-o", "a.png", "--panorama", "--resolution", "640x480"}, 1, "--resolution 960x480"},
      {{"cube.ply", "-o", "a.png", "--panorama", "--zoom", "2"}, 1, "does not go with --panorama"},
      {{"cube.ply", "-o", "a.png", "--color", "stealblue"}, 1, "did you mean steelblue?"},
      {{"cube.ply", "-o", "a.png", "--color", "1,1,255"}, 1, "0..1"},
      {{"cube.ply", "-o", "a.png", "--background-color", "#12345"}, 1, "#hex (#4682b4)"},
      {{"cube.ply", "-o", "a.png", "--color", "red", "--color-by", "row"}, 1, "give one of them"},
      {{"cube.ply", "-o", "a.png", "--color-by", "rows"}, 1, "did you mean 'row'?"},
      {{"cube.ply", "-o", "a.png", "--color-by", "RGB"}, 1, "did you mean 'rgb'?"},
      {{"cube.ply", "-o", "a.png", "--color-by", "height"}, 1, "did you mean 'elevation'?"},
      {{"cube.ply", "-o", "a.png", "--color-by", "Class"}, 1, "to colour by; it has:"},
      {{"cube.ply", "-o", "a.png", "--colormap", "turbu"}, 1, "did you mean 'turbo'?"},
      {{"cube.ply", "-o", "a.png", "--crop", "0,0,0,1,1"},
       1,
       "6 numbers separated by commas; write X0,Y0,Z0,X1,Y1,Z1"},
      {{"cube.ply", "-o", "a.png", "--color-range", "5"}, 1, "2 numbers separated by commas; write A,B"},
      {{"cube.ply", "-o", "a.png", "--crop", "1,0,0,0,1,1"}, 1, "smaller numbers first"},
      {{"cube.ply", "-o", "a.png", "--crop", "5,5,5,6,6,6"}, 2, "the points lie in 0,0,0,1,1,1"},
      {{"far.xyz", "-o", "a.png", "--crop", "5,5,5,6,6,6"}, 2, "lie in 1000.01,0,0,1300.74,40.1,7"},
      {{"cube.ply", "-o", "a.png", "--filter", "row"}, 1, "write SCALAR A..B"},
      {{"cube.ply", "-o", "a.png", "--filter", "rows 1..2"}, 1, "did you mean 'row'?"},
      {{"cube.ply", "-o", "a.png", "--filter", "row 7..9"}, 2, "row goes from 0 to 3"},
      {{"cube.ply", "-o", "a.png", "--filter", "row 9..7"}, 1, "its range is empty"},
      {{"cube.ply", "-o", "a.png", "--show-classes", "2"}, 1, "leave out the classes to show"},
      {{"cube.ply", "-o", "a.png", "--hide-classes", "noise"}, 1, "whole number"},
      {{"cube.ply", "-o", "a.png", "--threads", "0"}, 1, "at least 1"},
      {{"cube.ply", "-o", "a.png", "--up", "north"}, 1, "+X -X +Y -Y +Z -Z"},
  });
}

TEST_F(MistakesTest, OfFiles) {
  check({
      {{"missing.ply", "-o", "a.png"}, 6, "check the name"},
      {{"*.laz", "-o", "a.png"}, 6, "check the folder and the pattern"},
      {{"words.xyz", "-o", "a.png"}, 2, "words.xyz"},
      {{"wide.xyz", "-o", "a.png"}, 2, "iconv -f UTF-16 -t UTF-8"},
      {{"cube.ply", "-o", "a.bmp"}, 1, "written as .png, .jpg, .webp, .tif, .exr or .npy"},
      {{"cube.ply", "-o", "cube.ply"}, 1, "cube.ply"},
      {{"cube.ply", "-o", "a_{x}.png"}, 1, "there are {stem}"},
      {{"cube.ply", "-o", "a_{n}.png"}, 1, "{n} numbers the pictures of --path, --sequence or --each"},
      {{"cube.ply", "cube.ply", "-o", "{stem}.png"}, 1, "unless --each makes pictures"},
      {{"cube.ply", "cube.ply", "--each", "-o", "a.png"}, 1, "write {stem}"},
      {{"cube.ply", "-o", "a.png", "--path", "orbit"}, 1, "{n:04}"},
      {{"cube.ply", "-o", "a.png", "--frames", "3"}, 1, "need --path"},
      {{"cube.ply", "-o", "a.jpg", "--no-background"}, 1, "write a .png or .webp"},
      {{"cube.ply", "-o", "a.png", "--quality", "80"}, 1, "goes with .jpg and .webp"},
      {{"cube.ply", "-o", "a.jpg", "--quality", "800"}, 1, "1..100"},
      {{"cube.ply", "-o", "a.exr", "--legend"}, 1, ".png, .jpg and .webp only"},
      {{"cube.ply", "-o", "a.png", "--output-depth", "d.tif"}, 1, ".npy, .exr or .png"},
      {{"cube.ply", "-o", "a.png", "--preset", "broken.json"}, 2, "line 3, column"},
      {{"cube.ply", "-o", "a.png", "--preset", "odd.json"}, 2, "sfumato techniques NAME lists them"},
      {{"cube.ply", "-o", "a.png", "--preset", "none.json"}, 6, "check the name"},
      {{"convert", "cube.ply"}, 1, "add -o OUT"},
      {{"convert", "-o", "b.ply"}, 1, "usage: sfumato convert IN... -o OUT"},
      {{"convert", "cube.ply", "-o", "b.stl"}, 1, "clouds are written as"},
      {{"convert", "cube.ply", "-o", "cube.ply"}, 1, "cube.ply"},
      {{"info"}, 1, "sfumato info FILE..."},
      {{"synth", "courtyart", "-o", "a.ply"}, 1, "courtyard"},
  });
  EXPECT_EQ(files(), (std::vector<std::string>{"broken.json", "cube.ply", "far.xyz", "odd.json", "wide.xyz",
                                               "words.xyz"}))
      << "no mistake leaves a file behind";
}

}  // namespace
