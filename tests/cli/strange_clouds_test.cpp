// Clouds that no scanner makes on purpose, through `info`, prepare and every technique: each ends in bounded
// time.
#include <sys/resource.h>

#include <cmath>
#include <functional>
#include <random>

#include "cli/command.h"
#include "core/vec.h"

using namespace sfumato::testing;
using sfumato::dvec3;

namespace {

struct StrangeCloud {
  const char* name;
  std::function<std::vector<dvec3>()> make;
};

constexpr int many = 100'000;

std::vector<dvec3> random_points(int count, const dvec3& low, const dvec3& high) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<dvec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = share(random), y = share(random), z = share(random);
    points.push_back(low + dvec3(x, y, z) * (high - low));
  }
  return points;
}

std::vector<dvec3> joined(std::vector<dvec3> a, const std::vector<dvec3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const StrangeCloud strange_clouds[] = {
    {"one_place", [] { return std::vector<dvec3>(many, dvec3(1, 2, 3)); }},
    {"one_place_far_out", [] { return std::vector<dvec3>(many, dvec3(500000.123, 5400000.456, 3)); }},
    {"two_places",
     [] {
       return joined(std::vector<dvec3>(many, dvec3(1, 2, 3)), std::vector<dvec3>(many, dvec3(1, 2, 4)));
     }},
    {"line", [] { return random_points(many, dvec3(0), dvec3(1, 0, 0)); }},
    {"plane", [] { return random_points(many, dvec3(0), dvec3(1, 1, 0)); }},
    {"lattice",
     [] {
       std::vector<dvec3> points;
       for (int i = 0; i < 46 * 46 * 46; ++i) points.emplace_back(i % 46, i / 46 % 46, i / (46 * 46));
       return points;
     }},
    {"one_outlier_at_1e9",
     [] { return joined(random_points(many, dvec3(0), dvec3(10)), {dvec3(1e9, 0, 0)}); }},
    {"contrast_of_density",
     [] {
       return joined(random_points(many, dvec3(0), dvec3(1e-2, 1e-2, 0)),
                     random_points(many / 10, dvec3(0), dvec3(1e3, 1e3, 0)));
     }},
    {"tiny", [] { return random_points(many, dvec3(0), dvec3(1e-7)); }},
    {"huge", [] { return random_points(many, dvec3(0), dvec3(1e12)); }},
};

class StrangeCloudTest : public CommandTest, public ::testing::WithParamInterface<int> {};

TEST_P(StrangeCloudTest, IsDrawnByEveryTechnique) {
  const StrangeCloud& strange = strange_clouds[GetParam()];
  const std::vector<dvec3> points = strange.make();
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment up +Z\nelement vertex " +
                      std::to_string(points.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  bytes.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(dvec3));
  write("strange.ply", bytes);
  const nlohmann::json info = run_json({"info", "strange.ply", "--json"});
  EXPECT_EQ(info["points_finite"], points.size());
  for (const nlohmann::json& technique : run_json({"techniques", "--json"})) {
    const std::string name = technique["name"];
    struct rusage before {
    }, after{};
    getrusage(RUSAGE_CHILDREN, &before);
    const Outcome outcome =
        run({"strange.ply", "-t", name, "-o", name + ".png", "--resolution", "320x240", "--quiet"});
    getrusage(RUSAGE_CHILDREN, &after);
    ASSERT_EQ(outcome.code, 0) << name << ": " << outcome.err;
    // A harmless cloud of as many points takes up to 3 s of processor time, the worst of these 8; a hang
    // takes all.
    EXPECT_LT(after.ru_utime.tv_sec - before.ru_utime.tv_sec, 30) << name;
    const sfumato::Image<sfumato::Rgba8> picture = read_png(name + ".png");
    std::size_t drawn = 0;
    for (const sfumato::Rgba8& pixel : picture) drawn += pixel.r < 250 || pixel.g < 250 || pixel.b < 250;
    // Points in one place have no neighbours but themselves: `denoise` may take them for an outlier. What is
    // drawn as discs or strokes gets lost where sizes span nine orders of magnitude; that is known, and not
    // what these clouds are here for.
    const std::string cloud = strange.name;
    const bool spans = cloud == "one_outlier_at_1e9" || cloud == "contrast_of_density" || cloud == "tiny";
    if (name == "points" || name == "surface" || (name != "denoise" && !spans)) EXPECT_GT(drawn, 0u) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Clouds, StrangeCloudTest, ::testing::Range(0, int(std::size(strange_clouds))),
                         [](const auto& cloud) { return std::string(strange_clouds[cloud.param].name); });

}  // namespace
