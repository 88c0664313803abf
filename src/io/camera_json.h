// Cameras as JSON, in world coordinates.
//
//   {"position": [x,y,z], "target": [x,y,z], "up": [x,y,z], "fov_y_deg": 45, "width": 1280, "height": 720}
//
// suffices. Optional: "projection": "perspective" | "orthographic", the latter with "height_world" instead of
// the angle; "fx" "fy" "cx" "cy" in pixels win over both. Pixel centres lie at half integers, the first row
// is on top.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"

namespace sfumato::io {

std::string camera_to_json(const Camera& camera);
/// Throws Error(bad_input) that names `where`, the key and what was expected.
Camera camera_from_json(std::string_view text, const std::string& where);

Camera read_camera(const std::filesystem::path& file);
void write_camera(const std::filesystem::path& file, const Camera& camera);

/// What a file of cameras holds, at least one.
struct CameraPath {
  std::vector<Camera> cameras;
  bool are_pictures = false;    ///< poses of pictures, each drawn as it is; else keys to interpolate
  bool has_size = true;         ///< else size and angle are those of whoever looks
  std::optional<double> fov_x;  ///< of cameras without a size, radians
  std::vector<std::string> notes;

  /// The cameras; those without a size have that of `view`, and its angle unless they have one.
  std::vector<Camera> seen_as(const Camera& view) const;
};

/// {"cameras": [camera, ...]} or the bare array; or poses of other programs (io/poses.h), by content.
CameraPath read_camera_path(const std::filesystem::path& file);

}  // namespace sfumato::io
