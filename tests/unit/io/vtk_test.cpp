// VTK's formats as VTK writes them: one cloud in every dialect.
#include "io/vtk.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/error.h"
#include "unit/io/files.h"

namespace sfumato::io {
namespace {

const float places[4][3] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11.5}};
const std::uint8_t colors[4][3] = {{200, 10, 20}, {30, 40, 50}, {60, 70, 80}, {90, 100, 110}};
const float heats[4] = {1.5, 2.5, 3.5, 4.5};

template <class T>
std::string bytes_of(T value, bool big) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}
std::string xyz(bool big) {
  std::string all;
  for (const auto& p : places)
    for (float v : p) all += bytes_of(v, big);
  return all;
}
std::string rgb() {
  std::string all;
  for (const auto& c : colors)
    for (std::uint8_t v : c) all += char(v);
  return all;
}
std::string heat(bool big) {
  std::string all;
  for (float v : heats) all += bytes_of(v, big);
  return all;
}

std::string base64(const std::string& bytes) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : letters[v >> (18 - 6 * k) & 63];
  }
  return out;
}

class VtkTest : public ::testing::Test {
 protected:
  void expect_cloud(const std::string& name, const std::string& content) {
    SCOPED_TRACE(name);
    const ReadResult result = read(test::write_file(name, content));
    ASSERT_EQ(result.cloud.size(), 4u);
    ASSERT_EQ(result.cloud.colors.size(), 4u);
    const ScalarField* field = result.cloud.scalar("heat now");
    ASSERT_NE(field, nullptr);
    for (std::size_t i = 0; i < 4; ++i) {
      for (int k = 0; k < 3; ++k) EXPECT_EQ(result.cloud.world(i)[k], double(places[i][k]));
      EXPECT_EQ(result.cloud.colors[i], (Rgba8{colors[i][0], colors[i][1], colors[i][2], 255}));
      EXPECT_EQ(field->value(i), double(heats[i]));
    }
  }
  void expect_refused(const std::string& name, const std::string& content) {
    try {
      read(test::write_file(name, content));
      ADD_FAILURE() << name << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input) << name << error.what();
    }
  }
};

TEST_F(VtkTest, Legacy) {
  const std::string ascii =
      "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 1 2 3 4 5\n6 7 8 9 10 "
      "11.5\n"
      "VERTICES 4 8\n1 0\n1 1\n1 2\n1 3\nCELL_DATA 4\nSCALARS other int\nLOOKUP_TABLE default\n9 9 9 9\n"
      "POINT_DATA 4\nSCALARS heat%20now float 1\nLOOKUP_TABLE default\n1.5 2.5 3.5 4.5\n"
      "SCALARS paint unsigned_char 3\nLOOKUP_TABLE default\n200 10 20 30 40 50 60 70 80 90 100 110\n";
  expect_cloud("ascii.vtk", ascii);
  const std::string binary =
      "# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n" +
      xyz(true) +
      "\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 1 2\n\n"
      "CELLS 2 1\nOFFSETS vtktypeint64\n" +
      std::string(16, '\0') + "\nCONNECTIVITY vtktypeint64\n" + std::string(8, '\0') + "\nCELL_TYPES 1\n" +
      std::string(4, '\0') + "\nPOINT_DATA 4\nFIELD FieldData 2\nheat%20now 1 4 float\n" + heat(true) +
      "\npaint 3 4 unsigned_char\n" + rgb() + "\n";
  expect_cloud("binary.vtk", binary);
  expect_refused("cut.vtk", binary.substr(0, 130));
  expect_refused("many.vtk",
                 "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 400000000 float\n0 1 2\n");
  expect_refused("word.vtk",
                 "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 one 2\n");
  expect_refused("grid.vtk",
                 "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n");
}

TEST_F(VtkTest, Xml) {
  const auto file = [](const std::string& attributes, const std::array<std::string, 3>& arrays,
                       const std::string& end) {
    const auto array = [&](const std::string& head, const std::string& body) {
      return "<DataArray " + head +
             (body.starts_with("offset") ? " format=\"appended\" " + body + "/>" : body + "</DataArray>");
    };
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" " + attributes +
           "><PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"0\"><PointData>" +
           array("type=\"Float32\" Name=\"heat now\"", arrays[1]) +
           array("type=\"UInt8\" Name=\"paint\" NumberOfComponents=\"3\"", arrays[2]) +
           "</PointData><Points>" +
           array("type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\"", arrays[0]) +
           "</Points></Piece></PolyData>" + end + "</VTKFile>\n";
  };
  const auto sized = [](const std::string& bytes, bool big) {
    return bytes_of(std::uint32_t(bytes.size()), big) + bytes;
  };
  expect_cloud("ascii.vtp",
               file("",
                    {" format=\"ascii\">0 1 2 3 4 5 6 7 8\n 9 10 11.5 ", " format=\"ascii\">1.5 2.5 3.5 4.5",
                     " format=\"ascii\">200 10 20 30 40 50 60 70 80 90 100 110"},
                    ""));
  for (const bool big : {false, true}) {
    const std::string order =
        big ? "byte_order=\"BigEndian\"" : "byte_order=\"LittleEndian\" header_type=\"UInt32\"";
    const auto inlined = [&](const std::string& bytes) {
      return " format=\"binary\">\n  " + base64(sized(bytes, big)) + "\n";
    };
    expect_cloud("inline.vtp", file(order, {inlined(xyz(big)), inlined(heat(big)), inlined(rgb())}, ""));
    const std::string a = sized(xyz(big), big), b = sized(heat(big), big), c = sized(rgb(), big);
    const std::string raw = file(order,
                                 {"offset=\"0\"", "offset=\"" + std::to_string(a.size()) + "\"",
                                  "offset=\"" + std::to_string(a.size() + b.size()) + "\""},
                                 "<AppendedData encoding=\"raw\">\n_" + a + b + c + "\n</AppendedData>");
    expect_cloud("raw.vtp", raw);
    expect_refused("cut.vtp", raw.substr(0, raw.size() - 60));
  }
  const auto packed = [](const std::string& bytes) {  // in two blocks
    const std::size_t half = bytes.size() / 2 + 1;
    std::string head = bytes_of(std::uint64_t(2), false) + bytes_of(std::uint64_t(half), false) +
                       bytes_of(std::uint64_t(bytes.size() - half), false),
                body;
    for (const std::string& block : {bytes.substr(0, half), bytes.substr(half)}) {
      std::string out(compressBound(block.size()), '\0');
      uLongf size = out.size();
      compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(block.data()),
               block.size());
      head += bytes_of(std::uint64_t(size), false), body += out.substr(0, size);
    }
    return base64(head) + base64(body);
  };
  const std::string a = packed(xyz(false)), b = packed(heat(false)), c = packed(rgb());
  const std::string zlib = "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
  expect_cloud("zlib.vtp", file(zlib,
                                {"offset=\"0\"", "offset=\"" + std::to_string(a.size()) + "\"",
                                 "offset=\"" + std::to_string(a.size() + b.size()) + "\""},
                                "<AppendedData encoding=\"base64\">_" + a + b + c + "</AppendedData>"));
  expect_refused("lz4.vtp",
                 file("compressor=\"vtkLZ4DataCompressor\"",
                      {" format=\"binary\">AAAA", " format=\"binary\">AAAA", " format=\"binary\">AAAA"}, ""));
  expect_refused("not.vtp", "<VTKFile type=\"PolyData\"><PolyData>");
}

/// Of a square of four points: as one polygon, two triangles, or a strip.
TEST_F(VtkTest, PolygonsAreSampled) {
  const std::string head =
      "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
      "0 0 1 2 0 1 2 2 1 0 2 1\n";
  const auto xml = [](const std::string& cells) {
    return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\"><Points><DataArray "
           "type=\"Float32\" "
           "NumberOfComponents=\"3\" format=\"ascii\">0 0 1 2 0 1 2 2 1 0 2 1</DataArray></Points>" +
           cells + "</Piece></PolyData></VTKFile>";
  };
  const auto list = [](const std::string& name, const std::string& numbers) {
    std::string text = "<DataArray type=\"Int64\" format=\"ascii\" Name=\"";
    text += name, text += "\">", text += numbers, text += "</DataArray>";
    return text;
  };
  const std::pair<const char*, std::string> files[] = {
      {"a.vtk", head + "POLYGONS 1 5\n4 0 1 2 3\n"},
      {"a.vtk", head + "LINES 1 3\n2 0 1\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n"},
      {"a.vtk", head + "POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n"},
      {"a.vtk", head + "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"},
      {"a.vtp", xml("<Polys>" + list("connectivity", "0 1 2 3") + list("offsets", "4") + "</Polys>")},
      {"a.vtp", xml("<Strips>" + list("connectivity", "0 1 3 2") + list("offsets", "4") + "</Strips>")}};
  ReadOptions drawn;
  drawn.samples_faces = true;
  for (const auto& [name, content] : files) {
    const std::filesystem::path file = test::write_file(name, content);
    EXPECT_EQ(read(file).cloud.size(), 4u) << content;
    const PointCloud cloud = read(file, drawn).cloud;
    ASSERT_NEAR(double(cloud.size()), 720 * 720 / 2, 4) << content;
    for (const vec3& normal : cloud.normals) ASSERT_EQ(normal, vec3(0, 0, 1)) << content;
  }
  const ReadResult cut = read(test::write_file("c.vtp", xml("<Polys>" + list("connectivity", "0 1 2 3 x") +
                                                            list("offsets", "4") + "</Polys>")),
                              drawn);
  EXPECT_EQ(cut.cloud.size(), 4u);
  EXPECT_EQ(cut.report.notes.size(), 1u);
  // Corners that are no points, more of them than there are.
  for (const char* damaged :
       {"POLYGONS 1 5\n4 0 1 2 9\n", "POLYGONS 1 5\n9 0 1 2 3\n", "POLYGONS 1 2\n-3 0\n",
        "POLYGONS 2 4\nOFFSETS vtktypeint64\n0 9\nCONNECTIVITY vtktypeint64\n0 1 2 3\n"}) {
    const ReadResult result = read(test::write_file("b.vtk", head + damaged), drawn);
    EXPECT_EQ(result.cloud.size(), 4u) << damaged;
    EXPECT_EQ(result.report.notes.size(), 1u) << damaged;
  }
}

}  // namespace
}  // namespace sfumato::io
