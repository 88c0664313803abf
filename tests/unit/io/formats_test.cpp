// E57, PTX, PTS, NPY and KITTI files made here byte by byte: what they mean, and that damage is an error.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "io/e57_file.h"
#include "io/image_exr.h"
#include "unit/io/files.h"
#include "unit/io/format_bytes.h"

namespace sfumato {
namespace {

using namespace test;

TEST(E57, ChecksumIsCrc32c) {
  const std::string text = "123456789";  // the check value of the polynomial, RFC 3720
  EXPECT_EQ(io::crc32c(reinterpret_cast<const std::byte*>(text.data()), text.size()), 0xE3069283u);
}

TEST(E57, ScansOfEveryCodecWithTheirPoses) {
  const io::ReadResult result = io::read(test::write_file("a.e57", two_scans()));
  const PointCloud& cloud = result.cloud;
  EXPECT_EQ(result.report.points, 130u);
  EXPECT_EQ(result.report.points_dropped, 10u) << "invalid cells";
  ASSERT_EQ(cloud.size(), 120u);
  for (std::size_t i = 0; i < 100; ++i) {
    // A quarter turn about z takes (x, y) to (-y, x).
    const dvec3 local(0.5 * (double(i) - 50) + 1, 2.0 * double(i), 5.0 + double(i % 2));
    const dvec3 expected(1000 - local.y, 200 + local.x, local.z);
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(cloud.world(i)[k], expected[k], 1e-4) << i;  // floats about 1000: 6e-5
    EXPECT_EQ(cloud.colors[i].g, 7);
    EXPECT_EQ(cloud.colors[i].r, i);
  }
  EXPECT_NEAR(cloud.world(100).y, 2, 1e-4) << "azimuth of a quarter turn looks along y";
  EXPECT_NEAR(cloud.world(119).z, 2, 1e-4) << "elevation of a quarter turn looks up";
  ASSERT_EQ(cloud.scanners.size(), 2u);
  EXPECT_EQ(cloud.scanners[0], dvec3(1000, 200, 0));
  EXPECT_EQ(cloud.scanners[1], dvec3(0)) << "a spherical scan is measured from its origin";
  ASSERT_TRUE(cloud.scalar("scanner"));
  EXPECT_EQ(cloud.scalar("scanner")->value(119), 1);
}

/// For each pose a scan of one point at 1 0 0 whose normal is along x.
std::string scans_with_poses(const std::vector<std::string>& poses) {
  std::string scans;
  for (std::size_t k = 0; k < poses.size(); ++k)
    scans += R"(<vectorChild type="Structure">)" + poses[k] +
             R"(<points type="CompressedVector" fileOffset="%)" + std::to_string(k) +
             R"(" recordCount="1"><prototype type="Structure">
<cartesianX type="Float"/><cartesianY type="Float"/><cartesianZ type="Float"/><nor:normalX type="Float"/>
<nor:normalY type="Float"/><nor:normalZ type="Float"/></prototype></points></vectorChild>)";
  const std::string one = test::bytes_of(1.0), zero = test::bytes_of(0.0);
  return e57(std::vector(poses.size(), std::vector{one, zero, zero, one, zero, zero}),
             R"(<?xml version="1.0"?><e57Root type="Structure"><data3D type="Vector">)" + scans +
                 "</data3D></e57Root>");
}

const char* const quarter_turn_about_z =
    R"(<pose type="Structure"><rotation type="Structure"><w type="Float">0.7071067811865476</w><x type="Float"/>
<y type="Float"/><z type="Float">0.7071067811865476</z></rotation><translation type="Structure"><x type="Float">10</x>
<y type="Float"/><z type="Float"/></translation></pose>)";

TEST(E57, PosesTurnNormals) {
  const PointCloud cloud =
      io::read(test::write_file("a.e57", scans_with_poses({quarter_turn_about_z, ""}))).cloud;
  EXPECT_LT(glm::distance(cloud.world(0), dvec3(10, 1, 0)), 1e-6);
  EXPECT_LT(glm::distance(cloud.normals.at(0), vec3(0, 1, 0)), 1e-6f) << "turned, not moved";
  EXPECT_EQ(cloud.normals.at(1), vec3(1, 0, 0));
}

TEST(E57, WithoutAPoseTheScannerIsUnknown) {
  EXPECT_TRUE(io::read(test::write_file("a.e57", scans_with_poses({""}))).cloud.scanners.empty());
  const PointCloud cloud =
      io::read(test::write_file("b.e57", scans_with_poses({"", quarter_turn_about_z}))).cloud;
  ASSERT_EQ(cloud.scanners.size(), 2u) << "points number them";
  EXPECT_TRUE(std::isnan(cloud.scanners[0].x));
  EXPECT_EQ(cloud.scanners[1], dvec3(10, 0, 0));
}

TEST(E57, DamageIsAnError) {
  const std::string bytes = two_scans();
  std::mt19937 random(3);
  for (int run = 0; run < 400; ++run) {
    std::string damaged = bytes;
    if (run % 2)
      damaged.resize(random() % damaged.size());
    else
      damaged[random() % damaged.size()] ^= char(1 << random() % 8);
    const std::optional<Error> error = test::error_of(test::write_file("a.e57", damaged));
    ASSERT_TRUE(error) << run << ": every byte is under a checksum";
    EXPECT_EQ(error->code(), ErrorCode::bad_input) << error->what();
  }
  // Whole pages with right checksums and wrong contents.
  for (int run = 0; run < 2000; ++run) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = char(random());
    for (std::size_t at = 0; at + 1024 <= damaged.size(); at += 1024) {
      const std::uint32_t crc = io::crc32c(reinterpret_cast<const std::byte*>(damaged.data() + at), 1020);
      for (int i = 0; i < 4; ++i) damaged[at + 1020 + std::size_t(i)] = char(crc >> (8 * (3 - i)));
    }
    const std::optional<Error> error = test::error_of(test::write_file("a.e57", damaged));
    if (error) EXPECT_EQ(error->code(), ErrorCode::bad_input) << error->what();
  }
}

TEST(Ptx, ScansWithPosesAndMissingCells) {
  const std::string file = std::string("2\n3\n") + ptx_head + "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n" +
                           "1 0 0 0.5\n0 0 0 0.5\n3 0 0 0.25\n4 0 0 1\n5 0 0 1\n0 0 0 0.5\n" + "1\n1\n" +
                           ptx_head + "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" + "7 8 9 0.5 255 0 1\n";
  const io::ReadResult result = io::read(test::write_file("a.ptx", file));
  EXPECT_EQ(result.report.format, "ptx");
  EXPECT_EQ(result.report.points, 7u);
  EXPECT_EQ(result.report.points_dropped, 2u);
  const PointCloud& cloud = result.cloud;
  ASSERT_EQ(cloud.size(), 5u);
  EXPECT_EQ(cloud.world(0), dvec3(10, 21, 30));  // the row vector (1 0 0 1) times the matrix
  EXPECT_EQ(cloud.world(1), dvec3(10, 23, 30));
  EXPECT_EQ(cloud.world(4), dvec3(7, 8, 9));
  EXPECT_EQ(cloud.colors.at(4).b, 1);
  ASSERT_EQ(cloud.grids.size(), 2u);
  EXPECT_EQ(cloud.grids[0].count, 4u);
  EXPECT_EQ(cloud.grids[0].width, 2u);
  EXPECT_EQ(cloud.grid_index,
            (std::vector<std::uint32_t>{0, 4, 1, 3, 0}));  // column after column in the file
  EXPECT_EQ(cloud.scanners.at(0), dvec3(10, 20, 30));
  ASSERT_TRUE(cloud.scalar("scanner"));
}

TEST(Ptx, DamageIsAnError) {
  const std::string file = std::string("2\n2\n") + ptx_head + "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" +
                           "1 0 0 0.5\n2 0 0 0.5\n3 0 0 0.25\n4 0 0 1\n";
  test::expect_cuts_are_safe("a.ptx", file, 4);
  test::expect_changes_are_safe("a.ptx", file);
  const std::optional<Error> error =
      test::error_of(test::write_file("a.ptx", "2000000000\n2000000000\n" + file.substr(4)));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::bad_input);
}

TEST(Pts, ColumnsAreFixed) {
  // Intensities that look like bytes, and colours of zeros, deceive a guess; the count on top says that it is
  // a PTS.
  const PointCloud cloud =
      io::read(test::write_file("a.pts", "2\n1 2 3 100 0 0 0\n4 5 6 -2000 9 0 0\n")).cloud;
  ASSERT_TRUE(cloud.scalar("intensity"));
  EXPECT_EQ(cloud.scalar("intensity")->value(1), -2000);
  EXPECT_EQ(cloud.colors.at(1).r, 9);
  EXPECT_EQ(io::read(test::write_file("b.pts", "1\n1 2 3 0.5\n")).cloud.scalar("intensity")->value(0), 0.5);
}

TEST(Npy, RowsColumnsAndRecords) {
  const std::string rows = test::bytes_of(1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f);
  EXPECT_EQ(io::read(test::write_file("a.npy", npy("'<f4'", "2, 3", rows))).cloud.positions.at(1),
            vec3(4, 5, 6));
  EXPECT_EQ(io::read(test::write_file("b.npy", npy("'<f4'", "2, 3", rows, true))).cloud.positions.at(1),
            vec3(2, 4, 6));
  EXPECT_EQ(io::read(test::write_file("c.npy", npy("'>f8'", "1, 3", test::reversed_bytes_of(1.0, 2.0, 3.0))))
                .cloud.world(0),
            dvec3(1, 2, 3));
  const PointCloud records =
      io::read(
          test::write_file("d.npy", npy("[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('ring', '|u1')]", "2,",
                                        test::bytes_of(1.0f, 2.0f, 3.0f) + "\x05" +
                                            test::bytes_of(4.0f, 5.0f, 6.0f) + "\x06")))
          .cloud;
  EXPECT_EQ(records.positions.at(1), vec3(4, 5, 6));
  EXPECT_EQ(records.scalar("ring")->value(1), 6);
  // The pixels of a depth camera, and a row for each coordinate of more points than there are columns.
  const std::string pixels = rows + test::bytes_of(7.0f, 8.0f, 9.0f, 10.0f, 11.0f, 12.0f);
  const PointCloud picture = io::read(test::write_file("i.npy", npy("'<f4'", "2, 2, 3", pixels))).cloud;
  ASSERT_EQ(picture.size(), 4u);
  EXPECT_EQ(picture.positions.at(2), vec3(7, 8, 9));
  std::string wide_rows;
  for (int k = 0; k < 3 * 300; ++k) wide_rows += test::bytes_of(float(k));
  for (const bool by_column : {false, true}) {
    const std::string shape = by_column ? "300, 3" : "3, 300";
    const PointCloud turned =
        io::read(test::write_file("j.npy", npy("'<f4'", shape, wide_rows, by_column))).cloud;
    ASSERT_EQ(turned.size(), 300u);
    EXPECT_EQ(turned.positions.at(1), vec3(1, 301, 601));
  }
  // Pictures of depths, and channels in rows of pixels.
  for (const char* shape : {"17, 300", "3, 17, 20"})
    EXPECT_TRUE(
        test::error_of(test::write_file("m.npy", npy("'<f4'", shape, std::string(4 * 17 * 300, '\0')))))
        << shape;
  EXPECT_TRUE(test::error_of(test::write_file("k.npy", npy("'<f4'", "2, 2, 3", pixels, true))));
  // NumPy's own names say nothing.
  const std::string unnamed = npy("[('f0', '<f4'), ('f1', '<f4'), ('f2', '<f4'), ('f3', '|u1')]", "1,",
                                  test::bytes_of(1.0f, 2.0f, 3.0f) + "\x05");
  const PointCloud by_place = io::read(test::write_file("h.npy", unnamed)).cloud;
  EXPECT_EQ(by_place.positions.at(0), vec3(1, 2, 3));
  EXPECT_EQ(by_place.scalar("f3")->value(0), 5);
  io::ReadOptions named;
  named.columns = {"z", "y", "x", "ring"};
  EXPECT_EQ(io::read(test::write_file("h.npy", unnamed), named).cloud.positions.at(0), vec3(3, 2, 1));
  named.columns = {"x", "y", "z"};
  EXPECT_THROW(io::read(test::write_file("h.npy", unnamed), named), Error);
  // Fields of several numbers, as structured arrays of other programs have them.
  const std::string fields =
      npy("[('xyz', '<f4', (3,)), ('normal', '<f4', (3,)), ('rgb', '|u1', (3,)), ('pair', '|u1', (1, 2)), "
          "('ring', '|u1')]",
          "1,", test::bytes_of(1.0f, 2.0f, 3.0f, 0.0f, 0.0f, 1.0f) + "\x05\x06\x07\x08\x09\x0a");
  const PointCloud wide = io::read(test::write_file("e.npy", fields)).cloud;
  EXPECT_EQ(wide.positions.at(0), vec3(1, 2, 3));
  EXPECT_EQ(wide.normals.at(0), vec3(0, 0, 1));
  EXPECT_EQ(wide.colors.at(0), (Rgba8{5, 6, 7, 255}));
  EXPECT_EQ(wide.scalar("pair_1")->value(0), 9);
  EXPECT_EQ(wide.scalar("ring")->value(0), 10);
  // Fractions that were computed end a little above 1.
  const PointCloud bright =
      io::read(test::write_file("g.npy", npy("[('xyz', '<f4', (3,)), ('rgb', '<f4', (3,))]", "1,",
                                             test::bytes_of(1.0f, 2.0f, 3.0f, 1.0000001f, 0.2f, 0.0f))))
          .cloud;
  EXPECT_EQ(bright.colors.at(0), (Rgba8{255, 51, 0, 255}));
  const auto error = test::error_of(
      test::write_file("f.npy", npy("[('x', '<f4'), ('y', '<f4'), ('z', '<f4', (99999999999, 99999999999))]",
                                    "1,", test::bytes_of(1.0f, 2.0f, 3.0f))));
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("more than 512 numbers"), std::string::npos) << error->what();
  const std::string file = npy("'<f4'", "2, 3", rows);
  test::expect_cuts_are_safe("a.npy", file, 2);
  test::expect_changes_are_safe("a.npy", file);
}

TEST(Npz, ArraysBecomeColumnsByTheirNames) {
  for (const bool deflated : {false, true}) {
    const std::string bytes = npz_cloud(deflated);
    const io::ReadResult result = io::read(test::write_file("a.npz", bytes));
    EXPECT_EQ(result.report.format, "npz");
    const PointCloud& cloud = result.cloud;
    ASSERT_EQ(cloud.size(), 4u);
    EXPECT_EQ(cloud.positions[3], vec3(10, 11, 12));
    EXPECT_EQ(cloud.colors.at(2).r, 255);
    EXPECT_NEAR(cloud.scalar("intensity")->value(3), 1e-3, 1e-9);
    EXPECT_FALSE(cloud.scalar("other"));
    ASSERT_EQ(result.report.notes.size(), 1u);
    EXPECT_NE(result.report.notes[0].find("'other' is left out"), std::string::npos)
        << result.report.notes[0];
    test::expect_cuts_are_safe("a.npz", bytes, 4);
    test::expect_changes_are_safe("a.npz", bytes);
  }
  const auto lists =
      test::write_file("b.npz", zip({{"x.npy", npy("'<f4'", "2,", test::bytes_of(1.0f, 2.0f))},
                                     {"y.npy", npy("'<f4'", "2,", test::bytes_of(3.0f, 4.0f))},
                                     {"z.npy", npy("'<i2'", "2,", test::bytes_of(short(5), short(6)))}},
                                    true));
  EXPECT_EQ(io::read(lists).cloud.positions.at(1), vec3(2, 4, 6));
  const auto none = test::error_of(
      test::write_file("c.npz", zip({{"q.npy", npy("'<f4'", "2,", test::bytes_of(1.0f, 2.0f))}}, true)));
  ASSERT_TRUE(none);
  EXPECT_NE(std::string(none->what()).find("name one so"), std::string::npos) << none->what();
  // Fields without a name are called after their array, as all of it is.
  const auto nameless =
      test::write_file("e.npz", zip({{"xyz.npy", npy("[('', '<f4'), ('', '<f4'), ('z', '<f4')]", "1,",
                                                     test::bytes_of(1.0f, 2.0f, 3.0f))}},
                                    false));
  EXPECT_EQ(io::read(nameless).cloud.positions.at(0), vec3(1, 2, 3));
  // Zeros pack a thousandfold; a file that unpacks to gigabytes is no scan.
  EXPECT_TRUE(test::error_of(test::write_file(
      "d.npz", zip({{"xyz.npy", npy("'<f4'", "8000000, 3", std::string(96'000'000, '\0'))}}, true))));
}

#ifdef SFUMATO_DRACO
TEST(Draco, PointsColoursAndScalars) {
  const io::ReadResult result = io::read(test::write_file("a.drc", draco_cloud()));
  EXPECT_EQ(result.report.format, "draco");
  const PointCloud& cloud = result.cloud;
  ASSERT_EQ(cloud.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(cloud.positions[i], vec3(float(i % 10), float(i / 10 % 10), float(i / 100)))
        << i;  // sequential: in order, exact
    ASSERT_EQ(cloud.colors[i].r, i % 256);
    ASSERT_EQ(cloud.scalar("intensity")->value(i), double(i * 7 % 65536));
  }
  const std::string bytes = draco_cloud();
  for (std::size_t length = 0; length < bytes.size(); length += 101) {
    const auto error = test::error_of(test::write_file("b.drc", bytes.substr(0, length)));
    ASSERT_TRUE(error) << length;
    EXPECT_EQ(error->code(), ErrorCode::bad_input) << error->what();
  }
}

TEST(Draco, MeshesAreSampledOnTheirFaces) {
  for (const int encoding : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string bytes = draco_mesh(encoding);
    const auto file = test::write_file("mesh.drc", bytes);
    const PointCloud vertices = io::read(file).cloud;
    EXPECT_EQ(vertices.size(), 81u) << encoding;
    EXPECT_EQ(vertices.up, UpAxis::pos_y) << "as of other meshes, though only the vertices were wanted";
    EXPECT_EQ(vertices.provenance, Provenance::model);
    EXPECT_EQ(io::read_mesh(file).triangles.size(), 128u) << encoding;
    io::ReadOptions drawn;
    drawn.samples_faces = true;
    const PointCloud cloud = io::read(file, drawn).cloud;
    EXPECT_TRUE(cloud.of_faces);
    EXPECT_EQ(cloud.up, UpAxis::pos_y) << "as of other meshes";
    ASSERT_GT(cloud.size(), 100'000u) << "about one a pixel";
    std::array<std::size_t, 25> places{};
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const dvec3 p = cloud.world(i);
      ASSERT_NEAR(p.z, 2, 1e-5);
      EXPECT_EQ(cloud.colors.at(i), (Rgba8{255, 0, 0, 255}));
      ++places[std::size_t(std::clamp(p.x / 2, 0.0, 4.0)) * 5 + std::size_t(std::clamp(p.y / 2, 0.0, 4.0))];
    }
    const auto [least, most] = std::minmax_element(places.begin(), places.end());
    EXPECT_GT(double(*least), 0.9 * double(*most)) << "evenly";
    for (std::size_t length = 0; length < bytes.size(); length += 13) {
      const auto error = test::error_of(test::write_file("cut.drc", bytes.substr(0, length)), drawn);
      ASSERT_TRUE(error) << length;
      EXPECT_EQ(error->code(), ErrorCode::bad_input) << error->what();
    }
    std::mt19937 random(3);
    for (int run = 0; run < 60; ++run) {
      std::string damaged = bytes;
      damaged[11 + random() % (damaged.size() - 11)] = char(random());
      const auto at = test::write_file("damaged.drc", damaged);
      try {
        const Mesh mesh = io::read_mesh(at);
        for (const auto& triangle : mesh.triangles)
          for (const std::uint32_t corner : triangle) ASSERT_LT(corner, mesh.positions.size());
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_input) << error.what();
      }
    }
  }
}
#endif

TEST(Kitti, FloatsByExtension) {
  const io::ReadResult result = io::read(
      test::write_file("000000.bin", test::bytes_of(1.0f, 2.0f, 3.0f, 0.5f, 4.0f, 5.0f, 6.0f, 1.0f)));
  EXPECT_EQ(result.report.format, "kitti");
  EXPECT_EQ(result.cloud.positions.at(1), vec3(4, 5, 6));
  EXPECT_EQ(result.cloud.scalar("intensity")->value(0), 0.5);
  EXPECT_TRUE(test::error_of(test::write_file("a.bin", std::string(20, 'x'))));
  EXPECT_TRUE(test::error_of(test::write_file("b.bin", std::string(1600, 'x')))) << "1e21 m is no street";
}

TEST(DepthImage, OfFloatsIsAnExr) {
  Image<float> depth(3, 2);
  const float values[] = {1, 0, 2, 1, std::numeric_limits<float>::infinity(), 0.5f};
  std::copy(std::begin(values), std::end(values), depth.data());
  const std::filesystem::path exr = test::temp_file("d.exr");
  io::write_exr(exr, {}, depth, {});
  const std::string json =
      "{\"depth\": \"" + exr.filename().string() + "\", \"fx\": 2, \"fy\": 4, \"cx\": 1, \"cy\": 0}";
  const io::ReadResult result = io::read(test::write_file("a.json", json));
  EXPECT_EQ(result.report.points, 6u);
  ASSERT_EQ(result.cloud.size(), 4u) << "0 and infinity are no measurements";
  EXPECT_EQ(result.cloud.world(1), dvec3(1, 0, 2));
  EXPECT_EQ(result.cloud.world(3), dvec3(0.25, 0.125, 0.5));
  EXPECT_EQ(result.cloud.grids.at(0).width, 3u);
  std::ifstream in(exr, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::mt19937 random(5);
  for (int run = 0; run < 300; ++run) {
    std::string damaged = bytes;
    if (run % 2)
      damaged.resize(random() % damaged.size());
    else
      damaged[random() % damaged.size()] = char(random());
    test::write_file("d.exr", damaged);
    if (const auto error = test::error_of(test::write_file("a.json", json)))
      EXPECT_EQ(error->code(), ErrorCode::bad_input) << error->what();
  }
}

TEST(DepthImage, IsAnOrganisedCloud) {
  const std::string picture = png16(3, 2, {5000, 0, 10000, 5000, 5000, 2500});
  const std::filesystem::path png = test::write_file("d.png", picture);
  const std::string json =
      "{\"depth\": \"" + png.filename().string() + "\", \"fx\": 2, \"fy\": 4, \"cx\": 1, \"cy\": 0";
  const io::ReadResult result = io::read(test::write_file("a.json", json + "}"));
  EXPECT_EQ(result.report.points, 6u);
  EXPECT_EQ(result.report.points_dropped, 1u);
  const PointCloud& cloud = result.cloud;
  ASSERT_EQ(cloud.size(), 5u);
  EXPECT_EQ(cloud.world(0), dvec3(-0.5, 0, 1));
  EXPECT_EQ(cloud.world(1), dvec3(1, 0, 2));
  EXPECT_EQ(cloud.world(4), dvec3(0.25, 0.125, 0.5));
  EXPECT_EQ(cloud.grid_index, (std::vector<std::uint32_t>{0, 2, 3, 4, 5}));
  EXPECT_EQ(cloud.grids.at(0).width, 3u);
  // A quarter turn about z takes (x, y) to (-y, x).
  const PointCloud moved =
      io::read(test::write_file("b.json", json + ", \"pose\": [10, 0, 0, 0, 0, 0.70710678, 0.70710678]}"))
          .cloud;
  EXPECT_NEAR(moved.world(4).x, 10 - 0.125, 1e-6);
  EXPECT_NEAR(moved.world(4).y, 0.25, 1e-6);
  EXPECT_EQ(moved.scanners.at(0), dvec3(10, 0, 0));
  for (const char* bad :
       {", \"pose\": [1]}", ", \"zoom\": 1}", ", \"depth_scale\": 0}", ", \"color\": \"none.png\"}"})
    EXPECT_TRUE(test::error_of(test::write_file("c.json", json + bad))) << bad;
  const std::string without_cy = json.substr(0, json.find(", \"cy\"")) + "}";
  const auto incomplete = test::error_of(test::write_file("c.json", without_cy));
  ASSERT_TRUE(incomplete);
  EXPECT_NE(std::string(incomplete->what()).find("needs depth, fx, fy, cx and cy"), std::string::npos);
  for (std::size_t length = 0; length < picture.size(); length += 3) {
    test::write_file("d.png", picture.substr(0, length));
    const std::optional<Error> error = test::error_of(test::write_file("a.json", json + "}"));
    if (length < picture.size() - 30) EXPECT_TRUE(error) << length;  // the checksums at the end nobody needs
  }
}

#ifndef __SANITIZE_ADDRESS__
TEST(Laz, TakesNoMemoryOnTheWordOfAHeader) {
  // One point that claims to be four million, with eight scalars: 4e6 points would take 300 MB and more.
  PointCloud cloud;
  cloud.positions = {vec3(1, 2, 3)};
  for (int k = 0; k < 16; ++k)
    cloud.set_scalar({"extra" + std::to_string(k), 0, {0.5f}, StoredType::float32});
  const std::filesystem::path file = test::temp_file("a.laz");
  io::write(file, cloud);
  std::ifstream in(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const std::string count = le(4'000'000, 4);
  bytes.replace(107, 4, count);
  bytes.replace(247, 4, count);
  const std::size_t vlr = bytes.find("laszip encoded") - 2 + 54;
  bytes.replace(vlr + 12, 4, le(8'000'000, 4));  // points a chunk
  const std::filesystem::path damaged = test::write_file("b.laz", bytes);
  const pid_t child = fork();
  if (child == 0) {
    struct rlimit limit {};
    long mapped_pages = 0;
    std::ifstream("/proc/self/statm") >> mapped_pages;
    limit.rlim_cur = limit.rlim_max =
        rlim_t(mapped_pages) * rlim_t(sysconf(_SC_PAGESIZE)) + (rlim_t(128) << 20);
    setrlimit(RLIMIT_AS, &limit);
    try {
      io::read(damaged);
    } catch (const Error& error) {
      _exit(int(error.code()));
    } catch (...) {
      _exit(99);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), int(ErrorCode::bad_input));
}
#endif

}  // namespace
}  // namespace sfumato
