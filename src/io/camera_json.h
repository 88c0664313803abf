// Cameras as JSON, in world coordinates.
//
//   {"position": [x,y,z], "target": [x,y,z], "up": [x,y,z], "fov_y_deg": 45, "width": 1280, "height": 720}
//
// suffices. Optional: "projection": "perspective" | "orthographic", the latter with "height_world" instead of
// the angle; "fx" "fy" "cx" "cy" in pixels win over both. Pixel centres lie at half integers, the first row
// is on top.
#pragma once

#include <filesystem>
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

/// {"cameras": [camera, ...]}, or the bare array: the keys of a camera path, at least one.
std::vector<Camera> read_camera_path(const std::filesystem::path& file);

}  // namespace sfumato::io
