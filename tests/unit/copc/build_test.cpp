// What `build` writes: by a validator of its own every point once, in the node it belongs to, levels that
// look even; by our own reader every attribute; and what becomes of strange inputs.
#include "copc/build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <random>

#include "analysis/attributes.h"
#include "analysis/nearby.h"
#include "copc/attributes.h"
#include "copc/file_writer.h"
#include "copc/tree.h"
#include "core/threads.h"
#include "io/io.h"
#include "io/laz_encode.h"
#include "unit/copc/scan.h"
#include "unit/copc/validator.h"
#include "unit/io/las_bytes.h"
#include "unit/io/truth.h"

using namespace sfumato;
using test::CopcFile;
using test::scan;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

// Little enough that points of the tests wait on the disk.
constexpr std::uint64_t little_memory = 8'000'000;

class CopcBuild : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::filesystem::path write(const PointCloud& cloud, const std::string& name) const {
    io::write(path(name), cloud);
    return path(name);
  }
  copc::BuildReport build(const std::vector<std::filesystem::path>& files,
                          const copc::BuildOptions& options = {}) const {
    return copc::build(files, path("out.copc.laz"), options);
  }
  std::string error_of(const std::vector<std::filesystem::path>& files,
                       const copc::BuildOptions& options = {}) const {
    try {
      build(files, options);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      EXPECT_FALSE(std::filesystem::exists(path("out.copc.laz")));
      return error.what();
    }
    return "no error";
  }
  CopcFile validated() const {
    CopcFile file(path("out.copc.laz"));
    EXPECT_THAT(file.faults, IsEmpty());
    EXPECT_TRUE(file.bounds_are_exact && file.returns_are_exact && file.times_are_exact)
        << file.bounds_are_exact << file.returns_are_exact << file.times_are_exact;
    EXPECT_NEAR(file.spacing, 2 * file.half_size / 128, 1e-12 * file.spacing);
    return file;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      all.push_back(entry.path().filename().string());
    return all;
  }

  const std::filesystem::path folder_ = test::temporary("folder");
};

/// Rows of all attributes, sorted: equal for the same points in any order.
std::vector<std::vector<double>> rows(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const ScalarField& scalar : cloud.scalars) names.push_back(scalar.name);
  std::sort(names.begin(), names.end());
  std::vector<std::vector<double>> all(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 place = cloud.world(i);
    // A float's digits of the place differ with the origin; the tests' steps are a millimetre or more.
    for (int k = 0; k < 3; ++k) all[i].push_back(std::round(place[k] * 1000) / 1000);
    if (!cloud.colors.empty())
      all[i].insert(all[i].end(),
                    {double(cloud.colors[i].r), double(cloud.colors[i].g), double(cloud.colors[i].b)});
  }
  for (const std::string& name : names)
    for (std::size_t i = 0; i < cloud.size(); ++i) all[i].push_back(cloud.scalar(name)->value(i));
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::string> attribute_names(const io::ReadResult& result) {
  std::vector<std::string> names;
  for (const io::AttributeStats& a : result.report.attributes) names.push_back(a.name);
  return names;
}

TEST_F(CopcBuild, HasEveryPointOnceInItsNodeWithEvenLevels) {
  const PointCloud cloud = scan(450'000);
  const auto input = write(cloud, "in.laz");
  copc::BuildOptions options;
  options.memory = little_memory;
  const copc::BuildReport report = build({input}, options);
  EXPECT_EQ(report.points, 450'000u);
  CopcFile file = validated();
  EXPECT_EQ(file.nodes.size(), report.nodes);
  EXPECT_EQ(file.spacing, report.spacing);
  EXPECT_GE(report.levels, 3);
  // Surfaces of 100 m at 128 cells an axis: the root has thousands of points, not a handful and not all.
  const auto root =
      std::find_if(file.nodes.begin(), file.nodes.end(), [](const auto& node) { return node.key[0] == 0; });
  ASSERT_NE(root, file.nodes.end());
  EXPECT_GT(root->count, 128 * 128 / 4);
  EXPECT_LT(root->count, 128 * 128 * 4);
  EXPECT_GE(file.least_distance_of_inner_nodes(),
            0.5 - 1e-6);  // the rule, and the roundings of this side of it
  std::vector<test::RawPoint> expected = test::raw_points(input), got = file.points;
  std::sort(expected.begin(), expected.end());
  std::sort(got.begin(), got.end());
  EXPECT_TRUE(expected == got);
  EXPECT_EQ(names().size(), 2u);  // the input and the output
}

TEST_F(CopcBuild, ReadsBackWithEveryAttribute) {
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    PointCloud cloud = scan(5000, format);
    if (format == 0 || format == 2)
      std::erase_if(cloud.scalars, [](const ScalarField& s) { return s.name == "gps_time"; });
    if (format == 0 || format == 1 || format == 6) cloud.colors.clear();
    if (format == 8) {
      ScalarField nir{"nir", 0, {}, StoredType::uint16};
      for (std::size_t i = 0; i < cloud.size(); ++i) nir.values.push_back(float(i % 65536));
      cloud.scalars.push_back(nir);
    }
    const auto input = write(cloud, "in" + std::to_string(format) + ".las");
    build({input});
    validated();
    io::ReadResult before = io::read(input), after = io::read(path("out.copc.laz"));
    EXPECT_EQ(before.cloud.las->point_format, format);
    // Formats 6 to 8 have a time, which is 0 for points without.
    if (format == 0 || format == 2)
      std::erase_if(after.cloud.scalars, [](const ScalarField& s) { return s.name == "gps_time"; });
    EXPECT_EQ(after.report.format, "copc");
    EXPECT_EQ(after.report.crs, before.report.crs);
    EXPECT_EQ(after.cloud.las->scale, before.cloud.las->scale);
    EXPECT_EQ(after.cloud.las->offset, before.cloud.las->offset);
    EXPECT_TRUE(rows(before.cloud) == rows(after.cloud)) << format;
  }
}

/// Of each point by its time, which numbers the points of `scan`.
std::map<double, std::size_t> by_time(const PointCloud& cloud) {
  std::map<double, std::size_t> places;
  for (std::size_t i = 0; i < cloud.size(); ++i) places[cloud.scalar("gps_time")->value(i)] = i;
  return places;
}

// Parts are made one after the other, and what lies around a part counts: normals at its rim are those of the
// whole.
TEST_F(CopcBuild, AttributesAreThoseOfTheWhole) {
  const auto input = write(scan(450'000), "in.laz");
  copc::BuildOptions options;
  options.memory = little_memory;
  options.attributes = Attribute::normal | Attribute::uncertainty;
  build({input}, options);
  validated();
  const PointCloud got = io::read(path("out.copc.laz")).cloud;
  analysis::PrepareOptions whole;
  whole.clutter_radius = 1;
  const PreparedCloud expected = analysis::prepare(
      io::read(input).cloud, Attribute::normal | Attribute::radius | Attribute::uncertainty, whole);
  ASSERT_EQ(got.size(), 450'000u);
  ASSERT_EQ(got.normals.size(), got.size());
  const ScalarField* stored = got.scalar(analysis::stored_uncertainty);
  ASSERT_TRUE(stored);
  const std::vector<float> uncertainty =
      analysis::scale_free_uncertainty(expected, analysis::Nearby(expected.cloud.positions, no_progress()));
  const std::map<double, std::size_t> at = by_time(got);
  std::size_t turned = 0, uncertain = 0, near_rim = 0;
  for (std::size_t i = 0; i < expected.cloud.size(); ++i) {
    const std::size_t k = at.at(expected.cloud.scalar("gps_time")->value(i));
    // Steps of 1e-4 turn a normal by no more than 1e-4; half a degree is another neighbourhood, or, where
    // walls stand on the ground, another group of eight among those that tell the wider planes.
    turned +=
        std::abs(glm::dot(got.normals[k], expected.cloud.normals[i])) < std::cos(0.5 * 3.14159265 / 180);
    uncertain += std::abs(stored->value(k) - double(uncertainty[i])) > 0.006;  // half a step is 0.002
    const dvec3 from_middle = glm::abs(got.world(k) - dvec3(500050, 4100050, 100));
    near_rim += std::min(from_middle.x, from_middle.y) < 0.5;
  }
  // Parts of the cube meet in its middle. Which of two neighbours at one distance is the 24th may differ, as
  // may what such a point means for others.
  EXPECT_GT(near_rim, 6000u);
  EXPECT_LT(turned, 4500u);  // 1 %
  EXPECT_LT(uncertain, 200u);
  // Such a cloud is drawn with them.
  const PreparedCloud drawn = analysis::prepare(got, Attribute::normal | Attribute::uncertainty, whole);
  EXPECT_TRUE(drawn.available.has(Attribute::uncertainty));
  EXPECT_TRUE(drawn.computed.empty());
}

TEST_F(CopcBuild, AttributesOfTheFilesAreKept) {
  PointCloud cloud = scan(3000);
  cloud.normals.assign(cloud.size(), {0, 0.6f, 0.8f});
  const auto input = write(cloud, "in.laz");
  copc::BuildOptions options;
  options.attributes = Attribute::normal | Attribute::uncertainty;
  const copc::BuildReport report = build({input}, options);
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("have normals, which are kept")));
  const PointCloud got = io::read(path("out.copc.laz")).cloud;
  for (const vec3& normal : got.normals) ASSERT_EQ(normal, vec3(0, 0.6f, 0.8f));
  EXPECT_TRUE(got.scalar(analysis::stored_uncertainty));
}

TEST(CopcSchema, ComputedFieldsStandBehindBytesThatNobodyDescribes) {
  for (const std::uint16_t undescribed : {0, 3, 300}) {
    copc::Schema schema;
    schema.record_length = schema.file_length = std::uint16_t(30 + undescribed);
    copc::Schema untouched = schema;
    copc::add_computed_fields(untouched, {});
    EXPECT_THAT(untouched.extra_bytes, IsEmpty());
    EXPECT_EQ(untouched.record_length, schema.record_length);

    copc::add_computed_fields(schema, Attribute::normal);
    io::las::Header header;
    header.format = schema.format, header.record_length = schema.record_length;
    header.vlrs.push_back({.user_id = "LASF_Spec", .record_id = 4, .data = schema.extra_bytes});
    std::vector<std::string> notes;
    const std::vector<io::las::Field> fields = io::las::extra_fields(header, notes);
    ASSERT_EQ(fields.size(), 3u + (undescribed <= 16 ? undescribed : 0u));
    const io::las::Field& nx = fields[fields.size() - 3];
    EXPECT_EQ(nx.name, "nx");
    EXPECT_EQ(nx.byte, 30 + undescribed);
    if (undescribed == 3) EXPECT_EQ(fields[1].name, "extra_2");
  }
}

// Black and white by turns: a coarse level without averages is as black and white as the points.
TEST_F(CopcBuild, CoarseLevelsHaveMeanColorsOnRequest) {
  PointCloud cloud = scan(300'000);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.colors[i] = i % 2 ? Rgba8{250, 250, 250, 255} : Rgba8{0, 0, 0, 255};
  const auto input = write(cloud, "in.laz");
  std::size_t gray[2] = {0, 0};
  for (const bool average : {false, true}) {
    copc::BuildOptions options;
    options.memory = little_memory;
    options.average_colors = average;
    build({input}, options);
    validated();
    const PointCloud got = io::read(path("out.copc.laz")).cloud;
    EXPECT_EQ(got.size(), cloud.size());
    for (const Rgba8& c : got.colors) gray[average] += c.r > 20 && c.r < 230;
  }
  EXPECT_EQ(gray[0], 0u);
  EXPECT_GT(gray[1], 5000u);
}

TEST_F(CopcBuild, PutsFilesOfDifferentKindsTogether) {
  PointCloud first = scan(3000, 7), second = scan(2000, 3, 100, 6);
  second.scalars.back().name = "roughness";
  second.las->offset = {500123, 4100000, 0};  // another offset, the same steps
  PointCloud third = scan(1000, 1, 200, 7);
  third.colors.clear();
  third.las.reset();
  third.scalars.clear();
  const copc::BuildReport report =
      build({write(first, "a.laz"), write(second, "b.las"), write(third, "c.ply")});
  EXPECT_EQ(report.points, 6000u);
  validated();
  const io::ReadResult result = io::read(path("out.copc.laz"));
  EXPECT_THAT(attribute_names(result),
              testing::IsSupersetOf({"echo_width", "roughness", "red", "gps_time", "intensity"}));
  const ScalarField& roughness = *result.cloud.scalar("roughness");
  const ScalarField& width = *result.cloud.scalar("echo_width");
  std::size_t of_first = 0, of_second = 0;
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    of_first += std::isfinite(width.value(i));
    of_second += std::isfinite(roughness.value(i));
  }
  EXPECT_EQ(of_first, 3000u);
  EXPECT_EQ(of_second, 2000u);
  const Bounds box = bounds(result.cloud);
  EXPECT_NEAR(box.max.x, 500300, 1);
  EXPECT_NEAR(box.min.x, 500000, 1);
}

TEST_F(CopcBuild, TheSamePointsGiveTheSameBytes) {
  const auto input = write(scan(150'000), "in.laz");
  copc::BuildOptions options;
  build({input}, options);
  const test::Bytes first = test::load(path("out.copc.laz"));
  const unsigned before = thread_count();
  set_thread_count(1);
  build({input}, options);
  set_thread_count(before);
  EXPECT_TRUE(first == test::load(path("out.copc.laz")));
  // Neither does the order of the file matter, when its box is the same.
  PointCloud cloud = io::read(input).cloud;
  std::vector<std::uint32_t> order(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::uint32_t(i);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  build({write(select(cloud, order), "shuffled.laz")}, options);
  EXPECT_TRUE(first == test::load(path("out.copc.laz")));
}

TEST(CopcSample, PartsMergeToTheSampleOfTheWhole) {
  std::mt19937 random(3);
  std::vector<std::array<std::uint8_t, 9>> records(300'000);
  for (auto& record : records)
    for (std::uint8_t& byte : record) byte = std::uint8_t(random());
  std::copy_n(records.begin(), 50'000, records.end() - 50'000);  // some are there twice
  copc::RecordSample whole;
  for (const auto& record : records) whole.add(record);
  std::vector<copc::RecordSample> parts(7);
  for (std::size_t i = records.size(); i-- > 0;) parts[i % 2 ? 0 : random() % 7].add(records[i]);
  copc::RecordSample merged;
  for (const copc::RecordSample& part : parts) merged.add(part);
  const std::vector<std::uint8_t> expected = whole.first(copc::RecordSample::most);
  EXPECT_EQ(expected.size(), 9 * copc::RecordSample::most);
  EXPECT_TRUE(merged.first(copc::RecordSample::most) == expected);
  EXPECT_TRUE(merged.first(1000) == std::vector(expected.begin(), expected.begin() + 9000));
  EXPECT_EQ(copc::RecordSample().first(10).size(), 0u);
}

TEST_F(CopcBuild, StoresASampleOfAllPoints) {
  const PointCloud cloud = scan(300'000);
  const auto input = write(cloud, "in.laz");
  const auto sample = [&](std::uint64_t memory) {
    copc::BuildOptions options;
    options.memory = memory;
    build({input}, options);
    validated();
    const auto read = copc::read_sample(copc::read_tree(path("out.copc.laz")));
    EXPECT_TRUE(read);
    return read ? read->cloud : PointCloud();
  };
  const PointCloud few = sample(little_memory);
  EXPECT_TRUE(rows(few) == rows(sample(copc::BuildOptions().memory))) << "in pieces or not";
  ASSERT_EQ(few.size(), copc::RecordSample::size_for(cloud.size()));
  // Times tell points apart.
  const ScalarField *time = few.scalar("gps_time"), *intensity = few.scalar("intensity");
  ASSERT_TRUE(time && intensity);
  std::vector<bool> seen(cloud.size());
  std::size_t walls = 0;
  for (std::size_t i = 0; i < few.size(); ++i) {
    const auto number = std::size_t(std::lround((time->value(i) - 1000) / 0.125));
    ASSERT_LT(number, cloud.size());
    EXPECT_FALSE(seen[number]);
    seen[number] = true;
    EXPECT_EQ(intensity->value(i), cloud.scalar("intensity")->value(number));
    EXPECT_LT(glm::distance(few.world(i), cloud.world(number)), 0.002);
    walls += number % 4 == 0;
  }
  // By their number, and not by their place: five standard deviations.
  EXPECT_NEAR(double(walls) / double(few.size()), 0.25, 5 * std::sqrt(0.25 * 0.75 / double(few.size())));
  // Of few points the levels say as much.
  build({write(scan(20'000), "small.laz")});
  EXPECT_FALSE(copc::read_tree(path("out.copc.laz")).sample);
}

TEST_F(CopcBuild, ADamagedSampleIsNone) {
  build({write(scan(200'000), "in.laz")});
  const test::Bytes good = test::load(path("out.copc.laz"));
  const auto read = [&](const test::Bytes& bytes) {
    const auto file = test::save(bytes, "damaged.copc.laz");
    const copc::Tree tree = copc::read_tree(file);
    const bool has_sample = copc::read_sample(tree).has_value();
    EXPECT_EQ(tree.points, 200'000u);
    EXPECT_EQ(io::read(file).cloud.size(), 200'000u) << "the points are there without it";
    std::filesystem::remove(file);
    return has_sample;
  };
  EXPECT_TRUE(read(good));
  const auto sample = *copc::read_tree(path("out.copc.laz")).sample;
  const auto with = [&](std::size_t at, auto value) {
    test::Bytes bytes = good;
    test::put(bytes, at, value);
    return bytes;
  };
  const std::size_t payload = sample.byte - copc::sample_head,
                    layers = sample.byte + test::get<std::uint16_t>(good, 105) + 4;
  ASSERT_EQ(test::get<std::uint32_t>(good, payload), copc::sample_version);
  EXPECT_FALSE(read(with(payload, copc::sample_version + 1))) << "of a later version";
  for (const std::uint32_t count : {0u, sample.count - 1, sample.count + 1, 0xFFFFFFFFu})
    EXPECT_FALSE(read(with(payload + 4, count))) << count;
  for (const std::uint64_t size : {std::uint64_t(0), std::uint64_t(20), ~std::uint64_t(0)})
    EXPECT_FALSE(read(with(payload - 40, size))) << size;
  EXPECT_FALSE(read(with(layers, 0x7F7F7F7Fu)));
  for (const std::size_t left : {payload - 60, payload + 3, payload + 50, good.size() - 1})
    EXPECT_FALSE(read(test::Bytes(good.begin(), good.begin() + std::ptrdiff_t(left)))) << left;
  // Numbers of any kind are never fatal.
  std::mt19937 random(11);
  for (int round = 0; round < 20; ++round) {
    test::Bytes bytes = good;
    for (int k = 0; k < 8; ++k)
      bytes[payload + (round % 2 ? random() % 200 : random() % (good.size() - payload))] =
          std::uint8_t(random());
    copc::read_sample(copc::read_tree(test::save(bytes, "damaged.copc.laz")));
  }
  std::filesystem::remove(test::temporary("damaged.copc.laz"));
}

TEST_F(CopcBuild, CutsABoxAndANumberWhileReading) {
  const PointCloud cloud = scan(100'000);
  const auto input = write(cloud, "in.laz");
  copc::BuildOptions options;
  options.box = Bounds{{500015, 4100010, 0}, {500055, 4100050, 200}};
  const copc::BuildReport in_box = build({input}, options);
  std::size_t expected = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 p = cloud.world(i);
    expected += p.x >= 500015 && p.x <= 500055 && p.y >= 4100010 && p.y <= 4100050;
  }
  EXPECT_NEAR(double(in_box.points), double(expected), 2);  // floats of this side on the border
  EXPECT_EQ(in_box.points_read, 100'000u);
  const CopcFile file = validated();
  EXPECT_LE(2 * file.half_size, 40.1);  // the cube is the box's, not the file's

  options.max_points = 1000;
  EXPECT_EQ(build({input}, options).points, 1000u);
  validated();
  options.box.reset();
  EXPECT_EQ(build({input}, options).points, 1000u);
  validated();
  // The points that --max-points takes elsewhere.
  EXPECT_TRUE(rows(io::read(path("out.copc.laz")).cloud) == rows(subsample(io::read(input).cloud, 1000)));
  options.max_points = 1'000'000;
  EXPECT_EQ(build({input}, options).points, 100'000u);

  options.box = Bounds{{0, 0, 0}, {1, 1, 1}};
  std::filesystem::remove(path("out.copc.laz"));
  EXPECT_THAT(error_of({input}, options), HasSubstr("no point lies in --box"));
}

TEST_F(CopcBuild, TakesOnePointEqualPointsAndPointsFarOff) {
  PointCloud one = scan(1);
  EXPECT_EQ(build({write(one, "one.laz")}).nodes, 1u);
  EXPECT_GT(validated().spacing, 0);

  // More equal points than a leaf holds otherwise.
  PointCloud equal = scan(200'000);
  for (vec3& p : equal.positions) p = {1, 2, 3};
  EXPECT_EQ(build({write(equal, "equal.laz")}).points, 200'000u);
  validated();

  // One point a million kilometres off: as far as 32 bits of steps reach.
  PointCloud far = scan(300'000);
  far.las->scale = dvec3(0.5);
  far.las->offset = far.origin;
  far.positions.back() = {1e9f, -1e9f, 1e9f};
  copc::BuildOptions options;
  options.memory = little_memory;
  const copc::BuildReport report = build({write(far, "far.las")}, options);
  EXPECT_EQ(report.points, 300'000u);
  const CopcFile file = validated();
  EXPECT_LT(file.nodes.size(), 200u);
}

TEST_F(CopcBuild, KeepsNodesSmallWherePointsFillSpace) {
  PointCloud cloud = scan(500'000);
  std::mt19937 random(9);
  for (vec3& p : cloud.positions)
    p = {float(random() % 100000) * 0.001f, float(random() % 100000) * 0.001f,
         float(random() % 100000) * 0.001f};
  build({write(cloud, "full.las")});
  const CopcFile file = validated();
  std::array<std::size_t, 8> octants{};  // of the root's points
  for (const test::CopcNode& node : file.nodes) {
    EXPECT_LE(node.count, 131072);
    if (node.key[0] > 0) continue;
    EXPECT_EQ(node.count, 131072);
    for (std::size_t i = node.first; i < node.first + std::size_t(node.count); ++i)
      ++octants[std::size_t((file.places[i][0] > file.center[0]) + 2 * (file.places[i][1] > file.center[1]) +
                            4 * (file.places[i][2] > file.center[2]))];
  }
  // Even: 16384 expected in each, with a standard deviation of about 120.
  for (std::size_t n : octants) EXPECT_NEAR(double(n), 16384, 700);
}

TEST_F(CopcBuild, RefusesEmptyAndDamagedFiles) {
  PointCloud none = scan(0);
  EXPECT_THAT(error_of({write(none, "none.laz")}), HasSubstr("there is no point in it"));
  test::Bytes bytes = test::load(write(scan(50'000), "good.laz"));
  const auto cut =
      test::save(test::Bytes(bytes.begin(), bytes.begin() + std::ptrdiff_t(bytes.size() / 2)), "cut.laz");
  EXPECT_NE(error_of({cut}), "no error");
  std::filesystem::remove(cut);
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 64; ++i) bytes[i] ^= 0x5A;
  const auto flipped = test::save(bytes, "flipped.laz");
  // Damage inside the compressed numbers may go unseen; then the file is valid all the same.
  if (error_of({flipped}) == "no error") validated();
  std::filesystem::remove(flipped);
  EXPECT_THAT(error_of({path("absent.laz")}), HasSubstr("absent.laz"));
  EXPECT_EQ(names().size(), std::filesystem::exists(path("out.copc.laz")) ? 3u : 2u);
}

TEST_F(CopcBuild, FindsThePointsThatAHeaderMisplaces) {
  test::Bytes bytes = test::load(write(scan(20'000), "good.las"));
  for (std::size_t k = 0; k < 6; ++k) test::put<double>(bytes, 179 + 8 * k, 0);  // max x, min x, ...
  const auto lying = test::save(bytes, "lying.las");
  const copc::BuildReport report = build({lying});
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("outside the box that its header names")));
  EXPECT_EQ(report.points, 20'000u);
  const CopcFile file = validated();
  EXPECT_LT(2 * file.half_size, 101);
  std::filesystem::remove(lying);
}

TEST_F(CopcBuild, LeavesAnOlderFileAloneWhenItIsInterrupted) {
  class Impatient final : public Progress {
   public:
    explicit Impatient(int after) : left_(after) {}
    void update(double, std::string_view) override {}
    bool cancelled() const override { return --left_ < 0; }

   private:
    mutable std::atomic<int> left_;
  };
  const auto input = write(scan(300'000), "in.laz");
  std::ofstream(path("out.copc.laz")) << "older";
  copc::BuildOptions options;
  options.memory = little_memory;
  for (const int after : {0, 3, 10, 20, 40}) {
    Impatient impatient(after);
    EXPECT_THROW(copc::build({input}, path("out.copc.laz"), options, impatient), Cancelled) << after;
    EXPECT_EQ(test::load(path("out.copc.laz")), (test::Bytes{'o', 'l', 'd', 'e', 'r'}));
    EXPECT_EQ(names().size(), 2u);
  }
}

TEST_F(CopcBuild, SaysWhatAFullDiskLacks) {
  const auto input =
      write(scan(300'000), "in.las");  // the memory that LAZ is decoded through would feel the limit, too
  copc::BuildOptions options;
  options.memory = little_memory;
  // A limit on the size of files stands for the full disk.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{4 << 20, before.rlim_max};
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string text = error_of({input}, options);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  EXPECT_THAT(text, testing::AllOf(HasSubstr("out.copc.laz: cannot keep points beside it"),
                                   HasSubstr("write to another disk")));
  EXPECT_EQ(names().size(), 1u);
}

TEST_F(CopcBuild, LargeHierarchiesHavePages) {
  // A point in the middle of each node of five levels, and a branch without points of its own.
  copc::Schema schema;
  const copc::Cube cube = copc::Cube::around({{0, 0, 0}, {64, 64, 64}}, schema.scale);
  copc::FileWriter writer(path("out.copc.laz"), schema);
  copc::Summary summary;
  std::size_t nodes = 0;
  const auto add = [&](const copc::Key& key) {
    std::vector<std::uint8_t> record(schema.record_length);
    const double size = std::ldexp(cube.size, -key.level);
    const std::uint32_t place[3] = {key.x, key.y, key.z};
    for (int axis = 0; axis < 3; ++axis) {
      const auto steps =
          std::int32_t(std::lround((cube.min[axis] + (place[axis] + 0.5) * size) / schema.scale[axis]));
      std::memcpy(record.data() + 4 * axis, &steps, sizeof steps);
    }
    record[14] = 0x11;
    summary.add(record);
    writer.append({key, 1, io::las::encode_chunk(6, schema.record_length, record)});
    ++nodes;
  };
  for (int level = 0; level < 5; ++level)
    for (std::uint32_t i = 0; i < 1u << 3 * level; ++i) {
      const std::uint32_t side = 1u << level;
      add({level, i % side, i / side % side, i / side / side});
    }
  add({9, 511, 0, 0});
  writer.finish(cube, summary);
  const CopcFile file(path("out.copc.laz"));
  EXPECT_THAT(file.faults, IsEmpty());
  EXPECT_EQ(file.nodes.size(), nodes);
  EXPECT_GT(file.pages, 1);
  EXPECT_EQ(io::read(path("out.copc.laz")).cloud.size(), nodes);
  EXPECT_EQ(copc::read_tree(path("out.copc.laz")).nodes.size(), nodes);
}

class CopcRealScan : public CopcBuild, public testing::WithParamInterface<const char*> {};

TEST_P(CopcRealScan, KeepsItsPoints) {
  SFUMATO_NEEDS_REAL_SCAN(GetParam());
  const auto input = test::data_folder() / GetParam();
  copc::BuildOptions options;
  options.memory = little_memory;
  build({input}, options);
  CopcFile file = validated();
  const io::ReadResult before = io::read(input), after = io::read(path("out.copc.laz"));
  if (before.cloud.las->point_format >= 6) {
    std::vector<test::RawPoint> expected = test::raw_points(input);
    std::sort(expected.begin(), expected.end());
    std::sort(file.points.begin(), file.points.end());
    EXPECT_TRUE(expected == file.points);
  }
  // Of a file that says it twice, WKT is kept: it goes with point formats 6 to 8.
  if (before.report.crs.starts_with("EPSG:") && after.report.crs != before.report.crs)
    EXPECT_THAT(after.report.crs,
                HasSubstr("AUTHORITY[\"EPSG\",\"" + before.report.crs.substr(5, 4) + "\"]"));
  else
    EXPECT_EQ(after.report.crs, before.report.crs);
  EXPECT_EQ(after.report.bounds_min, before.report.bounds_min);
  EXPECT_EQ(after.report.bounds_max, before.report.bounds_max);
  for (const io::AttributeStats& a : before.report.attributes) {
    const auto& all = after.report.attributes;
    const auto b =
        std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == a.name; });
    ASSERT_NE(b, all.end()) << a.name;
    // Whole degrees become steps of 0.006 in formats 6 to 10.
    const double step = a.name == "scan_angle" && before.cloud.las->point_format < 6 ? 0.003 : 0;
    EXPECT_NEAR(b->min, a.min, step + 1e-12 * std::abs(a.min)) << a.name;
    EXPECT_NEAR(b->max, a.max, step + 1e-12 * std::abs(a.max)) << a.name;
    EXPECT_NEAR(b->mean, a.mean, step + 1e-9 * std::abs(a.mean)) << a.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Copc, CopcRealScan,
                         testing::Values("autzen_trim.las", "lion_takanawa.copc.laz", "bcts_3.laz",
                                         "indoor.laz", "las_with_several_extra_byte_bloc.laz"),
                         [](const auto& scan) {
                           std::string name = scan.param;
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return c == '.' || c == '-'; }, '_');
                           return name;
                         });

// The validator itself: a file of others is fine by it, and it sees what is wrong.
TEST(CopcValidator, FindsNothingInAFileOfOthersAndFaultsInDamage) {
  SFUMATO_NEEDS_REAL_SCAN("lion_takanawa.copc.laz");
  const auto lion = test::data_folder() / "lion_takanawa.copc.laz";
  const CopcFile file(lion, 0.005);  // half of its step
  EXPECT_THAT(file.faults, IsEmpty());
  EXPECT_EQ(file.points.size(), 341'989u);
  const test::Bytes good = test::load(lion);
  const auto page = test::get<std::uint64_t>(good, 469);
  const auto faults_with = [&](std::size_t at, std::uint32_t value) {
    test::Bytes bytes = good;
    test::put(bytes, at, value);
    const auto damaged = test::save(bytes, "damaged.copc.laz");
    const std::vector<std::string> faults = CopcFile(damaged, 0.005).faults;
    std::filesystem::remove(damaged);
    return faults;
  };
  EXPECT_THAT(faults_with(page + 28, 7), testing::Contains(HasSubstr("the header says")));
  EXPECT_THAT(faults_with(page, 1), testing::Not(IsEmpty()));           // the root on another level
  EXPECT_THAT(faults_with(page + 32 + 4, 2), testing::Not(IsEmpty()));  // a node beside its level
  EXPECT_THAT(faults_with(477, 33), testing::Not(IsEmpty()));           // a page of an odd size
}

}  // namespace
