// Parts of files: together they are the whole, and what holds for a file holds for each of them.
#include <gtest/gtest.h>

#include <fstream>

#include "io/format.h"
#include "unit/io/files.h"
#include "unit/io/las_bytes.h"
#include "unit/io/parts.h"

namespace sfumato::test {
namespace {

constexpr std::size_t total = 300'000;
static_assert(total > io::least_cut_points, "else files are read whole");

/// Of 16-bit colours, which are dark in the second half, where some attributes are nothing but zeros too.
PointCloud scan_with_a_dark_half() {
  PointCloud cloud;
  cloud.origin = {500000, 4100000, 100};
  cloud.las.emplace();
  cloud.las->scale = dvec3(0.001);
  cloud.las->offset = {500000, 4100000, 0};
  cloud.las->point_format = 7;
  ScalarField low{"rgb_low_bytes", 0, {}, StoredType::uint32},
      time{"gps_time", 300'000'000, {}, StoredType::float64}, user{"user_data", 0, {}, StoredType::uint8},
      extra{"echo_width", 0, {}, StoredType::float32};
  for (std::size_t i = 0; i < total; ++i) {
    const bool is_dark = i >= total / 2;
    cloud.positions.push_back({0.125f * float(i % 1000), 0.25f * float(i / 1000), 0.5f * float(i % 89)});
    cloud.colors.push_back(is_dark ? Rgba8{0, 0, 0, 255}
                                   : Rgba8{std::uint8_t(i), std::uint8_t(i >> 8), 7, 255});
    low.values.push_back(float((i % 251) << 16 | (i % 13) << 8 | 1));
    time.values.push_back(float(i) * 0.37f);
    user.values.push_back(is_dark ? 0.0f : float(i % 5));
    extra.values.push_back(is_dark ? 0.0f : float(i % 17));
  }
  cloud.scalars = {low, time, user, extra};
  return cloud;
}

const std::vector<std::uint64_t> numbers{1, 2, 3, 7};

TEST(Part, OfLasAreTheWhole) {
  const PointCloud cloud = scan_with_a_dark_half();
  for (const char* name : {"a.las", "a.laz"}) {
    io::write(temp_file(name), cloud);
    expect_parts_are_all(temp_file(name), numbers);
    io::ReadOptions some;
    some.max_points = 12'345;
    expect_parts_are_all(temp_file(name), numbers, some);
  }
}

// One that decides alone takes the dark half for 8-bit colours, and leaves out attributes.
TEST(Part, DecidesNothingThatHoldsForTheFile) {
  const PointCloud cloud = scan_with_a_dark_half();
  for (const char* name : {"a.las", "a.laz"}) {
    SCOPED_TRACE(name);
    io::write(temp_file(name), cloud);
    const PointCloud dark = parts_of(temp_file(name), 2)[1].cloud;
    EXPECT_EQ(dark.las->color_bits, 16);
    EXPECT_EQ(dark.colors.back(), (Rgba8{0, 0, 0, 255}));
    EXPECT_TRUE(dark.scalar("user_data"));
    EXPECT_TRUE(dark.scalar("echo_width"));
    EXPECT_EQ(dark.origin, io::read(temp_file(name)).cloud.origin);
    EXPECT_EQ(dark.scalar("gps_time")->offset, io::read(temp_file(name)).cloud.scalar("gps_time")->offset);
  }
}

// Its own records are all that it counts, and the other chunks are not decoded.
TEST(Part, DoesNotSeeDamageOfOthers) {
  io::write(temp_file("a.laz"), scan_with_a_dark_half());
  Bytes bytes = load(temp_file("a.laz"));
  for (std::size_t i = 0; i < 2000; ++i)
    bytes[bytes.size() / 12 + i] = std::uint8_t(i * 37);  // of six chunks
  std::ofstream(temp_file("damaged.laz"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  const std::vector<io::ReadResult> parts = parts_of(temp_file("damaged.laz"), 3);
  EXPECT_EQ(parts[0].report.damage.size(), 1u);
  EXPECT_EQ(parts[0].cloud.size() + parts[0].report.points_missing, total / 3);
  for (const std::size_t k : {1, 2}) {
    EXPECT_TRUE(parts[k].report.damage.empty());
    EXPECT_EQ(parts[k].cloud.size(), total / 3);
    EXPECT_EQ(parts[k].report.points, total / 3);
  }
}

TEST(Part, OfSmallFilesAndOtherFormatsAreCutFromTheWhole) {
  PointCloud cloud;
  for (std::size_t i = 0; i < 10; ++i) {
    cloud.positions.push_back({float(i), float(i % 3), 1});
    cloud.colors.push_back({std::uint8_t(i), 2, 3, 255});
  }
  for (const char* name : {"a.las", "a.laz", "a.ply", "a.pcd", "a.csv", "a.npy"}) {
    io::write(temp_file(name), cloud);
    expect_parts_are_all(temp_file(name), {1, 2, 3, 7, 23});
    io::ReadOptions some;
    some.max_points = 4;
    expect_parts_are_all(temp_file(name), {1, 2, 3, 7, 23}, some);
  }
}

// More parts than chunks: some are empty.
TEST(Part, OfMorePartsThanThereIsToCut) {
  io::write(temp_file("a.laz"), scan_with_a_dark_half());
  expect_parts_are_all(temp_file("a.laz"), {23});
}

/// Entwine Point Tiles as they are written: a root and its eight children, x, y, z as whole numbers of
/// millimetres, 16-bit colours that are dark in the last three, and a time.
std::filesystem::path entwine_point_tiles(const std::string& name) {
  const std::filesystem::path folder = temp_file(name);
  std::filesystem::create_directories(folder / "ept-hierarchy");
  std::filesystem::create_directories(folder / "ept-data");
  std::ofstream(folder / "ept.json") << R"({"bounds": [0, 0, 0, 128, 128, 128],
    "boundsConforming": [0, 0, 0, 128, 128, 128], "dataType": "binary", "hierarchyType": "json", "points": 306000,
    "span": 128, "version": "1.0.0", "schema": [
      {"name": "X", "type": "signed", "size": 4, "scale": 0.001, "offset": 0},
      {"name": "Y", "type": "signed", "size": 4, "scale": 0.001, "offset": 0},
      {"name": "Z", "type": "signed", "size": 4, "scale": 0.001, "offset": 0},
      {"name": "Red", "type": "unsigned", "size": 2}, {"name": "Green", "type": "unsigned", "size": 2},
      {"name": "Blue", "type": "unsigned", "size": 2}, {"name": "GpsTime", "type": "float", "size": 8}]})";
  std::string hierarchy;
  for (int tile = 0; tile < 9; ++tile) {
    const int octant = tile - 1;
    const std::string key = tile == 0
                                ? "0-0-0-0"
                                : "1-" + std::to_string(octant & 1) + "-" + std::to_string(octant >> 1 & 1) +
                                      "-" + std::to_string(octant >> 2);
    constexpr int points = 34'000;
    hierarchy += (hierarchy.empty() ? "{\"" : ", \"") + key + "\": " + std::to_string(points);
    std::string records;
    for (int i = 0; i < points; ++i) {
      // The root has points everywhere, in every colour.
      const bool is_dark = tile > 5;
      const int half = tile == 0 ? 0 : 64'000, room = tile == 0 ? 128'000 : 64'000;
      const auto within = [&](int axis, int step) {
        return std::int32_t((octant >> axis & 1 && tile > 0 ? half : 0) + i * step % room);
      };
      records += bytes_of(within(0, 7), within(1, 131), within(2, 1013));
      const auto channel = [&](int step) { return std::uint16_t(i * step % (is_dark ? 256 : 65536)); };
      records += bytes_of(channel(3), channel(5), channel(1), 3e8 + 0.001 * (i + tile * points));
    }
    std::ofstream(folder / "ept-data" / (key + ".bin"), std::ios::binary) << records;
  }
  std::ofstream(folder / "ept-hierarchy" / "0-0-0-0.json") << hierarchy << "}";
  return folder / "ept.json";
}

TEST(Part, OfTilesAreTheWhole) {
  const std::filesystem::path file = entwine_point_tiles("tiles");
  std::vector<std::vector<double>> places;
  const PointCloud whole = io::read(file).cloud;
  ASSERT_EQ(whole.size(), 306'000u);
  for (const std::uint64_t count : {2, 3, 7, 23}) {
    std::size_t at = 0;
    for (const io::ReadResult& part : parts_of(file, count))
      for (std::size_t i = 0; i < part.cloud.size(); ++i, ++at) {
        ASSERT_EQ(part.cloud.world(i), whole.world(at)) << at;
        ASSERT_EQ(part.cloud.colors[i], whole.colors[at]) << at;
        // The middle of the numbers, which one float is told from, is that of the root.
        ASSERT_NEAR(part.cloud.scalars[0].value(i), whole.scalars[0].value(at), 1e-4) << at;
      }
    ASSERT_EQ(at, whole.size());
  }
  io::ReadOptions some;
  some.max_points = 100'000;
  std::size_t points = 0;
  for (const io::ReadResult& part : parts_of(file, 3, some)) points += part.cloud.size();
  EXPECT_EQ(points, 100'000u);
}

}  // namespace
}  // namespace sfumato::test
