// Files as people send them, through the whole command: what was reported wrong once, right.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <glm/glm.hpp>

#include "cli/command.h"

namespace sfumato::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class StrangersCommand : public CommandTest {
 protected:
  /// A hill of points: x and y from `low` on, `size` wide, `height` high; a colour a stripe.
  std::string write_hill(const std::string& name, double x, double y, double size, double height,
                         double base = 0) {
    std::string text = "x y z r g b\n";
    char line[160];
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 60; ++j) {
        const double u = i / 59.0, v = j / 59.0, z = base + height * std::sin(3 * u) * std::sin(3 * v);
        std::snprintf(line, sizeof line, "%.10f %.10f %.4f %d %d %d\n", x + size * u, y + size * v, z, 200,
                      40 + 3 * i, 40);
        text += line;
      }
    return write(name, text);
  }
  static double wide(const Image<Rgba8>& image) {
    int low = image.width(), high = -1;
    const Rgba8 background = image.at(0, 0);
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        if (image.at(x, y) != background) low = std::min(low, x), high = std::max(high, x);
    return high - low + 1;
  }
  /// The file of that name in ../shared/data/strangers, or nothing.
  static std::optional<std::string> stranger(const std::string& name) {
    std::filesystem::path folder;
    if (const char* given = std::getenv("SFUMATO_TEST_DATA")) folder = given;
    for (std::filesystem::path at = SFUMATO_SOURCE_DIR; folder.empty() && at.has_relative_path();
         at = at.parent_path())
      if (std::filesystem::exists(at.parent_path() / "shared/data"))
        folder = at.parent_path() / "shared/data";
    const std::filesystem::path file = folder / "strangers" / name;
    return std::filesystem::exists(file) ? std::optional(file.string()) : std::nullopt;
  }
};

/// Around the station WTZR (EPN): X, Y, Z of its log file and the directions there, by finite differences of
/// nothing but the sphere's: up is off by 0.2 degrees at most (the ellipsoid's normal).
TEST_F(StrangersCommand, PlacesFromTheCentreOfTheEarthStandUpright) {
  const glm::dvec3 station(4075580.3, 931853.9, 4801568.2), up = glm::normalize(station),
                                                            east = glm::normalize(glm::dvec3(-up.y, up.x, 0)),
                                                            north = glm::cross(up, east);
  std::string rows, map;
  char line[80];
  for (int x = -40; x <= 40; ++x)
    for (int y = -30; y <= 30; ++y) {
      const bool is_mast = std::abs(x) < 2 && std::abs(y) < 2;
      for (int z = 0; z <= (is_mast ? 20 : 0); ++z) {
        const glm::dvec3 p = station + double(x) * east + double(y) * north + double(z) * up;
        std::snprintf(line, sizeof line, "v %.3f %.3f %.3f\n", p.x, p.y, p.z);
        rows += line;
        // The northings of a map are as far from 0.
        std::snprintf(line, sizeof line, "%d %d %d\n", 500'000 + x, 6'372'000 + y, z);
        map += line;
      }
    }
  write("earth.obj", rows);
  const nlohmann::json drawn =
      run_json({"earth.obj", "-o", "a.png", "-t", "points", "--resolution", "64x64", "--json"});
  EXPECT_EQ(drawn["up"], "+Z");
  const Outcome said = run({"earth.obj", "-o", "a.png", "-t", "points", "--resolution", "64x64"});
  EXPECT_THAT(said.err, HasSubstr("centre of the Earth"));
  EXPECT_THAT(said.err, HasSubstr("49.144"));
  EXPECT_THAT(said.err, HasSubstr("12.878"));
  // The station is 666 m above the ellipsoid: half of the mast is above 675.5 m.
  const nlohmann::json top = run_json({"earth.obj", "-o", "b.png", "-t", "points", "--resolution", "64x64",
                                       "--filter", "z 675.5..", "--json"});
  EXPECT_EQ(top["points_rendered"], 9 * 11);
  write("map.xyz", map);
  EXPECT_THAT(run({"map.xyz", "-o", "c.png", "-t", "points", "--resolution", "64x64"}).err,
              Not(HasSubstr("centre of the Earth")));
}

TEST_F(StrangersCommand, DegreesAreDrawnInMetresAndSaid) {
  write_hill("degrees.txt", 13.38, 52.51, 0.0003, 6, 34);
  const Outcome made = run({"degrees.txt", "--view", "top", "--camera-orthographic", "-o", "a.png",
                            "--resolution", "200x200", "-t", "points"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("degrees"));
  EXPECT_THAT(made.err, HasSubstr("67.9 km"));
  EXPECT_GT(wide(read_png("a.png")), 80);
  const Outcome info = run({"info", "degrees.txt"});
  EXPECT_THAT(info.out, HasSubstr("13.38"));
  EXPECT_EQ(run({"convert", "degrees.txt", "-o", "copy.ply"}).code, 0);
  EXPECT_THAT(run({"info", "copy.ply"}).out, HasSubstr("13.38"));
  // The third is a height, also of a slope that lies before the middle of the sea level below it.
  std::string slope;
  char row[80];
  for (int x = -60; x <= 60; ++x)
    for (int y = -60; y <= 60; ++y) {
      std::snprintf(row, sizeof row, "%.8f %.8f %d\n", -49.5 + 5e-5 * x, 69 + 2e-5 * y, 600 + 4 * y);
      slope += row;
    }
  write("slope.txt", slope);
  const std::vector<std::string> words{"slope.txt", "-o", "c.png", "--resolution", "64x64", "--json"};
  EXPECT_EQ(run_json(words)["up"], "+Z");
  // Metres are none, however small the numbers.
  write_hill("metres.txt", 13.38, 52.51, 8, 6, 34);
  EXPECT_THAT(run({"metres.txt", "-o", "b.png", "--resolution", "64x64"}).err, Not(HasSubstr("degrees")));
}

TEST_F(StrangersCommand, ASequenceHasOneRange) {
  write_hill("low.txt", 0, 0, 20, 6, 34);
  write_hill("high.txt", 0, 0, 20, 24, 34);
  const auto mean_green = [&](const std::string& other) {
    EXPECT_EQ(run({"low.txt", other, "--sequence", "--up", "+Z", "--color-by", "elevation", "-o",
                   "frame_{n}.png", "-t", "points", "--resolution", "120x90"})
                  .code,
              0);
    const Image<Rgba8> image = read_png("frame_0.png");
    double sum = 0;
    int count = 0;
    for (const Rgba8& c : image)
      if (!(c == image.at(0, 0))) sum += c.g, ++count;
    return sum / count;
  };
  // The same file is darker where another one of the sequence is higher.
  EXPECT_GT(mean_green("low.txt"), mean_green("high.txt") + 20);
}

TEST_F(StrangersCommand, ChangeBetweenSurveysIsAScalar) {
  write_hill("before.txt", 389120, 5819300, 20, 3, 34);
  write_hill("after.txt", 389120, 5819300, 20, 3, 34.5);
  const auto distances = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"convert", "after.txt", "--distance-to", "before.txt", "-o", "change.laz"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(distances({}), HasSubstr("to the nearest of before.txt"));
  const auto mean = [&] {
    return run_json({"info", "--stats", "--json", "change.laz"})["attributes"]["distance"]["mean"]
        .get<double>();
  };
  EXPECT_GT(mean(), 0.2);
  EXPECT_LT(mean(), 0.5);
  distances({"--distance-scale", "2"});
  const double up = mean();
  EXPECT_NEAR(up, 0.47, 0.03) << "half a unit times the cosine of the slope";
  ASSERT_EQ(run({"convert", "before.txt", "--distance-to", "after.txt", "--distance-scale", "2", "-o",
                 "change.laz"})
                .code,
            0);
  EXPECT_NEAR(mean(), -up, 0.01);
  ASSERT_EQ(
      run({"change.laz", "--color-by", "distance", "--legend", "-o", "a.png", "--resolution", "160x120"})
          .code,
      0);
  EXPECT_THAT(run({"convert", "after.txt", "--distance-scale", "2", "-o", "c.ply"}).err,
              HasSubstr("--distance-to"));
  EXPECT_EQ(run({"convert", "after.txt", "--distance-to", "no.las", "-o", "c.ply"}).code, 6);
  EXPECT_FALSE(exists("c.ply"));
}

TEST_F(StrangersCommand, PlansHaveNoHighlight) {
  std::string text = "x y z r g b\n";
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      text += std::to_string(i) + " " + std::to_string(j) + " 0 " + (i < 50 ? "20 20 20\n" : "150 120 80\n");
  write("plan.txt", text);
  const auto picture = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"plan.txt", "--view", "top", "--up",         "+Z",     "-t",
                                   "splats",   "-o",     name,  "--resolution", "100x100"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run(words).code, 0);
    return read_png(name);
  };
  const Image<Rgba8> plan = picture("a.png", {"--camera-orthographic"}),
                     matt = picture("b.png", {"--camera-orthographic", "--specular", "0"}),
                     seen = picture("c.png", {}), seen_matt = picture("d.png", {"--specular", "0"});
  EXPECT_TRUE(std::equal(plan.begin(), plan.end(), matt.begin()));
  EXPECT_FALSE(std::equal(seen.begin(), seen.end(), seen_matt.begin()));
}

TEST_F(StrangersCommand, TheRealOnes) {
  const auto chart = stranger("12_chart.ply"), land = stranger("16_land_z_up.ply"),
             west = stranger("14_west_zero_rgb.las"), east = stranger("14_east_rgb.las"),
             west8 = stranger("11_west_8bit.las"), east16 = stranger("11_east_16bit.las"),
             degrees = stranger("05_degrees_no_crs.las");
  if (!chart || !land || !west || !east || !west8 || !east16 || !degrees)
    GTEST_SKIP() << "no strangers' files";
  EXPECT_THAT(run({"convert", *land, "-o", "x.las"}).err, Not(HasSubstr("--up +Y")));
  EXPECT_THAT(run({*degrees, "-o", "d.png", "--resolution", "64x48"}).err, HasSubstr("degrees"));
  const Outcome joined = run({*west, *east, "-o", "w.png", "--resolution", "64x48"});
  EXPECT_THAT(joined.err, HasSubstr("has no colours"));
  ASSERT_EQ(run({"build", *west8, *east16, "-o", "o.copc.laz"}).code, 0);
  const std::string info = run({"info", "--stats", "o.copc.laz"}).out;
  EXPECT_THAT(info, ::testing::ContainsRegex("red +10280 +53970"));
  ASSERT_EQ(run({*chart, "--view", "top", "--camera-orthographic", "--up", "+Z", "-o", "c.png",
                 "--resolution", "300x200"})
                .code,
            0);
  int black = 0;
  for (const Rgba8& c : read_png("c.png")) black += std::abs(c.r - 20) < 4 && std::abs(c.g - 20) < 4;
  EXPECT_GT(black, 1000);
}

TEST_F(StrangersCommand, OfEachTwoLinesAreSaid) {
  const auto any = stranger("12_chart.ply");
  if (!any) GTEST_SKIP() << "no strangers' files";
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(*any).parent_path())) {
    if (entry.path().extension() == ".md") continue;
    const Outcome outcome = run({entry.path().string(), "-o", "a.png", "--resolution", "32x24"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_LE(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 2) << outcome.err;
  }
}

}  // namespace
}  // namespace sfumato::testing
