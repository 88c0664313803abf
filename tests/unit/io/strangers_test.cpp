// Files as people send them: what was reported wrong once, read right. The files themselves are read where
// they are
// (../shared/data/strangers); those of the same kinds are made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "unit/io/files.h"
#include "unit/io/las_bytes.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::write_file;
using ::testing::HasSubstr;

/// The file of that name, or nothing, and the test is skipped.
std::optional<std::filesystem::path> stranger(const std::string& name) {
  const std::filesystem::path file = test::data_folder() / "strangers" / name;
  if (std::filesystem::exists(file)) return file;
  return std::nullopt;
}

#define READ_STRANGER(result, name)                                    \
  const auto file_of_stranger = stranger(name);                        \
  if (!file_of_stranger) GTEST_SKIP() << "no file strangers/" << name; \
  const io::ReadResult result = io::read(*file_of_stranger)

void expect_box(const io::ReadResult& read, const dvec3& low, const dvec3& high, double within) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(read.report.bounds_min[k], low[k], within) << "xyz"[k];
    EXPECT_NEAR(read.report.bounds_max[k], high[k], within) << "xyz"[k];
  }
}

std::string notes_of(const io::ReadResult& read) {
  std::string all;
  for (const std::string& note : read.report.notes) all += note + "\n";
  return all;
}

io::ReadResult read_text(const std::string& bytes, const std::string& name = "a.txt") {
  return io::read(write_file(name, bytes));
}

TEST(Strangers, ColmapPointsByTheirComment) {
  READ_STRANGER(read, "01_points3D.txt");
  EXPECT_EQ(read.report.points, 900u);
  expect_box(read, {-10, -4.4, -6}, {10, 1.61, 6}, 0.2);
  EXPECT_EQ(read.cloud.colors.at(0), (Rgba8{150, 120, 80, 255}));
}

TEST(Strangers, FiveFloatsOfNuscenes) {
  READ_STRANGER(read, "02_frame__LIDAR_TOP.pcd.bin");
  EXPECT_EQ(read.report.points, 900u);
  expect_box(read, {-10, -6, -1.8}, {10, 6, 4.2}, 0.2);
  EXPECT_TRUE(read.cloud.scalar("ring"));
}

TEST(Strangers, PlacesNamedAtTheEndOfTheRow) {
  READ_STRANGER(read, "06_xyz_named_points_m_last.csv");
  EXPECT_NEAR(read.report.bounds_min.x, -10, 0.2);
  EXPECT_NEAR(read.report.bounds_max.z, 4.2, 0.2);
  EXPECT_TRUE(read.cloud.scalar("laser_id") && read.cloud.scalar("azimuth") &&
              read.cloud.scalar("intensity"));
}

TEST(Strangers, AGridOfHeights) {
  READ_STRANGER(read, "07_grid.asc");
  EXPECT_EQ(read.cloud.size(), 945u);
  expect_box(read, {389120.25, 5819300.25, 34}, {389139.75, 5819311.75, 39.4}, 0.1);
}

TEST(Strangers, ALabelBehindTheColours) {
  READ_STRANGER(read, "09_xyzrgb_label.txt");
  EXPECT_EQ(read.cloud.colors.at(0), (Rgba8{150, 120, 80, 255}));
  EXPECT_EQ(read.cloud.scalar("label")->value(0), 2);
}

TEST(Strangers, NumbersOfPointsAndWordsBehindThem) {
  for (const char* name : {"10_number_north_east_height.txt", "10_number_north_east_height_code.txt"}) {
    READ_STRANGER(read, name);
    EXPECT_EQ(read.report.points, 900u);
    EXPECT_NEAR(read.report.bounds_min.x, 389120, 0.5) << name;
    EXPECT_NEAR(read.report.bounds_min.y, 5819300, 0.5) << name;
    io::ReadOptions named;
    named.columns = {"_", "y", "x", "z"};
    EXPECT_EQ(io::read(*stranger(name), named).report.points, 900u) << name;
  }
}

TEST(Strangers, NoDataIsNoValue) {
  READ_STRANGER(read, "03_reflectance_nodata_u16.las");
  const ScalarField* field = read.cloud.scalar("Reflectance");
  ASSERT_TRUE(field);
  EXPECT_EQ(std::count_if(field->values.begin(), field->values.end(), [](float v) { return std::isnan(v); }),
            150);
  const auto& stats = read.report.attributes.back();
  EXPECT_GE(stats.min, -18.1);
  EXPECT_LE(stats.max, -11.9);
}

TEST(Strangers, AScanWithoutColoursHasNone) {
  READ_STRANGER(read, "04_one_scan_without_colours.e57");
  std::size_t absent = 0;
  for (std::size_t i = 0; i < read.cloud.size(); ++i) {
    const bool is_absent = read.cloud.colors.at(i) == no_color;
    absent += is_absent;
    EXPECT_FALSE(read.cloud.colors[i] == (Rgba8{0, 0, 0, 255}));
  }
  EXPECT_TRUE(absent > 300 && absent < 600) << absent;
  EXPECT_THAT(notes_of(read), HasSubstr("no colour"));
}

TEST(Strangers, OneOddValueDecidesNothing) {
  READ_STRANGER(read, "08_rgb8_one_256.las");
  int brightest = 0, ordinary = 0;
  for (const Rgba8& c : read.cloud.colors) brightest = std::max(brightest, int(c.r)), ordinary += c.r >= 40;
  EXPECT_EQ(brightest, 255);
  EXPECT_EQ(ordinary, 900);
  EXPECT_THAT(notes_of(read), HasSubstr("beyond 255"));
}

TEST(Strangers, SplatsOfHardlyAnyOpacityAreLeftOut) {
  READ_STRANGER(read, "13_splats_fog.ply");
  EXPECT_EQ(read.cloud.size(), 900u);
  EXPECT_THAT(notes_of(read), HasSubstr("300"));
}

TEST(Strangers, NothingReturnsFromTheScannerItself) {
  READ_STRANGER(read, "17_zeros_at_the_scanner.e57");
  EXPECT_EQ(read.cloud.size(), 900u);
  EXPECT_THAT(notes_of(read), HasSubstr("450 records"));
}

std::string ply_of(const std::string& lines) {
  return "ply\nformat ascii 1.0\nelement vertex " +
         std::to_string(std::count(lines.begin(), lines.end(), '\n')) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nend_header\n" +
         lines;
}

TEST(Strangers, AxesOfCamerasAreNoPoints) {
  std::string points = "5 5 5 255 0 0\n6 6 6 10 20 30\n7 7 7 40 50 60\n", axes;
  for (const int camera : {0, 1})
    for (const auto& [way, color] :
         {std::pair(vec3(1, 0, 0), "255 0 0"), {vec3(0, 1, 0), "0 255 0"}, {vec3(0, 0, 1), "0 0 255"}})
      for (int k = 0; k < 10; ++k) {
        const vec3 p = vec3(float(camera), 2, 3) + 0.1f * float(k) * way;
        axes +=
            std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + " " + color + "\n";
      }
  const std::string seen = points.substr(points.find('\n') + 1);
  const io::ReadResult read = io::read(write_file("axes.ply", ply_of(seen + axes)));
  EXPECT_EQ(read.cloud.size(), 2u);
  EXPECT_THAT(notes_of(read), HasSubstr("the axes of 2 cameras, 60 points, are left out"));
  expect_box(read, {6, 6, 6}, {7, 7, 7}, 0);
  // A red point more, or axes that meet nowhere, and nobody knows.
  EXPECT_EQ(io::read(write_file("axes.ply", ply_of(points + axes))).cloud.size(), 63u);
  EXPECT_EQ(
      io::read(write_file("axes.ply", ply_of(seen + axes.substr(axes.find('\n') + 1) + "9 9 9 0 0 255\n")))
          .cloud.size(),
      62u);
}

TEST(Strangers, NextToNothingIsNothingToo) {
  std::string lines;
  for (int i = 0; i < 400; ++i) lines += std::to_string(0.001 * i) + " 0.2 0.5\n";
  for (int i = 0; i < 5; ++i) lines += "0 0 0\n";
  const std::string near = "0.001 0.002 0.003\n";
  EXPECT_EQ(read_text(lines + near).cloud.size(), 400u);
  // Where nothing else is nothing, or what is near is many, it stays.
  EXPECT_EQ(read_text(lines.substr(0, lines.find("0 0 0")) + near).cloud.size(), 401u);
  std::string many;
  for (int i = 0; i < 40; ++i) many += "0.001 0.002 " + std::to_string(0.0001 * i) + "\n";
  EXPECT_EQ(read_text(lines + many).cloud.size(), 440u);
}

/// A LAS file of point format 2 with these colours.
std::filesystem::path colored_las(const std::string& name, const std::vector<std::array<int, 3>>& colors,
                                  int east = 0) {
  test::LasFile file;
  file.format = 2, file.record_length = 26;
  file.records.resize(26 * colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    test::put<std::int32_t>(file.records, 26 * i, east + int(i));
    test::put<std::int32_t>(file.records, 26 * i + 4, int(i * i % 97));
    file.records[26 * i + 14] = 9;
    for (std::size_t k = 0; k < 3; ++k)
      test::put<std::uint16_t>(file.records, 26 * i + 20 + 2 * k, std::uint16_t(colors[i][k]));
  }
  return test::save(file.bytes(), name);
}

std::vector<std::array<int, 3>> colors_of(int most, int points = 300) {
  std::vector<std::array<int, 3>> colors;
  for (int i = 0; i < points; ++i)
    colors.push_back({i * most / (points - 1), most / 2 + i % 3, most - i % 5});
  return colors;
}

TEST(StrangersKinds, EightTwelveAndSixteenBits) {
  for (const int bits : {8, 12, 16}) {
    const int most = (1 << bits) - 1;
    const io::ReadResult read = io::read(colored_las("a.las", colors_of(most)));
    for (std::size_t i = 0; i < 300; ++i)
      EXPECT_NEAR(read.cloud.colors[i].r, 255.0 * double(i) / 299, 1.01) << bits;
    // A few odd values change nothing for the others.
    std::vector<std::array<int, 3>> odd = colors_of(most);
    odd[7] = {most + 1 > 65535 ? 65535 : most + 1, 0, 0};
    EXPECT_NEAR(io::read(colored_las("b.las", odd)).cloud.colors[200].b, 255, 2) << bits;
    // And all of it is written as it was.
    const std::filesystem::path copy = test::temporary("copy.las");
    io::write(copy, read.cloud);
    const test::Bytes before = test::load(test::temporary("a.las")), after = test::load(copy);
    const std::size_t from = test::get<std::uint32_t>(before, 96), to = test::get<std::uint32_t>(after, 96);
    for (std::size_t i = 0; i < 300; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_EQ(test::get<std::uint16_t>(after, to + i * test::get<std::uint16_t>(after, 105) + 20 + 2 * k),
                  test::get<std::uint16_t>(before, from + 26 * i + 20 + 2 * k))
            << bits << " bits, point " << i;
  }
  // Dark, but made of 8 bits: 16.
  std::vector<std::array<int, 3>> dark;
  for (int i = 0; i < 300; ++i) dark.push_back({i % 12 * 257, 257, 514});
  EXPECT_EQ(io::read(colored_las("c.las", dark)).cloud.colors[11].r, 11);
}

// Every pair of files in both orders, through every format that is written: no colour changes by more than a
// step.
TEST(StrangersKinds, JoinsKeepTheColoursOfEach) {
  struct Part {
    const char* name;
    int most;  ///< 0: all black, which is none
  };
  const Part parts[] = {{"8", 255}, {"12", 4095}, {"16", 65535}, {"none", 0}};
  for (const Part& first : parts)
    for (const Part& second : parts) {
      if (first.most == 0 && second.most == 0) continue;
      std::filesystem::path files[2];
      const Part* own[2] = {&first, &second};
      for (int k = 0; k < 2; ++k)
        files[k] = colored_las(std::to_string(k) + ".las",
                               own[k]->most ? colors_of(own[k]->most) : std::vector<std::array<int, 3>>(300),
                               1000 * k);
      PointCloud joined = io::read(files[0]).cloud;
      append(joined, io::read(files[1]).cloud);
      for (const char* extension : {".las", ".laz", ".ply", ".pcd"}) {
        const std::filesystem::path out = test::temporary(std::string("joined") + extension);
        io::write(out, joined);
        const PointCloud back = io::read(out).cloud;
        ASSERT_EQ(back.size(), 600u);
        for (int k = 0; k < 2; ++k)
          for (std::size_t i = 0; i < 300; ++i) {
            const Rgba8 c = back.colors.at(std::size_t(300 * k) + i);
            const double expected = own[k]->most ? 255.0 * double(i) / 299 : 255;
            ASSERT_NEAR(c.r, expected, 1.01)
                << first.name << " + " << second.name << extension << " point " << i;
          }
      }
    }
}

TEST(StrangersKinds, NumbersThatStandForNoValue) {
  struct Kind {
    std::uint8_t type;
    std::size_t size;
    double no_data;
    double scale;
  };
  for (const Kind& kind : {Kind{1, 1, 255, 1}, Kind{3, 2, 65535, 0.01}, Kind{4, 2, -9999, 1},
                           Kind{6, 4, -9999, 0.001}, Kind{9, 4, -9999, 1}, Kind{10, 8, -9999, 1}}) {
    test::Bytes described = test::extra_field("value", kind.type, kind.scale != 1 ? 1 | 8 : 1, kind.scale);
    if (kind.type >= 9)
      test::put<double>(described, 40, kind.no_data);
    else
      test::put<std::int64_t>(described, 40, std::int64_t(kind.no_data));
    test::LasFile file;
    file.minor = 4;
    file.record_length = std::uint16_t(20 + kind.size);
    file.vlrs = {{"LASF_Spec", 4, described}};
    file.records.resize(3 * file.record_length);
    const double raw[3] = {10, kind.no_data, 20};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = i * file.record_length + 20;
      test::put<std::int32_t>(file.records, i * file.record_length, int(i));
      switch (kind.type) {
        case 1: test::put(file.records, at, std::uint8_t(raw[i])); break;
        case 3: test::put(file.records, at, std::uint16_t(raw[i])); break;
        case 4: test::put(file.records, at, std::int16_t(raw[i])); break;
        case 6: test::put(file.records, at, std::int32_t(raw[i])); break;
        case 9: test::put(file.records, at, float(raw[i])); break;
        default: test::put(file.records, at, raw[i]);
      }
    }
    const std::filesystem::path path = test::save(file.bytes(), "a.las"), copy = test::temporary("b.las");
    const io::ReadResult read = io::read(path);
    io::write(copy, read.cloud);
    for (const io::ReadResult& each : {read, io::read(copy)}) {
      EXPECT_TRUE(std::isnan(each.cloud.scalar("value")->values[1])) << int(kind.type);
      EXPECT_NEAR(each.cloud.scalar("value")->value(2), 20 * kind.scale, 1e-7) << int(kind.type);
      EXPECT_NEAR(each.report.attributes.back().max, 20 * kind.scale, 1e-9) << int(kind.type);
      EXPECT_NEAR(each.report.attributes.back().mean, 15 * kind.scale, 1e-9) << int(kind.type);
    }
  }
}

TEST(StrangersKinds, PartsOfPtxWithoutColours) {
  const std::string pose = "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (const char* without : {"1 2 3 0.5\n4 5 6 0.5\n", "1 2 3 0.5 0 0 0\n4 5 6 0.5 0 0 0\n"}) {
    const PointCloud cloud =
        read_text(pose + without + pose + "7 8 9 0.5 10 20 30\n1 1 1 0.5 0 0 0\n", "a.ptx").cloud;
    EXPECT_EQ(cloud.colors.at(0), no_color);
    EXPECT_EQ(cloud.colors.at(2), (Rgba8{10, 20, 30, 255}));
    EXPECT_EQ(cloud.colors.at(3), (Rgba8{0, 0, 0, 255}));  // black beside colours is black
  }
}

/// Three splats: solid, hardly there, and solid.
TEST(StrangersKinds, PackedSplats) {
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n";
  for (const char* name : {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z"})
    ply += std::string("property float ") + name + "\n";
  ply +=
      "element vertex 3\nproperty uint packed_position\nproperty uint packed_rotation\nproperty uint "
      "packed_scale\n"
      "property uint packed_color\nend_header\n";
  ply += test::bytes_of(-1.0f, -2.0f, -3.0f, 1.0f, 2.0f, 3.0f);
  const std::uint32_t high = 2047u << 21 | 1023u << 11 | 2047u;
  ply += test::bytes_of(0u, 0u, 0u, 0x0A141EFFu, 0u, 0u, 0u, 0x0A141E00u, high, 0u, 0u, 0x645A50FFu);
  const io::ReadResult read = io::read(write_file("a.compressed.ply", ply));
  ASSERT_EQ(read.cloud.size(), 2u);
  EXPECT_EQ(read.cloud.world(0), dvec3(-1, -2, -3));
  EXPECT_EQ(read.cloud.world(1), dvec3(1, 2, 3));
  EXPECT_EQ(read.cloud.colors.at(0), (Rgba8{10, 20, 30, 255}));
  std::string splats;
  for (int i = 0; i < 3; ++i) {
    splats += test::bytes_of(float(i), 2.0f, 3.0f, 0.1f, 0.1f, 0.1f);
    splats +=
        test::bytes_of(std::uint8_t(9), std::uint8_t(8), std::uint8_t(7), std::uint8_t(i == 1 ? 0 : 255), 0u);
  }
  const PointCloud cloud = io::read(write_file("a.splat", splats)).cloud;
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.world(1), dvec3(2, 2, 3));
  EXPECT_EQ(cloud.colors.at(0), (Rgba8{9, 8, 7, 255}));
  test::expect_cuts_are_safe("b.ply", ply, 3);
}

/// Two full buckets of two splats and one that holds one; `level` 0 keeps places as floats.
std::string ksplat(int level) {
  const std::vector<vec3> centers{{10, 0, 0}, {0, 20, 0}, {0, 0, -30}};
  std::string head = test::bytes_of(0u, 1u, 1u, 5u, 5u, std::uint32_t(level), 0.0f, 0.0f, 0.0f);
  head.resize(4096);
  std::string section = test::bytes_of(5u, 5u, 2u, 3u, 5.0f, 12u, 1000u, 0u, 2u, 1u, 0u);
  section.resize(1024);
  std::string data = test::bytes_of(1u);
  for (const vec3& center : centers) data += test::bytes_of(center.x, center.y, center.z);
  for (unsigned i = 0; i < 5; ++i) {
    const vec3 at = centers[i / 2] + vec3(float(i % 2), -1, 2);
    if (level == 0) {
      data += test::bytes_of(at.x, at.y, at.z) + std::string(28, '\0');
    } else {  // steps of 2.5 / 1000
      for (int axis = 0; axis < 3; ++axis)
        data += test::bytes_of(std::uint16_t(1000 + 400 * (at[axis] - centers[i / 2][axis])));
      data += std::string(14, '\0');
    }
    data += test::bytes_of(std::uint8_t(i), std::uint8_t(8), std::uint8_t(7), std::uint8_t(255));
  }
  return head + section + data;
}

TEST(StrangersKinds, SplatsInBuckets) {
  for (const int level : {0, 1, 2}) {
    const PointCloud cloud = io::read(write_file("a.ksplat", ksplat(level))).cloud;
    ASSERT_EQ(cloud.size(), 5u) << level;
    const dvec3 centers[] = {{10, 0, 0}, {0, 20, 0}, {0, 0, -30}};
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_LT(glm::distance(cloud.world(i), centers[i / 2] + dvec3(double(i % 2), -1, 2)), 1e-5) << level;
      EXPECT_EQ(cloud.colors.at(i), (Rgba8{std::uint8_t(i), 8, 7, 255})) << level;
    }
    // Half of a splat, of the buckets, of both heads.
    for (const std::size_t left :
         {ksplat(level).size() - 9, std::size_t(5130), std::size_t(4500), std::size_t(99)})
      EXPECT_THROW(io::read(write_file("b.ksplat", ksplat(level).substr(0, left))), Error) << left;
  }
  std::string too_many = ksplat(1);
  too_many[4096 + 8] = 1;  // buckets of one
  EXPECT_THROW(io::read(write_file("c.ksplat", too_many)), Error);
}

TEST(StrangersKinds, ModelsOfVisualSfm) {
  const std::string head =
      "NVM_V3 \n\n2\na b.jpg\t1474.5 0.1 0.2 -0.9 -0.1 0.5 0.5 -1.4 -0.002 0 \nb.jpg\t1480 1 0 0 0 1 2 3 0 "
      "0\n\n3\n";
  const std::string points =
      "1.5 -2 3.25 10 20 30 2 0 7 1.5 -2.5 1 8 0 0 \n-1 0 1e-1 0 255 3 3 0 1 2 3 1 2 3 4 1 5 6 7\n"
      "4 5 6 7 8 9 2 0 1 1 1 1 1 1 1\n";
  const io::ReadResult read = io::read(write_file("a.nvm", head + points + "\n0\n\n#the last model\n0\n"));
  const PointCloud& cloud = read.cloud;
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.world(0), dvec3(1.5, -2, 3.25));
  EXPECT_NEAR(cloud.world(1).z, 0.1, 1e-7);
  EXPECT_EQ(cloud.colors.at(1), (Rgba8{0, 255, 3, 255}));
  EXPECT_EQ(cloud.scalar("track_length")->value(1), 3);
  EXPECT_EQ(cloud.up, UpAxis::neg_y);
  const io::ReadResult cut = io::read(write_file("b.nvm", head + points.substr(0, points.size() - 20)));
  EXPECT_EQ(cut.cloud.size(), 2u);
  EXPECT_EQ(cut.report.points_missing, 1u);
  for (const std::string& damaged :
       {head, head.substr(0, 20), std::string("NVM_V3\n"), "NVM_V3\n0\n1\n1 2 z 1 2 3 4\n" + std::string()})
    EXPECT_THROW(io::read(write_file("c.nvm", damaged)), Error) << damaged;
}

TEST(StrangersKinds, SplatsOfSpz) {
  const std::vector<dvec3> places{{1.5, -2.25, 100}, {-0.5, 0, 0.75}, {8, -1024.25, 3}};
  for (const std::uint32_t version : {1u, 2u, 3u}) {
    std::string spz =
        "NGSP" + test::bytes_of(version, 3u, std::uint8_t(0), std::uint8_t(12), std::uint16_t(0));
    for (const dvec3& p : places)
      for (int axis = 0; axis < 3; ++axis)
        if (version == 1)
          spz += test::bytes_of(glm::packHalf1x16(float(p[axis])));
        else
          spz += test::bytes_of(std::int32_t(p[axis] * 4096)).substr(0, 3);
    spz += std::string("\xff\xc0\xff", 3);
    // Terms of 0, 1 and -1 in red, .5 in green, 1 in blue: channels of .5 and .282 times as much.
    for (const double term : {0.0, 1.0, -1.0})
      for (int channel = 0; channel < 3; ++channel)
        spz += char(std::lround(255 * (0.5 + 0.15 * (channel == 0 ? term : 0.5 * channel))));
    spz += std::string(3 * (version == 3 ? 7 : 6), '\0');
    const PointCloud cloud = io::read(write_file("a.spz", spz)).cloud;
    ASSERT_EQ(cloud.size(), 3u) << version;
    EXPECT_EQ(cloud.up, UpAxis::pos_y);
    constexpr double half_step = 0.5;  // of a half float from 1024 on
    const int reds[] = {128, 199, 56};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(glm::distance(cloud.world(i), places[i]), version == 1 ? half_step : 1e-6) << version;
      EXPECT_NEAR(cloud.colors.at(i).r, reds[i], 1) << version;
      EXPECT_NEAR(cloud.colors.at(i).g, 163, 1) << version;
      EXPECT_NEAR(cloud.colors.at(i).b, 199, 1) << version;
    }
    EXPECT_NEAR(cloud.scalar("opacity")->value(1), 192 / 255.0, 1e-6);
    for (const std::size_t left : {std::size_t(9), std::size_t(16 + 20)})
      EXPECT_THROW(io::read(write_file("b.spz", spz.substr(0, left))), Error) << version << ", " << left;
    spz[4] = 4;
    EXPECT_THROW(io::read(write_file("c.spz", spz)), Error) << "a later version";
  }
}

TEST(StrangersKinds, RecordsOfNothingAreLeftOut) {
  std::string points, grid;
  for (int i = 0; i < 40; ++i) points += i % 4 ? "0 0 0 7\n" : std::to_string(i) + ".5 2.5 3 7\n";
  EXPECT_EQ(read_text(points).cloud.size(), 10u);
  EXPECT_THAT(notes_of(read_text(points)), HasSubstr("30 records are 0 0 0"));
  EXPECT_EQ(read_text("0 0 0\n1 2 3\n4 5 6\n").cloud.size(), 3u);  // the origin may be a point
}

// Half of a file in the coordinates of a map.
TEST(StrangersKinds, WhatIsFarOffInOneDirectionIsKept) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-50, 50);
  std::string points;
  for (int i = 0; i < 5000; ++i) {
    const dvec3 at = i < 3000 ? dvec3(0) : dvec3(4e5, 5e6, 100);
    for (int k = 0; k < 3; ++k) points += std::to_string(at[k] + unit(random)) + (k < 2 ? " " : "\n");
  }
  const io::ReadResult read = io::read(test::write_file("mixed.xyz", points));
  EXPECT_EQ(read.cloud.size(), 5000u);
}

TEST(StrangersKinds, RangesOfNothingAreLeftOut) {
  // A lidar of 32 lines between two walls, below the sky.
  std::string walls, sky, ball;
  std::size_t returns = 0, others = 0;
  for (int i = 0; i < 32 * 900; ++i) {
    const double angle = 2 * M_PI * (i / 32) / 900, rise = 0.02 * (i % 32) - 0.4;
    const dvec3 way(std::cos(rise) * std::cos(angle), std::cos(rise) * std::sin(angle), std::sin(rise));
    const auto line = [&](double range) {
      const dvec3 p = range * way;
      return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    };
    ++(rise > 0 ? others : returns);
    (rise > 0 ? sky : walls) += line(rise > 0 ? 120 : std::min(40.0, 8 / std::abs(std::sin(angle) + 1e-9)));
    ball += line(40);
  }
  const io::ReadResult read = read_text(walls + sky);
  EXPECT_EQ(read.cloud.size(), returns);
  EXPECT_THAT(notes_of(read),
              HasSubstr(std::to_string(others) + " records as far from 0 0 0 as the farthest"));
  EXPECT_NEAR(read.report.bounds_max.x, 40, 0.1);
  EXPECT_EQ(read_text(ball).cloud.size(), returns + others);
  // Of two shells the outer one lies along the same lines of sight.
  std::string shells;
  for (int i = 0; i < 4000; ++i) {
    const double angle = 2.39996 * i, z = 1 - 2 * (i + 0.5) / 4000, across = std::sqrt(1 - z * z);
    for (const double range : {0.5, 1.0})
      if (range < 1 || i % 2 == 0)
        shells += std::to_string(range * across * std::cos(angle)) + " " +
                  std::to_string(range * across * std::sin(angle)) + " " + std::to_string(range * z) + "\n";
  }
  EXPECT_EQ(read_text(shells).cloud.size(), 6000u);
  // A scan that was cut at a distance has points up to it.
  std::string cut;
  for (int i = 0; i < 3000; ++i) cut += std::to_string(0.01 * i - 15) + " " + std::to_string(i % 60) + " 1\n";
  EXPECT_EQ(read_text(cut).cloud.size(), 3000u);
}

// Names of the columns, in remarks and lines of their own, by any separator.
TEST(StrangersKinds, HeadersWinOverGuessing) {
  struct Case {
    const char* text;
    vec3 first;
  };
  for (const Case& c : {
           Case{"# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n# Number: 2\n"
                "7 1.5 2.5 3.5 10 20 30 0.4 1 0 2 1\n9 4.5 5.5 6.5 1 2 3 0.4 1 0\n",
                {1.5, 2.5, 3.5}},
           Case{"Hochwert;Rechtswert;Hoehe\n20,5;10,5;3,5\n21,5;11,5;4,5\n", {10.5, 20.5, 3.5}},
           Case{"Hochwert;Rechtswert;H\xC3\xB6he\n20.5;10.5;3.5\n", {10.5, 20.5, 3.5}},
           Case{"Punktnummer\tRechtswert\tHochwert\tH\xF6he\n1\t10.5\t20.5\t3.5\n", {10.5, 20.5, 3.5}},
           Case{"Latitude, Longitude, Altitude\n20.5, 10.5, 3.5\n21.5, 10.5, 3.5\n", {10.5, 20.5, 3.5}},
           Case{"time,POINT_X,POINT_Y,POINT_Z\n9,1.5,2.5,3.5\n", {1.5, 2.5, 3.5}},
           Case{"cartesianX cartesianY cartesianZ\n1.5 2.5 3.5\n", {1.5, 2.5, 3.5}},
           Case{"# columns: intensity x y z\n9 1.5 2.5 3.5\n", {1.5, 2.5, 3.5}},
           Case{"\"\",\"x\",\"y\",\"z\"\n\"1\",1.5,2.5,3.5\n\"2\",4.5,5.5,6.5\n", {1.5, 2.5, 3.5}},
           Case{"\"z\" \"y\" \"x\"\n\"1\" 3.5 2.5 1.5\n\"2\" 4.5 5.5 6.5\n", {1.5, 2.5, 3.5}},
           Case{",x,y,z\n0,1.5,2.5,3.5\n1,4.5,5.5,6.5\n", {1.5, 2.5, 3.5}},
           Case{"0,1,2\n1.5,2.5,3.5\n4.5,5.5,6.5\n", {1.5, 2.5, 3.5}},
           Case{"x_m,y_m,z_m,t\n1.5,2.5,3.5,9\n", {1.5, 2.5, 3.5}},
       }) {
    const io::ReadResult read = read_text(c.text);
    EXPECT_EQ(vec3(read.cloud.world(0)), c.first) << c.text << notes_of(read);
  }
}

TEST(StrangersKinds, ARunningNumberIsNoPlace) {
  std::string rising, falling, hashed, few, grid;
  for (int i = 1; i <= 300; ++i) {
    const std::string place = " " + std::to_string(i % 17) + ".25 " + std::to_string(i % 5) + ".5 3.5\n";
    rising += std::to_string(i) + place;
    falling += std::to_string(300 - i) + place;
    hashed += std::to_string(i * 7919 % 10007) + place;
    if (i <= 20) few += std::to_string(i * 7919 % 10007) + place;
    grid += std::to_string(i % 150) + " " + std::to_string(i / 150) + ".5 0.5 3.5\n";
  }
  EXPECT_EQ(read_text(rising).report.bounds_max.x, 16.25);
  EXPECT_EQ(read_text(falling).report.bounds_max.x, 16.25);
  EXPECT_EQ(read_text(hashed).report.bounds_max.x, 16.25);
  EXPECT_GT(read_text(few).report.bounds_max.x, 1000);
  EXPECT_EQ(read_text(grid).report.bounds_max.x, 149);
}

TEST(StrangersKinds, WordsAnywhereArePassedOver) {
  for (const char* text :
       {"1.5 2.5 3.5 GRD\n4.5 5.5 6.5 BLD\n", "1.5,2.5,3.5,tall tree,9\n4.5,5.5,6.5,wall,8\n",
        "P1;1.5;2.5;3.5;top of kerb\nP2;4.5;5.5;6.5;x\n", "A 7,1.5,2.5,3.5\nB 8,4.5,5.5,6.5\n",
        "2024-05-01T10:00:00,1.5,2.5,3.5\n2024-05-01T10:00:01,4.5,5.5,6.5\n",
        "BEGIN\n1.5 2.5 3.5\n4.5 5.5 6.5\nEND\n", "BEGIN\n1.5 2.5 3.5\nEND\nBEGIN\n4.5 5.5 6.5\nEND\n"})
    EXPECT_EQ(read_text(text).cloud.positions, (std::vector<vec3>{{1.5, 2.5, 3.5}, {4.5, 5.5, 6.5}})) << text;
  // Empty cells between tabs.
  EXPECT_EQ(read_text("x\ty\tz\ti\tj\n1\t2\t3\t\t5\n").cloud.scalar("j")->value(0), 5);
  const io::ReadResult semicolons = read_text("1;2;-5.5\t\t\r\n4;5;-6\t\t\r\n");
  ASSERT_EQ(semicolons.cloud.size(), 2u);
  EXPECT_EQ(semicolons.cloud.world(0), dvec3(1, 2, -5.5)) << "tabs behind them are blanks";
}

TEST(StrangersKinds, ColumnsByAllOfTheirNumbers) {
  const auto columns = [](const std::string& lines) { return notes_of(read_text(lines)); };
  EXPECT_THAT(columns("1.5 2 3 210 40 40 0\n1 2.5 3 40 160 50 3\n1 2 3.5 40 70 220 12\n"),
              HasSubstr("x,y,z,red,green,blue,label"));
  EXPECT_THAT(columns("1.5 2 3 12 40 40 210\n1 2.5 3 14 160 50 90\n1 2 3.5 200 70 220 80\n"),
              HasSubstr("x,y,z,intensity,red,green,blue"));
  EXPECT_THAT(columns("1.5 2 3 2 210 40 40\n1 2.5 3 5 140 160 50\n1 2 3.5 2 40 70 220\n"),
              HasSubstr("x,y,z,label,red,green,blue"));
  EXPECT_THAT(columns("1.5 2 3 0 210 40 40\n1 2.5 3 0 140 160 50\n1 2 3.5 0 40 70 220\n"),
              HasSubstr("x,y,z,intensity,red,green,blue"));
  EXPECT_THAT(columns("1.5 2 3 53970 10280 1028\n1 2.5 3 400 4000 50000\n"),
              HasSubstr("x,y,z,red,green,blue"));
  EXPECT_THAT(columns("1.5 2 3 53970 1 2\n1 2.5 3 400 2 2\n"), HasSubstr("x,y,z,intensity,column_5"));
  EXPECT_THAT(columns("1.5 2 3 0 0 1\n1 2.5 3 0 0 1\n"), HasSubstr("x,y,z,nx,ny,nz"));
}

TEST(StrangersKinds, GridsOfHeights) {
  const char* esri =
      "NCOLS 3\r\nNROWS 2\r\nXLLCENTER 10\r\nYLLCENTER 20\r\nCELLSIZE 2\r\nNODATA_value -32768\r\n"
      "1 2 3\r\n4 -32768 6\r\n";
  const io::ReadResult read = read_text(esri, "a.asc");
  EXPECT_EQ(read.report.format, "grid");
  EXPECT_EQ(read.cloud.size(), 5u);
  EXPECT_EQ(read.cloud.world(0), dvec3(10, 22, 1));
  EXPECT_EQ(read.cloud.world(4), dvec3(14, 20, 6));
  const io::ReadResult grass = read_text(
      "north: 24\nsouth: 20\neast: 6\nwest: 0\nrows: 2\ncols: 3\nnull: -1\n1 2 3\n4 -1 6\n", "g.txt");
  EXPECT_EQ(grass.cloud.world(0), dvec3(1, 23, 1));
  EXPECT_EQ(grass.cloud.size(), 5u);
  const io::ReadResult surfer = read_text("DSAA\n3 2\n0 4\n10 11\n1 6\n1 2 3\n4 1.70141e+038 6\n", "s.grd");
  EXPECT_EQ(surfer.cloud.world(2), dvec3(4, 10, 3));
  EXPECT_EQ(surfer.cloud.size(), 5u);
  for (const char* bad : {"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5\n",
                          "ncols 300000\nnrows 200000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n",
                          "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\n1 2 3\n4 5 6\n"})
    EXPECT_TRUE(test::error_of(write_file("b.asc", bad))) << bad;
}

/// A scanner of 16 rings in a street, as a driver dumps it.
std::string dump(std::size_t columns, int points = 4000) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(-0.02f, 0.02f);
  std::string bytes;
  for (int i = 0; i < points; ++i) {
    const float angle = float(i / 16) * 0.02f, range = 5 + 20 * std::abs(std::sin(3 * angle));
    const float ring = float(i % 16), tilt = (ring - 12) * 0.03f;
    const float row[8] = {range * std::cos(angle) + noise(random),
                          range * std::sin(angle) + noise(random),
                          range * tilt,
                          float(int(random() % 120)),
                          ring,
                          float(i) * 1e-5f,
                          1.0f,
                          float(random() % 3000)};
    bytes.append(reinterpret_cast<const char*>(row), columns * sizeof(float));
  }
  return bytes;
}

TEST(StrangersKinds, ColumnsOfDumpsAreFoundByWhatTheyHold) {
  for (const std::size_t columns : {3, 4, 5, 6, 8}) {
    const io::ReadResult read = io::read(write_file("a.bin", dump(columns)));
    EXPECT_EQ(read.report.points, 4000u) << columns << notes_of(read);
    EXPECT_LT(read.report.bounds_max.z, 3) << columns;
  }
  io::ReadOptions asked;
  asked.columns = {"x", "y", "z", "intensity", "ring"};
  EXPECT_EQ(io::read(write_file("a.bin", dump(5)), asked).report.points, 4000u);
  // Bytes of anything are none.
  std::mt19937 random(5);
  std::string bytes;
  std::uniform_real_distribution<float> any(-50, 50);
  for (int i = 0; i < 4800; ++i) {
    const float value = any(random);
    bytes.append(reinterpret_cast<const char*>(&value), 4);
  }
  const auto error = test::error_of(write_file("noise.bin", bytes));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("--columns"));
}

TEST(StrangersKinds, PointsOfColmapInBinary) {
  std::string bytes;
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint64_t(3));
  for (int i = 0; i < 3; ++i) {
    put(std::uint64_t(10 + i));
    put(double(i)), put(2.5), put(-3.5);
    put(std::uint8_t(10)), put(std::uint8_t(20)), put(std::uint8_t(30));
    put(0.5);
    put(std::uint64_t(i));
    for (int k = 0; k < i; ++k) put(std::uint32_t(k)), put(std::uint32_t(7));
  }
  const io::ReadResult read = io::read(write_file("points3D.bin", bytes));
  EXPECT_EQ(read.report.format, "colmap");
  EXPECT_EQ(read.cloud.provenance, Provenance::photographs);
  EXPECT_EQ(read.cloud.world(2), dvec3(2, 2.5, -3.5));
  EXPECT_EQ(read.cloud.colors.at(1), (Rgba8{10, 20, 30, 255}));
  test::expect_cuts_are_safe("points3D.bin", bytes, 3);
}

/// images.bin of COLMAP, one camera, whose pictures turn the axis `up` of the world up.
std::string images_of(const std::vector<dvec3>& ups) {
  std::string bytes;
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint64_t(ups.size()));
  for (std::size_t i = 0; i < ups.size(); ++i) {
    // Half a turn about the middle of `up` and the -y of the picture takes one to the other.
    const dvec3 middle = glm::normalize(ups[i] + dvec3(0.01, -1, 0.02));
    put(std::uint32_t(i + 1));
    put(0.0), put(middle.x), put(middle.y), put(middle.z);
    put(double(i)), put(0.0), put(2.0);
    put(std::uint32_t(1));
    bytes += "picture";
    bytes += '\0';
    put(std::uint64_t(0));
  }
  return bytes;
}

TEST(StrangersKinds, PointsOfColmapStandAsTheirPictures) {
  std::string points = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n", cameras;
  for (int i = 1; i < 9; ++i)
    points += std::to_string(i) + " 1." + std::to_string(i) + " 2.5 3.5 10 20 30 0.5 1 7 2 3\n";
  const auto put = [&](auto value) { cameras.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint64_t(1)), put(std::uint32_t(1)), put(std::int32_t(0)), put(std::uint64_t(640)),
      put(std::uint64_t(480));
  put(500.0), put(320.0), put(240.0);
  const std::filesystem::path folder = test::temp_file("colmap");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "sparse");
  const auto read = [&] { return io::read(write_file("colmap/points3D.txt", points)); };
  EXPECT_EQ(read().cloud.up, UpAxis::neg_y);
  EXPECT_FALSE(read().cloud.up_is_known) << "no pictures beside them";
  write_file("colmap/cameras.bin", cameras);
  const dvec3 up(0.2, 0.1, -1), aside(0, 0.3, -1);
  const std::string images = images_of({up, aside, up});
  write_file("colmap/images.bin", images);
  const io::ReadResult known = read();
  EXPECT_EQ(known.cloud.up, UpAxis::neg_z);
  EXPECT_TRUE(known.cloud.up_is_known);
  EXPECT_THAT(known.report.notes, ::testing::Contains("-Z is up, by its pictures"));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n";
  EXPECT_EQ(io::read(write_file("colmap/fused.ply", ply)).cloud.up, UpAxis::neg_z);
  const std::string stated =
      "ply\nformat ascii 1.0\ncomment up +Z\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty int POINT3D_ID\nend_header\n1 2 3 4\n";
  EXPECT_EQ(io::read(write_file("colmap/stated.ply", stated)).cloud.up, UpAxis::pos_z);
  EXPECT_EQ(io::read(write_file("colmap/other.xyz", "1 2 3\n1 2 4\n")).cloud.up, UpAxis::pos_z);
  // Pictures of every orientation, and damaged files, say nothing.
  write_file("colmap/images.bin", images_of({up, -up, aside, -aside}));
  EXPECT_FALSE(read().cloud.up_is_known);
  write_file("colmap/images.bin", images.substr(0, images.size() - 20));
  EXPECT_FALSE(read().cloud.up_is_known);
  EXPECT_EQ(read().cloud.up, UpAxis::neg_y);
  std::filesystem::remove(folder / "images.bin");
  // What is fused lies beside the folder `sparse`.
  write_file("colmap/sparse/cameras.bin", cameras);
  write_file("colmap/sparse/images.bin", images);
  EXPECT_EQ(io::read(write_file("colmap/fused.ply", ply)).cloud.up, UpAxis::neg_z);
  std::filesystem::remove_all(folder);
}

// A panoramic camera's driver writes -1e6 times the layer where nothing came back.
TEST(Strangers, PlacesFarFromAllOthersThatManyShareAreNoPoints) {
  const auto read_with = [](int copies, double away) {
    std::string text;
    for (int i = 0; i < 1000; ++i)
      text += std::to_string(i % 10 + 0.5) + " " + std::to_string(i / 10 % 10) + " " +
              std::to_string(i / 100) + "\n";
    const std::string far = std::to_string(-away);
    for (int i = 0; i < copies; ++i) text += far + " " + far + " 1\n" + far + " " + far + " 2\n";
    return io::read(write_file("far.xyz", text));
  };
  const io::ReadResult markers = read_with(300, 1e6);
  EXPECT_EQ(markers.cloud.size(), 1000u);
  EXPECT_EQ(markers.report.points_dropped, 600u);
  EXPECT_EQ(markers.report.points_finite, 1000u);
  EXPECT_EQ(markers.report.bounds_min, dvec3(0.5, 0, 0));
  ASSERT_FALSE(markers.report.notes.empty());
  EXPECT_NE(markers.report.notes.back().find("600 records in 2 places"), std::string::npos);
  std::string coarse = "5 5 5\n6 5 5\n";  // and 40 places of 100 points each
  for (int i = 0; i < 4000; ++i) coarse += std::to_string(i % 40 * 1000 + 1) + " 0 0\n";
  EXPECT_EQ(io::read(write_file("coarse.xyz", coarse)).cloud.size(), 4002u);
  EXPECT_EQ(read_with(3, 1e6).cloud.size(), 1006u) << "a few may be strays";
  EXPECT_EQ(read_with(300, 10).cloud.size(), 1600u) << "no farther than all is long";
}

}  // namespace
}  // namespace sfumato
