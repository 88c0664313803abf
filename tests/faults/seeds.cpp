#include "faults/seeds.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "copc/build.h"
#include "io/image_exr.h"
#include "io/io.h"
#include "unit/io/format_bytes.h"
#include "unit/io/las_cloud.h"

namespace sfumato::test {
namespace {

PointCloud cloud_of(int points, int format) {
  PointCloud cloud = las_cloud(points, format, 9);
  cloud.normals.assign(cloud.size(), {0, 0, 1});
  return cloud;
}

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "sfumato-seeds-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error(ErrorCode::io, name + ": cannot be made");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string written(const std::string& name, const PointCloud& cloud) const {
    io::write(path_ / name, cloud);
    return bytes(name);
  }
  std::string bytes(const std::string& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string pcd(const std::string& data) {
  std::string head =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH "
      "3\nHEIGHT 2\n"
      "VIEWPOINT 0 0 1 1 0 0 0\nPOINTS 6\nDATA " +
      data + "\n";
  std::string rows, columns[4], lines;
  for (int i = 0; i < 6; ++i) {
    const float value = float(i);
    rows += bytes_of(value, 1.0f, 2.0f, 0x102030u);
    columns[0] += bytes_of(value), columns[1] += bytes_of(1.0f), columns[2] += bytes_of(2.0f),
        columns[3] += bytes_of(0x102030u);
    lines += std::to_string(i) + " 1 nan 1056816\n";
  }
  if (data == "ascii") return head + lines;
  if (data == "binary") return head + rows;
  // LZF: runs of literals, each behind its length - 1; every column once.
  std::string packed, plain = columns[0] + columns[1] + columns[2] + columns[3];
  for (std::size_t at = 0; at < plain.size(); at += 32)
    packed += char(std::min<std::size_t>(32, plain.size() - at) - 1) + plain.substr(at, 32);
  return head + le(packed.size(), 4) + le(plain.size(), 4) + packed;
}

}  // namespace

std::vector<Seed> seeds() {
  const Folder folder;
  std::vector<Seed> all;
  const auto add = [&](const std::string& format, const std::string& extension, const std::string& bytes) {
    all.push_back({format, extension, bytes, {}, {}});
  };
  for (const int format : {1, 3, 7}) add("las", ".las", folder.written("a.las", cloud_of(30, format)));
  for (const int format : {0, 3, 7, 8}) add("laz", ".laz", folder.written("a.laz", cloud_of(60, format)));
  folder.written("a.las", cloud_of(300, 7));
  copc::build({folder.path() / "a.las"}, folder.path() / "a.copc.laz");
  add("copc", ".copc.laz", folder.bytes("a.copc.laz"));
  add("ply", ".ply", folder.written("a.ply", cloud_of(20, 3)));
  add("ply", ".ply",
      "ply\nformat ascii 1.0\ncomment made here\nelement face 1\nproperty list uchar int "
      "vertex_indices\nelement vertex 3\n"
      "property double x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar "
      "green\nproperty uchar blue\n"
      "end_header\n3 0 1 2\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1.5e-1 0 1 2 3\n");
  for (const char* data : {"ascii", "binary", "binary_compressed"}) add("pcd", ".pcd", pcd(data));
  add("obj", ".obj",
      "# made here\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1e-3 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf -1 -2 -3\n");
  add("off", ".off",
      "COFF\n# made here\n3 2 0\n0 0 0 10 20 30 255\n1 0 0 0 0 0 255\n0 1e-1 0 5 5 5 255\n3 0 1 2 255 0 0\n3 "
      "2 1 0\n");
  add("stl", ".stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-1 "
      "0\nendloop\nendfacet\nendsolid a\n");
  add("stl", ".stl",
      std::string(80, ' ') + bytes_of(1u, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f,
                                      0.0f, std::uint16_t(0)));
  const std::string vtk =
      "# vtk DataFile Version 3.0\nmade here\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 1 2 3 4 5\n6 7 "
      "8.5\n";
  add("vtk", ".vtk",
      vtk + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS heat float 1\nLOOKUP_TABLE default\n1.5 2.5 3.5\n");
  add("vtk", ".vtk",
      vtk +
          "TRIANGLE_STRIPS 1 4\n3 0 1 2\nPOINT_DATA 3\nFIELD FieldData 1\npaint 3 3 unsigned_char\n1 2 3 4 5 "
          "6 7 8 9\n");
  add("vtp", ".vtp",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\"><PolyData>"
      "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData><DataArray type=\"Float32\" Name=\"heat\" "
      "format=\"ascii\">1 2 3"
      "</DataArray></PointData><Points><DataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\" "
      "format=\"ascii\">"
      "0 1 2 3 4 5 6 7 8</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" "
      "format=\"ascii\">0 1 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" "
      "format=\"ascii\">3</DataArray></Polys></Piece></PolyData></VTKFile>\n");
  add("e57", ".e57", two_scans());
  add("ptx", ".ptx",
      std::string("2\n2\n") + ptx_head +
          "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 0 0 0.5 1 2 3\n0 0 0 0.5 1 2 3\n"
          "3 0 0 0.25 4 5 6\n4 0 0 1 7 8 9\n");
  add("pts", ".pts", "3\n1 2 3 100 0 0 0\n4 5 6 -2000 9 0 0\n7 8 9 5 4 3 2\n");
  add("text", ".xyz", "x,y,z,red,green,blue,class\n1.25,2,3,4,5,6,7\n-1e3,2.5,3,4,5,6,7\n0,0,0,0,0,0,0\n");
  add("text", ".xyz", "# no header\n1 2 3 0.5\n4\t5\t6\t0.25\r\n7;8;9;1\n");
  add("npy", ".npy", npy("'<f4'", "2, 3", bytes_of(1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f)));
  add("npy", ".npy",
      npy("[('x', '<f4'), ('y', '<f8'), ('z', '<i2'), ('ring', '|u1')]", "2,",
          bytes_of(1.0f, 2.0, short(3)) + "\x05" + bytes_of(4.0f, 5.0, short(6)) + "\x06"));
  add("npz", ".npz", npz_cloud(false));
  add("npz", ".npz", npz_cloud(true));
#ifdef SFUMATO_DRACO
  add("draco", ".drc", draco_cloud());
#endif
  const std::string expe = "property position 12\nproperty color 4\nnofpoints 2\ndata\n";
  add("expe", ".pts",
      "[Expe/PointSet/Binary/0.1]\n" + expe + bytes_of(1.0f, 2.0f, 3.0f, 77, 4.0f, 5.0f, 6.0f, 88));
  add("expe", ".pts",
      "[Expe/PointSet/Ascii/0.2]\nproperty position 3 r32\nproperty radius 1 r32\nnofpoints 2\ndata\n"
      "1,2,3 ; 0.5\n4,5,6 ; 0.5\n");
  add("kitti", ".bin", bytes_of(1, 1.0f, 2.0f, 3.0f, 1, 0.5f, 0.5f, 0.5f, 1, 0.0f, 0.0f, 1.0f));
  add("kitti", ".bin", bytes_of(1.0f, 2.0f, 3.0f, 0.5f, 4.0f, 5.0f, 6.0f, 1.0f));
  const std::string head = "ncols 3\nnrows 2\nxllcorner 1\nyllcorner 2\ncellsize 0.5\nNODATA_value -9\n";
  add("grid", ".asc", head + "1 2 3\n4 -9 6\n");
  add("grid", ".grd", "DSAA\n3 2\n0 4\n10 11\n1 6\n1 2 3\n4 5 6\n");
  std::string colmap = bytes_of(std::uint64_t(2));
  for (const double x : {1.0, 2.0})
    colmap += bytes_of(std::uint64_t(7), x, 2.5, 3.5) + "rgb" + bytes_of(0.5, std::uint64_t(1), 3u, 4u);
  add("colmap", ".bin", colmap);
  add("splat", ".splat",
      bytes_of(1.0f, 2.0f, 3.0f, 1.0f, 1.0f, 1.0f, 0xFF102030u, 0u) +
          bytes_of(4.0f, 5.0f, 6.0f, 1.0f, 1.0f, 1.0f, 0xFF405060u, 0u));
  std::string ksplat = bytes_of(0u, 1u, 1u, 2u, 2u, 1u);
  ksplat.resize(4096);
  ksplat += bytes_of(2u, 2u, 2u, 1u, 5.0f, 12u, 32767u, 0u, 1u, 0u, 0u);
  ksplat.resize(4096 + 1024);
  ksplat += bytes_of(1.0f, 2.0f, 3.0f);
  for (const std::uint16_t step : {std::uint16_t(100), std::uint16_t(60000)})
    ksplat += bytes_of(step, step, step) + std::string(14, '\0') + bytes_of(0xFF405060u);
  add("ksplat", ".ksplat", ksplat);
  add("nvm", ".nvm", "NVM_V3\n\n1\na.jpg 1 1 0 0 0 1 2 3 0 0\n\n2\n1 2 3 4 5 6 1 0 1 2 3\n4 5 6 7 8 9 0\n");
  add("spz", ".spz",
      "NGSP" + bytes_of(2u, 2u, std::uint8_t(0), std::uint8_t(12), std::uint16_t(0)) +
          std::string(44, '\x90'));
  const std::string frame =
      R"({"depth": "d.png", "fx": 2, "fy": 4, "cx": 1, "cy": 0, "depth_scale": 1000, "pose": [1,2,3,0,0,0,1]})";
  all.push_back({"depth", ".json", frame, "d.png", png16(3, 2, {5000, 0, 10000, 5000, 5000, 2500})});
  Image<float> depth(8, 6);
  std::fill_n(depth.data(), depth.size(), 2.5f);
  io::write_exr(folder.path() / "d.exr", {}, depth, {});
  all.push_back({"depth", ".json", R"({"depth": "d.exr", "fx": 2, "fy": 4, "cx": 1, "cy": 0})", "d.exr",
                 folder.bytes("d.exr")});
  return all;
}

}  // namespace sfumato::test
