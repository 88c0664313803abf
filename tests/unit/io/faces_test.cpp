// Meshes as points on their faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/image_file.h"
#include "io/image_png.h"
#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::bytes_of;
using test::temp_file;
using test::write_file;

io::ReadResult drawn(const std::filesystem::path& file) {
  io::ReadOptions options;
  options.samples_faces = true;
  return io::read(file, options);
}
io::ReadResult drawn_obj(const std::string& text) { return drawn(write_file("a.obj", text)); }

bool has_note(const io::ReadResult& result, const std::string& words) {
  return std::any_of(result.report.notes.begin(), result.report.notes.end(),
                     [&](const std::string& note) { return note.find(words) != note.npos; });
}

const std::string square = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n";

TEST(FacesTest, ASquareIsFilledEvenly) {
  const io::ReadResult result = drawn_obj(square);
  const PointCloud& cloud = result.cloud;
  // Its diagonal is 720 pixels, so its area is half of those squared.
  EXPECT_NEAR(double(cloud.size()), 720 * 720 / 2, 2);
  EXPECT_TRUE(has_note(result, "1 face sampled to 259200 points (--vertices: the vertices alone)"));
  EXPECT_EQ(result.report.points, cloud.size());
  EXPECT_EQ(cloud.up, UpAxis::pos_y);
  EXPECT_EQ(cloud.provenance, Provenance::model);
  EXPECT_TRUE(cloud.of_faces);
  const int cells = 180;  // of 8 points each, or of 2 of 4 spacings' side
  std::vector<int> counts(cells * cells, 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const vec3& p = cloud.positions[i];
    EXPECT_EQ(p.z, 0);
    EXPECT_EQ(cloud.normals[i], vec3(0, 0, 1));
    ++counts[std::size_t(std::clamp(int(p.y / 2 * cells), 0, cells - 1) * cells +
                         std::clamp(int(p.x / 2 * cells), 0, cells - 1))];
  }
  EXPECT_GE(*std::min_element(counts.begin(), counts.end()), 5);  // of 8; of random ones 42 were empty
  EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 11);
  const float spacing = float(2 / std::sqrt(double(cloud.size())));
  EXPECT_NEAR(cloud.radii.front(), spacing * 1.128f, 1e-3f * spacing);
}

TEST(FacesTest, WhoDoesNotDrawReadsVertices) {
  const io::ReadResult result = io::read(write_file("a.obj", square));
  EXPECT_EQ(result.cloud.size(), 4u);
  EXPECT_FALSE(result.cloud.of_faces);
  EXPECT_TRUE(result.cloud.normals.empty() && result.cloud.grid_index.empty() && result.report.notes.empty());
}

TEST(FacesTest, SliversAreFilledAlongTheirWholeLength) {
  // A strip of 2 x 0.02 of two triangles: points along it are as far apart as across.
  const PointCloud cloud = drawn_obj("v 0 0 0\nv 2 0 0\nv 2 .02 0\nv 0 .02 0\nf 1 2 3\nf 1 3 4\n").cloud;
  std::vector<float> x;
  for (const vec3& p : cloud.positions) x.push_back(p.x);
  std::sort(x.begin(), x.end());
  float gap = 0;
  for (std::size_t i = 1; i < x.size(); ++i) gap = std::max(gap, x[i] - x[i - 1]);
  EXPECT_GT(cloud.size(), 4000u);
  EXPECT_LT(gap, 2 * 2.f / 720);  // two pixels
}

// A depth picture: what is near has small faces, and a hundredth of the area.
TEST(FacesTest, SmallFacesHaveASampleEach) {
  std::string text, faces;
  const auto grid = [&](int side, double from, double size, double z) {
    const int first = int(std::count(text.begin(), text.end(), 'v'));
    for (int i = 0; i <= side; ++i)
      for (int j = 0; j <= side; ++j)
        text += "v " + std::to_string(from + size * i / side) + " " + std::to_string(from + size * j / side) +
                " " + std::to_string(z) + "\n";
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        const int at = first + i * (side + 1) + j + 1;
        faces += "f " + std::to_string(at) + " " + std::to_string(at + side + 1) + " " +
                 std::to_string(at + 1) + "\n";
      }
  };
  grid(100, 0.4, 0.02, 0), grid(2, 0, 1, 1);
  const PointCloud cloud = drawn_obj(text + faces).cloud;
  std::size_t near = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].z > 0.5f) continue;
    ++near;
    EXPECT_LT(cloud.radii[i], 0.02f / 100 * 1.2f);  // of its faces' own spacing
  }
  EXPECT_NEAR(double(near), 10'000, 100);  // where all would be more than are drawn, but for one in a hundred
}

TEST(FacesTest, LabelsAreNotMixed) {
  constexpr int side = 40;
  std::string vertices, faces;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      vertices += std::to_string(i) + " " + std::to_string(j) + (i < 17 ? " 0 200 0 0\n" : " 0 0 0 200\n");
  for (int i = 0; i + 1 < side; ++i)
    for (int j = 0; j + 1 < side; ++j) {
      const int at = i * side + j;
      faces += "4 " + std::to_string(at) + " " + std::to_string(at + 1) + " " +
               std::to_string(at + side + 1) + " " + std::to_string(at + side) + "\n";
    }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1600\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1521\n"
      "property list uchar int vertex_indices\nend_header\n";
  const PointCloud cloud = drawn(write_file("labels.ply", head + vertices + faces)).cloud;
  ASSERT_GT(cloud.colors.size(), 10'000u);
  for (const Rgba8& c : cloud.colors) EXPECT_EQ(c.r + c.b, 200);
  for (const Rgba8& c : cloud.colors) EXPECT_TRUE(c.r == 0 || c.b == 0);
}

TEST(FacesTest, EveryFaceHasItsShareInFileOrder) {
  // Areas of 1, 100 and 1 hundredths.
  const PointCloud cloud = drawn_obj(
                               "v 0 0 0\nv .2 0 0\nv 0 .1 0\nv 0 0 1\nv 2 0 1\nv 0 1 1\nv 0 0 2\nv .2 0 2\n"
                               "v 0 .1 2\nf 1 2 3\nf 4 5 6\nf 7 8 9\n")
                               .cloud;
  std::size_t counts[3] = {};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ++counts[int(cloud.positions[i].z)];
    if (i > 0) ASSERT_GE(cloud.positions[i].z, cloud.positions[i - 1].z);
  }
  EXPECT_NEAR(double(counts[0]) / double(cloud.size()), 1 / 102.0, 1e-4);
  EXPECT_NEAR(double(counts[1]) / double(cloud.size()), 100 / 102.0, 1e-4);
}

TEST(FacesTest, DenseVerticesStay) {
  std::string text;
  const int n = 800;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
  for (int y = 1; y < n; ++y)
    for (int x = 1; x < n; ++x) {
      const int at = y * n + x + 1;
      text += "f " + std::to_string(at - n - 1) + " " + std::to_string(at - n) + " " + std::to_string(at) +
              " " + std::to_string(at - 1) + "\n";
    }
  const io::ReadResult result = drawn_obj(text);
  EXPECT_EQ(result.cloud.size(), std::size_t(n * n));
  EXPECT_TRUE(result.report.notes.empty());
}

TEST(FacesTest, NormalsAreSmoothButForEdges) {
  // A tube of 24 sides: 15 degrees from one to the next; and a lid at a right angle.
  std::string text, lid = "f";
  for (int k = 0; k < 24; ++k)
    for (int z : {0, 1})
      text += "v " + std::to_string(std::cos(k * M_PI / 12)) + " " + std::to_string(std::sin(k * M_PI / 12)) +
              " " + std::to_string(z) + "\n";
  for (int k = 0; k < 24; ++k) {
    const int a = 2 * k + 1, b = 2 * ((k + 1) % 24) + 1;
    text += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(b + 1) + " " +
            std::to_string(a + 1) + "\n";
    lid += " " + std::to_string(a + 1);
  }
  const PointCloud cloud = drawn_obj(text + lid + "\n").cloud;
  std::size_t of_lid = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const vec3 p = cloud.positions[i], n = cloud.normals[i];
    if (p.z > 0.9999f && n.z > 0.5f) {
      ++of_lid;
      EXPECT_GT(n.z, 0.9999f);
    } else {
      const vec3 round = glm::normalize(vec3(p.x, p.y, 0));
      ASSERT_GT(glm::dot(n, round), std::cos(1.0f * float(M_PI) / 180)) << p.x << " " << p.y << " " << p.z;
    }
  }
  EXPECT_GT(of_lid, 10'000u);
}

TEST(FacesTest, NormalsThatBelongElsewhereAreComputed) {
  // A ball of squares whose corners name normals of the ball in another order.
  constexpr int rings = 20, around = 40;
  const auto ball = [](int shift) {
    std::string v, n, f;
    for (int i = 0; i < rings; ++i)
      for (int k = 0; k < around; ++k) {
        const double a = M_PI * (i + 0.5) / rings, b = 2 * M_PI * k / around;
        const std::string at = std::to_string(std::sin(a) * std::cos(b)) + " " +
                               std::to_string(std::sin(a) * std::sin(b)) + " " + std::to_string(std::cos(a)) +
                               "\n";
        v += "v " + at, n += "vn " + at;
        if (i + 1 == rings) continue;
        f += "f";
        for (const int at_corner : {i * around + k, (i + 1) * around + k, (i + 1) * around + (k + 1) % around,
                                    i * around + (k + 1) % around})
          f += " " + std::to_string(at_corner + 1) + "//" +
               std::to_string((at_corner * shift) % (rings * around) + 1);
        f += "\n";
      }
    return drawn_obj(v + n + f);
  };
  for (const int shift : {1, 331}) {
    const io::ReadResult result = ball(shift);
    EXPECT_EQ(result.report.notes.back().find("do not fit") != std::string::npos, shift != 1);
    for (std::size_t i = 0; i < result.cloud.size(); ++i)
      ASSERT_GT(glm::dot(result.cloud.normals[i], glm::normalize(result.cloud.positions[i])), 0.97) << shift;
  }
}

TEST(FacesTest, WhatVerticesAndCornersSayIsInterpolated) {
  const PointCloud cloud =
      drawn_obj("v 0 0 0 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nvn 0 0 -1\nvn 1 0 0\nf 1//1 2//-2 3//1\n")
          .cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_NEAR(cloud.colors[i].r, 255 * cloud.positions[i].x, 1);
    EXPECT_NEAR(cloud.colors[i].g, 255 * cloud.positions[i].y, 1);
    EXPECT_EQ(cloud.normals[i], vec3(0, 0, -1));  // as the file says, against the winding
  }
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float heat\nproperty uchar label\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 0 5\n1 0 0 10 6\n0 1 0 0 7\n3 0 1 2\n";
  const PointCloud scalars = drawn(write_file("a.ply", ply)).cloud;
  for (std::size_t i = 0; i < scalars.size(); ++i) {
    EXPECT_NEAR(scalars.scalar("heat")->value(i), 10 * scalars.positions[i].x, 1e-4);
    const double label = scalars.scalar("label")->value(i);
    EXPECT_TRUE(label == 5 || label == 6 || label == 7);
  }
}

TEST(FacesTest, PicturesBesideTheFileGiveColors) {
  Image<Rgba8> picture(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      picture.at(x, y) = {std::uint8_t(x < 32 ? 200 : 20), std::uint8_t(y < 32 ? 200 : 20), 0, 255};
  const std::filesystem::path png = temp_file("a.png"), jpeg = temp_file("b.jpg");
  io::write_png(png, picture, false);
  io::write_jpeg(jpeg, picture, 95);
  const std::string faces = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
  for (const std::filesystem::path& file : {png, jpeg}) {
    const std::filesystem::path library = write_file(
        "a.mtl", "newmtl wood \nKd 1 1 1\nmap_Kd -s 1 1 1 C:\\nowhere\\" + file.filename().string() + "\n");
    const std::string obj = "mtllib " + library.filename().string() + "\r\n" +
                            square.substr(0, square.find('f')) + "usemtl wood\n" + faces;
    const PointCloud cloud = drawn_obj(obj).cloud;
    ASSERT_EQ(cloud.colors.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const vec3 p = cloud.positions[i];
      if (std::abs(p.x - 1) < 0.1f || std::abs(p.y - 1) < 0.1f || std::min(p.x, p.y) < 0.1f ||
          std::max(p.x, p.y) > 1.9f)
        continue;
      EXPECT_NEAR(cloud.colors[i].r, p.x < 1 ? 200 : 20, 12);
      EXPECT_NEAR(cloud.colors[i].g, p.y > 1 ? 200 : 20, 12);  // row 0 is on top
    }
    const std::string ply =
        "ply\nformat ascii 1.0\ncomment TextureFile " + file.filename().string() +
        "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 .1 .1 .4 .1 .1 .4\n";
    for (const Rgba8& c : drawn(write_file("a.ply", ply)).cloud.colors) {
      ASSERT_NEAR(c.r, 200, 12);
      ASSERT_NEAR(c.g, 20, 12);
    }
  }
  const io::ReadResult without = drawn_obj("mtllib other.mtl\nusemtl wood\n" + square);
  EXPECT_TRUE(without.cloud.colors.empty());
  EXPECT_TRUE(has_note(without, "without colours: other.mtl is not beside the file"));
}

TEST(FacesTest, DamagedPicturesLeaveTheFaces) {
  write_file("a.png", "\x89PNG\r\n\x1a\nand then nothing that makes sense");
  write_file("b.jpg", "\xff\xd8\xff and then nothing");
  for (const char* name : {"a.png", "b.jpg"}) {
    const std::filesystem::path library =
        write_file("a.mtl", "newmtl wood\nmap_Kd " + temp_file(name).filename().string() +
                                "\nKd spectral x\nKd 1\nnewmtl\n");
    const io::ReadResult result =
        drawn_obj("mtllib " + library.filename().string() + "\nusemtl wood\n" + square);
    EXPECT_GT(result.cloud.size(), 1000u);
    EXPECT_TRUE(has_note(result, "without colours: ")) << name;
  }
}

TEST(FacesTest, FacesThatCannotBeAreLeftOut) {
  const io::ReadResult result = drawn_obj(
      "v nan 0 0\nv 0 0 0\nv 2 0 0\nv 2 2 0\nf 2 3 4\nf 2 3 9\nf 1 2 3\nf 2 2 3\nf -1 -2 -3\nf 3\n");
  EXPECT_TRUE(has_note(result, "1 face has a corner that is no vertex (line 6): left out"));
  EXPECT_TRUE(has_note(result, "6 faces sampled to"));
  for (const vec3& p : result.cloud.positions) EXPECT_LE(p.y, p.x + 1e-5f);
  const io::ReadResult damaged = drawn_obj(square + "f 1 2 x\n");
  EXPECT_EQ(damaged.cloud.size(), 4u);
  EXPECT_TRUE(has_note(damaged, "line 6: found the corner 'x'"));
  EXPECT_TRUE(has_note(damaged, "drawn without its faces"));
  EXPECT_EQ(drawn_obj("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n").cloud.size(), 3u);  // no area at all
}

TEST(FacesTest, ConcavePolygonsAreCutFromAPlaceThatSeesAll) {
  // An arrow head of area 2; a fan from its first corner would cover 3.
  const PointCloud cloud = drawn_obj("v 0 0 0\nv 2 -1 0\nv 1 1 0\nv -3 -1 0\nf 4 1 2 3\n").cloud;
  const PointCloud same = drawn_obj("v 0 0 0\nv 2 -1 0\nv 1 1 0\nv -3 -1 0\nf 2 3 4 1\n").cloud;
  for (const PointCloud* each : {&cloud, &same})
    for (const vec3& p : each->positions)
      EXPECT_FALSE(p.x < 0 ? p.y < p.x / 3 - 1e-4f : p.y < -p.x / 2 - 1e-4f) << p.x << " " << p.y;
}

TEST(FacesTest, StripsOfTrianglesAreRead) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  std::string bytes = header;
  for (int z : {0, 1})
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
      bytes += bytes_of(float(x), float(y), float(z));
  bytes += bytes_of(9, 0, 1, 2, 3, -1, 4, 5, 6, 7);
  const io::ReadResult result = drawn(write_file("a.ply", bytes));
  EXPECT_TRUE(has_note(result, "4 faces sampled to"));
  double on[2] = {}, beyond = 0;
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    const vec3 p = result.cloud.positions[i];
    on[int(p.z)] += 1;
    beyond += p.x + p.y > 1;
    EXPECT_EQ(result.cloud.normals[i], vec3(0, 0, 1));
  }
  EXPECT_NEAR(on[0] / on[1], 1, 0.01);
  EXPECT_NEAR(beyond / (on[0] + on[1]), 0.5, 0.01);
}

TEST(FacesTest, FacesHaveColorsOfTheirOwn) {
  const std::string ply =
      "ply\nformat ascii 1.0\nMade by a program that knows no comments\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2 255 0 0\n3 1 3 2 0 0 255\n";
  const PointCloud cloud = drawn(write_file("a.ply", ply)).cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_EQ(cloud.colors[i], cloud.positions[i].x + cloud.positions[i].y < 1 ? (Rgba8{255, 0, 0, 255})
                                                                               : (Rgba8{0, 0, 255, 255}));
}

TEST(FacesTest, PointsOfAScanStayBesideAFewFaces) {
  std::string text = square;
  for (int i = 0; i < 100; ++i) text += "v " + std::to_string(i * 0.01) + " 1 1\n";
  const PointCloud cloud = drawn_obj(text).cloud;
  EXPECT_EQ(
      std::count_if(cloud.positions.begin(), cloud.positions.end(), [](const vec3& p) { return p.z == 1; }),
      100);
}

/// A tetrahedron with its corners at 0 and 2 on the axes.
const std::array<std::array<float, 9>, 4> tetrahedron{{{0, 0, 0, 0, 2, 0, 2, 0, 0},
                                                       {0, 0, 0, 2, 0, 0, 0, 0, 2},
                                                       {0, 0, 0, 0, 0, 2, 0, 2, 0},
                                                       {2, 0, 0, 0, 2, 0, 0, 0, 2}}};
std::string stl_bytes(std::string header, std::uint32_t facets) {
  header.resize(80);
  std::string bytes = header + bytes_of(facets);
  for (const std::array<float, 9>& facet : tetrahedron)
    bytes += bytes_of(0.0f, 0.0f, 0.0f, facet, std::uint16_t(0));
  return bytes;
}
std::string stl_text() {
  std::string text = "solid a b\n";
  for (const std::array<float, 9>& facet : tetrahedron) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (std::size_t k = 0; k < 9; k += 3)
      text += "   vertex " + std::to_string(facet[k]) + " " + std::to_string(facet[k + 1]) + " " +
              std::to_string(facet[k + 2]) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid a b\n";
}

TEST(FacesTest, FacetsOfStlShareTheirCorners) {
  // A binary file may begin with the word of text files.
  std::string capitals = stl_text();
  for (char& c : capitals) c = char(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& bytes :
       {stl_bytes("a scanner", 4), stl_bytes("solid", 4), stl_text(), "  " + capitals}) {
    const std::filesystem::path file = write_file("a.stl", bytes);
    const PointCloud vertices = io::read(file).cloud;
    ASSERT_EQ(vertices.size(), 4u);
    EXPECT_EQ(vertices.positions.at(1), vec3(0, 2, 0));
    EXPECT_EQ(vertices.provenance, Provenance::model);
    const io::ReadResult result = drawn(file);
    EXPECT_TRUE(has_note(result, "4 faces sampled to"));
    EXPECT_EQ(result.cloud.up, UpAxis::pos_z);
    float farthest = 0;
    for (const vec3& p : result.cloud.positions) {
      EXPECT_GE(std::min({p.x, p.y, p.z}), -1e-6f);
      farthest = std::max(farthest, p.x + p.y + p.z);
    }
    EXPECT_NEAR(farthest, 2, 1e-5);
    const Mesh mesh = io::read_mesh(file);
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 4u);
  }
}

TEST(FacesTest, DamagedStlIsAnError) {
  const auto why = [](const std::string& bytes) {
    const std::optional<Error> error = test::error_of(write_file("a.stl", bytes));
    return error && error->code() == ErrorCode::bad_input ? std::string(error->what()) : std::string();
  };
  EXPECT_NE(why(stl_bytes("", 5)).find("ends after 4 facets, expected 5"), std::string::npos);
  EXPECT_NE(why(stl_bytes("", 0)).find("found none"), std::string::npos);
  EXPECT_NE(why(std::string(40, 'a')).find("inside its header"), std::string::npos);
  const std::string text = stl_text();
  EXPECT_NE(why(text.substr(0, text.rfind("vertex"))).find("before its solid"), std::string::npos);
  EXPECT_NE(why("solid\nfacet\nvertex 1 2 a\n").find("line 3"), std::string::npos);
  EXPECT_NE(why(text.substr(0, text.rfind("endsolid"))).find("before its solid"), std::string::npos);
  EXPECT_NE(why("solid\nfacet\nvertex 1 2 3\nendloop\n").find("line 4"), std::string::npos);
  EXPECT_NE(why("solid\nfacet\nvertex 1 2 3\nendsolid\n").find("three corners"), std::string::npos);
  test::expect_cuts_are_safe("a.stl", text, 4);
  test::expect_cuts_are_safe("a.stl", stl_bytes("", 4), 4);
  test::expect_changes_are_safe("a.stl", stl_bytes("", 4));
}

const std::string off_vertices = "0 0 0\n2 0 0 # right\n\n0 2 0\n0 0 2\n",
                  off_faces = "3 0 2 1\n3 0 1 3\n 3 0 3 2\n3 1 2 3\n";

TEST(FacesTest, OffInItsSpellings) {
  for (const std::string header : {"OFF\n4 4 6\n", "# of a museum\n\nOFF # text\r\n4 4 0\r\n", "OFF4 4 0\n",
                                   "OFF 4 4 6\n", "STOFF\n4 4\n"}) {
    const std::filesystem::path file = write_file("a.off", header + off_vertices + off_faces);
    const PointCloud vertices = io::read(file).cloud;
    ASSERT_EQ(vertices.size(), 4u) << header;
    EXPECT_EQ(vertices.positions.at(1), vec3(2, 0, 0));
    EXPECT_EQ(vertices.provenance, Provenance::model);
    EXPECT_TRUE(vertices.colors.empty());
    EXPECT_TRUE(has_note(drawn(file), "4 faces sampled to"));
    EXPECT_EQ(io::read_mesh(file).triangles.size(), 4u);
  }
}

TEST(FacesTest, OffWithNormalsAndColours) {
  const PointCloud cloud = io::read(write_file("a.off",
                                               "CNOFF\n2 0 0\n1 2 3 0 0 1 255 0 0 255\n"
                                               "4 5 6 0 1 0 0 0 255 255\n"))
                               .cloud;
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.normals.at(1), vec3(0, 1, 0));
  EXPECT_EQ(cloud.colors.at(0), (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(cloud.provenance, Provenance::unknown);
  // Colours that the first line does not tell, of 1.
  const PointCloud said =
      io::read(write_file("b.off", "OFF\n2 0 0\n0 0 0 1.0 0.0 0.0\n1 1 1 0.0 0.0 1.0\n")).cloud;
  EXPECT_EQ(said.colors.at(1), (Rgba8{0, 0, 255, 255}));
  const PointCloud faces =
      drawn(write_file("c.off", "OFF\n4 2 0\n" + off_vertices + "3 0 1 2 255 0 0\n3 1 2 3 0.0 0.0 1.0 1.0\n"))
          .cloud;
  ASSERT_EQ(faces.colors.size(), faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const vec3 p = faces.positions[i];
    if (p.z > 1e-4f) EXPECT_EQ(faces.colors[i], (Rgba8{0, 0, 255, 255}));
  }
  EXPECT_EQ(std::count(faces.colors.begin(), faces.colors.end(), Rgba8{255, 0, 0, 255}) > 0, true);
}

TEST(FacesTest, DamagedOffIsAnError) {
  const auto why = [](const std::string& bytes) {
    const std::optional<Error> error = test::error_of(write_file("a.off", bytes));
    return error && error->code() == ErrorCode::bad_input ? std::string(error->what()) : std::string();
  };
  EXPECT_NE(why("OFF\n").find("line 1"), std::string::npos);
  EXPECT_NE(why("OFF BINARY\n4 4 6\n").find("binary OFF"), std::string::npos);
  EXPECT_NE(why("4OFF\n4 4 6\n").find("three coordinates"), std::string::npos);
  EXPECT_NE(why("OFF\n4 four 6\n").find("line 2"), std::string::npos);
  EXPECT_NE(why("OFF\n0 0 0\n").find("no vertices"), std::string::npos);
  EXPECT_NE(why("OFF\n9 0 0\n" + off_vertices).find("expected 9 vertices"), std::string::npos);
  EXPECT_NE(why("OFF\n4 0 0\n0 0 0\n1 1 1\n2 b 2\n3 3 3\n").find("line 5"), std::string::npos);
  const std::string text = "OFF\n4 4 6\n" + off_vertices + off_faces;
  EXPECT_TRUE(has_note(drawn(write_file("a.off", text.substr(0, text.size() - 8))), "expected 4"));
  test::expect_cuts_are_safe("a.off", text, 4);
  test::expect_changes_are_safe("a.off", text);
}

// A fan around the origin, whose triangles share no vertex, and rims that are equally far.
TEST(FacesTest, VerticesAreNoRecordsOfNothing) {
  std::string vertices, faces;
  for (int i = 0; i < 300; ++i) {
    vertices += "0 0 0\n";
    for (const int k : {i, i + 1})
      vertices += std::to_string(std::cos(0.02 * k)) + " " + std::to_string(std::sin(0.02 * k)) + " 0\n";
    faces += "3 " + std::to_string(3 * i) + " " + std::to_string(3 * i + 1) + " " +
             std::to_string(3 * i + 2) + "\n";
  }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 300\nproperty list uchar int vertex_indices\nend_header\n";
  const io::ReadResult result = drawn(write_file("a.ply", head + vertices + faces));
  EXPECT_TRUE(has_note(result, "300 faces sampled to"));
  EXPECT_FALSE(has_note(result, "left out"));
  EXPECT_EQ(io::read(test::temp_file("a.ply")).cloud.size(), 900u) << "whoever asks for vertices";
}

TEST(FacesTest, RealMeshesAreSampled) {
  SFUMATO_NEEDS_REAL_SCAN("armadillo.obj");
  const io::ReadResult result = drawn(test::data_folder() / "armadillo.obj");
  EXPECT_GT(result.cloud.size(), 300'000u);
  EXPECT_TRUE(has_note(result, "86482 faces sampled to"));
}

TEST(FacesTest, CutAndChangedFilesNeverCrash) {
  const std::string bytes = "mtllib a.mtl\nv 1 2 3\nv 4 5 6\nv 4 6 5\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3\n";
  for (std::size_t cut = 0; cut < bytes.size(); ++cut)
    for (int change : {0, 1}) {
      std::string damaged = bytes.substr(0, change ? bytes.size() : cut);
      if (change) damaged[cut] = char(damaged[cut] + 1);
      try {
        drawn_obj(damaged);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_input);
      }
    }
}

}  // namespace
}  // namespace sfumato
