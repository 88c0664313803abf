// Soft transparency on scans as they come: random samples without normals, forests over known ground, real
// statues.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <tuple>

#include "analysis/attributes.h"
#include "copc/build.h"
#include "copc/tree.h"
#include "io/io.h"
#include "reference/gl_fixture.h"
#include "synth/synth.h"
#include "techniques/soft/field.h"
#include "unit/io/truth.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class SoftScans : public GlTest {
 protected:
  SoftScans() { settings_.transparent = true; }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  RenderOutput draw(const std::string& technique, const PointCloud& cloud, const Camera& camera) {
    auto other = find_technique(technique).create();
    Renderer renderer(context());
    show(renderer, cloud, other->needs());
    return renderer.render(*other, camera, settings_, all_outputs());
  }
  void show_cloud(const PointCloud& cloud) { show(renderer_, cloud, technique_->needs()); }
  RenderOutput render(const Camera& camera) {
    return renderer_.render(*technique_, camera, settings_, all_outputs());
  }

  std::unique_ptr<Technique> technique_ = find_technique("soft").create();
  RenderSettings settings_;
  Renderer renderer_{context()};
};

PointCloud forest_scan(int points) {
  synth::SampleOptions options;
  options.points = points;
  options.normals.user = false;
  return synth::sample(synth::make_scene("forest"), options);
}

/// From above at an angle, from far and near, and almost along the ground.
std::vector<Camera> forest_cameras(const Bounds& box) {
  std::vector<Camera> cameras;
  for (double elevation : {30.0, 60.0, 85.0})
    cameras.push_back(frame(box, UpAxis::pos_z, 480, 360, glm::radians(-45.0), glm::radians(elevation)));
  Camera near = cameras[0];
  near.position = near.target + 0.4 * (near.position - near.target);
  cameras.push_back(near);
  return cameras;
}

// Chosen by class, trees let the terrain be seen, and it is where it is: within two spacings of the truth.
TEST_F(SoftScans, TerrainBelowTreesIsSeenByClass) {
  const synth::Scene forest = synth::make_scene("forest");
  synth::Scene terrain = forest;
  terrain.primitives.clear();
  terrain.build();
  const PointCloud scan = forest_scan(120'000);
  const double spacing = analysis::prepare(scan, {}, {}).median_spacing;
  set("field", "class");
  set("field_classes", "3,5");
  show_cloud(scan);
  for (const Camera& camera : forest_cameras(forest.box)) {
    const synth::Truth truth = synth::truth(terrain, camera);
    const RenderOutput out = render(camera);
    int ground = 0, found = 0;
    for (std::size_t i = 0; i < truth.depth.size(); ++i) {
      if (!std::isfinite(truth.depth.data()[i])) continue;
      ++ground;
      found += std::abs(out.depth.data()[i] - truth.depth.data()[i]) < 2 * spacing;
    }
    ASSERT_GT(ground, 5000);
    EXPECT_GE(found, 0.9 * ground) << "of " << ground;
    std::printf("terrain within two spacings (%.2f m): %.1f %%\n", 2 * spacing, 100.0 * found / ground);
  }
}

// Leaves that are haze are as large as Eq. 20 has them, though solid ones shrink in clutter. However deep the
// haze: nine in ten of its pixels let a quarter through at defaults. Shown against nothing,
// so that alpha is what the haze hides.
TEST_F(SoftScans, ChosenHazeCanBeSeenThrough) {
  PointCloud leaves = forest_scan(60'000);
  Bounds box = bounds(leaves);
  set("field", "class");
  set("field_classes", "2,3,5");
  show_cloud(leaves);
  std::vector<Camera> cameras = forest_cameras(box);
  cameras.push_back(frame(box, UpAxis::pos_z, 240, 180, glm::radians(-45.0), glm::radians(2.0)));
  auto least_transmittance = [&](const Camera& camera) {
    std::vector<float> transmittance;
    const RenderOutput out = render(camera);
    for (std::size_t i = 0; i < out.color_linear.size(); ++i)
      if (out.color_linear.data()[i].a > 0.01f) transmittance.push_back(1 - out.color_linear.data()[i].a);
    EXPECT_GT(transmittance.size(), 1000u);
    std::nth_element(transmittance.begin(), transmittance.begin() + std::ptrdiff_t(transmittance.size() / 10),
                     transmittance.end());
    return transmittance[transmittance.size() / 10];
  };
  for (const char* model : {"express", "base"}) {
    set("model", model);
    for (const Camera& asked : cameras) {
      const Camera camera = asked.resized(160, 120);
      EXPECT_GE(least_transmittance(camera), 0.25) << model;
      EXPECT_LE(least_transmittance(camera), 0.6) << model << ": too thin to be seen itself";
    }
  }
  set("model", "express");
  set("opacity", "0.15");
  EXPECT_LT(least_transmittance(cameras[0].resized(160, 120)), 0.1)
      << "the forest is not deep enough to prove anything";
}

// Opacity follows the camera without steps: a tenth of a degree changes it by less than 2 %.
TEST_F(SoftScans, AutomaticOpacityFollowsTheCamera) {
  const PointCloud scan = forest_scan(60'000);
  set("field", "class");
  set("field_classes", "3,5");
  show_cloud(scan);
  double last = 0;
  for (int step = 0; step < 20; ++step) {
    render(frame(bounds(scan), UpAxis::pos_z, 96, 72, glm::radians(-45 + 0.1 * step), glm::radians(30.0)));
    ParamList parameters;
    technique_->describe(parameters);
    double opacity = 0;
    for (const Param& param : parameters.all())
      if (param.name == "opacity") opacity = std::stod(param.resolved());
    EXPECT_LT(opacity, 0.1);
    EXPECT_GT(opacity, 0.005);
    if (step > 0) EXPECT_NEAR(opacity / last, 1, 0.02);
    last = opacity;
  }
}

bool says(const RenderOutput& out, const std::string& text) {
  return std::any_of(out.notes.begin(), out.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

// A clean scan has nothing uncertain, at any scale, sampled at random and with noise of half a spacing.
TEST_F(SoftScans, NothingIsSoftWhereNothingIsUncertain) {
  for (const char* scene : {"spheres", "plane"})
    for (double noise : {0.0, 0.5})
      for (double scale : {1e-3, 1e3}) {
        synth::SampleOptions options;
        options.points = 30'000;
        options.normals.user = false;
        const synth::Scene made = synth::make_scene(scene);
        double area = 0;
        for (std::size_t i = 0; i < made.surface_count(); ++i) area += made.surface_area(i);
        options.sigma = float(noise * std::sqrt(area / options.points));
        PointCloud cloud = synth::sample(made, options);
        for (vec3& p : cloud.positions) p *= float(scale);
        show_cloud(cloud);
        const Bounds box = bounds(cloud);
        const RenderOutput out = render(frame(box, UpAxis::pos_z, 64, 48, 0.3, 0.5));
        EXPECT_TRUE(says(out, "nothing is uncertain")) << scene << " " << noise;
        EXPECT_TRUE(says(out, "0.0 % of the points are soft")) << scene << " " << noise;
      }
}

// The room from two known places, normals known: F by the lidar equation, in double and from the scene's own
// surfaces.
TEST_F(SoftScans, SensorKnowsRangeAngleAndReturns) {
  synth::SampleOptions options;
  options.points = 40000;
  options.scanner_position = {1.0f, 1.2f, 1.5f, 3.2f, 2.4f, 1.2f};
  options.noise = synth::NoiseModel::tof;
  options.normals.user = true;
  const synth::Scene scene = synth::make_scene("room");
  PointCloud cloud = synth::sample(scene, options);
  ASSERT_FALSE(cloud.scanners.empty());
  ScalarField returns{"number_of_returns", 0, std::vector<float>(cloud.size(), 1)};
  for (std::size_t i = 0; i < cloud.size(); i += 3) returns.values[i] = 2;
  for (std::size_t i = 1; i < cloud.size(); i += 3)  // not known, which is one
    returns.values[i] = std::numeric_limits<float>::quiet_NaN();
  cloud.set_scalar(returns);
  const PreparedCloud prepared = analysis::prepare(cloud, technique_->needs(), {});
  const PointCloud& points = prepared.cloud;
  const ScalarField &which = *points.scalar("scanner"), &shared = *points.scalar("number_of_returns");

  std::vector<double> sigma(points.size()), error(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const dvec3 from = points.scanners[std::size_t(which.value(i))], way = points.world(i) - from;
    const double range = glm::length(way);
    const auto hit = scene.intersect({from, way / range});
    ASSERT_TRUE(hit.has_value());
    error[i] = std::abs(range - hit->t);
    const double cosine = std::max(std::abs(glm::dot(dvec3(points.normals[i]), way / range)), 0.1);
    sigma[i] = range * range / cosine * std::max(1.0, shared.value(i));
  }
  std::vector<double> sorted = sigma;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  const double median = sorted[sorted.size() / 2];

  soft::FieldSettings settings;
  settings.field = "sensor";
  analysis::Nearby nearby;
  const soft::Field field = soft::evaluate(prepared, settings, nearby);
  double soft_sum = 0, solid_sum = 0, wrong = 0;
  std::size_t soft_count = 0, solid_count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    wrong = std::max(wrong, std::abs(field.values[i] - (1 - 1 / std::max(sigma[i] / median, 1.0))));
    if (shared.value(i) > 1) continue;  // made up: the scanner of the scene measured all alike
    (field.values[i] > 0.5f ? soft_sum : solid_sum) += error[i];
    ++(field.values[i] > 0.5f ? soft_count : solid_count);
  }
  EXPECT_LT(wrong, 1e-3);  // the median of an even number, normals in float
  EXPECT_GE(field.threshold, 0.5f);
  // What is called uncertain is worse measured: the noise of the synthetic scanner grows as its light fails.
  ASSERT_GT(soft_count, 500u);
  EXPECT_GT(soft_sum / double(soft_count), 2 * solid_sum / double(solid_count));
}

TEST_F(SoftScans, SensorNeedsAFileThatKnowsIt) {
  PointCloud cloud = sphere_cloud(2000);
  PreparedCloud prepared = analysis::prepare(cloud, technique_->needs(), {});
  soft::FieldSettings settings;
  settings.field = "sensor";
  analysis::Nearby nearby;
  EXPECT_THROW(soft::evaluate(prepared, settings, nearby), Error);
  cloud.scanners.assign(1, dvec3(std::numeric_limits<double>::quiet_NaN()));
  prepared = analysis::prepare(cloud, technique_->needs(), {});
  EXPECT_THROW(soft::evaluate(prepared, settings, nearby), Error) << "somewhere it stood";
  cloud.scanners.clear();

  // The scanner alone, in the middle of a sphere: all alike, nothing is soft.
  cloud.scanners.push_back(dvec3(0));
  prepared = analysis::prepare(cloud, technique_->needs(), {});
  const soft::Field alike = soft::evaluate(prepared, settings, nearby);
  EXPECT_LT(*std::max_element(alike.values.begin(), alike.values.end()), 0.05f);
  EXPECT_GE(alike.threshold, 0.5f);

  // Returns alone, as from the air: of three of them each point has three times the noise of a single one.
  cloud.scanners.clear();
  ScalarField returns{"number_of_returns", 0, std::vector<float>(cloud.size(), 1)};
  returns.values[7] = 3;
  cloud.set_scalar(returns);
  prepared = analysis::prepare(cloud, technique_->needs(), {});
  const soft::Field shared = soft::evaluate(prepared, settings, nearby);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_FLOAT_EQ(shared.values[i],
                    prepared.cloud.scalar("number_of_returns")->value(i) == 3 ? 2.0f / 3 : 0);
}

// Where leaves stand over flat ground the leaves are what is soft, in patches.
TEST_F(SoftScans, UncertainPointsOfAForestAreLeaves) {
  const PointCloud scan = forest_scan(100'000);
  const PreparedCloud prepared = analysis::prepare(scan, Attribute::uncertainty, {});
  const analysis::Nearby nearby(prepared.cloud.positions, no_progress());
  const std::vector<float> field = analysis::scale_free_uncertainty(prepared, nearby);
  const ScalarField* classes = prepared.cloud.scalar("classification");
  std::size_t soft = 0, ground = 0, together = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    EXPECT_GE(field[i], 0);
    EXPECT_LE(field[i], 1);
    if (field[i] <= analysis::uncertain_from) continue;
    ++soft;
    ground += classes->value(i) == 2;
    std::size_t like = 0;
    for (std::uint32_t j : nearby.of(i)) like += field[j] > analysis::uncertain_from;
    together += 2 * like > nearby.of(i).size();
  }
  EXPECT_GT(soft, field.size() / 10);
  EXPECT_LT(ground, soft / 100);
  EXPECT_GT(together, soft * 9 / 10);
}

/// Above what is uncertain by itself, by place in tenths of a millimetre.
std::map<std::tuple<long, long, long>, bool> uncertain_places(const PointCloud& cloud) {
  const PreparedCloud prepared = analysis::prepare(cloud, Attribute::uncertainty | Attribute::radius, {});
  soft::FieldSettings settings;
  analysis::Nearby nearby;
  const soft::Field field = soft::evaluate(prepared, settings, nearby);
  std::map<std::tuple<long, long, long>, bool> places;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    const dvec3 at = 1e4 * prepared.cloud.world(i);
    places[{std::lround(at.x), std::lround(at.y), std::lround(at.z)}] =
        field.values[i] > analysis::uncertain_from;
  }
  return places;
}

// A point of a coarse level is soft where it is in the whole, though its neighbours are far apart there.
TEST_F(SoftScans, LevelsHaveTheUncertaintyOfTheWhole) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "sfumato_soft_levels";
  std::filesystem::create_directories(folder);
  synth::SampleOptions sampling;
  sampling.points = 200'000;
  sampling.normals.user = false;
  io::write(folder / "in.laz", synth::sample(synth::make_scene("courtyard"), sampling));
  copc::BuildOptions options;
  options.attributes = Attribute::uncertainty;
  copc::build({folder / "in.laz"}, folder / "out.copc.laz", options);
  const auto whole = uncertain_places(io::read(folder / "in.laz").cloud);

  const copc::Tree tree = copc::read_tree(folder / "out.copc.laz");
  std::vector<std::size_t> root;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i)
    if (tree.nodes[i].key.level == 0) root.push_back(i);
  PointCloud level = copc::read_nodes(tree, root).cloud;
  const auto differing = [&] {
    double either = 0, differ = 0;
    for (const auto& [place, is_soft] : uncertain_places(level)) {
      const auto same = whole.find(place);
      if (same == whole.end()) continue;  // one in a hundred lies between two tenths
      either += is_soft || same->second, differ += is_soft != same->second;
    }
    EXPECT_GT(either, 200);
    return differ / either;
  };
  EXPECT_LT(differing(), 0.05);  // values in steps of 0.004, of which few lie next to the threshold
  std::erase_if(level.scalars, [](const auto& s) { return s.name == analysis::stored_uncertainty; });
  EXPECT_GT(differing(), 0.3);  // by the points of the level alone
  std::filesystem::remove_all(folder);
}

/// Pixels at least four away from what `splats` leaves open, and those of them that `soft` lets light
/// through.
std::pair<int, int> interior_holes(const Image<vec4>& splats, const Image<vec4>& soft) {
  int interior = 0, holes = 0;
  const int reach = 4;
  for (int y = reach; y < splats.height() - reach; ++y)
    for (int x = reach; x < splats.width() - reach; ++x) {
      bool inside = true;
      for (int dy = -reach; dy <= reach && inside; ++dy)
        for (int dx = -reach; dx <= reach && inside; ++dx) inside = splats.at(x + dx, y + dy).a > 0.97f;
      if (!inside) continue;
      ++interior;
      holes += soft.at(x, y).a < 0.98f;
    }
  return {interior, holes};
}

class SoftStatues : public SoftScans, public ::testing::WithParamInterface<const char*> {};

TEST_P(SoftStatues, HaveNoHoles) {
  SFUMATO_NEEDS_REAL_SCAN(GetParam());
  const PointCloud scan = io::read(sfumato::test::data_folder() / GetParam()).cloud;
  show_cloud(scan);
  for (double azimuth : {-45.0, 60.0, 170.0}) {
    const Camera camera =
        frame(robust_bounds(scan), scan.up, 400, 300, glm::radians(azimuth), glm::radians(20.0));
    const auto [interior, holes] =
        interior_holes(draw("splats", scan, camera).color_linear, render(camera).color_linear);
    EXPECT_GT(interior, 5000);
    EXPECT_EQ(holes, 0) << "of " << interior << " from " << azimuth;
  }
}
INSTANTIATE_TEST_SUITE_P(, SoftStatues, ::testing::Values("Guanyin.ply", "dragon_vrip_res2.ply"),
                         [](const auto& one) {
                           return std::string(one.param, std::strcspn(one.param, "."));
                         });

// A plane whose right half has a sixteenth of the points: no holes in it. A few points over the plane,
// however many: discs no larger than what belongs to points as far apart.
TEST_F(SoftScans, SparsePartsAreClosedAndStraysStaySmall) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointCloud cloud;
  for (int i = 0; i < 32'000; ++i) {
    const vec3 p(uniform(random), uniform(random), 0);
    if (p.x < 0 || i % 16 == 0) cloud.positions.push_back(p);
  }
  const std::size_t plane = cloud.positions.size();
  const float spacing = std::sqrt(4.0f / 32'000);
  for (int strays = 1; strays <= 25; strays += 4)
    for (int k = 0; k < strays; ++k) {  // a group of that many in a cube of one spacing, over the dense half
      const vec3 within(uniform(random), uniform(random), uniform(random));
      cloud.positions.push_back(
          vec3(strays % 8 < 4 ? -0.75f : -0.25f, -0.95f + 0.07f * float(strays), 0.25f) +
          0.5f * spacing * within);
    }
  show_cloud(cloud);
  // From above: the plane closed away from its rim.
  const RenderOutput out = render(camera_above(2, 1.8, 180));
  int open = 0;
  // But for one spacing of the sparse half, 4 px, on the seam: its points are cut to the size of what is
  // around them.
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 180; ++x) open += (x < 90 || x >= 95) && out.color_linear.at(x, y).a < 0.5f;
  // Poisson: a place of the sparse half is out of reach of discs of 1.69 spacings with probability exp(-9)
  // = 1.2e-4; four times that.
  EXPECT_LE(open, int(4 * std::exp(-9.0) * double(out.color_linear.size())));
  // Radii of what floats: at most four times that of the six nearest of its group, or of the plane below.
  const PreparedCloud prepared = analysis::prepare(cloud, Attribute::radius, {});
  std::vector<float> radii = prepared.cloud.radii;
  analysis::limit_isolated(prepared.cloud.positions,
                           analysis::Nearby(prepared.cloud.positions, no_progress()), radii);
  std::size_t floating = 0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (prepared.cloud.positions[i].z < 0.2f) continue;
    ++floating;
    EXPECT_LT(radii[i],
              6 * spacing);  // 4 x 2 sqrt(3)/sqrt(6) of a cube's diagonal; of the way to the plane: 9
  }
  EXPECT_EQ(floating, cloud.positions.size() - plane);
}

}  // namespace
