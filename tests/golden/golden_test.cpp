// Whole pictures of synthetic scenes against references kept beside this file. A picture is one row of the
// table. SFUMATO_BLESS=1 writes the references anew; look at them before they are committed
// (docs/testing.md).
#include <algorithm>
#include <cstdlib>
#include <set>

#include "core/coloring.h"
#include "io/image_png.h"
#include "reference/gl_fixture.h"
#include "reference/png.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

struct Golden {
  const char* name;  ///< of the reference, without .png
  const char* technique;
  const char* scene;
  int points;
  std::vector<std::pair<std::string, std::string>> parameters;  ///< the technique's and the shared ones
  const char* color_by = "auto";
};

void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.name; }

/// At most 20 in all: every technique as it looks by default, not every parameter of it.
const Golden pictures[] = {
    {"points_courtyard", "points", "courtyard", 60'000, {}},
    {"points_courtyard_elevation", "points", "courtyard", 60'000, {}, "elevation"},
    {"points_spheres_lit",
     "points",
     "spheres",
     20'000,
     {{"size_mode", "pixels"}, {"point_size", "3"}, {"edl", "false"}}},
    {"points_tori_shadow", "points", "tori", 30'000, {{"shadows", "hard"}, {"light", "dir:-1,-1,3"}}},
    {"splats_courtyard", "splats", "courtyard", 60'000, {}},
    {"surface_courtyard", "surface", "courtyard", 60'000, {}},
    {"surface_spheres", "surface", "spheres", 4'000, {}},
    {"soft_courtyard", "soft", "courtyard", 60'000, {}},
    {"layers_tori", "layers", "tori", 30'000, {}},
    {"denoise_courtyard", "denoise", "courtyard", 60'000, {}},
    {"strokes_courtyard", "strokes", "courtyard", 60'000, {}},
};

// The tolerance pair. Drivers and compilers round differently: a shaded channel moves by a step or two of
// 255, so 4 is noise and 5 is a change. Where two points compete for a pixel, or a disc's rim crosses a pixel
// centre, the last bit of a float decides, and the whole pixel flips: at most one in 200.
constexpr int largest_difference = 4;
constexpr double share_outside = 0.005;

const std::filesystem::path references = std::filesystem::path(SFUMATO_SOURCE_DIR) / "tests/golden";

int difference(const Rgba8& a, const Rgba8& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
}

/// A picture of nothing would equal itself for ever: some of it is drawn, in more than a few colours.
void expect_not_empty(const Image<Rgba8>& image) {
  std::size_t drawn = 0;
  std::set<std::uint32_t> colors;
  for (const Rgba8& c : image) {
    if (difference(c, {255, 255, 255, 255}) == 0) continue;
    ++drawn;
    colors.insert(std::uint32_t(c.r) << 16 | std::uint32_t(c.g) << 8 | c.b);
  }
  EXPECT_GT(drawn, image.size() / 20) << "hardly anything but background";
  EXPECT_GT(colors.size(), 30u) << "hardly any colours";
}

Image<Rgba8> render(const Golden& golden) {
  synth::SampleOptions options;
  options.points = golden.points;
  options.sampling = synth::Sampling::area;
  PointCloud cloud = synth::sample(synth::make_scene(golden.scene), options);
  const Camera camera =
      frame(robust_bounds(cloud), cloud.up, 200, 150, glm::radians(-45.0), glm::radians(30.0));
  const std::unique_ptr<Technique> technique = find_technique(golden.technique).create();
  RenderSettings settings;
  ParamList own, shared;
  technique->describe(own);
  settings.describe(shared);
  for (const auto& [name, value] : golden.parameters) {
    Param* param = own.find(name) ? own.find(name) : shared.find(name);
    if (!param) throw Error(ErrorCode::usage, std::string(golden.technique) + " has no parameter " + name);
    param->set(value);
  }
  PreparedCloud prepared = analysis::prepare(std::move(cloud), technique->needs(), {});
  ColorSettings coloring;
  coloring.color_by = golden.color_by;
  std::vector<Rgba8> colors = color_points(prepared.cloud, coloring).colors;
  Renderer renderer(context());
  renderer.set_cloud(std::move(prepared), std::move(colors));
  return renderer.render(*technique, camera, settings).rgba8;
}

/// Actual, expected and difference (8 times as strong) side by side.
Image<Rgba8> evidence(const Image<Rgba8>& actual, const Image<Rgba8>& expected) {
  const int w = std::max(actual.width(), expected.width()), h = std::max(actual.height(), expected.height());
  Image<Rgba8> sheet(3 * w, h, Rgba8{255, 0, 255, 255});
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const bool in_actual = x < actual.width() && y < actual.height();
      const bool in_expected = x < expected.width() && y < expected.height();
      if (in_actual) sheet.at(x, y) = actual.at(x, y);
      if (in_expected) sheet.at(w + x, y) = expected.at(x, y);
      if (!in_actual || !in_expected) continue;
      const std::uint8_t d = std::uint8_t(std::min(255, 8 * difference(actual.at(x, y), expected.at(x, y))));
      sheet.at(2 * w + x, y) = {d, d, d, 255};
    }
  return sheet;
}

class GoldenTest : public GlTest, public ::testing::WithParamInterface<Golden> {};

TEST_P(GoldenTest, LooksAsBefore) {
  const std::filesystem::path file = references / (std::string(GetParam().name) + ".png");
  const Image<Rgba8> actual = render(GetParam());
  expect_not_empty(actual);
  if (std::getenv("SFUMATO_BLESS")) {
    io::write_png(file, actual, false);
    GTEST_SKIP() << "wrote " << file << "; look at it before it is committed";
  }
  const Image<Rgba8> expected = read_png(file);
  expect_not_empty(expected);
  std::size_t outside = 0;
  int largest = 0;
  const bool same_size = actual.width() == expected.width() && actual.height() == expected.height();
  EXPECT_TRUE(same_size) << actual.width() << "x" << actual.height();
  for (std::size_t i = 0; same_size && i < actual.size(); ++i) {
    const int d = difference(actual.data()[i], expected.data()[i]);
    largest = std::max(largest, d);
    outside += d > largest_difference;
  }
  EXPECT_LE(double(outside), share_outside * double(actual.size()))
      << outside << " pixels differ by more than " << largest_difference << ", the worst by " << largest;
  if (!HasFailure()) return;
  const std::filesystem::path folder = std::filesystem::path(SFUMATO_BINARY_DIR) / "golden";
  std::filesystem::create_directories(folder);
  io::write_png(folder / file.filename(), evidence(actual, expected), false);
  ADD_FAILURE() << "actual, expected and difference side by side: " << (folder / file.filename()).string();
}

INSTANTIATE_TEST_SUITE_P(Pictures, GoldenTest, ::testing::ValuesIn(pictures),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST(GoldenFiles, ShowEveryTechnique) {
  for (const TechniqueInfo& info : all_techniques())
    EXPECT_TRUE(std::any_of(
        std::begin(pictures), std::end(pictures),
        [&](const Golden& golden) { return golden.technique == info.name && golden.parameters.empty(); }))
        << info.name << " at its defaults has no row in the table";
}

TEST(GoldenFiles, StayFewAndSmallAndAreAllUsed) {
  std::set<std::string> names;
  for (const Golden& golden : pictures) EXPECT_TRUE(names.insert(golden.name).second) << golden.name;
  std::uintmax_t bytes = 0;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(references)) {
    if (entry.path().extension() != ".png") continue;
    ++count;
    bytes += entry.file_size();
    EXPECT_LE(entry.file_size(), 60u * 1024) << entry.path();
    EXPECT_TRUE(names.contains(entry.path().stem())) << entry.path() << " has no row in the table";
    const Image<Rgba8> image = read_png(entry.path());
    EXPECT_LE(std::max(image.width(), image.height()), 256) << entry.path();
  }
  EXPECT_LE(count, 20u);
  EXPECT_LT(bytes, 2u * 1024 * 1024);
}

}  // namespace
