#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::bytes_of;
using test::reversed_bytes_of;
using test::temp_file;
using test::write_file;
using ::testing::Contains;
using ::testing::HasSubstr;

const float nan = std::numeric_limits<float>::quiet_NaN();

std::string header(const std::string& format, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + body + "end_header\n";
}
const std::string xyz = "property float x\nproperty float y\nproperty float z\n";

/// A field of 40 x 40 points `spacing` apart, its corner at `north`, of coordinates of that type.
std::vector<std::string> notes_of_field(const std::string& type, double north, double spacing) {
  std::string text = header("ascii", "element vertex 1600\nproperty " + type + " x\nproperty " + type +
                                         " y\nproperty " + type + " z\n");
  for (int i = 0; i < 1600; ++i) {
    const double values[] = {spacing * (i % 40), north + spacing * (i / 40), 0.1 * (i % 7)};
    for (const double value : values) text += std::to_string(value) + " ";
    text += "\n";
  }
  return io::read(write_file("field.ply", text)).report.notes;
}

TEST(PlyTest, FloatsThatStandFarApartAreSpokenOf) {
  EXPECT_THAT(notes_of_field("float", 5421350, 0.7),
              Contains(HasSubstr("0.5 apart along y (its points: about 0.6")));
  EXPECT_TRUE(notes_of_field("double", 5421350, 0.7).empty()) << "nothing is lost";
  EXPECT_TRUE(notes_of_field("float", 0, 0.7).empty());
  EXPECT_TRUE(notes_of_field("float", 5421350, 3.7).empty()) << "too little to see";
  EXPECT_TRUE(notes_of_field("float", 5421350, 1).empty()) << "whole metres are floats there";
}

// As RealSense's viewer writes vertices: colours on lines of their own.
TEST(PlyTest, VerticesTakeSeveralLines) {
  const std::string head =
      header("ascii", "element vertex 3\n" + xyz +
                          "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                          "element face 1\nproperty list uchar int vertex_indices\n");
  const std::string vertices = "0 1 2 \n10 20 30 \n3 4 5 \n40 50 60 \n\n6 7 8.5\n70 80 90\n";
  const std::filesystem::path file = write_file("lines.ply", head + vertices + "3 0 1 2\n");
  const PointCloud cloud = io::read(file).cloud;
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.positions[2], vec3(6, 7, 8.5f));
  EXPECT_EQ(cloud.colors[1], (Rgba8{40, 50, 60, 255}));
  EXPECT_EQ(io::read_mesh(file).triangles.size(), 1u);
  const auto why = [&](const std::string& body) {
    const std::optional<Error> error = test::error_of(write_file("lines.ply", head + body));
    return error ? std::string(error->what()) : "";
  };
  EXPECT_THAT(why("0 1 2\n10 20 30\n3 four 5\n1 2 3\n4 5 6\n7 8 9\n"),
              HasSubstr("'four', expected a number for y"));
}

TEST(PlyTest, NumbersThatWindowsWroteAreNone) {
  const io::ReadResult read =
      io::read(write_file("windows.ply", header("ascii", "element vertex 3\n" + xyz) +
                                             "1.#QNAN0 -1.#IND00 1.#INF00\n1 2 3\n1.#QNAN 1 2\n"));
  ASSERT_EQ(read.cloud.size(), 1u);
  EXPECT_EQ(read.report.points_dropped, 2u);
}

// Trainers of splats store the points of COLMAP so: in the axes of a camera, with normals that are all zero.
TEST(PlyTest, PointsWithColoursAndNoNormalButZerosHaveYDown) {
  const auto up_of = [](const std::string& comment, const std::string& normal, bool colored) {
    const std::string colors =
        colored ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "";
    const std::string color = colored ? " 200 100 50" : "";
    return io::read(write_file("points3D.ply", header("ascii", comment + "element vertex 2\n" + xyz +
                                                                   "property float nx\nproperty float ny\n"
                                                                   "property float nz\n" +
                                                                   colors) +
                                                   "1 2 3 0 0 0" + color + "\n4 5 7 " + normal + color +
                                                   "\n"))
        .cloud.up;
  };
  EXPECT_EQ(up_of("", "0 0 0", true), UpAxis::neg_y);
  EXPECT_EQ(up_of("", "0 0 1", true), UpAxis::pos_y);
  EXPECT_EQ(up_of("", "0 0 0", false), UpAxis::pos_y);
  EXPECT_EQ(up_of("comment up +Y\n", "0 0 0", true), UpAxis::pos_y);
  EXPECT_EQ(up_of("comment usual_up +Z\n", "0 0 0", true), UpAxis::pos_z);
}

// Of public files by these programs ten have Z up and one Y, of others as many have one as the other.
TEST(PlyTest, ProgramsThatHaveZUpSaySoByTheirName) {
  const auto cloud_of = [](const std::string& comments) {
    return io::read(write_file("by.ply",
                               header("ascii", comments + "element vertex 2\n" + xyz) + "1 2 3\n4 5 7\n"))
        .cloud;
  };
  for (const char* comment : {"Created by CloudCompare v2.11.3 (Anoia)", "Author: CloudCompare (TELECOM)",
                              "Created by Blender 2.83.6 - www.blender.org, source file: ''",
                              "Created in Blender version 5.0.0", "PCL generated"}) {
    const PointCloud cloud = cloud_of(std::string("comment ") + comment + "\n");
    EXPECT_EQ(cloud.up, UpAxis::pos_z) << comment;
    EXPECT_FALSE(cloud.up_is_known) << comment;
  }
  EXPECT_EQ(cloud_of("comment Created by Open3D\n").up, UpAxis::pos_y);
  const PointCloud named = cloud_of("comment Created by CloudCompare v2.12\ncomment up +Y\n");
  EXPECT_EQ(named.up, UpAxis::pos_y) << "what a file says counts";
  EXPECT_TRUE(named.up_is_known);
  EXPECT_EQ(cloud_of("comment up +Y\ncomment Created by CloudCompare v2.12\n").up, UpAxis::pos_y);
  EXPECT_EQ(cloud_of("comment usual_up -Y\ncomment PCL generated\n").up, UpAxis::neg_y);
  EXPECT_EQ(cloud_of("comment TextureFile Blender_export.png\n").up, UpAxis::pos_y);
  // Whose y is up whatever a camera's view tells.
  const PointCloud of_realsense = cloud_of("comment pointcloud saved from Realsense Viewer\n");
  EXPECT_EQ(of_realsense.up, UpAxis::pos_y);
  EXPECT_TRUE(of_realsense.up_is_known);
  EXPECT_EQ(cloud_of("comment saved from Realsense Viewer\ncomment up +Z\n").up, UpAxis::pos_z);
}

// OpenMVS names no program, but writes lists as few others do, in the axes of a camera.
TEST(PlyTest, ListsOfOpenMvsHaveTheAxesOfACamera) {
  const auto up_of = [](const std::string& type, const std::string& of_vertex, const std::string& of_face,
                        const std::string& comment = "") {
    std::string lines = comment + "element vertex 1\n";
    for (const char* axis : {"x", "y", "z"}) lines += "property " + type + " " + axis + "\n";
    lines += of_vertex + "element face 1\n" + of_face;
    const std::string body = std::string("1 2 3") + (of_vertex.empty() ? "" : " 1 0") + "\n3 0 0 0\n";
    return io::read(write_file("by.ply", header("ascii", lines) + body)).cloud.up;
  };
  const std::string corners = "property list uint8 uint32 vertex_indices\n";
  EXPECT_EQ(up_of("float32", "", corners), UpAxis::neg_y);
  EXPECT_EQ(up_of("float32", "property list uint8 uint32 view_indices\n",
                  "property list uchar int vertex_indices\n"),
            UpAxis::neg_y);
  EXPECT_EQ(up_of("float", "", corners), UpAxis::pos_y);
  EXPECT_EQ(up_of("float32", "", "property list uchar uint vertex_indices\n"), UpAxis::pos_y);
  EXPECT_EQ(up_of("float32", "", corners, "comment Created by CloudCompare v2.12\n"), UpAxis::pos_z);
}

TEST(PlyTest, EveryTypeInEveryByteOrderGivesTheSameCloud) {
  const std::string body =
      "comment made by hand\nobj_info nothing\nelement vertex 2\nproperty short s\nproperty double z\n"
      "property uchar red\nproperty float32 x\nproperty uint8 green\nproperty int8 c\nproperty uchar blue\n"
      "property float y\nproperty uint u\nproperty int i\nproperty uint16 us\n";
  const auto record = [](auto pack) {
    return pack(std::int16_t(-300), 3.25, std::uint8_t(10), 1.5f, std::uint8_t(20), std::int8_t(-7),
                std::uint8_t(30), 2.5f, std::uint32_t(70000), std::int32_t(-70000), std::uint16_t(60000)) +
           pack(std::int16_t(4), -1.0, std::uint8_t(40), 0.5f, std::uint8_t(50), std::int8_t(8),
                std::uint8_t(60), -2.0f, std::uint32_t(1), std::int32_t(2), std::uint16_t(3));
  };
  const std::string little = record([](auto... v) { return bytes_of(v...); });
  const std::string big = record([](auto... v) { return reversed_bytes_of(v...); });
  const std::string ascii =
      "-300 3.25 10 1.5 20 -7 30 2.5 70000 -70000 60000\n\n  4\t-1 40 0.5 50 8 60 -2 1 2 3  \r\n";
  for (const std::string& bytes : {header("binary_little_endian", body) + little,
                                   header("binary_big_endian", body) + big, header("ascii", body) + ascii}) {
    const io::ReadResult result = io::read(write_file("a.ply", bytes));
    const PointCloud& cloud = result.cloud;
    ASSERT_EQ(cloud.size(), 2u);
    EXPECT_EQ(cloud.world(0), dvec3(1.5, 2.5, 3.25));
    EXPECT_EQ(cloud.world(1), dvec3(0.5, -2, -1));
    EXPECT_EQ(cloud.colors[0], (Rgba8{10, 20, 30, 255}));
    ASSERT_EQ(cloud.scalars.size(), 5u);
    const std::pair<const char*, std::array<double, 2>> fields[] = {
        {"s", {-300, 4}}, {"c", {-7, 8}}, {"u", {70000, 1}}, {"i", {-70000, 2}}, {"us", {60000, 3}}};
    for (const auto& [name, values] : fields) {
      ASSERT_NE(cloud.scalar(name), nullptr) << name;
      EXPECT_EQ(cloud.scalar(name)->value(0), values[0]) << name;
      EXPECT_EQ(cloud.scalar(name)->value(1), values[1]) << name;
    }
    EXPECT_EQ(cloud.scalar("us")->type, StoredType::uint16);
    EXPECT_EQ(cloud.up, UpAxis::pos_y);
    ASSERT_EQ(result.report.attributes.size(), 8u);
    EXPECT_EQ(result.report.attributes[0].name, "s");  // file order
    EXPECT_EQ(result.report.attributes[0].min, -300);
    EXPECT_EQ(result.report.attributes[0].mean, -148);
    EXPECT_EQ(result.report.bounds_max, dvec3(1.5, 2.5, 3.25));
  }
}

TEST(PlyTest, ScalarsOfOtherProgramsHaveTheUsualNames) {
  const std::string body = "element vertex 1\n" + xyz +
                           "property float scalar_Intensity\nproperty float scalar_Return_Number\n"
                           "property uchar Class\nproperty uchar classification\nproperty float scalar_C2C\n"
                           "property uchar ScanChannel\n";
  const PointCloud cloud = io::read(write_file("a.ply", header("ascii", body) + "1 2 3 4 5 6 7 8 9\n")).cloud;
  const std::pair<const char*, double> fields[] = {{"scanner_channel", 9}, {"intensity", 4},
                                                   {"return_number", 5},   {"Class", 6},
                                                   {"classification", 7},  {"scalar_C2C", 8}};
  for (const auto& [name, value] : fields) {
    ASSERT_NE(cloud.scalar(name), nullptr) << name;
    EXPECT_EQ(cloud.scalar(name)->value(0), value) << name;
  }
}

TEST(PlyTest, ListsOfAnyElementArePassedOver) {
  const std::string body =
      "element strip 2\nproperty list uchar short parts\nproperty float w\nelement vertex 2\n" + xyz +
      "property list ushort int views\nproperty float quality\nelement tail 1\nproperty int a\n";
  const auto data = [](auto pack) {
    return pack(std::uint8_t(3), std::int16_t(1), std::int16_t(2), std::int16_t(3), 1.0f, std::uint8_t(0),
                2.0f) +
           pack(1.0f, 2.0f, 3.0f, std::uint16_t(2), std::int32_t(9), std::int32_t(8), 0.25f) +
           pack(4.0f, 5.0f, 6.0f, std::uint16_t(0), 0.75f) + pack(std::int32_t(1));
  };
  for (const std::string& bytes :
       {header("binary_little_endian", body) + data([](auto... v) { return bytes_of(v...); }),
        header("binary_big_endian", body) + data([](auto... v) { return reversed_bytes_of(v...); }),
        header("ascii", body) + "3 1 2 3 1\n0 2\n1 2 3 2 9 8 0.25\n4 5 6 0 0.75\n1\n"}) {
    const PointCloud cloud = io::read(write_file("a.ply", bytes)).cloud;
    ASSERT_EQ(cloud.size(), 2u);
    EXPECT_EQ(cloud.positions[1], vec3(4, 5, 6));
    EXPECT_EQ(cloud.scalar("quality")->values, (std::vector<float>{0.25f, 0.75f}));
    EXPECT_EQ(cloud.scalar("views"), nullptr);
  }
}

TEST(PlyTest, DropsPointsAndNormalsThatAreNotFinite) {
  std::string bytes =
      header("binary_little_endian", "element vertex 5\n" + xyz +
                                         "property float nx\nproperty float ny\nproperty float nz\n"
                                         "property float radius\n");
  bytes += bytes_of(0.f, 0.f, 0.f, 0.f, 0.f, 1.f, 1.f);
  bytes += bytes_of(nan, 0.f, 0.f, 0.f, 0.f, 1.f, 2.f);
  bytes += bytes_of(1.f, 0.f, 0.f, 0.f, 0.f, 0.f, 3.f);
  bytes += bytes_of(2.f, 0.f, 0.f, nan, 0.f, 1.f, 4.f);
  bytes += bytes_of(3.f, 0.f, 0.f, 0.f, 3.f, 4.f, 5.f);
  const io::ReadResult result = io::read(write_file("a.ply", bytes));
  EXPECT_EQ(result.report.points, 5u);
  EXPECT_EQ(result.report.points_finite, 4u);
  EXPECT_EQ(result.report.points_dropped, 1u);
  EXPECT_EQ(result.report.normals_dropped, 2u);
  EXPECT_EQ(result.cloud.normals, (std::vector<vec3>{{0, 0, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0.6f, 0.8f}}));
  EXPECT_EQ(result.cloud.radii, (std::vector<float>{1, 3, 4, 5}));
}

TEST(PlyTest, ColorsOfEveryRangeBecomeBytes) {
  const auto color_of = [](const std::string& type, const std::string& values) {
    const std::string bytes =
        header("ascii", "element vertex 2\n" + xyz + "property " + type + " red\nproperty " + type +
                            " green\nproperty " + type + " blue\n") +
        "0 0 0 " + values + "\n1 1 1 0 0 0\n";
    return io::read(write_file("a.ply", bytes)).cloud.colors.at(0);
  };
  EXPECT_EQ(color_of("uchar", "1 2 255"), (Rgba8{1, 2, 255, 255}));
  EXPECT_EQ(color_of("float", "0 0.5 1"), (Rgba8{0, 128, 255, 255}));
  EXPECT_EQ(color_of("double", "0 12 255"), (Rgba8{0, 12, 255, 255}));
  EXPECT_EQ(color_of("ushort", "65535 256 255"), (Rgba8{255, 1, 0, 255}));  // >> 8
  EXPECT_EQ(color_of("ushort", "255 12 0"), (Rgba8{255, 12, 0, 255}));      // 8 bit in 16
  EXPECT_EQ(color_of("uchar", "1 1 1"), (Rgba8{1, 1, 1, 255}));             // bytes are never fractions
}

TEST(PlyTest, GaussianSplatsHaveTheColoursOfTheirConstantTerms) {
  const std::string terms = "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n";
  const std::string bytes = header("ascii", "element vertex 3\n" + xyz + terms) +
                            "0 0 0 0 1.7724539 -1.7724539\n1 1 1 0.8862269 9 -9\n2 2 2 nan 0 0\n";
  const io::ReadResult result = io::read(write_file("a.ply", bytes));
  // 1.7724539 is sqrt(pi): by 1 / sqrt(4 pi) half the range.
  EXPECT_EQ(result.cloud.colors,
            (std::vector<Rgba8>{{128, 255, 0, 255}, {191, 255, 0, 255}, {128, 128, 128, 255}}));
  EXPECT_THAT(result.report.notes, Contains(HasSubstr("Gaussian splats")));
  // Colours of their own win.
  const std::string both =
      header("ascii", "element vertex 1\n" + xyz + terms +
                          "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
      "0 0 0 0 0 0 1 2 3\n";
  EXPECT_EQ(io::read(write_file("b.ply", both)).cloud.colors.at(0), (Rgba8{1, 2, 3, 255}));
}

TEST(PlyTest, AnIncompleteGroupIsScalars) {
  const std::string bytes =
      header("ascii", "element vertex 1\n" + xyz + "property float nx\nproperty uchar red\n") + "1 2 3 4 5\n";
  const PointCloud cloud = io::read(write_file("a.ply", bytes)).cloud;
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_TRUE(cloud.colors.empty());
  EXPECT_EQ(cloud.scalar("nx")->value(0), 4);
  EXPECT_EQ(cloud.scalar("red")->value(0), 5);
}

TEST(PlyTest, HonoursUpAndCrsComments) {
  const std::string bytes =
      header("ascii", "comment up +Z\r\ncomment crs EPSG:25832\nelement vertex 1\n" + xyz) + "1 2 3";
  const io::ReadResult result = io::read(write_file("a.ply", bytes));
  EXPECT_EQ(result.cloud.up, UpAxis::pos_z);
  EXPECT_EQ(result.report.crs, "EPSG:25832");
  EXPECT_EQ(result.cloud.size(), 1u);
}

TEST(PlyTest, WhatNobodySaidAboutUpIsNotSaidByWriting) {
  PointCloud cloud;
  cloud.positions = {{1, 2, 3}};
  cloud.up = UpAxis::pos_z;  // the custom of LAS, say
  const auto file = std::filesystem::path(testing::TempDir()) / "up.ply";
  for (const bool known : {false, true}) {
    cloud.up_is_known = known;
    io::write(file, cloud);
    const PointCloud back = io::read(file).cloud;
    EXPECT_EQ(back.up, UpAxis::pos_z) << "not +Y, which is the custom of PLY files from elsewhere";
    EXPECT_EQ(back.up_is_known, known);
    EXPECT_EQ(select(back, {0}).up_is_known, known);
  }
}

TEST(PlyTest, LargeCoordinatesKeepTheirDigits) {
  // Doubles: steps of a millimetre at 6.6e6, which float alone would round to half a metre.
  const std::string bytes =
      header("binary_little_endian",
             "element vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
             "property double gps_time\n") +
      bytes_of(500000.001, 6600000.002, 12.003, 300000000.25) +
      bytes_of(500010.004, 6600020.005, 15.006, 300000001.5);
  const PointCloud cloud = io::read(write_file("a.ply", bytes)).cloud;
  EXPECT_NE(cloud.origin, dvec3(0));
  // 24 bits of a 20 m cloud: 1.2e-6
  EXPECT_NEAR(cloud.world(0).y, 6600000.002, 2e-6);
  EXPECT_NEAR(cloud.world(1).x, 500010.004, 2e-6);
  EXPECT_EQ(cloud.scalar("gps_time")->value(0), 300000000.25);
  EXPECT_EQ(cloud.scalar("gps_time")->value(1), 300000001.5);
  const std::filesystem::path copy = temp_file("copy.ply");
  io::write(copy, cloud);
  const PointCloud again = io::read(copy).cloud;
  EXPECT_EQ(again.world(0), cloud.world(0));
  EXPECT_EQ(again.scalar("gps_time")->value(1), 300000001.5);
}

TEST(PlyTest, LargeFloatsMoveToAnOriginWithoutLoss) {
  const float x[] = {5421350.5f, 5421351.f, 5422382.f};
  std::string bytes = header("binary_little_endian", "element vertex 3\n" + xyz);
  for (float v : x) bytes += bytes_of(v, v / 16, v * 1e-7f);
  const PointCloud cloud = io::read(write_file("a.ply", bytes)).cloud;
  EXPECT_NE(cloud.origin.x, 0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(cloud.world(i), dvec3(vec3(x[i], x[i] / 16, x[i] * 1e-7f)));
  // Written as the floats they were.
  const std::filesystem::path copy = temp_file("copy.ply");
  io::write(copy, cloud);
  std::ifstream in(copy, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(text.find("property float x"), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 36), bytes.substr(bytes.size() - 36));
}

PointCloud full_cloud(std::size_t n) {
  PointCloud cloud;
  std::uint32_t state = 1;
  const auto random = [&] { return float(state = state * 1664525u + 1013904223u) * 0x1p-32f - 0.5f; };
  ScalarField intensity{"intensity", 0, {}, StoredType::uint16},
      quality{"quality", 0, {}, StoredType::float32}, time{"time", 1e9, {}, StoredType::float64};
  for (std::size_t i = 0; i < n; ++i) {
    cloud.positions.push_back({random(), random(), random()});
    cloud.normals.push_back(i % 7 == 0 ? vec3(0) : glm::normalize(vec3(random(), random(), random())));
    cloud.colors.push_back(
        {std::uint8_t(i), std::uint8_t(i / 3), std::uint8_t(i / 5), std::uint8_t(i % 2 ? 255 : 9)});
    cloud.radii.push_back(random() + 1);
    intensity.values.push_back(float(i * 17 % 65536));
    quality.values.push_back(random());
    time.values.push_back(float(i));
  }
  cloud.scalars = {intensity, quality, time};
  cloud.up = UpAxis::pos_z;
  cloud.crs = "EPSG:4978";
  return cloud;
}

TEST(PlyTest, RoundTripKeepsEverything) {
  // More points than one block and one thread take.
  const PointCloud cloud = full_cloud(60001);
  const std::filesystem::path file = temp_file("a.ply");
  io::write(file, cloud);
  const PointCloud again = io::read(file).cloud;
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.normals, cloud.normals);
  EXPECT_EQ(again.colors, cloud.colors);
  EXPECT_EQ(again.radii, cloud.radii);
  EXPECT_EQ(again.up, UpAxis::pos_z);
  EXPECT_EQ(again.crs, "EPSG:4978");
  ASSERT_EQ(again.scalars.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again.scalars[k].name, cloud.scalars[k].name);
    EXPECT_EQ(again.scalars[k].type, cloud.scalars[k].type);
    for (std::size_t i = 0; i < cloud.size(); i += 997)
      EXPECT_EQ(again.scalars[k].value(i), cloud.scalars[k].value(i)) << cloud.scalars[k].name << i;
  }
  const std::filesystem::path second = temp_file("b.ply");
  io::write(second, again);
  EXPECT_EQ(std::filesystem::file_size(file), std::filesystem::file_size(second));
}

TEST(PlyTest, RealFileRoundTripIsExact) {
  SFUMATO_NEEDS_REAL_SCAN("Guanyin.ply");
  const PointCloud cloud = io::read(test::data_folder() / "Guanyin.ply").cloud;
  EXPECT_EQ(cloud.origin, dvec3(0));
  const std::filesystem::path copy = temp_file("copy.ply");
  io::write(copy, cloud);
  const PointCloud again = io::read(copy).cloud;
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.colors, cloud.colors);
}

TEST(PlyTest, DroppedPointsAcrossThreadsLeaveNoGap) {
  std::string bytes = header("binary_little_endian", "element vertex 50000\n" + xyz + "property int id\n");
  std::vector<double> kept;
  for (int i = 0; i < 50000; ++i) {
    const bool bad = i % 3 == 0 || (i > 20000 && i < 30000);
    bytes += bytes_of(float(i), bad ? nan : 0.f, 0.f, i);
    if (!bad) kept.push_back(i);
  }
  const io::ReadResult result = io::read(write_file("a.ply", bytes));
  ASSERT_EQ(result.cloud.size(), kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ASSERT_EQ(result.cloud.positions[i].x, float(kept[i]));
    ASSERT_EQ(result.cloud.scalar("id")->value(i), kept[i]);
  }
  EXPECT_EQ(result.report.bounds_max.x, kept.back());
}

TEST(PlyTest, AsciiInManyBlocksKeepsFileOrder) {
  // 9 MB of text: three blocks.
  const int n = 400000;
  std::string bytes =
      header("ascii", "element vertex " + std::to_string(n) + "\n" + xyz + "element face 0\n");
  for (int i = 0; i < n; ++i) bytes += std::to_string(i) + " 0.25 -1.5e2 \n" + (i % 1000 ? "" : "\n");
  bytes += std::string(2 << 20, ' ').replace((1 << 20) - 1, 1, "\n");
  const PointCloud cloud = io::read(write_file("a.ply", bytes)).cloud;
  ASSERT_EQ(cloud.size(), std::size_t(n));
  for (int i = 0; i < n; i += 1) ASSERT_EQ(cloud.positions[std::size_t(i)], vec3(float(i), 0.25f, -150));
}

TEST(PlyTest, MeshesAreFannedAndDroppedCornersLeaveTheirTriangles) {
  const std::string body = "element vertex 5\n" + xyz +
                           "element face 3\nproperty uchar flag\n"
                           "property list uchar int vertex_indices\n";
  std::string binary = header("binary_little_endian", body);
  for (float i : {0.f, 1.f, 2.f, nan, 4.f}) binary += bytes_of(i, i, i);
  binary += bytes_of(std::uint8_t(1), std::uint8_t(3), 0, 1, 2) +
            bytes_of(std::uint8_t(1), std::uint8_t(4), 0, 1, 2, 4) +
            bytes_of(std::uint8_t(1), std::uint8_t(3), 0, 1, 3);
  const std::string ascii =
      header("ascii", body) + "0 0 0\n1 1 1\n2 2 2\nnan 3 3\n4 4 4\n1 3 0 1 2\n1 4 0 1 2 4\n1 3 0 1 3\n";
  for (const std::string& bytes : {binary, ascii}) {
    const Mesh mesh = io::read_mesh(write_file("a.ply", bytes));
    EXPECT_EQ(mesh.positions.size(), 4u);
    const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(mesh.triangles, expected);
  }
  std::string damaged = binary;
  damaged[damaged.size() - 1] = 1;
  EXPECT_THROW(io::read_mesh(write_file("b.ply", damaged)), Error);
  EXPECT_NO_THROW(io::read(write_file("b.ply", damaged)));  // faces do not matter to points
}

TEST(PlyTest, DamageBehindTheLastPointIsNoError) {
  const std::string bytes =
      header("binary_little_endian",
             "element vertex 1\n" + xyz + "element face 9\nproperty list uchar int vertex_index\n") +
      bytes_of(1.f, 2.f, 3.f) + "\xff";
  EXPECT_EQ(io::read(write_file("a.ply", bytes)).cloud.size(), 1u);
}

TEST(PlyTest, AFileOfNoPointsIsValid) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const io::ReadResult result = io::read(write_file("a.ply", header(format, "element vertex 0\n" + xyz)));
    EXPECT_EQ(result.report.points, 0u);
    EXPECT_TRUE(result.cloud.empty());
    const std::filesystem::path copy = temp_file("copy.ply");
    io::write(copy, result.cloud);
    EXPECT_EQ(io::read(copy).report.points, 0u);
  }
}

struct BadPly {
  const char* what;
  std::string bytes, message;
};

TEST(PlyTest, BadHeadersAreNamedByTheirLine) {
  const std::string start = "ply\nformat ascii 1.0\n";
  const BadPly cases[] = {
      {"no end", start + "element vertex 1\n" + xyz, "line 7"},
      {"format", "ply\nformat nonsense 1.0\nend_header\n", "line 2"},
      {"count", start + "element vertex -4\n" + xyz + "end_header\n1 2 3\n", "line 3"},
      {"type", start + "element vertex 1\nproperty floaty x\nend_header\n", "line 4"},
      {"homeless property", start + xyz + "end_header\n", "line 3"},
      {"no vertex", start + "element face 1\nproperty int a\nend_header\n1\n", "no 'element vertex'"},
      {"no z", start + "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
       "x, y and z"},
      {"promise", header("binary_little_endian", "element vertex 4000000000000000000\n" + xyz) + "abc",
       "0 points"},
      {"lists promise",
       header("binary_little_endian",
              "element vertex 4000000000000\n" + xyz + "property list uchar int a\n") +
           "abc",
       "at most 0 points"},
      {"ascii promise", header("ascii", "element vertex 4000000000000\n" + xyz) + "\n", "0 points,"},
      {"list before",
       header("binary_little_endian", "element f 9\nproperty list uint int a\nelement vertex 1\n" + xyz) +
           bytes_of(std::uint32_t(4000000000u), 1, 2, 3, 4, 5),
       "byte"},
      {"word", header("ascii", "element vertex 2\n" + xyz) + "1 2 3\n1 two 3\n", "line 9: found 'two'"},
      {"short line", header("ascii", "element vertex 2\n" + xyz) + "1 2 3\n1 2\n", "line 9"},
  };
  for (const BadPly& bad : cases) {
    const std::optional<Error> error = test::error_of(write_file("a.ply", bad.bytes));
    ASSERT_TRUE(error.has_value()) << bad.what;
    EXPECT_EQ(error->code(), ErrorCode::bad_input) << bad.what;
    EXPECT_NE(std::string(error->what()).find(bad.message), std::string::npos)
        << bad.what << ": " << error->what();
    EXPECT_NE(std::string(error->what()).find("a.ply"), std::string::npos) << bad.what;
  }
}

// Records of 13 bytes, lines and vertices of several lines, of which the file holds fewer than its header
// says: whole ones are kept, a number that may be cut is not.
TEST(PlyTest, WhatACutFileHoldsIsRead) {
  const std::string three = "element vertex 3\n" + xyz;
  std::string binary = header("binary_little_endian", three + "property uchar a\nelement face 1\n" +
                                                          "property list uchar int vertex_indices\n");
  for (float i : {1.f, 2.f}) binary += bytes_of(i, 0.f, 0.f, std::uint8_t(7));
  const struct {
    std::string bytes;
    std::size_t held;
  } cuts[] = {{binary + std::string(12, 'x'), 2},
              {header("ascii", three) + "1 2 3\n4 5 6\n", 2},
              {header("ascii", three) + "1 2 3\n4 5 6", 1},
              {header("ascii", three + "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
                   "1 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5\n",
               2}};
  for (const auto& [bytes, held] : cuts) {
    const std::filesystem::path file = write_file("cut.ply", bytes);
    io::ReadOptions options;
    options.samples_faces = true;
    const io::ReadResult read = io::read(file, options);
    EXPECT_EQ(read.cloud.size(), held) << bytes;
    EXPECT_EQ(read.report.points, 3u);
    EXPECT_EQ(read.report.points_missing, 3 - held);
    EXPECT_EQ(read.report.points_dropped, 0u);
    EXPECT_THAT(read.report.damage, testing::ElementsAre(HasSubstr(", expected 3; fetch the rest")));
    EXPECT_TRUE(read.report.notes.empty()) << read.report.notes[0];
    EXPECT_TRUE(read.cloud.grid_index.empty());
    options.strict = true;
    EXPECT_TRUE(test::error_of(file, options).has_value());
  }
}

TEST(PlyTest, CutAndChangedFilesNeverCrash) {
  const std::string vertices = "element vertex 3\n" + xyz + "property uchar a\n";
  const std::string lists = "element f 1\nproperty list uchar int q\nelement vertex 2\n" + xyz;
  std::string binary = header("binary_little_endian", vertices), walked = header("binary_big_endian", lists);
  for (float i : {1.f, 2.f, 3.f}) binary += bytes_of(i, i, i, std::uint8_t(i));
  walked += reversed_bytes_of(std::uint8_t(2), 7, 8, 1.f, 2.f, 3.f, 4.f, 5.f, 6.f);
  const std::string ascii = header("ascii", lists) + "2 7 8\n1 2 3\n4 5 6\n";
  // Binary files tell every cut; the ascii file may lose its last line end, and "4 5 6" its last digit is
  // needed.
  EXPECT_EQ(test::expect_cuts_are_safe("a.ply", binary, 3), int(binary.size()));
  EXPECT_EQ(test::expect_cuts_are_safe("b.ply", walked, 2), int(walked.size()));
  EXPECT_EQ(test::expect_cuts_are_safe("c.ply", ascii, 2), int(ascii.size()) - 1);
  test::expect_changes_are_safe("d.ply", binary);
  test::expect_changes_are_safe("e.ply", walked);
  test::expect_changes_are_safe("f.ply", ascii);
}

}  // namespace
}  // namespace sfumato
