// How much of a picture nobody measured: the share of covered pixels that are far from every projected point,
// and how many pixels between near points are open. Both pictures are depths (--output-depth FILE.npy) of one
// camera:
//
//   sfumato SCAN -t splats -o a.png --output-depth a.npy --output-camera c.json
//   sfumato SCAN -t points --camera c.json --size-mode pixels --point-size 1 -o b.png --output-depth b.npy
//   eval_evidence a.npy b.npy
//
// prints one line of JSON. Distances follow the height of the picture: 8 px of 720.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

struct Depth {
  int width = 0, height = 0;
  std::vector<float> values;
  bool covers(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height &&
           std::isfinite(values[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
  }
};

[[noreturn]] void refuse(const std::string& what) {
  std::cerr << what << '\n';
  std::exit(2);
}

Depth load(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  std::array<char, 10> start{};
  if (!file.read(start.data(), start.size())) refuse(name + ": cannot be read");
  const std::size_t length = std::size_t(std::uint8_t(start[8])) + 256 * std::size_t(std::uint8_t(start[9]));
  std::string header(length, ' ');
  file.read(header.data(), std::streamsize(length));
  const std::size_t shape = header.find('(');
  Depth depth;
  if (header.find("<f4") == std::string::npos || shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "(%d, %d", &depth.height, &depth.width) != 2)
    refuse(name + ": not a depth picture of sfumato (.npy)");
  depth.values.resize(std::size_t(depth.width) * std::size_t(depth.height));
  if (!file.read(reinterpret_cast<char*>(depth.values.data()),
                 std::streamsize(depth.values.size() * sizeof(float))))
    refuse(name + ": ends early");
  return depth;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) refuse("usage: eval_evidence DEPTH.npy DEPTH_OF_POINTS.npy");
  const Depth picture = load(arguments[1]), points = load(arguments[2]);
  if (picture.width != points.width || picture.height != points.height) refuse("pictures of two sizes");
  const double far = 8.0 * picture.height / 720;
  const int reach = int(std::floor(far));
  long covered = 0, invented = 0, open = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      bool is_near = false;
      unsigned quadrants = 0;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          if (dx * dx + dy * dy > far * far || !points.covers(x + dx, y + dy)) continue;
          is_near = true;
          if (dx >= 0 && dy >= 0) quadrants |= 1;
          if (dx <= 0 && dy >= 0) quadrants |= 2;
          if (dx <= 0 && dy <= 0) quadrants |= 4;
          if (dx >= 0 && dy <= 0) quadrants |= 8;
        }
      if (picture.covers(x, y))
        ++covered, invented += !is_near;
      else
        open += quadrants == 15;
    }
  const double all = double(std::max(covered, 1L));
  std::printf("{\"covered_px\": %ld, \"invented_share\": %.5f, \"open_share\": %.5f}\n", covered,
              double(invented) / all, double(open) / all);
}
