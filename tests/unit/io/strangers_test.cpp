// Files as people send them: what was reported wrong once, read right. The files themselves are read where
// they are
// (../shared/data/strangers); those of the same kinds are made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "unit/io/files.h"
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
  std::string numbered, grid;
  for (int i = 1; i <= 300; ++i) {
    numbered +=
        std::to_string(i) + " " + std::to_string(i % 17) + ".25 " + std::to_string(i % 5) + ".5 3.5\n";
    grid += std::to_string(i % 150) + " " + std::to_string(i / 150) + ".5 0.5 3.5\n";
  }
  EXPECT_EQ(read_text(numbered).report.bounds_max.x, 16.25);
  EXPECT_EQ(read_text(grid).report.bounds_max.x, 149);
}

TEST(StrangersKinds, WordsAnywhereArePassedOver) {
  for (const char* text :
       {"1.5 2.5 3.5 GRD\n4.5 5.5 6.5 BLD\n", "1.5,2.5,3.5,tall tree,9\n4.5,5.5,6.5,wall,8\n",
        "P1;1.5;2.5;3.5;top of kerb\nP2;4.5;5.5;6.5;x\n", "A 7,1.5,2.5,3.5\nB 8,4.5,5.5,6.5\n",
        "2024-05-01T10:00:00,1.5,2.5,3.5\n2024-05-01T10:00:01,4.5,5.5,6.5\n"})
    EXPECT_EQ(read_text(text).cloud.positions, (std::vector<vec3>{{1.5, 2.5, 3.5}, {4.5, 5.5, 6.5}})) << text;
  // Empty cells between tabs.
  EXPECT_EQ(read_text("x\ty\tz\ti\tj\n1\t2\t3\t\t5\n").cloud.scalar("j")->value(0), 5);
}

TEST(StrangersKinds, ColumnsByAllOfTheirNumbers) {
  const auto columns = [](const std::string& lines) { return notes_of(read_text(lines)); };
  EXPECT_THAT(columns("1.5 2 3 210 40 40 0\n1 2.5 3 40 160 50 3\n1 2 3.5 40 70 220 12\n"),
              HasSubstr("x,y,z,red,green,blue,label"));
  EXPECT_THAT(columns("1.5 2 3 12 40 40 210\n1 2.5 3 14 160 50 90\n1 2 3.5 200 70 220 80\n"),
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
  EXPECT_EQ(read.cloud.world(2), dvec3(2, 2.5, -3.5));
  EXPECT_EQ(read.cloud.colors.at(1), (Rgba8{10, 20, 30, 255}));
  test::expect_cuts_are_safe("points3D.bin", bytes, 3);
}

}  // namespace
}  // namespace sfumato
