// Pictures that one can measure in: what is drawn into them stands where coordinates say.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "cli/command.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

class FiguresTest : public CommandTest {
 protected:
  /// An area of points half a unit apart, 7 high in its middle, its lower left corner at (1000, 2000).
  std::string write_area(const std::string& name, double width = 100, double height = 60) {
    std::string rows;
    for (double x = 0; x <= width; x += 0.5)
      for (double y = 0; y <= height; y += 0.5)
        rows += std::to_string(1000 + x) + " " + std::to_string(2000 + y) + " " +
                std::to_string(7 * (1 - std::abs(2 * x / width - 1))) + "\n";
    return write(name, rows);
  }
  static bool is_ink(const Rgba8& c) { return c.r < 40 && c.g < 40 && c.b < 40; }
  /// Longest run of ink in any row.
  static int longest_run(const Image<Rgba8>& image) {
    int longest = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0, run = 0; x < image.width(); ++x)
        longest = std::max(longest, run = is_ink(image.at(x, y)) ? run + 1 : 0);
    return longest;
  }
  /// Rows that are not background.
  static int rows_drawn(const Image<Rgba8>& image) {
    int rows = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        if (!(image.at(x, y) == Rgba8{255, 255, 255, 255})) {
          ++rows;
          break;
        }
    return rows;
  }
  void expect_ok(std::vector<std::string> words) {
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
};

TEST_F(FiguresTest, AScaleBarOnPaperIsRightToAPixel) {
  write_area("a.xyz");
  for (const auto& [scale, dpi, bar_m] :
       {std::tuple("1:500", 300, 20.0), {"1:1000", 150, 20.0}, {"1:250", 96, 20.0}}) {
    expect_ok({"a.xyz", "-t", "points", "--up", "+Z", "--view", "top", "--color", "#ffcc66", "--scale", scale,
               "--dpi", std::to_string(dpi), "--unit", "m", "--scale-bar", "-o", "a.png"});
    const Image<Rgba8> image = read_png("a.png");
    const double metres_a_pixel = std::atof(scale + 2) * 0.0254 / dpi;
    EXPECT_NEAR(longest_run(image), bar_m / metres_a_pixel, 1) << scale;
    // On paper the area is as large as it should be, and the file says how large a pixel is there.
    EXPECT_NEAR(image.width(), 100 / metres_a_pixel, 2) << scale;
    const std::string bytes = text("a.png");
    const std::size_t chunk = bytes.find("pHYs");
    ASSERT_NE(chunk, std::string::npos);
    int per_metre = 0;
    for (int i = 0; i < 4; ++i) per_metre = 256 * per_metre + std::uint8_t(bytes[chunk + 4 + std::size_t(i)]);
    EXPECT_NEAR(per_metre, dpi / 0.0254, 1);
  }
}

// The ratio of a unit that nobody knows may be wrong, and is not written.
TEST_F(FiguresTest, ARatioIsWrittenWhereTheUnitIsKnown) {
  write_area("a.xyz");
  const std::vector<std::string> plan{"a.xyz", "-t", "points", "--up", "+Z", "--view", "top", "--scale-bar"};
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), plan.begin(), plan.end());
    more.insert(more.end(), {"-o", "a.png"});
    expect_ok(more);
    const Image<Rgba8> image = read_png("a.png");
    return std::vector<Rgba8>(image.data(), image.data() + image.size());
  };
  const std::vector<std::string> scale{"--scale", "1:500", "--dpi", "127"},
      pixel{"--pixel-size", "0.1", "--dpi", "127"};
  const auto with_unit = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--unit", "m"});
    return words;
  };
  EXPECT_EQ(render(scale), render(pixel));
  EXPECT_NE(render(with_unit(scale)), render(with_unit(pixel)));
}

// A bar is that of horizontal lengths; whoever measures heights with it has to know.
TEST_F(FiguresTest, ExaggeratedHeightsAreSaidAboveTheBarWhereHeightsAreSeen) {
  std::string rows;  // flat, so that nothing but the words changes
  for (int i = 0; i <= 2500; ++i) rows += std::to_string(i % 50) + " " + std::to_string(i / 50) + " 0\n";
  write("a.xyz", rows);
  const auto render = [&](const char* view, const char* factor) {
    expect_ok({"a.xyz", "-t", "points", "--up", "+Z", "--color", "#ffcc66", "--view", view, "--resolution",
               "640x360", "--camera-orthographic", "--vertical-exaggeration", factor, "--scale-bar", "-o",
               "a.png"});
    const Image<Rgba8> image = read_png("a.png");
    int ink = 0;
    for (const Rgba8& c : image) ink += is_ink(c);
    return ink;
  };
  EXPECT_EQ(render("top", "3"), render("top", "1"));
  EXPECT_GT(render("front", "3"), render("front", "1") + 50);
}

TEST_F(FiguresTest, FeetAreShorterOnPaperThanMetres) {
  write_area("a.xyz");
  expect_ok({"a.xyz", "-t", "points", "--up", "+Z", "--view", "top", "--scale", "1:500", "--unit", "m", "-o",
             "m.png"});
  expect_ok({"a.xyz", "-t", "points", "--up", "+Z", "--view", "top", "--scale", "1:500", "--unit", "ft", "-o",
             "ft.png"});
  EXPECT_NEAR(read_png("ft.png").width(), 0.3048 * read_png("m.png").width(), 2);
}

TEST_F(FiguresTest, GridLinesStandAtTheirCoordinates) {
  write_area("a.xyz");
  const std::vector<std::string> words = {"a.xyz", "-t",      "points",  "--up",         "+Z", "--view",
                                          "top",   "--color", "#ffcc66", "--pixel-size", "0.1"};
  auto with = [&](const char* name, bool grid) {
    std::vector<std::string> all = words;
    if (grid) all.push_back("--grid");
    all.insert(all.end(), {"-o", name});
    expect_ok(all);
    return read_png(name);
  };
  const Image<Rgba8> plain = with("a.png", false), grid = with("b.png", true);
  ASSERT_EQ(plain.width(), 1000);
  ASSERT_EQ(plain.height(), 600);
  // The lowest row has no labels: lines of x = 1000 + 20 n, 200 px apart.
  const auto darkened = [&](int x, int y) { return int(plain.at(x, y).r) - int(grid.at(x, y).r); };
  for (int n = 1; n < 5; ++n) {
    double weight = 0, sum = 0;
    for (int x = 200 * n - 8; x < 200 * n + 8; ++x)
      weight += darkened(x, 597), sum += darkened(x, 597) * (x + 0.5);
    ASSERT_GT(weight, 0) << n;
    EXPECT_NEAR(sum / weight, 200 * n, 0.1);
  }
  // And the last column: lines of y = 2000 + 20 n, counted from below.
  for (int n = 1; n < 3; ++n) {
    double weight = 0, sum = 0;
    for (int y = 600 - 200 * n - 8; y < 600 - 200 * n + 8; ++y)
      weight += darkened(997, y), sum += darkened(997, y) * (y + 0.5);
    ASSERT_GT(weight, 0) << n;
    EXPECT_NEAR(sum / weight, 600 - 200 * n, 0.1);
  }
}

TEST_F(FiguresTest, ExaggeratedHeightsKeepTheirTrueValues) {
  write_area("a.xyz");
  const std::vector<std::string> side = {"a.xyz",  "-t",    "points",       "--up", "+Z",
                                         "--view", "front", "--pixel-size", "0.05", "-o"};
  auto with = [&](std::vector<std::string> words, const char* name, const char* factor) {
    words.insert(words.end(), {name, "--vertical-exaggeration", factor});
    expect_ok(words);
    return read_png(name);
  };
  EXPECT_NEAR(with(side, "b.png", "3").height(), 3 * with(side, "a.png", "1").height(), 3);
  // From above nothing changes but relief, the legend of true heights included.
  std::vector<std::string> top = {
      "a.xyz",      "-t",        "points",       "--up",  "+Z",          "--view", "top",
      "--color-by", "elevation", "--pixel-size", "0.25",  "--size-mode", "pixels", "--point-size",
      "2",          "--legend",  "--edl",        "false", "-o"};
  top.insert(top.begin() + 1, {"--ambient-occlusion", "0"});
  const Image<Rgba8> plain = with(top, "c.png", "1"), high = with(top, "d.png", "3");
  ASSERT_EQ(plain.size(), high.size());
  std::size_t differ = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) differ += !(plain.data()[i] == high.data()[i]);
  EXPECT_LT(differ, plain.size() / 1000);
}

TEST_F(FiguresTest, EverythingIsDrawnAndRefusedWhereItMeansNothing) {
  write_area("a.xyz");
  const std::vector<std::string> view = {"a.xyz",        "-t",     "points", "--up",
                                         "+Z",           "--view", "top",    "--camera-orthographic",
                                         "--resolution", "640x360"};
  auto with = [&](std::vector<std::string> more, const char* name) {
    std::vector<std::string> words = view;
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", name});
    expect_ok(words);
    return read_png(name);
  };
  const Image<Rgba8> plain = with({}, "plain.png");
  for (const std::vector<std::string>& one :
       std::vector<std::vector<std::string>>{{"--title", "A title"},
                                             {"--caption", "Words below"},
                                             {"--north-arrow"},
                                             {"--scale-bar"},
                                             {"--grid"}}) {
    const Image<Rgba8> drawn = with(one, "one.png");
    std::size_t ink = 0;
    for (std::size_t i = 0; i < plain.size(); ++i)
      ink += int(plain.data()[i].g) - int(drawn.data()[i].g) > 60;
    EXPECT_GT(ink, one[0] == "--grid" ? 20u : 40u) << one[0];
  }
  // A legend goes where it is told, and its size with it.
  const auto box_of = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--color-by", "elevation"});
    const Image<Rgba8> bare = with({"--color-by", "elevation"}, "bare.png"),
                       legend = with(more, "legend.png");
    std::array<int, 4> box = {9999, 9999, 0, 0};
    for (int y = 0; y < bare.height(); ++y)
      for (int x = 0; x < bare.width(); ++x)
        if (!(bare.at(x, y) == legend.at(x, y)))
          box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
    return box;
  };
  const auto usual = box_of({"--legend"}), moved = box_of({"--legend", "--legend-place", "top-left"}),
             large = box_of({"--legend", "--legend-size", "2"});
  EXPECT_GT(usual[0], 320);
  EXPECT_GT(usual[1], 150);
  EXPECT_LT(moved[2], 320);
  EXPECT_LT(moved[3], 210);
  EXPECT_GT(large[3] - large[1], 1.5 * (usual[3] - usual[1]));
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  for (const Case& c : std::vector<Case>{
           {{"a.xyz", "-t", "points", "--up", "+Z", "-o", "x.png", "--scale-bar"},
            "--scale-bar: in perspective"},
           {{"a.xyz", "-t", "points", "--up", "+Z", "-o", "x.png", "--grid"},
            "--grid: coordinates are those of a plan"},
           {{"a.xyz", "-t", "points", "--up", "+Z", "-o", "x.png", "--view", "back",
             "--camera-elevation-angle", "0"},
            "contradict"},
           {{"a.xyz", "-t", "points", "--up", "+Z", "-o", "x.png", "--camera-azimuth-angle", "0",
             "--camera-elevation-angle", "0", "--north-arrow"},
            "--north-arrow: north is straight ahead"},
           {{"a.xyz", "-o", "x.png", "--scale", "200"}, "is no scale; write 1:200"},
           {{"a.xyz", "-o", "x.png", "--scale", "1:200", "--pixel-size", "1"}, "contradict"},
           {{"a.xyz", "-o", "x.png", "--legend-place", "middle"}, "--legend-place: 'middle' is no corner"},
           {{"a.xyz", "-o", "x.png", "--legend-size", "9"}, "--legend-size: '9' is not in 0.3..4"},
           {{"a.xyz", "-o", "x.png", "--vertical-exaggeration", "0"}, "is not in 0.001..1000"},
           {{"a.xyz", "-t", "points", "--up", "+Z", "-o", "x.png", "--world-file"},
            "--world-file: only a plan"},
           {{"a.xyz", "-o", "x.npy", "--title", "x"}, "--title goes with .png"}}) {
    const Outcome outcome = run(c.words);
    EXPECT_EQ(outcome.code, 1) << c.says;
    EXPECT_THAT(outcome.err, HasSubstr(c.says));
    EXPECT_FALSE(exists("x.png"));
  }
}

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (!pipe) return text;
  char block[4096];
  while (const std::size_t n = std::fread(block, 1, sizeof block, pipe)) text.append(block, n);
  pclose(pipe);
  return text;
}

constexpr std::array<std::array<double, 2>, 4> dots{
    {{1010.3, 2005.7}, {1093.1, 2004.2}, {1051.55, 2033.95}, {1002.2, 2058.4}}};

/// Coordinates of the middle of a disc, by the six numbers of a world file.
std::array<double, 2> place_of(const Image<Rgba8>& image, const std::array<double, 6>& g, double px,
                               double py) {
  double n = 0, sx = 0, sy = 0;
  for (int y = std::max(0, int(py) - 12); y < std::min(image.height(), int(py) + 12); ++y)
    for (int x = std::max(0, int(px) - 12); x < std::min(image.width(), int(px) + 12); ++x) {
      const double weight = image.at(x, y).a;
      n += weight, sx += weight * x, sy += weight * y;
    }
  const double x = sx / n, y = sy / n;
  return {g[0] * x + g[2] * y + g[4], g[1] * x + g[3] * y + g[5]};
}

TEST_F(FiguresTest, PlansLieAtTheirPlaceToATenthOfAPixel) {
  std::string rows;
  for (const auto& [x, y] : dots) rows += std::to_string(x) + " " + std::to_string(y) + " 0\n";
  write("dots.xyz", "1000 2000 0\n1100 2060 0\n" + rows);
  for (const std::vector<std::string>& turn : {std::vector<std::string>{}, {"--roll", "30"}}) {
    std::vector<std::string> words = {
        "dots.xyz",        "-t",           "points",       "--up",    "+Z",          "--whole",
        "--view",          "top",          "--color",      "red",     "--size-mode", "pixels",
        "--point-size",    "15",           "--pixel-size", "0.1",     "--samples",   "16",
        "--no-background", "--world-file", "-o",           "plan.png"};
    words.insert(words.end(), turn.begin(), turn.end());
    expect_ok(words);
    const Image<Rgba8> image = read_png("plan.png");
    std::array<double, 6> g{};
    std::istringstream lines(text("plan.pgw"));
    for (double& number : g) lines >> number;
    const double det = g[0] * g[3] - g[1] * g[2];
    for (const auto& [x, y] : dots) {
      const double dx = x - g[4], dy = y - g[5];
      const auto found = place_of(image, g, (g[3] * dx - g[2] * dy) / det, (-g[1] * dx + g[0] * dy) / det);
      EXPECT_NEAR(found[0], x, 0.1 * 0.1);  // a tenth of a pixel
      EXPECT_NEAR(found[1], y, 0.1 * 0.1);
    }
  }
}

TEST_F(FiguresTest, GdalReadsPlansAtTheirPlace) {
  if (output_of("gdalinfo --version").find("GDAL") == std::string::npos)
    GTEST_SKIP() << "gdalinfo is not installed (scripts/install-deps --all)";
  std::string rows;
  for (const auto& [x, y] : dots) rows += std::to_string(x) + " " + std::to_string(y) + " 0\n";
  write("dots.xyz", "1000 2000 0\n1100 2060 0\n" + rows);
  for (const std::vector<std::string>& turn : {std::vector<std::string>{}, {"--roll", "30"}}) {
    std::vector<std::string> words = {"dots.xyz",    "-t",     "points",       "--up",    "+Z",
                                      "--whole",     "--view", "top",          "--color", "red",
                                      "--size-mode", "pixels", "--point-size", "3",       "--pixel-size",
                                      "0.1",         "-o",     "plan.tif"};
    words.insert(words.end(), turn.begin(), turn.end());
    expect_ok(words);
    const std::string tif = path("plan.tif");
    const nlohmann::json info = nlohmann::json::parse(output_of("gdalinfo -json " + tif));
    if (turn.empty()) {
      // 1000..1100 by 2000..2060, its borders on multiples of a pixel.
      EXPECT_NEAR(info["geoTransform"][0].get<double>(), 1000, 0.01);
      EXPECT_NEAR(info["geoTransform"][3].get<double>(), 2060, 0.01);
      EXPECT_EQ(info["size"], (nlohmann::json{1000, 600}));
    }
    EXPECT_NEAR(std::hypot(info["geoTransform"][1].get<double>(), info["geoTransform"][4].get<double>()), 0.1,
                1e-9);
    EXPECT_EQ(info["bands"].size(), 4u);
    EXPECT_EQ(info["bands"][3]["colorInterpretation"], "Alpha");
    for (const auto& [x, y] : dots) {
      const auto at = [&](double px, double py) {
        return output_of("gdallocationinfo -geoloc -valonly " + tif + " " + std::to_string(px) + " " +
                         std::to_string(py));
      };
      EXPECT_THAT(at(x, y), HasSubstr("255\n")) << x << " " << y;
      EXPECT_EQ(at(x + 0.5, y + 0.5), "0\n0\n0\n0\n");  // five pixels beside it there is nothing
    }
  }
}

TEST_F(FiguresTest, GdalKnowsTheReferenceSystemOfPlans) {
  if (output_of("gdalinfo --version").find("GDAL") == std::string::npos)
    GTEST_SKIP() << "gdalinfo is not installed (scripts/install-deps --all)";
  const std::string scan = SFUMATO_SOURCE_DIR "/../shared/data/autzen_trim.las";
  if (!std::filesystem::exists(scan)) GTEST_SKIP() << scan << " is not there";
  expect_ok({scan, "-t", "points", "--up", "+Z", "--view", "top", "--pixel-size", "2", "-o", "plan.tif"});
  const nlohmann::json info = nlohmann::json::parse(output_of("gdalinfo -json " + path("plan.tif").string()));
  const std::string wkt = info["coordinateSystem"]["wkt"];
  EXPECT_THAT(wkt, HasSubstr("Lambert"));
  EXPECT_THAT(wkt, HasSubstr("0.3048"));
  // Its bounds are 636001.76..637179.22 by 848935.2..849497.9: what encloses them in steps of two feet.
  EXPECT_NEAR(info["geoTransform"][0].get<double>(), 636000, 0.2);
  EXPECT_NEAR(info["geoTransform"][3].get<double>(), 849498, 0.2);
}

}  // namespace
