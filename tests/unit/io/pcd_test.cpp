#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::bytes_of;
using test::write_file;

const float nan = std::numeric_limits<float>::quiet_NaN();

std::string header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, int width, int height, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes +
         "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " +
         std::to_string(height) + "\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS " + std::to_string(width * height) +
         "\nDATA " + data + "\n";
}

/// LZF in its simplest form: runs of at most 32 bytes as they are.
std::string lzf_literals(const std::string& bytes) {
  std::string packed;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string run = bytes.substr(i, 32);
    packed += char(run.size() - 1) + run;
  }
  return packed;
}
std::string compressed(const std::string& fields_together) {
  const std::string packed = lzf_literals(fields_together);
  return bytes_of(std::uint32_t(packed.size()), std::uint32_t(fields_together.size())) + packed;
}

TEST(PcdTest, TheFirstPointMayFollowTheWordAsciiAtOnce) {
  std::string text = header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "ascii");
  text.pop_back();
  const auto file = write_file("at_once.pcd", text + "-1.5 2 3\n4 5 6\n");
  const PointCloud cloud = io::read(file).cloud;
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.world(0), dvec3(-1.5, 2, 3));
  EXPECT_EQ(cloud.world(1), dvec3(4, 5, 6));
}

TEST(PcdTest, BytesOfAsciiMayBeCharacters) {
  const auto head = header("x y z tag line", "4 4 4 1 1", "F F F U I", "1 1 1 1 1", 3, 1, "ascii");
  const auto file = write_file("bytes.pcd", head + "1 2 3 \x10 \xfe\n4 5 6 \x80 7\r\n7 8 9  16   -2\n");
  const PointCloud cloud = io::read(file).cloud;
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.world(2), dvec3(7, 8, 9));
  EXPECT_EQ(cloud.scalar("tag")->values, (std::vector<float>{16, 128, 16}));
  EXPECT_EQ(cloud.scalar("line")->values, (std::vector<float>{-2, 7, -2}));
  EXPECT_THROW(io::read(write_file("words.pcd", head + "1 2 3 ab c\n4 5 6 7 8\n4 5 6 7 8\n")), Error);
}

TEST(PcdTest, RowsOfNumbersWithoutAHeaderAreText) {
  for (const char* name : {"rows.pcd", "rows.ply"}) {
    const auto file = write_file(name, "-0.5 1 2 \n3 4 5\n6 7 8\n");
    EXPECT_EQ(io::read(file).report.format, "text") << name;
    EXPECT_EQ(io::read(file).cloud.size(), 3u) << name;
  }
}

TEST(PcdTest, EveryEncodingGivesTheSameCloud) {
  const auto head = [](const std::string& data) {
    return header("x _ y z rgb intensity ring hist", "4 1 4 4 4 2 8 4", "F U F F F U F F", "1 3 1 1 1 1 1 2",
                  2, 1, data);
  };
  const std::uint32_t rgb[2] = {0x0a141e, 0xff28323c};  // the second one with alpha
  std::string binary = head("binary"), columns;
  const std::string padding = "abc";
  for (int i = 0; i < 2; ++i)
    binary += bytes_of(1.f + float(i)) + padding + bytes_of(2.f, 3.f) +
              bytes_of(rgb[i], std::uint16_t(600 + i), 0.5 * i, 7.f, 8.f + float(i));
  columns = bytes_of(1.f, 2.f) + padding + padding + bytes_of(2.f, 2.f, 3.f, 3.f, rgb[0], rgb[1]) +
            bytes_of(std::uint16_t(600), std::uint16_t(601), 0.0, 0.5, 7.f, 8.f, 7.f, 9.f);
  // Both ways of ascii: the float whose bits are the colour, and the whole number.
  const std::string ascii = "1 97 98 99 2 3 9.2410e-40 600 0 7 8\n2 97 98 99 2 3 2634300 601 0.5 7 9\n";
  int kind = 0;
  for (const std::string& bytes :
       {binary, head("binary_compressed") + compressed(columns), head("ascii") + ascii}) {
    SCOPED_TRACE(kind);
    const io::ReadResult result = io::read(write_file("a.pcd", bytes));
    const PointCloud& cloud = result.cloud;
    EXPECT_EQ(result.report.format, "pcd");
    EXPECT_EQ(cloud.positions, (std::vector<vec3>{{1, 2, 3}, {2, 2, 3}}));
    if (kind++ < 2)
      EXPECT_EQ(cloud.colors, (std::vector<Rgba8>{{10, 20, 30, 255}, {40, 50, 60, 255}}));
    else
      EXPECT_EQ(cloud.colors[1], (Rgba8{0x28, 0x32, 0x3c, 255}));
    EXPECT_EQ(cloud.scalar("intensity")->value(1), 601);
    EXPECT_EQ(cloud.scalar("intensity")->type, StoredType::uint16);
    EXPECT_EQ(cloud.scalar("ring")->value(1), 0.5);
    EXPECT_EQ(cloud.scalar("hist_0")->value(0), 7);
    EXPECT_EQ(cloud.scalar("hist_1")->value(1), 9);
    EXPECT_EQ(cloud.scalar("_"), nullptr);
    EXPECT_EQ(cloud.up, UpAxis::pos_z);
    EXPECT_TRUE(cloud.grids.empty());
    EXPECT_EQ(cloud.scanners, std::vector<dvec3>{dvec3(1, 2, 3)});
  }
}

TEST(PcdTest, AsciiColorAsTheBitsOfAFloat) {
  float packed;
  const std::uint32_t rgb = 0x0a141e;
  std::memcpy(&packed, &rgb, sizeof packed);
  char text[64];
  std::snprintf(text, sizeof text, "%.9g", double(packed));
  const std::string bytes =
      header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, 1, "ascii") + "0 0 0 " + text + "\n";
  EXPECT_EQ(io::read(write_file("a.pcd", bytes)).cloud.colors.at(0), (Rgba8{10, 20, 30, 255}));
  const std::string whole =
      header("x y z rgba", "4 4 4 4", "F F F U", "1 1 1 1", 1, 1, "ascii") + "0 0 0 4278850590\n";
  EXPECT_EQ(io::read(write_file("b.pcd", whole)).cloud.colors.at(0), (Rgba8{10, 20, 30, 255}));
}

TEST(PcdTest, OrganisedCloudsKeepTheirGrid) {
  std::string bytes = header("x y z", "4 4 4", "F F F", "1 1 1", 3, 2, "binary");
  for (int i = 0; i < 6; ++i) bytes += bytes_of(i % 2 ? nan : float(i), 0.f, 1.f);
  const PointCloud cloud = io::read(write_file("a.pcd", bytes)).cloud;
  ASSERT_EQ(cloud.grids.size(), 1u);
  EXPECT_EQ(cloud.grids[0].width, 3u);
  EXPECT_EQ(cloud.grids[0].height, 2u);
  EXPECT_EQ(cloud.grids[0].count, 3u);
  EXPECT_EQ(cloud.grids[0].viewpoint, dvec3(1, 2, 3));
  EXPECT_EQ(cloud.grid_index, (std::vector<std::uint32_t>{0, 2, 4}));
}

TEST(PcdTest, RealOrganisedFrameKeepsItsPixels) {
  SFUMATO_NEEDS_REAL_SCAN("office1.pcd");
  const PointCloud cloud = io::read(test::data_folder() / "office1.pcd").cloud;
  ASSERT_EQ(cloud.grid_index.size(), cloud.size());
  // A pinhole camera of 525 px focal length (Kinect) looking along z: the column follows from x / z. Depth is
  // quantised and the principal point not quite central, so a few pixels of slack.
  for (std::size_t i = 0; i < cloud.size(); i += 1001) {
    const vec3 p = cloud.positions[i];
    EXPECT_NEAR(double(cloud.grid_index[i] % 640), 319.5 + 525 * double(p.x / p.z), 4) << i;
    EXPECT_NEAR(double(cloud.grid_index[i] / 640), 239.5 + 525 * double(p.y / p.z), 4) << i;
  }
}

TEST(PcdTest, OldVersionsLackWhatLaterOnesAdd) {
  const std::string bytes =
      "VERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 nan\n";
  const io::ReadResult result = io::read(write_file("a.pcd", bytes));
  EXPECT_EQ(result.report.points, 2u);
  EXPECT_EQ(result.report.points_dropped, 1u);
  EXPECT_TRUE(result.cloud.scanners.empty());
}

TEST(PcdTest, TheWordAfterDataMayBeInCapitals) {
  const std::string head =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n";
  EXPECT_EQ(io::read(write_file("a.pcd", head + "DATA ASCII\n1 2 3\n")).cloud.positions[0], vec3(1, 2, 3));
}

// Recorders that fill in the numbers at the end hold their place so.
TEST(PcdTest, ANumberEndsBeforeAHash) {
  const std::string file =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2#####\nHEIGHT 1\nPOINTS 2#####\n"
      "DATA ascii\n1 2 3\n4 5 6\n";
  EXPECT_EQ(io::read(write_file("a.pcd", file)).cloud.size(), 2u);
  EXPECT_TRUE(test::error_of(write_file("b.pcd", "FIELDS x y z\nWIDTH #\nPOINTS 1\nDATA ascii\n1 2 3\n")));
}

// Programs that fill in POINTS alone.
TEST(PcdTest, PointsCountWhereWidthAndHeightAreZero) {
  for (const char* size : {"WIDTH 0\nHEIGHT 0\n", "WIDTH 0\nHEIGHT 1\n", "WIDTH 2\nHEIGHT 0\n"}) {
    const std::string file = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n" +
                             std::string(size) + "POINTS 2\nDATA ascii\n1 2 3\n4 5 6\n";
    const PointCloud cloud = io::read(write_file("a.pcd", file)).cloud;
    EXPECT_EQ(cloud.positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}})) << size;
    EXPECT_TRUE(cloud.grids.empty());
  }
}

TEST(PcdTest, NoPointsIsValid) {
  for (const char* data : {"ascii", "binary", "binary_compressed"})
    EXPECT_EQ(
        io::read(write_file("a.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 0, 1, data))).report.points,
        0u);
}

TEST(PcdTest, BadFilesAreOneLine) {
  const std::string good = header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "binary");
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string bytes = good + std::string(24, '\0');
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::pair<std::string, const char*> cases[] = {
      {good + std::string(11, '\0'), "after 0 points, expected 2"},
      {replaced("POINTS 2", "POINTS 3"), "expected WIDTH x HEIGHT = 2"},
      {replaced("WIDTH 2", "WIDTH x"), "line 7: found WIDTH 'x'"},
      {replaced("SIZE 4 4 4", "SIZE 4 4 3"), "'z' of type F3"},
      {replaced("FIELDS x y z", "FIELDS x y w"), "lacks x, y or z"},
      {replaced("DATA binary", "DATA zipped"), "found DATA 'zipped'"},
      {replaced("COUNT 1 1 1", "COUNT 1 1 60000"), "at most 4096"},
      {replaced("VERSION", "NONSENSE"), "line 2: found 'NONSENSE'"},
      {header("x y z", "4 4 4", "F F F", "1 1 1", 40000, 40000, "binary"), "after 0 points"},
      {header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "ascii") + "1 2 3\n4 5\n", "line 13"},
      {header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "binary_compressed") + bytes_of(99u, 24u),
       "expected 99"},
      {header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "binary_compressed") + bytes_of(1u, 24u) + "\x05",
       "unpack"},
      {header("x y z", "4 4 4", "F F F", "1 1 1", 30000, 9999, "binary_compressed") +
           bytes_of(1u, 3599640000u) + "a",
       "packed in 1"},
  };
  for (const auto& [bytes, message] : cases) {
    const std::optional<Error> error = test::error_of(write_file("a.pcd", bytes));
    ASSERT_TRUE(error.has_value()) << message;
    EXPECT_EQ(error->code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(error->what()).find(message), std::string::npos) << error->what();
  }
}

// A picture of 2 by 2 pixels of which three are there.
TEST(PcdTest, WhatACutFileHoldsIsRead) {
  for (const std::string& bytes :
       {header("x y z", "4 4 4", "F F F", "1 1 1", 2, 2, "binary") +
            bytes_of(1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f, 9.f, 10.f),
        header("x y z", "4 4 4", "F F F", "1 1 1", 2, 2, "ascii") + "1 2 3\n4 5 6\n7 8 9\n"}) {
    const std::filesystem::path file = write_file("cut.pcd", bytes);
    const io::ReadResult read = io::read(file);
    ASSERT_EQ(read.cloud.size(), 3u);
    EXPECT_EQ(read.cloud.grid_index, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(read.report.points_missing, 1u);
    EXPECT_THAT(read.report.damage, testing::ElementsAre(testing::HasSubstr("after 3 points, expected 4")));
    io::ReadOptions options;
    options.strict = true;
    EXPECT_TRUE(test::error_of(file, options).has_value());
  }
}

TEST(PcdTest, CutAndChangedFilesNeverCrash) {
  const std::string points = bytes_of(1.f, 2.f, 3.f, 0x112233, 4.f, 5.f, 6.f, 0x445566);
  for (const std::string& bytes :
       {header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 2, 1, "binary") + points,
        header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, 2, "binary_compressed") + compressed(points),
        header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, 2, "ascii") + "1 2 3 4000000\n5 6 7 80"}) {
    // Only the last digit of the ascii file can go unnoticed.
    EXPECT_GE(test::expect_cuts_are_safe("a.pcd", bytes, 2), int(bytes.size()) - 1);
    test::expect_changes_are_safe("b.pcd", bytes);
  }
}

}  // namespace
}  // namespace sfumato
