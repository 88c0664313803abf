// The seeds as files, a folder a fuzz target: where fuzzing starts. usage: write_seeds FOLDER
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "faults/seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: write_seeds FOLDER\n"), 1;
  int number = 0;
  const auto write = [&](const std::string& target, const std::string& bytes) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / target;
    std::filesystem::create_directories(folder);
    std::ofstream(folder / ("seed" + std::to_string(number++)), std::ios::binary) << bytes;
  };
  for (const sfumato::test::Seed& seed : sfumato::test::seeds()) {
    if (seed.companion_name.ends_with(".exr"))
      write("exr", seed.companion);
    else
      write(seed.format, seed.companion.empty() ? seed.bytes : seed.bytes + '\0' + seed.companion);
    for (const char* format : {"ply", "obj", "off", "stl", "vtk", "vtp"})
      if (seed.format == format) write("mesh", seed.bytes);
  }
  write(
      "camera",
      R"({"position": [1,2,3], "target": [0,0,0], "up": [0,0,1], "fov_y_deg": 45, "width": 640, "height": 480})");
  write(
      "camera",
      R"({"cameras": [{"position": [1,2,3], "target": [0,0,0], "projection": "orthographic", "height_world": 3,
 "width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 32, "cy": 24}]})");
  write("http", "GET /0123456789abcdef0123456789abcdef/info HTTP/1.1\r\nHost: localhost\r\n\r\n");
  write("websocket", R"({"do":"size","width":64,"height":48})");
  write("preset", R"({"technique": "points", "parameters": {"shadows": "hard", "points": {"point_size": 2}},
 "options": {"color-by": "elevation"}, "camera": {"position": [1,2,3], "target": [0,0,0], "width": 8, "height": 8}})");
  write(
      "preset",
      R"({"files": ["a.ply", {"file": "b.laz", "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}], "parameters": {}})");
  for (const char* words :
       {"-o\na.png\n-t\npoints\n--resolution\n64x48\n--point-size\n2",
        "--draw\nclassification 3-5: soft\n-o\nb_{n:04}.png",
        "info\n--json\n--filter\nz 2.. and intensity ..9",
        "convert\n-o\nb.las\n--crop-relative\n0,0,0,1,1,0.5",
        "--camera-position\n1,2,3\n--look-at\n0,0,0\n--fov\n40\n--path\norbit\n--frames\n3\n-o\nf_{n}.png"})
    write("command_line", words);
}
