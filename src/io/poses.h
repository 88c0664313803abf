// Cameras as programs of photogrammetry, SLAM and radiance fields write them: the poses of pictures.
//
// nerfstudio and Instant-NGP `transforms.json` (x right, y up, looking down -z), COLMAP `images.txt/.bin`
// with `cameras.txt/.bin` beside them, TUM and KITTI trajectories, Open3D's `.log` and JSON (all x right, y
// down, looking along z). Pixel centres lie at half integers in the first two and in COLMAP, at integers in
// Open3D.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "io/camera_json.h"

namespace sfumato::io {

/// Size and intrinsics of a picture, and what is not applied: "OPENCV distortion".
struct Lens {
  int width = 0, height = 0;
  Intrinsics k;
  std::string distortion;
};

/// `right`, `down` and `forward` are the axes of the camera in the world. Throws Error(bad_input) at `place`
/// where they are no rotation, which may be scaled as a whole.
Camera camera_of_pose(const dvec3& right, const dvec3& down, const dvec3& forward, const dvec3& position,
                      const Lens* lens, const std::filesystem::path& file, const std::string& place);

bool is_transforms(const nlohmann::ordered_json& json);
bool is_open3d(const nlohmann::ordered_json& json);
CameraPath read_transforms(const nlohmann::ordered_json& json, const std::filesystem::path& file);
CameraPath read_open3d(const nlohmann::ordered_json& json, const std::filesystem::path& file);
/// Pictures in the order of their names.
CameraPath read_colmap_images(const std::filesystem::path& file);
/// What is up for the pictures of COLMAP beside the points that it found, or in the folder `sparse` beside
/// what it fused of them: the axis nearest to the mean of theirs. Nothing where there are none, where their
/// files are damaged, or where they were taken with no side up in common.
std::optional<UpAxis> up_of_pictures(const std::filesystem::path& points);
/// TUM, KITTI or Open3D `.log`, told apart by the numbers of a line.
CameraPath read_trajectory(const std::filesystem::path& file);

}  // namespace sfumato::io
