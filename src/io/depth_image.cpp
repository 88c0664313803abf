// A depth image and what its camera is, as JSON beside it: an organised cloud.
//
//   {"depth": "depth/1.png", "color": "rgb/1.png", "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5,
//   "depth_scale": 5000,
//    "pose": [tx, ty, tz, qx, qy, qz, qw]}
//
// As in the TUM RGB-D data: 16 bits a pixel, `depth_scale` of them a metre (5000), 0 where nothing was
// measured. Or an OpenEXR with depth as floats in its channel Z, `depth_scale` 1, and 0 or no number where
// nothing was measured. The middle of the first pixel is (0, 0); x right, y down, z forward; the pose takes
// the camera to the world. `color` and `pose` may be left out.
#include <algorithm>
#include <cmath>

#include "core/lower_case.h"
#include "io/bounded_json.h"
#include "io/byte_source.h"
#include "io/exr_read.h"
#include "io/format.h"
#include "io/png_read.h"
#include "io/table.h"

namespace sfumato::io {
namespace {

struct Frame {
  std::filesystem::path depth, color;
  double fx = 0, fy = 0, cx = std::nan(""), cy = std::nan(""), scale = 0;
  double q[4] = {0, 0, 0, 1};  // x y z w
  dvec3 place{0};
  bool has_pose = false;
};

/// A name is one of a file beside the JSON, never an address.
std::filesystem::path file_name_of(const std::string& text) {
  return is_remote(text) ? std::filesystem::path(".") / text : std::filesystem::path(text);
}

Frame read_frame(const std::filesystem::path& path) {
  const nlohmann::ordered_json json = load_json(path);
  const auto refuse = [&](const std::string& what) { bad_input(path, "JSON", what); };
  const auto number = [&](const nlohmann::ordered_json& value, const std::string& key, bool positive) {
    const double v = value.is_number() ? value.get<double>() : std::nan("");
    if (!std::isfinite(v) || std::abs(v) > 1e15 || (positive && !(v > 0)))
      refuse("'" + key + "' is not a " + (positive ? "positive " : "") + "number");
    return v;
  };
  Frame frame;
  if (!json.is_object()) refuse("a depth image is an object with depth, fx, fy, cx, cy");
  for (const auto& [key, value] : json.items()) {
    if (key == "depth" || key == "color") {
      if (!value.is_string()) refuse("'" + key + "' is not the name of a picture");
      (key == "depth" ? frame.depth : frame.color) =
          path.parent_path() / file_name_of(value.get<std::string>());
    } else if (key == "fx") {
      frame.fx = number(value, key, true);
    } else if (key == "fy") {
      frame.fy = number(value, key, true);
    } else if (key == "cx") {
      frame.cx = number(value, key, false);
    } else if (key == "cy") {
      frame.cy = number(value, key, false);
    } else if (key == "depth_scale") {
      frame.scale = number(value, key, true);
    } else if (key == "pose") {
      if (!value.is_array() || value.size() != 7) refuse("'pose' is not [tx, ty, tz, qx, qy, qz, qw]");
      double length = 0;
      for (int k = 0; k < 7; ++k) {
        const double v = number(value[std::size_t(k)], key, false);
        if (k < 3)
          frame.place[k] = v;
        else
          frame.q[k - 3] = v, length += v * v;
      }
      if (!(std::abs(length - 1) < 0.01)) refuse("'pose' holds an invalid rotation");
      for (double& v : frame.q) v /= std::sqrt(length);
      frame.has_pose = true;
    } else {
      refuse("unknown key '" + key.substr(0, 30) + "', expected depth color fx fy cx cy depth_scale pose");
    }
  }
  if (frame.depth.empty() || frame.fx == 0 || frame.fy == 0 || std::isnan(frame.cx) || std::isnan(frame.cy))
    refuse("needs depth, fx, fy, cx and cy");
  return frame;
}

/// Of either kind of picture.
struct Depth {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> whole;
  std::vector<float> real;
  double scale = 1;
  double metres(std::size_t i) const { return (real.empty() ? double(whole[i]) : double(real[i])) / scale; }
};

Depth read_depth(const Frame& frame) {
  if (lower_case(frame.depth.extension().string()) == ".exr") {
    ExrDepth exr = read_exr_depth(frame.depth);
    return {exr.width, exr.height, {}, std::move(exr.values), frame.scale > 0 ? frame.scale : 1};
  }
  PngPicture png = read_png(frame.depth);
  if (png.channels != 1 || png.bits != 16)
    bad_input(frame.depth, "header",
              "found " + std::to_string(png.channels) + " channels of " + std::to_string(png.bits) +
                  " bits, expected depth as one channel of 16 bits");
  return {png.width, png.height, std::move(png.samples), {}, frame.scale > 0 ? frame.scale : 5000};
}

}  // namespace

bool is_depth_image(std::string_view head) { return begins_as_object_with(head, {"depth", "fx"}); }

ReadResult read_depth_image(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const Frame frame = read_frame(path);
  const Depth depth = read_depth(frame);
  PngPicture color;
  if (!frame.color.empty()) {
    color = read_png(frame.color);
    if (color.width != depth.width || color.height != depth.height || color.channels < 3 || color.bits != 8)
      bad_input(frame.color, "header",
                "found a picture of another size or kind, expected " + std::to_string(depth.width) + "x" +
                    std::to_string(depth.height) + " of 8-bit colours");
  }
  std::vector<Column> columns{
      {"x", StoredType::float64}, {"y", StoredType::float64}, {"z", StoredType::float64}};
  if (!color.samples.empty())
    for (const char* name : {"red", "green", "blue"}) columns.push_back({name, StoredType::uint8});
  assign_roles(columns);
  Table table(std::move(columns), std::size_t(depth.width) * depth.height);
  const dvec3 axis(frame.q[0], frame.q[1], frame.q[2]);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (i % 65536 == 0) progress.check();
    for (std::size_t k = 0; k < 3 && !color.samples.empty(); ++k)
      table.column(3 + k)[i] = color.samples[i * std::size_t(color.channels) + k];
    const double z = depth.metres(i);
    if (!(z > 0)) continue;
    dvec3 p((double(i % depth.width) - frame.cx) * z / frame.fx,
            (double(i / depth.width) - frame.cy) * z / frame.fy, z);
    if (frame.has_pose) {
      const dvec3 t = 2.0 * glm::cross(axis, p);
      p = p + frame.q[3] * t + glm::cross(axis, t) + frame.place;
    }
    for (int k = 0; k < 3; ++k) table.column(std::size_t(k))[i] = p[k];
  }
  ReadResult result;
  table.build(true, progress, result);
  PointCloud& cloud = result.cloud;
  cloud.grids.push_back({0, cloud.size(), depth.width, depth.height, frame.place});
  cloud.scanners.push_back(frame.place);
  cloud.up = frame.has_pose ? UpAxis::pos_z : UpAxis::neg_y;
  return result;
}

}  // namespace sfumato::io
