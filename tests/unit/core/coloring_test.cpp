// Colour maps and the colour of points.
#include "core/coloring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/color.h"
#include "core/colormap.h"
#include "core/error.h"

using namespace sfumato;

namespace {

PointCloud ramp(int n) {
  PointCloud cloud;
  for (int i = 0; i < n; ++i) cloud.positions.push_back({0, float(i), 2 * float(i)});
  return cloud;
}

ScalarField field(const char* name, std::vector<float> values) { return {name, 0, std::move(values)}; }

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "no error";
}

TEST(Colormap, EndsAndMiddleAreTheKnownColours) {
  EXPECT_EQ(Colormap::named("viridis").at(0), (Rgba8{0x44, 0x01, 0x54, 255}));
  EXPECT_EQ(Colormap::named("viridis").at(1), (Rgba8{0xfd, 0xe7, 0x25, 255}));
  EXPECT_EQ(Colormap::named("gray").at(0.5), (Rgba8{160, 160, 160, 255}));
  EXPECT_EQ(Colormap::named("jet").at(0.5), (Rgba8{128, 255, 128, 255}));
  EXPECT_EQ(Colormap::named("coolwarm").at(0), (Rgba8{59, 76, 192, 255}));  // Moreland 2009, table
  EXPECT_EQ(Colormap::named("coolwarm").at(1), (Rgba8{180, 4, 38, 255}));
  EXPECT_EQ(Colormap::named("spectral").at(0.5), (Rgba8{255, 255, 191, 255}));
}

TEST(Colormap, RunsThroughColoursThatAreGiven) {
  const Colormap own = Colormap::named("white,#ff8800,black");
  EXPECT_EQ(own.at(0), (Rgba8{255, 255, 255, 255}));
  EXPECT_EQ(own.at(0.5), (Rgba8{255, 136, 0, 255}));
  EXPECT_EQ(own.at(1), (Rgba8{0, 0, 0, 255}));
  EXPECT_NE(refusal([] { Colormap::named("white,nocolour"); }).find("'nocolour'"), std::string::npos);
  EXPECT_NE(refusal([] { Colormap::named("white,"); }).find("no colour"), std::string::npos);
  EXPECT_NE(refusal([] { Colormap::named("virids_r"); }).find("did you mean 'viridis'"), std::string::npos);
}

TEST(Coloring, ClassesHaveTheColoursThatAreGiven) {
  PointCloud cloud = ramp(4);
  cloud.set_scalar(field("classification", {2, 6, 2, 5}));
  ColorSettings settings;
  settings.color_by = "classification";
  settings.class_colors = parse_class_colors("2=#aa7744, building=orange");
  const Coloring out = color_points(cloud, settings);
  EXPECT_EQ(out.colors[0], (Rgba8{0xaa, 0x77, 0x44, 255}));
  EXPECT_EQ(out.colors[1], (Rgba8{255, 165, 0, 255}));
  EXPECT_EQ(out.colors[3], class_color(5)) << "others keep theirs";
  EXPECT_EQ(out.swatches[0].color, out.colors[0]) << "the legend shows the same";
  EXPECT_EQ(out.color_of_class(6), out.colors[1]) << "and so do lists of classes";
  EXPECT_EQ(out.color_of_class(9), class_color(9)) << "of what is not there";
  EXPECT_EQ(parse_class_colors("2=tan\n6=orange\n").size(), 2u) << "a file: a line each";
  EXPECT_NE(refusal([] { parse_class_colors("2=tan,lawn=green"); }).find("'lawn=green'"), std::string::npos);
  EXPECT_NE(refusal([] { parse_class_colors("2"); }).find("CLASS=COLOUR"), std::string::npos);
  EXPECT_NE(refusal([] { parse_class_colors(""); }).find("no class"), std::string::npos);
}

TEST(Coloring, AProductDarkensColoursByANumber) {
  PointCloud cloud = ramp(5);
  cloud.colors = {
      {200, 100, 50, 255}, {200, 100, 50, 255}, {200, 100, 50, 255}, {200, 100, 50, 255}, {10, 20, 250, 255}};
  cloud.set_scalar(field("intensity", {0, 50, 100, NAN, 400}));
  ColorSettings settings;
  settings.color_by = "rgb*intensity";
  settings.shade = {0, 100};
  settings.exposure = 1;
  const Coloring product = color_points(cloud, settings);
  EXPECT_EQ(product.source, "rgb*intensity");
  EXPECT_EQ(product.kind, ColorKind::rgb);
  EXPECT_EQ(
      product.colors,
      (std::vector<Rgba8>{
          {0, 0, 0, 255}, {100, 50, 25, 255}, {200, 100, 50, 255}, {200, 100, 50, 255}, {10, 20, 250, 255}}));
  settings.color_by = "rgb*intensities";
  EXPECT_THAT(refusal([&] { color_points(cloud, settings); }),
              testing::HasSubstr("did you mean 'intensity'"));
  settings.color_by = "rgb*normal";
  EXPECT_THAT(refusal([&] { color_points(cloud, settings); }), testing::HasSubstr("no number"));
  cloud.set_scalar(field("a*b", {0, 1, 2, 3, 4}));  // a name of its own
  settings.color_by = "a*b";
  EXPECT_EQ(color_points(cloud, settings).kind, ColorKind::scalar);
}

TEST(Colormap, ViridisBetweenTheStopsIsNearTheFullMap) {
  // Entries 40, 100 and 200 of the 256; seventeen stops stay within 6/255 of them.
  const Colormap map = Colormap::named("viridis");
  for (auto [index, rgb] : {std::pair{40, 0x453781}, {100, 0x2a768e}, {200, 0x70cf57}}) {
    const Rgba8 c = map.at(index / 255.0);
    EXPECT_NEAR(c.r, rgb >> 16, 6) << index;
    EXPECT_NEAR(c.g, rgb >> 8 & 255, 6) << index;
    EXPECT_NEAR(c.b, rgb & 255, 6) << index;
  }
}

TEST(Colormap, EveryNameWorksAndClampsOutside) {
  EXPECT_EQ(Colormap::names().size(), 12u);
  for (const std::string& name : Colormap::names()) {
    const Colormap map = Colormap::named(name);
    EXPECT_EQ(map.at(-3), map.at(0)) << name;
    EXPECT_EQ(map.at(7), map.at(1)) << name;
    EXPECT_FALSE(map.at(0) == map.at(1)) << name;
  }
}

TEST(Colormap, ListsEachBothWays) {
  const std::vector<std::string> all = Colormap::choices();
  EXPECT_EQ(all.size(), 2 * Colormap::names().size());
  EXPECT_EQ(all.front(), Colormap::names().front());
  EXPECT_EQ(all.back(), Colormap::names().back() + "_r");
}

TEST(Colormap, RunsBackwardsWithAnR) {
  for (const std::string& name : Colormap::names()) {
    const Colormap map = Colormap::named(name), back = Colormap::named(name + "_r");
    for (const double t : {0.0, 0.25, 0.5, 1.0}) EXPECT_EQ(back.at(t), map.at(1 - t)) << name << " " << t;
  }
  EXPECT_THAT(refusal([] { Colormap::named("virids_r"); }), ::testing::HasSubstr("viridis"));
}

TEST(Colormap, CividisIsThatOfItsAuthors) {
  // The ends and the grey in the middle of the published table.
  const Colormap map = Colormap::named("cividis");
  EXPECT_EQ(map.at(0), (Rgba8{0, 34, 78, 255}));
  EXPECT_EQ(map.at(1), (Rgba8{254, 232, 56, 255}));
  const Rgba8 middle = map.at(0.5);
  EXPECT_NEAR(middle.r, middle.g, 4);
  EXPECT_NEAR(middle.b, 118, 4);
}

TEST(Colormap, WrongNameNamesTheNearest) {
  EXPECT_THAT(refusal([] { Colormap::named("virids"); }), ::testing::HasSubstr("did you mean 'viridis'"));
}

TEST(Coloring, LabelsTellThingsApart) {
  PointCloud cloud = ramp(4);
  cloud.set_scalar(field("scalar_Label", {0, 0, 0, 0}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay") << "one thing";
  cloud.set_scalar(field("scalar_Label", {0, 1, 1, 0}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "scalar_Label");
  const Coloring coloring = color_points(cloud, {});
  EXPECT_EQ(coloring.kind, ColorKind::files);
  EXPECT_EQ(coloring.swatches.size(), 2u);
}

TEST(Coloring, AutoFallsFromColourToIntensityToClay) {
  PointCloud cloud = ramp(4);
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay");
  cloud.set_scalar(field("classification", {1, 0, 1}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay") << "neither is a class";
  cloud.set_scalar(field("classification", {1, 6, 1}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "classification");
  cloud.set_scalar(field("classification", {6, 6, 6}));
  cloud.set_scalar(field("intensity", {5, 5, 5, 5}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay") << "a constant shows nothing";
  cloud.set_scalar(field("intensity", {5, 5, 6, 5}));
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "intensity");
  cloud.colors.assign(4, {0, 0, 0, 255});
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "intensity") << "all zero means no colour";
  EXPECT_THROW(resolve_color_by(cloud, "rgb"), Error) << "asked for by name, it is not drawn black either";
  cloud.colors[1].g = cloud.colors[2].g = 100;
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "intensity") << "half of it has none";
  cloud.colors[3].g = 100;
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "rgb");
}

// Light shows more on clay.
TEST(Coloring, OneColourForAllIsNotDrawn) {
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i)
    cloud.positions.push_back({float(i % 10), float(i / 10 % 10), float(i / 100)});
  for (const Rgba8 nothing : {Rgba8{255, 255, 255, 255}, Rgba8{3, 3, 3, 255}}) {
    cloud.colors.assign(1000, nothing);
    EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay");
    for (std::size_t i = 0; i < 5; ++i) cloud.colors[i] = {200, 10, 10, 255};
    EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay") << "five dots";
    EXPECT_EQ(resolve_color_by(cloud, "rgb"), "rgb") << "asked for by name";
  }
  cloud.colors.assign(1000, {180, 40, 40, 255});
  EXPECT_EQ(resolve_color_by(cloud, "auto"), "clay") << "one red for all shows less";
}

// Intensities that change from point to point by as much as over the whole cloud are noise.
TEST(Coloring, SpeckleIsNotDrawn) {
  PointCloud cloud;
  ScalarField intensity = field("intensity", {});
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0, 1);
  const auto fill = [&](float along, float speckle) {
    cloud.positions.clear(), intensity.values.clear();
    for (int i = 0; i < 8000; ++i) {
      const vec3 p(float(i % 20), float(i / 20 % 20), float(i / 400));
      cloud.positions.push_back(p);
      intensity.values.push_back(along * p.z + speckle * noise(random));
    }
    cloud.set_scalar(intensity);
    return resolve_color_by(cloud, "auto");
  };
  EXPECT_EQ(fill(1, 0), "intensity");
  EXPECT_EQ(fill(1, 3), "intensity") << "a variance of 33 between places, of 9 between neighbours";
  EXPECT_EQ(fill(1, 12), "clay");
  EXPECT_EQ(fill(0, 1), "clay");
}

// Returns of one crown that are called vegetation and unknown by turns.
TEST(Coloring, ClassesThatMottleAreNotDrawn) {
  std::mt19937 random(6);
  PointCloud cloud;
  ScalarField classes = field("classification", {});
  const auto source_of = [&](float speckle) {
    cloud.positions.clear(), classes.values.clear();
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 4000; ++i) {
      cloud.positions.push_back({float(i % 20), float(i / 20 % 10), float(i / 200)});
      classes.values.push_back((unit(random) < speckle ? unit(random) < 0.5f : i < 2000) ? 5 : 2);
    }
    cloud.set_scalar(classes);
    return resolve_color_by(cloud, "auto");
  };
  EXPECT_EQ(source_of(0.2f), "classification");
  EXPECT_EQ(source_of(1), "clay");
}

TEST(Coloring, GreyThatIsSpeckleIsNoPhotograph) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto source_of = [&](float along, float speckle, int tint) {
    PointCloud cloud;
    for (int i = 0; i < 4000; ++i) {
      // Along a curve that neighbours share, as prepared clouds are.
      const float t = float(i) / 4000;
      cloud.positions.push_back({std::cos(40 * t), std::sin(40 * t), 4 * t});
      const auto grey =
          std::uint8_t(128 + 100 * along * std::sin(12 * t) + 100 * speckle * (unit(random) - 0.5f));
      cloud.colors.push_back({grey, grey, std::uint8_t(grey + tint), 255});
    }
    return resolve_color_by(cloud, "auto");
  };
  EXPECT_EQ(source_of(1, 0, 0), "rgb") << "a grey photograph";
  EXPECT_EQ(source_of(0, 1, 0), "clay") << "the echoes of a scanner";
  EXPECT_EQ(source_of(0, 1, 5), "rgb") << "speckle in colour is a photograph of leaves or gravel";
}

TEST(Coloring, TheRampOfHeightsShowsShadesAndContrastsWithThePage) {
  const Colormap land = Colormap::named("land");
  for (int i = 0; i <= 100; ++i) {
    const Rgba8 c = land.at(i / 100.0);
    const double luminance = 0.2126 * double(linear_from_srgb(c.r)) + 0.7152 * double(linear_from_srgb(c.g)) +
                             0.0722 * double(linear_from_srgb(c.b));
    // Ambient light of 0.3 and 0.7 from 32 degrees leave the middle of lightness.
    EXPECT_GT(luminance * (0.3 + 0.7 * std::sin(glm::radians(32.0))), 0.184) << i;  // viridis: 0.009 at 0
    EXPECT_GT(1.05 / (luminance + 0.05), 1.5) << i;  // with white (WCAG 2.2); viridis: 1.27 at 1
  }
}

TEST(Coloring, LandWithoutColourShowsItsHeight) {
  PointCloud land;
  for (int i = 0; i < 400; ++i) land.positions.push_back({float(i % 20), float(i / 20), 0.3f * float(i % 7)});
  land.set_scalar(field("intensity", std::vector<float>(400, 1)));
  land.scalars[0].values[3] = 2;
  EXPECT_EQ(resolve_color_by(land, "auto"), "elevation");
  land.colors.assign(400, {10, 200, 30, 255});
  EXPECT_EQ(resolve_color_by(land, "auto"), "elevation") << "one green for all shows less";
  for (std::size_t i = 0; i < 200; ++i) land.colors[i].r = 150;
  EXPECT_EQ(resolve_color_by(land, "auto"), "rgb");
  land.colors.clear();
  for (vec3& p : land.positions) p.z *= 20;  // a thing
  EXPECT_EQ(resolve_color_by(land, "auto"), "intensity");
  land.crs = "EPSG:2056";  // towers along a street
  EXPECT_EQ(resolve_color_by(land, "auto"), "elevation");
  for (vec3& p : land.positions) p.z = 1;
  land.scalars.clear();
  EXPECT_EQ(resolve_color_by(land, "auto"), "clay") << "no height at all";
}

TEST(Coloring, ClayIsOneNeutralColour) {
  const Coloring clay = color_points(ramp(4), {});
  EXPECT_EQ(clay.kind, ColorKind::rgb);
  for (const Rgba8& c : clay.colors) EXPECT_EQ(c, clay.colors[0]);
  EXPECT_LT(clay.colors[0].r - clay.colors[0].b, 50) << "nearly gray";
}

TEST(Coloring, BackgroundContrastsWithOneColour) {
  EXPECT_LT(contrasting_background(std::vector<Rgba8>(9, {250, 250, 250, 255})).x, 0.2f);
  EXPECT_EQ(contrasting_background(std::vector<Rgba8>(9, {201, 186, 168, 255})), vec3(1));
  EXPECT_EQ(contrasting_background(std::vector<Rgba8>(9, {20, 20, 20, 255})), vec3(1));
  EXPECT_EQ(contrasting_background({}), vec3(1));
  std::vector<Rgba8> stray(99, {201, 186, 168, 255});
  stray[0] = {10, 200, 10, 255};
  EXPECT_EQ(contrasting_background(stray), vec3(1)) << "one point is not many colours";
}

TEST(Coloring, BackgroundOfManyColoursIsDarkButBehindDarkOnes) {
  std::vector<Rgba8> room(9, {150, 130, 120, 255});
  for (std::size_t i = 0; i < 4; ++i) room[i] = {225, 225, 220, 255};  // white walls around other things
  EXPECT_LT(contrasting_background(room).x, 0.2f);
  for (std::size_t i = 0; i < 5; ++i) room[i] = {30, 80, 20, 255};  // trees
  EXPECT_EQ(contrasting_background(room), vec3(1));
  room[0] = {225, 225, 220, 255};
  EXPECT_LT(contrasting_background(room).x, 0.2f) << "fewer than half are dark";
}

TEST(Coloring, ElevationIsTheWorldCoordinateAlongUp) {
  PointCloud cloud = ramp(101);
  cloud.origin = {1e6, 5e6, 300};
  Coloring along_z = color_points(cloud, {"elevation", "gray", std::nullopt});
  EXPECT_EQ(along_z.low, 300);  // of 101 heights 300, 302 ... 500, for 2 % at an end are crowns and roofs
  EXPECT_EQ(along_z.high, 500);
  EXPECT_NEAR(along_z.colors[50].r, 160, 1);
  PointCloud noisy = cloud;
  noisy.positions[100].z = 1e4f;  // a bird
  EXPECT_LT(color_points(noisy, {"elevation", "gray", std::nullopt}).high, 540);
  EXPECT_EQ(along_z.colors[0].r, 0x50);
  EXPECT_EQ(along_z.colors[100].r, 0xf0);
  cloud.up = UpAxis::neg_y;
  const Coloring down = color_points(cloud, {"elevation", "gray", std::array{-5e6 - 100.0, -5e6}});
  EXPECT_EQ(down.colors[0].r, 0xf0);
  EXPECT_EQ(down.colors[100].r, 0x50);
}

TEST(Coloring, IntensitiesThatAFewExceedByFarAreNotLeftInBlack) {
  PointCloud cloud;
  ScalarField lambertian{"intensity", 0, {}, StoredType::float32}, even = lambertian;
  for (int i = 0; i <= 1000; ++i) {
    cloud.positions.push_back({float(i), 0, 0});
    const float distance = 1 + 0.009f * float(i);  // 1 to 10 m from the scanner
    lambertian.values.push_back(10000 / (distance * distance));
    even.values.push_back(float(i));
  }
  cloud.scalars = {lambertian};
  const Coloring fallen = color_points(cloud, {"intensity"});
  EXPECT_NEAR(fallen.high, 10000 / (1.9 * 1.9), 10) << "the 90 % quantile: a tenth is white, no more";
  EXPECT_GT(fallen.colors[500].r, 45) << "the median";
  EXPECT_EQ(color_points(cloud, {"intensity", "", std::array<double, 2>{0, 9000}}).high, 9000);
  cloud.scalars = {even};
  EXPECT_NEAR(color_points(cloud, {"intensity"}).high, 980, 1) << "an even distribution keeps its range";
  cloud.scalars[0].name = "amplitude";
  cloud.scalars[0].values = lambertian.values;
  EXPECT_GT(color_points(cloud, {"amplitude"}).high, 6000) << "only intensities fall so";
}

TEST(Coloring, StretchIgnoresStrayValues) {
  PointCloud cloud = ramp(1000);
  std::vector<float> values(1000);
  for (int i = 0; i < 1000; ++i) values[std::size_t(i)] = float(i % 10);
  values[7] = 1e9f;
  values[8] = std::numeric_limits<float>::quiet_NaN();
  cloud.set_scalar(field("echo", values));
  const Coloring shown = color_points(cloud, {"echo", "gray", std::nullopt});
  EXPECT_EQ(shown.low, 0);
  EXPECT_EQ(shown.high, 9);
  EXPECT_EQ(shown.colors[7].r, 0xf0);
  EXPECT_EQ(shown.colors[8], (Rgba8{128, 128, 128, 255}));
}

TEST(Coloring, TheRampIsForTheHeightsThatAreShown) {
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  cloud.origin = {0, 0, 3000};
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back({float(i), 0, 0.01f * float(i)});
  for (int i = 0; i < 500; ++i) cloud.positions.push_back({float(i), 9e3f, -80});
  ColorSettings settings;
  settings.color_by = "elevation";
  EXPECT_LT(color_points(cloud, settings).low, 2930);
  std::vector<double> heights;
  for (int i = 0; i < 200; ++i) heights.push_back(3000 + 0.05 * i);
  const Coloring shown = color_points(cloud, settings, heights);
  EXPECT_NEAR(shown.low, 3000, 0.1);
  EXPECT_NEAR(shown.high, 3009.95, 0.1);
  EXPECT_NE(shown.colors.at(100), shown.colors.at(900));
  EXPECT_EQ(shown.colors.at(1000), shown.colors.at(0)) << "what lies lower has the lowest colour";
  settings.range = {2900, 3000};
  EXPECT_EQ(color_points(cloud, settings, heights).low, 2900) << "who names a range has it";
  settings.range.reset();
  cloud.set_scalar({"elevation", 0, std::vector<float>(cloud.size(), 7), StoredType::float32});
  EXPECT_EQ(color_points(cloud, settings, heights).low, 7) << "a number of the file's own";
}

TEST(Coloring, LargeOffsetsAndConstantsKeepTheirColour) {
  PointCloud cloud = ramp(3);
  cloud.set_scalar({"gps_time", 2e8, {0, 0.5f, 1}});
  const Coloring shown = color_points(cloud, {"gps_time", "gray", std::array{2e8, 2e8 + 1}});
  EXPECT_EQ(shown.colors[0].r, 0x50);
  EXPECT_NEAR(shown.colors[1].r, 160, 1);  // one step of the 1024 entries
  EXPECT_EQ(shown.colors[2].r, 0xf0);
  cloud.set_scalar(field("flat", {3, 3, 3}));
  EXPECT_NEAR(color_points(cloud, {"flat", "gray", std::nullopt}).colors[0].r, 160, 1);
}

TEST(Coloring, ReversedRangeReversesTheMap) {
  PointCloud cloud = ramp(2);
  cloud.set_scalar(field("v", {0, 1}));
  const Coloring shown = color_points(cloud, {"v", "gray", std::array{1.0, 0.0}});
  EXPECT_EQ(shown.colors[0].r, 0xf0);
  EXPECT_EQ(shown.colors[1].r, 0x50);
}

TEST(Coloring, ClassesHaveTheKnownColours) {
  PointCloud cloud = ramp(4);
  cloud.set_scalar(field("classification", {2, 6, 6, 70}));
  const Coloring shown = color_points(cloud, {"classification", "", std::nullopt});
  EXPECT_EQ(shown.kind, ColorKind::classes);
  ASSERT_EQ(shown.classes.size(), 3u);
  EXPECT_EQ(shown.classes[1].id, 6);
  EXPECT_EQ(shown.classes[1].points, 2u);
  EXPECT_EQ(shown.colors[1], (Rgba8{255, 168, 0, 255}));  // building, orange
  EXPECT_EQ(class_name(2), "ground");
  EXPECT_EQ(class_name(70), "class 70");
  EXPECT_FALSE(class_color(70) == class_color(71));
  // What no classifier writes has a colour as well, and is one class, not class 0.
  cloud.set_scalar(field("classification", {-3e9f, -2147483648.0f, 1e30f, 2147483648.0f}));
  const Coloring odd = color_points(cloud, {"classification", "", std::nullopt});
  ASSERT_EQ(odd.classes.size(), 2u);
  EXPECT_EQ(odd.classes[0].id, -odd.classes[1].id);
  EXPECT_EQ(odd.colors[0], odd.colors[3]);  // the same code with another sign
}

TEST(Coloring, WrongNameNamesTheNearest) {
  PointCloud cloud = ramp(2);
  cloud.set_scalar(field("intensity", {1, 2}));
  EXPECT_THAT(refusal([&] {
                color_points(cloud, {"intensty", "", std::nullopt});
              }),
              ::testing::HasSubstr("did you mean 'intensity'"));
  EXPECT_THAT(refusal([&] {
                color_points(cloud, {"rgb", "", std::nullopt});
              }),
              ::testing::HasSubstr("no 'rgb'"));
  EXPECT_THAT(refusal([&] {
                color_points(cloud, {"normal", "", std::nullopt});
              }),
              ::testing::HasSubstr("no normals"));
}

TEST(Coloring, DarkPhotographsAreRaisedAndOtherColoursAreKept) {
  PointCloud cloud = ramp(100);
  const auto photograph = [&](std::uint8_t green) {  // a hundred colours
    std::vector<Rgba8> colors;
    for (int i = 0; i < 100; ++i) colors.push_back({46, green, std::uint8_t(20 + i), 255});
    return colors;
  };
  cloud.colors = photograph(215);
  EXPECT_EQ(color_points(cloud, {"rgb"}).colors, cloud.colors);
  // A little darker than the 211 that a tenth should exceed: 1.09 times as bright would be seen by nobody.
  cloud.colors = photograph(208);
  EXPECT_EQ(color_points(cloud, {"rgb"}).colors, cloud.colors);
  cloud.colors = photograph(140);
  cloud.colors[0] = {255, 255, 255, 255}, cloud.colors[1] = {0, 0, 0, 255};
  const Coloring raised = color_points(cloud, {"rgb"});
  // To 0.65 in linear light it is 5.2 times as bright: half the stops beyond three.
  EXPECT_NEAR(raised.exposure, std::sqrt(3 * 5.2), 0.1);
  EXPECT_NEAR(raised.colors[50].g, 201, 3);
  EXPECT_EQ(raised.colors[0], cloud.colors[0]) << "white stays white";
  EXPECT_EQ(raised.colors[1], cloud.colors[1]);
  // The same hue: channels keep their ratios in linear light.
  const auto linear = [](int code) { return std::pow((double(code) / 255 + 0.055) / 1.055, 2.4); };
  EXPECT_NEAR(linear(raised.colors[70].b) / linear(raised.colors[70].g), linear(90) / linear(140), 0.02);
  ASSERT_EQ(raised.notes.size(), 1u);
  ColorSettings as_they_are;
  as_they_are.exposure = 1;
  EXPECT_EQ(color_points(cloud, as_they_are).colors, cloud.colors);
  EXPECT_TRUE(color_points(cloud, as_they_are).notes.empty());
  // What stands for a value is never raised, nor are labels in the file's own colours.
  cloud.set_scalar(field("classification", std::vector<float>(100, 2)));
  EXPECT_EQ(color_points(cloud, {"classification", "", std::nullopt}).colors[5], class_color(2));
  for (int i = 0; i < 100; ++i)
    cloud.colors[std::size_t(i)] = {46, std::uint8_t(130 + i % 10), 90, std::uint8_t(100 + i)};
  const Coloring labels = color_points(cloud, {"rgb"});
  EXPECT_FALSE(labels.is_photographed) << "whatever alpha they have";
  EXPECT_EQ(labels.colors[7].g, 137);
  EXPECT_TRUE(raised.is_photographed);
  // A ramp of any number of colours: each has a full channel and an empty one.
  for (int i = 0; i < 100; ++i)
    cloud.colors[std::size_t(i)] =
        i < 50 ? Rgba8{0, std::uint8_t(5 * i), 255, 255} : Rgba8{0, 255, std::uint8_t(5 * (99 - i)), 255};
  EXPECT_FALSE(color_points(cloud, {"rgb"}).is_photographed);
  for (int i = 0; i < 95; ++i) cloud.colors[std::size_t(i)].r = 20;
  EXPECT_TRUE(color_points(cloud, {"rgb"}).is_photographed) << "a signal in the picture";
  // At most eightfold, and told from twice on.
  cloud.colors = photograph(215);
  for (Rgba8& c : cloud.colors) c = {std::uint8_t(c.b % 20), 21, std::uint8_t(c.b / 4), 255};
  EXPECT_EQ(color_points(cloud, {"rgb"}).exposure, 8);
  cloud.colors = photograph(190);
  EXPECT_GT(color_points(cloud, {"rgb"}).exposure, 1.2);
  EXPECT_TRUE(color_points(cloud, {"rgb"}).notes.empty());
}

// Of a photograph that fades to black all is kept; of one without dark colours black is none.
TEST(Coloring, BlackOfPointsThatNoPhotographShowsIsDrawnInTheMedianColour) {
  constexpr int count = 4000;
  PointCloud cloud = ramp(count);
  for (int i = 0; i < count; ++i)
    cloud.colors.push_back({std::uint8_t(40 + i % 200), std::uint8_t(60 + i % 100), 90, 255});
  const std::vector<Rgba8> plain = color_points(cloud, {"rgb"}).colors;
  for (int i = 0; i < count; i += 20) cloud.colors[std::size_t(i)] = {0, 0, 0, 255};
  const Coloring coloring = color_points(cloud, {"rgb"});
  EXPECT_EQ(coloring.notes.size(), 1u);
  EXPECT_NEAR(coloring.for_black.r, 140, 2);
  EXPECT_NEAR(coloring.for_black.g, 110, 2);
  EXPECT_EQ(coloring.for_black.b, 90);
  for (int i = 1; i < 20; ++i) EXPECT_EQ(coloring.colors[std::size_t(i)], plain[std::size_t(i)]);
  EXPECT_EQ(coloring.colors[0], coloring.colors[20]);
  EXPECT_GT(coloring.colors[0].r, 100);
  // Of a part without any as of the whole that has some, and the other way round.
  ColorSettings settings{"rgb"};
  settings.for_black = Rgba8{0, 0, 0, 255};
  EXPECT_EQ(color_points(cloud, settings).colors[0].r, 0);
  settings = {"rgb"};
  settings.exposure = 1;
  EXPECT_EQ(color_points(cloud, settings).colors, cloud.colors) << "as they are";
  const std::vector<Rgba8> colors = cloud.colors;
  for (int i = 30; i < count; i += 10)
    if (i % 20 != 0) cloud.colors[std::size_t(i)] = {std::uint8_t(8 * (i % 3)), 17, std::uint8_t(i % 4), 255};
  EXPECT_GT(color_points(cloud, {"rgb"}).for_black.g, 100) << "one less";
  cloud.colors[1] = {17, 0, 0, 255};
  EXPECT_EQ(color_points(cloud, {"rgb"}).for_black.g, 0) << "dark photographs";
  cloud.colors = colors;
  for (Rgba8& c : cloud.colors) c.g = c.b = c.r;
  EXPECT_EQ(color_points(cloud, {"rgb"}).for_black.g, 0) << "intensities as colours";
  cloud.colors = colors;
  cloud.set_scalar({"opacity", 0, std::vector<float>(cloud.size(), 1.0f)});
  EXPECT_EQ(color_points(cloud, {"rgb"}).for_black.g, 0) << "Gaussian splats";
}

TEST(Coloring, HeightsAreSpreadByTheNumberOfPoints) {
  // 900 points on level ground below 2, of 1000 up to 10.
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i)
    cloud.positions.push_back(
        {float(i % 40), float(i / 40), i < 900 ? 2 * float(i) / 900 : 2 + 8 * float(i - 900) / 99});
  const Coloring spread = color_points(cloud, {"elevation"});
  ASSERT_EQ(spread.places.size(), 33u);
  EXPECT_EQ(spread.places.front(), 0);
  EXPECT_NEAR(spread.places.back(), 1, 1e-12);
  for (std::size_t i = 1; i < spread.places.size(); ++i) EXPECT_GT(spread.places[i], spread.places[i - 1]);
  // A fifth of the heights has nine tenths of the points: .65 * .2 + .35 * .9, within what quantiles cut off.
  const double step = (2 - spread.low) / (spread.high - spread.low) * 32;
  EXPECT_NEAR(std::lerp(spread.places[std::size_t(step)], spread.places[std::size_t(step) + 1],
                        step - std::floor(step)),
              0.445, 0.02);
  // Two levels of as many points are as far from both ends, and one alone has no steps.
  PointCloud levels;
  for (int i = 0; i < 1000; ++i)
    levels.positions.push_back({float(i % 40), float(i / 40), i % 2 ? 10.f : 0.f});
  const std::vector<double> two = color_points(levels, {"elevation"}).places;
  ASSERT_EQ(two.size(), 33u);
  EXPECT_NEAR(two[1], 1 - two[31], 1e-12);
  for (vec3& p : levels.positions) p.z = 3;
  EXPECT_TRUE(color_points(levels, {"elevation"}).places.empty());
  EXPECT_TRUE(color_points(PointCloud(), {"elevation"}).places.empty());
  // The legend has what is drawn.
  const Colormap ramp = spread.ramp();
  for (const std::size_t i : {100u, 500u, 950u}) {
    const double share = (double(cloud.positions[i].z) - spread.low) / (spread.high - spread.low);
    const Rgba8 a = ramp.at(share), b = spread.colors[i];
    EXPECT_NEAR(a.r, b.r, 2);
    EXPECT_NEAR(a.g, b.g, 2);
    EXPECT_NEAR(a.b, b.b, 2);
  }
  EXPECT_EQ(Colormap::named(ramp.text()).at(0.3), ramp.at(0.3));
  // Who names a map or a range reads values off it.
  EXPECT_TRUE(color_points(cloud, {"elevation", "land"}).places.empty());
  EXPECT_TRUE(color_points(cloud, {"elevation", "", std::array<double, 2>{0, 10}}).places.empty());
  // A part of it is coloured as in the whole.
  ColorSettings as_whole;
  as_whole.color_by = "elevation", as_whole.range = {spread.low, spread.high},
  as_whole.places = spread.places;
  EXPECT_EQ(color_points(cloud, as_whole).colors, spread.colors);
}

TEST(Coloring, HidesNoiseClassesAndWithheldPoints) {
  PointCloud cloud = ramp(5);
  cloud.set_scalar(field("classification", {2, 7, 18, 6, 2}));
  cloud.set_scalar(field("withheld", {0, 0, 0, 0, 1}));
  EXPECT_EQ(hide_classes(cloud, {7, 18}), 3u);
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.source_index, (std::vector<std::uint32_t>{0, 3}));
  EXPECT_EQ(cloud.scalar("classification")->values, (std::vector<float>{2, 6}));
  EXPECT_EQ(hide_classes(cloud, {}), 0u);
}

// Flight lines 66 to 68 are three things, and no number lies between them.
TEST(Coloring, FewNumbersThatNameThingsAreSwatches) {
  PointCloud cloud;
  ScalarField lines{"point_source_id", 0, {}, StoredType::uint16}, heat{"heat", 0, {}, StoredType::uint16};
  for (int i = 0; i < 90; ++i) {
    cloud.positions.push_back(vec3(float(i), 0, 0));
    lines.values.push_back(float(66 + i % 3));
    heat.values.push_back(float(66 + i % 3));
  }
  cloud.scalars = {lines, heat};
  ColorSettings settings;
  settings.color_by = "point_source_id";
  const Coloring named = color_points(cloud, settings);
  ASSERT_EQ(named.swatches.size(), 3u);
  EXPECT_EQ(named.swatches[2].label, "68");
  EXPECT_EQ(named.swatches[2].points, 30u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(named.colors[std::size_t(i)], named.swatches[std::size_t(i)].color);
  EXPECT_NE(named.colors[0], named.colors[1]);
  // A line has its colour where others are out of view as well.
  PointCloud one = cloud;
  for (float& value : one.scalars[0].values) value = value == 66 ? 67 : value;
  EXPECT_EQ(color_points(one, settings).colors[1], named.colors[1]);
  settings.colormap = "viridis";
  EXPECT_TRUE(color_points(cloud, settings).swatches.empty()) << "a ramp that is asked for";
  settings.colormap.clear();
  settings.color_by = "heat";
  EXPECT_TRUE(color_points(cloud, settings).swatches.empty()) << "a measured number";
  settings.color_by = "point_source_id";
  for (std::size_t i = 0; i < 90; ++i) cloud.scalars[0].values[i] = float(i);
  EXPECT_TRUE(color_points(cloud, settings).swatches.empty()) << "more than colours tell apart";
}

TEST(Coloring, ManyClustersAreToldApart) {
  PointCloud cloud;
  cloud.positions.resize(3000);
  ScalarField field{"cluster", 0, {}};
  for (std::size_t i = 0; i < cloud.size(); ++i) field.values.push_back(float(i / 10));
  cloud.set_scalar(field);
  ColorSettings settings;
  settings.color_by = "cluster";
  const Coloring coloring = color_points(cloud, settings);
  EXPECT_TRUE(coloring.swatches.empty());
  for (std::size_t i = 10; i < cloud.size(); i += 10) {
    const Rgba8 a = coloring.colors[i - 10], b = coloring.colors[i];
    EXPECT_EQ(coloring.colors[i + 9], b);
    EXPECT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 60) << i;
    EXPECT_GT(std::max({b.r, b.g, b.b}) - std::min({b.r, b.g, b.b}), 60) << "colourful, unlike no label";
  }
  settings.colormap = "viridis";
  EXPECT_EQ(color_points(cloud, settings).kind, ColorKind::scalar) << "a ramp that is asked for";
}

}  // namespace
