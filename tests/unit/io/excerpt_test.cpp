// Excerpts of large files: every point is one that was written, with all it holds, and they come from
// everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "io/record_tap.h"
#include "unit/io/files.h"

namespace sfumato::test {
namespace {

constexpr std::size_t total = 200'000, wanted = 2'000;

// Point i, in numbers that floats, steps of a millimetre and text hold exactly.
vec3 place(std::size_t i) { return {0.125f * float(i), float(i % 97), 0.5f * float(i % 89)}; }
Rgba8 color(std::size_t i) { return {std::uint8_t(i), std::uint8_t(i >> 8), 7, 255}; }
float intensity(std::size_t i) { return float(i % 1000); }

PointCloud numbered_cloud() {
  PointCloud cloud;
  ScalarField field{"intensity", 0, {}, StoredType::uint16};
  for (std::size_t i = 0; i < total; ++i) {
    cloud.positions.push_back(place(i));
    cloud.colors.push_back(color(i));
    field.values.push_back(intensity(i));
  }
  cloud.set_scalar(std::move(field));
  return cloud;
}

enum Holds { only_places = 0, colors = 1, scalars = 2 };

void expect_some(const std::optional<io::ReadResult>& excerpt, int holds, bool knows_total = true) {
  ASSERT_TRUE(excerpt);
  const PointCloud& cloud = excerpt->cloud;
  EXPECT_GT(cloud.size(), wanted / 2);
  EXPECT_LT(cloud.size(), 2 * wanted);
  if (knows_total) EXPECT_EQ(excerpt->report.points, total);
  std::set<std::size_t> seen;
  int quarters[4] = {};
  const ScalarField* field = cloud.scalar("intensity");
  if (holds & scalars) ASSERT_TRUE(field);
  if (holds & colors) ASSERT_EQ(cloud.colors.size(), cloud.size());
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const dvec3 p = cloud.world(k);
    const auto i = std::size_t(std::lround(p.x / 0.125));
    ASSERT_LT(i, total);
    EXPECT_TRUE(seen.insert(i).second) << "point " << i << " twice";
    ASSERT_NEAR(glm::length(p - dvec3(place(i))), 0, 2e-3) << i;
    if (holds & colors) ASSERT_EQ(cloud.colors[k], color(i)) << i;
    if (holds & scalars) ASSERT_EQ(field->value(k), double(intensity(i))) << i;
    ++quarters[4 * i / total];
  }
  for (const int points : quarters) EXPECT_GT(points, int(wanted) / 16);
}

void expect_excerpt(const std::filesystem::path& file, int holds, bool knows_total = true) {
  SCOPED_TRACE(file.string());
  const auto excerpt = io::read_excerpt(file, wanted);
  expect_some(excerpt, holds, knows_total);
  if (excerpt) EXPECT_EQ(excerpt->report.file, file);
}

TEST(Excerpt, HoldsPointsFromEverywhereInTheFile) {
  const PointCloud cloud = numbered_cloud();
  for (const char* name : {"a.las", "a.laz", "a.ply", "a.pcd"}) {
    io::write(temp_file(name), cloud);
    expect_excerpt(temp_file(name), colors | scalars);
  }
  io::write(temp_file("a.csv"), cloud);
  expect_excerpt(temp_file("a.csv"), colors | scalars, false);
}

TEST(Excerpt, OfLayeredChunks) {  // point formats 6 to 10
  PointCloud cloud = numbered_cloud();
  cloud.set_scalar({"nir", 0, std::vector<float>(total, 300.0f), StoredType::uint16});
  io::write(temp_file("a.laz"), cloud);
  expect_excerpt(temp_file("a.laz"), colors | scalars);
  io::write(temp_file("a.las"), cloud);
  expect_excerpt(temp_file("a.las"), colors | scalars);
}

std::string lines(const std::function<std::string(std::size_t)>& line) {
  std::string text;
  for (std::size_t i = 0; i < total; ++i) text += line(i) + "\n";
  return text;
}
std::string numbers(std::size_t i) {
  const vec3 p = place(i);
  return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
}

TEST(Excerpt, OfLines) {
  const std::string body = lines(numbers), count = std::to_string(total);
  expect_excerpt(
      write_file("a.ply", "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex " + count +
                              "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + body),
      only_places);
  expect_excerpt(
      write_file("a.pcd",
                 "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                     count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA ascii\n" +
                     body),
      only_places);
  expect_excerpt(write_file("a.xyz", "# by hand\n" + body), only_places, false);
  expect_excerpt(write_file("a.pts", count + "\n" + body), only_places, false);
  expect_excerpt(
      write_file("a.obj", "o thing\n" + lines([](std::size_t i) { return "v " + numbers(i); }) + "f 1 2 3\n"),
      only_places, false);
}

// Faces behind the vertices are no matter; a grid becomes a list.
TEST(Excerpt, OfMeshesAndGrids) {
  std::string body;
  for (std::size_t i = 0; i < total; ++i) body += bytes_of(place(i).x, place(i).y, place(i).z);
  expect_excerpt(
      write_file("a.ply",
                 "ply\r\nformat binary_little_endian 1.0\r\nelement vertex " + std::to_string(total) +
                     "\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nelement face 1\r\n"
                     "property list uchar int vertex_indices\r\nend_header\r\n" +
                     body + bytes_of(std::uint8_t(3), 0, 1, 2)),
      only_places);
  expect_excerpt(
      write_file("a.pcd",
                 "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 500\nHEIGHT 400\n"
                 "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 200000\nDATA binary\n" +
                     body),
      only_places);
}

TEST(RecordTap, KeepsSomeOfWhatPasses) {
  const PointCloud cloud = numbered_cloud();
  for (const char* name : {"a.las", "a.laz"}) {
    SCOPED_TRACE(name);
    io::write(temp_file(name), cloud);
    io::RecordTap tap(wanted);
    EXPECT_FALSE(tap.so_far());
    io::ReadOptions options;
    options.tap = &tap;
    EXPECT_EQ(io::read(temp_file(name), options).cloud.size(), total);
    expect_some(tap.so_far(), colors | scalars);
  }
}

TEST(Excerpt, IsNothingWhereReadingIsAsGood) {
  const PointCloud cloud = numbered_cloud();
  for (const char* name : {"a.las", "a.laz", "a.ply", "a.pcd", "a.csv"}) {
    io::write(temp_file(name), cloud);
    EXPECT_FALSE(io::read_excerpt(temp_file(name), total / 3)) << name;
  }
  io::write(temp_file("a.npy"), cloud);  // of a format without excerpts
  EXPECT_FALSE(io::read_excerpt(temp_file("a.npy"), wanted));
}

TEST(Excerpt, OfFilesThatAreCutShortIsNothingOrAnError) {
  const PointCloud cloud = numbered_cloud();
  for (const char* name : {"a.las", "a.laz", "a.ply", "a.pcd", "a.csv"}) {
    io::write(temp_file(name), cloud);
    const auto size = std::filesystem::file_size(temp_file(name));
    for (const std::uintmax_t left : {size / 2, size / 10, std::uintmax_t(300), std::uintmax_t(1)}) {
      std::filesystem::resize_file(temp_file(name), left);
      try {
        const auto excerpt = io::read_excerpt(temp_file(name), wanted);
        if (excerpt) EXPECT_LT(excerpt->cloud.size(), 2 * wanted) << name << " " << left;
      } catch (const Error& error) {
        EXPECT_FALSE(std::string(error.what()).empty());
      }
    }
  }
}

}  // namespace
}  // namespace sfumato::test
