// The window as a hand uses it: real keys and a real mouse on a display of its own, and pixels looked at.
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>

#include "viewer/desk.h"
#include "viewer/drop.h"

namespace sfumato::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

int colors_of(const Image<Rgba8>& image) {
  std::set<std::uint32_t> seen;
  for (const Rgba8& c : image) seen.insert(std::uint32_t(c.r) << 16 | std::uint32_t(c.g) << 8 | c.b);
  return int(seen.size());
}

bool equal(const Image<Rgba8>& a, const Image<Rgba8>& b) {
  return a.width() == b.width() && a.height() == b.height() && std::equal(a.begin(), a.end(), b.begin());
}

class WindowTest : public DeskTest {
 protected:
  void make_forest() {
    const Outcome made = run({"synth", "forest", "--points", "30000", "-o", "forest.laz", "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
  }
  /// Another text for the field at a place. Keys are held as long as a finger does: the interface looks at
  /// them once a frame.
  void type_over(int x, int y, const std::string& text) {
    hand("mousemove " + std::to_string(x) + " " + std::to_string(y) +
         " click 1 sleep 0.3 keydown ctrl sleep 0.3 keydown a sleep 0.3 keyup a keyup ctrl sleep 0.3 type "
         "--delay 80 '" +
         text + "'");
    hand("sleep 0.3 keydown Return sleep 0.3 keyup Return mousemove 475 20");
  }
  void close() {
    hand("key ctrl+q");
    EXPECT_EQ(exit_code(), 0) << said();
  }
  /// The saved picture is what these words draw without a window.
  void expect_drawn_by(const std::string& name, std::vector<std::string> words) {
    words.insert(words.end(), {"--resolution", "950x694", "-o", "plain.png"});
    const Outcome plain = run(words);
    ASSERT_EQ(plain.code, 0) << plain.err;
    EXPECT_TRUE(equal(read_png(name), read_png("plain.png"))) << png_texts(name)["Command"];
  }
  /// The saved picture is what its command draws without a window.
  void expect_reproducible(const std::string& name) {
    const std::string command = png_texts(name)["Command"];
    EXPECT_TRUE(equal(read_png(name), read_png(drawn_again(command, "again.png")))) << command;
  }
};

TEST_F(WindowTest, DrawsEveryTechniqueAsTheCommandDoes) {
  make_forest();
  open({"forest.laz"});
  wait_for("final picture");
  hand("mousemove 475 350");
  // Long enough that what techniques need is measured ahead of them: it must be the same.
  hand("sleep 4");
  std::vector<std::string> pictures;
  int n = 0;
  for (const char* technique : {"points", "splats", "surface", "soft", "layers", "denoise", "strokes"}) {
    SCOPED_TRACE(technique);
    hand("key " + std::to_string(++n));
    wait_for(std::string("final picture: ") + technique);
    // Each from a side of its own.
    const int before = count("final picture");
    hand(
        "mousedown 1 sleep 0.2 mousemove_relative --sync 9 3 sleep 0.1 mousemove_relative --sync 30 4 sleep "
        "0.2 mouseup 1 "
        "sleep 0.1 mousemove 475 350");
    wait_for("final picture", before + 1);
    pictures.push_back(save());
  }
  const int before = count("final picture: points");
  hand("key 1");  // nor may it change what does not need it
  wait_for("final picture: points", before + 1);
  pictures.push_back(save());
  // The screen shows the last of them, pixel by pixel.
  const Image<Rgba8> shown = screen(), last = read_png(pictures.back());
  ASSERT_EQ(last.width(), view_width);
  ASSERT_EQ(last.height(), view_height);
  int different = 0;
  for (int y = 0; y < view_height; ++y)
    for (int x = 0; x < view_width; ++x) different += !(shown.at(x, y) == last.at(x, y));
  EXPECT_LT(different, view_width * view_height / 50);  // the message that it was saved lies over it
  close();
  for (const std::string& each : pictures) {
    SCOPED_TRACE(each);
    EXPECT_GT(colors_of(read_png(each)), 50);
    expect_reproducible(each);
  }
  EXPECT_EQ(std::set<std::string>(pictures.begin(), pictures.end()).size(), 8u);
}

TEST_F(WindowTest, FirstPictureIsThatOfTheCommand) {
  make_forest();
  open({"forest.laz"});
  wait_for("final picture");
  const std::string saved = save();
  close();
  expect_drawn_by(saved, {"forest.laz"});
}

// Points appear while the file is read; what was found of the whole takes over where no hand has moved.
TEST_F(WindowTest, ShowsASampleWhileItReads) {
  ASSERT_EQ(run({"synth", "tori", "--points", "1200000", "-o", "tori.laz", "--quiet"}).code, 0);
  setenv("SFUMATO_THREADS", "1", 1);  // seconds of reading
  open({"tori.laz", "-t", "points"});
  wait_for("points are read");
  const std::string before = said();
  EXPECT_LT(before.find("a sample of "), before.find("first picture after ")) << before;
  EXPECT_LT(before.find("first picture after "), before.find("1200000 points are read")) << before;
  wait_for("final picture");
  const std::string saved = save();
  close();
  // A hand that turns the sample goes on from there. What it saves is of all points.
  open({"tori.laz", "-t", "points"});
  wait_for("first picture after ");
  const std::string early = save();
  EXPECT_LT(said().find("saved once everything is loaded"), said().find("1200000 points are read"));
  EXPECT_TRUE(equal(read_png(early), read_png(saved)));
  close();
  open({"tori.laz", "-t", "points"});
  wait_for("first picture after ");
  hand("mousemove 475 20 key KP_7");
  wait_for("points are read");
  wait_for("final picture");
  const std::string turned = save();
  hand("key r");
  wait_for("final picture", 2);
  const std::string home = save();
  close();
  unsetenv("SFUMATO_THREADS");
  expect_drawn_by(saved, {"tori.laz", "-t", "points"});
  EXPECT_TRUE(equal(read_png(home), read_png("plain.png")));
  EXPECT_FALSE(equal(read_png(turned), read_png("plain.png")));
  expect_reproducible(turned);
}

TEST_F(WindowTest, PicturesOfRoomsThatAreCutOpenSaySo) {
  ASSERT_EQ(run({"synth", "room", "--points", "60k", "-o", "room.ply", "--quiet"}).code, 0);
  open({"room.ply", "-t", "points", "--up", "+Z"});
  wait_for("final picture");
  const std::string name = save();
  expect_reproducible(name);
  const std::string description = png_texts(name)["Description"];
  EXPECT_THAT(description, HasSubstr("--whole"));
  EXPECT_EQ(description, png_texts("again.png")["Description"]);
  close();
}

TEST_F(WindowTest, DragsTheLight) {
  make_forest();
  open({"forest.laz", "-t", "surface", "--no-edl", "--light", "headlight"});
  wait_for("final picture");
  const std::string before = save();
  hand(
      "mousemove 475 350 keydown ctrl keydown shift sleep 0.3 mousedown 1 sleep 0.2 mousemove_relative "
      "--sync 40 0 sleep 0.1 "
      "mousemove_relative --sync 133 0 sleep 0.3");
  const Image<Rgba8> shown = screen();
  hand("mouseup 1 sleep 0.1 keyup shift keyup ctrl mousemove 475 20");
  wait_for("final picture", 2);
  const std::string after = save();
  // 173 of 694 pixels are an eighth of a turn.
  const std::string command = png_texts(after)["Command"];
  EXPECT_THAT(command, HasSubstr("--light=dir:"));
  EXPECT_FALSE(equal(read_png(before), read_png(after)));
  // While it is dragged the light is a dot on a ball: at sin 45 degrees of its radius, which is a quarter of
  // the view's height.
  int amber = 0;
  const int x = view_width / 2 + int(std::sin(3.14159265 * 173 / view_height) * view_height / 4),
            y = view_height / 2;
  for (int dy = -9; dy <= 9; ++dy)
    for (int dx = -9; dx <= 9; ++dx) amber += shown.at(x + dx, y + dy) == Rgba8{0xff, 0xb0, 0x00, 255};
  EXPECT_GT(amber, 60);
  hand("key ctrl+z");
  wait_for("final picture", 3);
  EXPECT_TRUE(equal(read_png(save()), read_png(before)));
  close();
  expect_reproducible(after);
}

// Nobody needs a mouse: arrows walk through the panels, also where a key goes down and up between two frames.
TEST_F(WindowTest, KeysReachTheControls) {
  write_cube("cube.ply", 20);
  open({"cube.ply", "-t", "points"});
  wait_for("final picture");
  const auto tap = [&](const std::string& key) { hand("key --delay 0 " + key + " sleep 0.5"); };
  hand("mousemove 475 20 sleep 0.3");
  for (const char* key : {"Tab", "Down", "Right", "space"})
    tap(key);  // to the panels, on the first button, to the second
  wait_for("final picture: splats");
  const int before = count("final picture");
  for (const char* key : {"End", "space"})
    tap(key);  // the last heading opens: timings want a picture of their own
  wait_for("final picture", before + 1);
  EXPECT_THAT(said(), Not(HasSubstr("a path needs two keys")));  // what Space does elsewhere
  close();
}

// Shaders are edited live: a mistake is said and the picture stays, what compiles is seen.
TEST_F(WindowTest, CompilesShadersAgainWhenTheyChange) {
  namespace fs = std::filesystem;
  for (const char* room : {"src", "shaders"})
    for (const auto& each : fs::recursive_directory_iterator(fs::path(SFUMATO_SOURCE_DIR) / room)) {
      const std::string kind = each.path().extension().string();
      if (kind != ".glsl" && kind != ".comp" && kind != ".vert" && kind != ".frag") continue;
      const fs::path copy = path("checkout") / fs::relative(each.path(), SFUMATO_SOURCE_DIR);
      fs::create_directories(copy.parent_path());
      fs::copy_file(each.path(), copy);
    }
  write_cube("cube.ply", 40);
  open({"cube.ply", "-t", "points", "--shader-dir", "checkout"});
  wait_for("final picture");
  const std::string before = save();
  const std::string file = "checkout/src/passes/finish.glsl", good = text(file);
  ASSERT_NE(good.find("vec4 finished_color("), std::string::npos);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  write(file, good + "\nthis is no shader\n");
  wait_for("does not compile");
  EXPECT_THAT(said(), HasSubstr("finish.glsl:"));
  const Image<Rgba8> shown = screen(), last = read_png(before);
  EXPECT_EQ(shown.at(view_width / 2, 40), last.at(view_width / 2, 40));
  int same = 0;
  for (int y = 100; y < 400; ++y) same += shown.at(view_width / 2, y) == last.at(view_width / 2, y);
  EXPECT_GT(same, 290);
  // What is finished is green now.
  std::string green = good;
  green.replace(green.find("vec4 finished_color("), 5,
                "vec4 finished_color(vec4 color) { return vec4(0.0, 1.0, 0.0, 1.0); }\nvec4 real_");
  const int pictures = count("final picture");
  write(file, green);
  wait_for("final picture", pictures + 1);
  const Image<Rgba8> seen = read_png(save());
  EXPECT_EQ(seen.at(view_width / 2, view_height / 2), (Rgba8{0, 255, 0, 255}));
  write(file, good);
  wait_for("final picture", pictures + 2);
  EXPECT_TRUE(equal(read_png(save()), last));
  close();
}

TEST_F(WindowTest, SlidersClassesCopyAndUndo) {
  make_forest();
  open({"forest.laz", "-t", "points"});
  wait_for("final picture");
  const std::string first = save();
  // The slider of the size of points is the second control of the panel.
  hand("mousemove 1080 148 click 1 sleep 0.3 mousemove 475 20");
  wait_for("final picture", 2);
  const std::string larger = save();
  EXPECT_THAT(png_texts(larger)["Command"], HasSubstr("--point-size="));
  EXPECT_FALSE(equal(read_png(first), read_png(larger)));
  // The list of classes opens below, its first row is the ground.
  hand("mousemove 1010 261 click 1 sleep 0.3 mousemove 988 287 click 1 sleep 0.1 mousemove 475 20");
  wait_for("final picture", 3);
  const std::string without_ground = save();
  const std::string command = png_texts(without_ground)["Command"];
  EXPECT_THAT(command, HasSubstr("--hide-classes=2,7,18"));
  hand("key ctrl+shift+c");
  wait_for("the command is copied");
  const std::string copied = clipboard();
  EXPECT_EQ(copied.substr(0, copied.rfind(" -o ")), command.substr(0, command.rfind(" -o ")));
  EXPECT_TRUE(equal(read_png(without_ground), read_png(drawn_again(copied, "copied.png"))));
  expect_reproducible(larger);
  hand("key ctrl+z");
  wait_for("final picture", 4);
  EXPECT_TRUE(equal(read_png(save()), read_png(larger)));
  hand("key ctrl+z");
  wait_for("final picture", 5);
  EXPECT_TRUE(equal(read_png(save()), read_png(first)));
  // A camera leaves and comes back as text.
  hand("key ctrl+c");
  wait_for("the camera is copied");
  EXPECT_THAT(clipboard(), HasSubstr("\"fov_y_deg\""));
  hand("key KP_7");
  wait_for("final picture", 6);
  hand("key ctrl+v");
  wait_for("final picture", 7);
  EXPECT_TRUE(equal(read_png(save()), read_png(first)));
  close();
}

// Items are rows: what the command line says is there, a row is switched off, another one is edited, and all
// of it is in the command of the picture.
TEST_F(WindowTest, ItemsAreRows) {
  make_forest();
  open({"forest.laz", "-t", "points", "--draw", "class ground: splats", "--draw", "z 6..: soft"});
  wait_for("final picture");
  const std::string both = save();
  EXPECT_THAT(png_texts(both)["Command"], HasSubstr("'--draw=class ground: splats' '--draw=z 6..: soft'"));
  // The first row's box, in the panel that is open where there are rows.
  hand("mousemove 970 237 click 1 sleep 0.3 mousemove 475 20");
  wait_for("final picture", 2);
  const std::string one = save();
  EXPECT_THAT(png_texts(one)["Command"], HasSubstr("'--draw=class ground: none'"));
  EXPECT_FALSE(equal(read_png(both), read_png(one)));
  // The second row's selection, typed anew.
  type_over(1092, 287, "z 4..");
  wait_for("final picture", 3);
  const std::string edited = save();
  EXPECT_THAT(png_texts(edited)["Command"], HasSubstr("'--draw=z 4..: soft'"));
  // A number that the scan lacks is said, and nothing is lost.
  type_over(1092, 287, "beauty 4..");
  wait_for("no 'beauty'");
  EXPECT_TRUE(equal(read_png(save()), read_png(edited)));
  close();
  for (const std::string& each : {both, one, edited}) expect_reproducible(each);
}

/// Points of which only the times tell one from the next, and what --color-range says of a picture of them.
class RangeTest : public WindowTest {
 protected:
  /// `end`: of the time, behind `begin` and a number from 100 to 199.
  void open_times(const std::string& begin, const std::string& end, const std::vector<std::string>& more) {
    {
      std::ofstream out(path("strip.csv"));
      out << "x,y,z,gps_time\n";
      for (int i = 0; i < 5000; ++i)
        out << i % 100 << "," << i / 100 << "," << i % 7 << "," << begin << 100 + i % 100 << end << "\n";
    }
    std::vector<std::string> words{"strip.csv", "-t", "points", "--color-by", "gps_time"};
    words.insert(words.end(), more.begin(), more.end());
    open(words);
    wait_for("final picture");
    // Parameters are closed and colours opened.
    hand("mousemove 1010 73 click 1 sleep 0.5 mousemove 1010 123 click 1 sleep 0.7");
  }
  void drag(int from, int to, int y) {
    const auto move = [&](int x) { return "mousemove " + std::to_string(x) + " " + std::to_string(y); };
    hand(move(from) + " sleep 0.3 mousedown 1 sleep 0.3 " + move((2 * from + to) / 3) + " sleep 0.2 " +
         move(to) + " sleep 0.3 mouseup 1 sleep 0.3 mousemove 475 20");
  }
  std::pair<double, double> range(const std::string& name) {
    const std::string command = png_texts(name)["Command"], option = "--color-range=";
    double low = 0, high = 0;
    const std::size_t at = command.find(option);
    EXPECT_NE(at, std::string::npos) << command;
    if (at != std::string::npos)
      EXPECT_EQ(std::sscanf(command.c_str() + at + option.size(), "%lf,%lf", &low, &high), 2) << command;
    return {low, high};
  }
};

// Times of a GPS differ in digits that neither a float nor five digits have.
TEST_F(RangeTest, IsDraggedOfLargeNumbers) {
  open_times("300000", ".5", {});
  drag(1060, 1180, 235);  // over the histogram, which is 310 px wide, for 99 seconds
  wait_for("final picture", 2);
  const std::string dragged = save();
  const auto [low, high] = range(dragged);
  EXPECT_NEAR(low, 300'000'100.5 + 99 * 100.0 / 310, 1);
  EXPECT_NEAR(high, 300'000'100.5 + 99 * 220.0 / 310, 1);
  // The field of the lower end, below it, has room for all of its digits.
  drag(1035, 1055, 273);
  wait_for("final picture", 3);
  const auto [moved, kept] = range(save());
  EXPECT_GT(moved, low);
  EXPECT_LT(moved, high);
  EXPECT_EQ(kept, high);
  EXPECT_THAT(said(), Not(HasSubstr("two different numbers")));
  close();
  expect_reproducible(dragged);
}

// Two fields of so many digits stand below each other.
TEST_F(RangeTest, HasRoomForEveryDigit) {
  open_times("1234567890.0", "", {"--color-range", "1234567890.011,1234567890.018"});
  drag(1060, 1080, 273);
  wait_for("final picture", 2);
  const auto [low, high] = range(save());
  EXPECT_GT(low, 1234567890.011);
  EXPECT_EQ(high, 1234567890.018);
  drag(1060, 1080, 298);
  wait_for("final picture", 3);
  const auto [kept, moved] = range(save());
  EXPECT_EQ(kept, low);
  EXPECT_GT(moved, high);
  close();
}

TEST_F(WindowTest, PicksAndMeasures) {
  write_cube("cube.ply", 60);
  open({"cube.ply", "-t", "points", "--view", "front", "--camera-orthographic"});
  wait_for("final picture");
  // The front of the cube is a square in the middle: two places at one height.
  hand("mousemove 400 347 click 1");
  wait_for("picked point", 1);
  hand("sleep 0.6 mousemove 550 347 click 1");  // later than a double click
  wait_for("picked point", 2);
  hand("mousemove 20 690 sleep 0.5");
  const std::string all = said();
  const std::size_t at = all.find(", distance ");
  ASSERT_NE(at, std::string::npos) << all;
  double distance = 0, height = 0;
  ASSERT_EQ(std::sscanf(all.c_str() + at, ", distance %lf, height %lf", &distance, &height), 2);
  // 150 of the pixels of the parallel view. Points are 1/60 apart, and each of two is taken at most half of
  // that beside its place.
  hand("key ctrl+c");
  wait_for("the camera is copied");
  const double view_height_world = nlohmann::json::parse(clipboard())["height_world"];
  EXPECT_NEAR(distance, 150 * view_height_world / view_height, 1.0 / 60);
  EXPECT_NEAR(height, 0, 1.0 / 60);
  const Image<Rgba8> seen = screen();
  for (int x : {400, 550}) {
    int amber = 0;
    for (int dy = -9; dy <= 9; ++dy)
      for (int dx = -9; dx <= 9; ++dx) amber += seen.at(x + dx, 347 + dy) == Rgba8{0xff, 0xb0, 0x00, 255};
    EXPECT_GT(amber, 20) << x;  // a mark of radius 4
  }
  hand("key v");
  wait_for("sfumato: profile of ");
  hand("key Escape");
  close();
}

// The panel opens a second file beside the first, saves the look and the scene, and both bring back what they
// are of.
TEST_F(WindowTest, OpensASecondFileAndSavesLookAndScene) {
  write_cube("cube.ply", 20);
  write_cube("again.ply", 30);
  open({"cube.ply", "-t", "points", "--color-by", "elevation"});
  wait_for("final picture");
  // The headings above are closed, so that the last but one, of the scene, is where the test says: Parameters
  // first.
  hand("mousemove 1010 73 click 1 sleep 0.5 mousemove 1010 273 click 1 sleep 0.7");
  const int before = count("final picture");
  // The field for a name, below a bullet and four notes; Ctrl and the button beside it: beside what is open.
  type_over(1050, 413, "again.ply");
  hand(
      "sleep 0.3 keydown ctrl sleep 0.2 mousemove 1238 413 sleep 0.2 mousedown 1 sleep 0.2 mouseup 1 sleep "
      "0.2 keyup ctrl mousemove 475 20");
  wait_for("final picture", before + 1);
  const std::string both = save();
  EXPECT_THAT(png_texts(both)["Command"], HasSubstr("cube.ply again.ply"));
  close();
  expect_reproducible(both);
}

// What cannot be read to its end is said, and its sample stays.
TEST_F(WindowTest, KeepsTheSampleOfAFileThatIsDamaged) {
  {
    std::ofstream out(path("field.xyz"));
    for (int i = 0; i < 1'200'000; ++i) out << i % 1000 << " " << i / 1000 << " " << i % 7 << "\n";
    out << "1 nonsense 3\n";
    out << "1 2 3";
  }
  open({"field.xyz", "-t", "points"});
  wait_for("line 1200001");
  wait_for("what is shown is a sample");
  wait_for("first picture");
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  EXPECT_GT(colors_of(screen()), 50);
  hand("mousemove 475 350 key p");
  wait_for("only a sample could be read");
  hand("mousemove 475 350 click 1");
  wait_for("points are picked among all of them");
  close();
}

#ifdef SFUMATO_X11
// Files dragged from another program: one takes the place of what is open, with Ctrl it comes beside it.
TEST_F(WindowTest, TakesFilesThatAreDropped) {
  write_cube("cube.ply", 20);
  write_cube("second one.ply", 30);
  write_cube("third.ply", 10);
  open({"cube.ply", "-t", "points"});
  wait_for("final picture");
  std::string second = path("second one.ply").string();
  second.replace(second.find(' '), 1, "%20");
  ASSERT_EQ(drop_files({second}, 475, 350), "");
  wait_for("points are read", 2);
  const std::string alone = save();
  EXPECT_THAT(png_texts(alone)["Command"], HasSubstr("second one.ply"));
  EXPECT_THAT(png_texts(alone)["Command"], Not(HasSubstr("cube.ply")));
  hand("keydown ctrl sleep 0.3");
  ASSERT_EQ(drop_files({path("third.ply").string()}, 475, 350), "");
  hand("sleep 0.3 keyup ctrl");
  wait_for("points are read", 3);
  const std::string both = save();
  EXPECT_THAT(png_texts(both)["Command"], HasSubstr("second one.ply"));
  EXPECT_THAT(png_texts(both)["Command"], HasSubstr("third.ply"));
  close();
  expect_reproducible(both);
}

// A scene looks as the command draws it, whatever colours the window had.
TEST_F(WindowTest, TakesASceneThatIsDropped) {
  write_cube("cube.ply", 20);
  ASSERT_EQ(
      run({"cube.ply", "-t", "points", "--view", "front", "--save-scene", "scene.json", "-o", "any.png"})
          .code,
      0);
  open({"cube.ply", "-t", "points", "--color-by", "elevation", "--background-color", "black", "--legend"});
  wait_for("final picture");
  ASSERT_EQ(drop_files({path("scene.json").string()}, 475, 350), "");
  wait_for("final picture", 2);
  const std::string saved = save();
  hand("mousemove 475 350 key KP_7");
  wait_for("final picture", 3);
  hand("key r");
  wait_for("final picture", 4);
  EXPECT_TRUE(equal(read_png(save()), read_png(saved)));  // home is where the scene is seen from
  close();
  expect_drawn_by(saved, {"--scene", "scene.json"});
}

// One that keeps no camera is framed as its files would be.
TEST_F(WindowTest, FramesASceneWithoutACamera) {
  write_cube("cube.ply", 20);
  write_cube("other.ply", 25);
  ASSERT_EQ(run({"other.ply", "-t", "points", "--save-scene", "scene.json", "-o", "any.png"}).code, 0);
  nlohmann::json scene = nlohmann::json::parse(text("scene.json"));
  ASSERT_EQ(scene.erase("camera"), 1u);
  write("scene.json", scene.dump());
  open({"cube.ply", "-t", "points", "--view", "top"});
  wait_for("final picture");
  ASSERT_EQ(drop_files({path("scene.json").string()}, 475, 350), "");
  wait_for("points are read", 2);
  const std::string saved = save();
  close();
  expect_drawn_by(saved, {"--scene", "scene.json"});
}
#endif

// A limit on the size of files stands for the full disk.
TEST_F(WindowTest, LeavesNothingOfAPictureThatCannotBeSaved) {
  write_cube("cube.ply", 60);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{16'000, before.rlim_max};
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  open({"cube.ply", "-t", "points"});
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  wait_for("final picture");
  hand("key p");
  wait_for("File too large");
  EXPECT_FALSE(exists("sfumato_0001.png"));
  close();
}

// A path made of key views is played: its pictures are in motion, its end is the last key.
TEST_F(WindowTest, PlaysAPathOfKeyViews) {
  write_cube("cube.ply", 20);
  open({"cube.ply", "-t", "points"});
  wait_for("final picture");
  hand("key KP_1");
  wait_for("final picture", 2);
  hand("key k");
  wait_for("key 1 of the camera path");
  hand("key KP_7");
  wait_for("final picture", 3);
  const std::string top = save();
  hand("key k");
  wait_for("key 2 of the camera path");
  hand("key KP_1");
  wait_for("final picture", 4);
  EXPECT_FALSE(equal(read_png(save()), read_png(top)));
  hand("key space");
  wait_for("final picture", 5);
  EXPECT_THAT(said(), HasSubstr("in motion: "));
  EXPECT_TRUE(equal(read_png(save()), read_png(top)));  // it ends at the last key
  close();
}

// Files of a sequence are seen from one camera, and played.
TEST_F(WindowTest, PlaysTheFilesOfASequence) {
  write_cube("f1.ply", 10);
  write_cube("f2.ply", 25);
  open({"f1.ply", "f2.ply", "--sequence", "-t", "points"});
  wait_for("final picture");
  const std::string first = save();
  hand("key space");
  wait_for("final picture", 3);  // the second, and the first again
  hand("key space");
  close();
  EXPECT_THAT(png_texts(first)["Command"], HasSubstr("sfumato f1.ply -t points"));
  expect_reproducible(first);
}

TEST_F(WindowTest, ReadsFilesAgainWhenTheyChange) {
  write_cube("cube.ply", 20);
  open({"cube.ply", "-t", "points", "--watch"});
  wait_for("final picture");
  const std::string before = save();
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  write_cube("other.ply", 35);
  std::filesystem::rename(path("other.ply"), path("cube.ply"));
  wait_for("files changed");
  wait_for("final picture", 2);
  const std::string after = save();
  EXPECT_FALSE(equal(read_png(before), read_png(after)));
  expect_reproducible(after);
  close();
}

TEST_F(WindowTest, ClosesWhileItLoads) {
  ASSERT_EQ(run({"synth", "tori", "--points", "1000000", "-o", "tori.ply", "--quiet"}).code, 0);
  for (const int wait_ms : {700, 1500, 3000}) {
    open({"tori.ply", "-t", "strokes"});  // seconds of analysis
    // A key before the window is there would be lost.
    ASSERT_EQ(std::system("timeout 60 xdotool search --sync --onlyvisible --name sfumato >/dev/null"), 0)
        << said();
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    hand("mousemove 475 350 key ctrl+q");
    EXPECT_EQ(exit_code(60), 0) << wait_ms << "\n" << said();
  }
}

TEST_F(WindowTest, TellsWhatIsWrongWithTheFirstFileAndEnds) {
  write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n2\n3\n");
  open({"broken.ply"});
  EXPECT_EQ(exit_code(), 2) << said();
  EXPECT_THAT(said(), HasSubstr("broken.ply"));
}

}  // namespace
}  // namespace sfumato::testing
