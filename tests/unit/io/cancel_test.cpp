// Ctrl-C while a large file is read or written.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "io/io.h"
#include "reference/patience.h"

using namespace sfumato;
using sfumato::testing::expect_stops;

namespace {

constexpr std::size_t points = 1'500'000;
constexpr long blocks = points / 65'536;     // after each, Progress is asked
constexpr std::size_t text_block = 4 << 20;  // bytes of text that are read in one go

PointCloud large_cloud() {
  PointCloud cloud;
  cloud.positions.resize(points);
  cloud.colors.resize(points);
  for (std::size_t i = 0; i < points; ++i) {
    const auto k = float(i);
    cloud.positions[i] =
        glm::round(vec3(std::fmod(k * 0.37f, 100.0f), k * 1e-4f, 3 * std::sin(k)) * 1000.0f) / 1000.0f;
    cloud.colors[i] = {std::uint8_t(i), std::uint8_t(i / 7), std::uint8_t(i / 300), 255};
  }
  return cloud;
}

std::filesystem::path file_of(const std::string& extension) {
  return std::filesystem::path(::testing::TempDir()) /
         ("sfumato_cancel_" + std::to_string(getpid()) + extension);
}

class Cancel : public ::testing::TestWithParam<const char*> {};

TEST_P(Cancel, ReadingAndWritingStop) {
  const std::filesystem::path file = file_of(GetParam());
  const PointCloud cloud = large_cloud();
  expect_stops("writes " + std::string(GetParam()), blocks, 6,
               [&](Progress& progress) { io::write(file, cloud, progress); });
  io::write(file, cloud);
  expect_stops("reads " + std::string(GetParam()), blocks, 10,
               [&](Progress& progress) { io::read(file, {}, progress); });
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Formats, Cancel, ::testing::Values(".las", ".laz", ".ply", ".pcd", ".xyz", ".npy"),
                         [](const auto& one) { return std::string(one.param + 1); });

/// Those that we do not write: the lines of a text, behind a header.
struct Lines {
  const char *name, *header, *before;
};

class CancelText : public ::testing::TestWithParam<Lines> {};

TEST_P(CancelText, ReadingStops) {
  std::string text = GetParam().header;
  for (std::size_t i = 0; i < points; ++i)
    text += GetParam().before + std::to_string(i % 1000) + "." + std::to_string(i % 97) + " " +
            std::to_string(i / 1000) + " 0.25\n";
  const std::filesystem::path file = file_of("." + std::string(GetParam().name));
  std::ofstream(file, std::ios::binary) << text;
  expect_stops(std::string("reads ") + GetParam().name, long(text.size() / text_block), 10,
               [&](Progress& progress) { io::read(file, {}, progress); });
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, CancelText,
    ::testing::Values(
        Lines{"ply",
              "ply\nformat ascii 1.0\nelement vertex 1500000\nproperty float x\nproperty float y\nproperty "
              "float z\nend_header\n",
              ""},
        Lines{"pcd",
              "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1500000\nHEIGHT "
              "1\nVIEWPOINT 0 0 0 1 0 0 0\n"
              "POINTS 1500000\nDATA ascii\n",
              ""},
        Lines{"pts", "1500000\n", ""}, Lines{"obj", "", "v "},
        Lines{"ptx", "1500\n1000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", ""}),
    [](const auto& one) { return std::string(one.param.name); });

}  // namespace
