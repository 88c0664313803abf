#include <gtest/gtest.h>

#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::write_file;

TEST(ObjTest, ReadsVerticesAndPassesOverTheRest) {
  const io::ReadResult result = io::read(write_file(
      "a.obj",
      "# by hand\r\nmtllib a.mtl\no thing\nv 1 2 3\r\nvn 0 0 1\nvt 0.5 0.5\nv\t-1.5 2e1 .5 1\nf 1 2 1\n"));
  EXPECT_EQ(result.report.format, "obj");
  EXPECT_EQ(result.cloud.positions, (std::vector<vec3>{{1, 2, 3}, {-1.5f, 20, 0.5f}}));
  EXPECT_EQ(result.cloud.up, UpAxis::pos_y);
  EXPECT_EQ(result.cloud.provenance, Provenance::model);
  EXPECT_TRUE(result.cloud.colors.empty());
}

TEST(ObjTest, ReadsColorsBehindTheCoordinates) {
  const PointCloud cloud = io::read(write_file("a.obj", "v 1 2 3 0 0.5 1\nv 4 5 6 1 1 1\n")).cloud;
  EXPECT_EQ(cloud.colors, (std::vector<Rgba8>{{0, 128, 255, 255}, {255, 255, 255, 255}}));
}

TEST(ObjTest, MeshesAreFanned) {
  const Mesh mesh = io::read_mesh(write_file(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2/4 3//7\nv 0 1 0\nf -4/1 -3/1/1 -2 -1\nv nan 0 0\nf 1 2 5\n"));
  EXPECT_EQ(mesh.positions.size(), 4u);
  const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(mesh.triangles, expected);
}

TEST(ObjTest, RealMeshHasAllItsFaces) {
  SFUMATO_NEEDS_REAL_SCAN("armadillo.obj");
  const Mesh mesh = io::read_mesh(test::data_folder() / "armadillo.obj");
  EXPECT_EQ(mesh.positions.size(), 43243u);
  EXPECT_EQ(mesh.triangles.size(), 86482u);
}

TEST(ObjTest, BadFilesAreOneLine) {
  const std::pair<const char*, const char*> cases[] = {{"v 1 2 3\nv 1 2\n", "line 2: the line ends before z"},
                                                       {"v 1 2 3\nv 1 2 three\n", "line 2: found 'three'"},
                                                       {"o nothing\n\n", "no line 'v x y z'"}};
  for (const auto& [bytes, message] : cases) {
    const std::optional<Error> error = test::error_of(write_file("a.obj", bytes));
    ASSERT_TRUE(error.has_value()) << message;
    EXPECT_EQ(error->code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(error->what()).find(message), std::string::npos) << error->what();
  }
  for (const char* face : {"f 1 2 4\n", "f 1 2 0\n", "f 1 2 x\n", "f 1 2 -4\n"})
    EXPECT_THROW(io::read_mesh(write_file("b.obj", std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\n") + face)), Error)
        << face;
}

TEST(ObjTest, CutAndChangedFilesNeverCrash) {
  const std::string bytes = "# o\nv 1 2 3\nv 4 5 6\nf 1 2 2\n";
  test::expect_cuts_are_safe("a.obj", bytes, 2);
  test::expect_changes_are_safe("b.obj", bytes);
}

}  // namespace
}  // namespace sfumato
