#include "io/poses.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

using PoseJson = nlohmann::ordered_json;

constexpr std::uint64_t largest_trajectory = 256 << 20;
constexpr double farthest_pose = 1e15;

/// A number of a JSON file; names the key where there is none.
double json_number(const PoseJson& value, const std::string& key, const std::filesystem::path& file,
                   const std::string& place) {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= farthest_pose))
    bad_input(file, place, "'" + key + "' is not a number");
  return value.get<double>();
}

/// The numbers of a list, or of a list of rows.
std::vector<double> json_numbers(const PoseJson& parent, const std::string& key, std::size_t count,
                                 const std::filesystem::path& file, const std::string& place) {
  std::vector<double> numbers;
  const auto take = [&](const PoseJson& value) { numbers.push_back(json_number(value, key, file, place)); };
  if (parent.contains(key) && parent[key].is_array())
    for (const PoseJson& row : parent[key]) {
      if (row.is_array())
        for (const PoseJson& value : row) take(value);
      else
        take(row);
    }
  if (numbers.size() != count)
    bad_input(file, place, "'" + key + "' is not a list of " + std::to_string(count) + " numbers");
  return numbers;
}

int json_pixels(const PoseJson& value, const std::string& key, const std::filesystem::path& file,
                const std::string& place) {
  const double v = json_number(value, key, file, place);
  if (!(v >= 1 && v <= 65536) || v != std::floor(v))
    bad_input(file, place, "'" + key + "' is not a size in pixels");
  return int(v);
}

/// The lens of a transforms.json or of one of its frames; without a size nothing.
std::optional<Lens> lens_of(const PoseJson& json, const std::filesystem::path& file,
                            const std::string& place) {
  if (!json.contains("w") || !json.contains("h")) return std::nullopt;
  Lens lens;
  lens.width = json_pixels(json["w"], "w", file, place);
  lens.height = json_pixels(json["h"], "h", file, place);
  const auto given = [&](const char* key) {
    return json.contains(key) ? std::optional(json_number(json[key], key, file, place)) : std::nullopt;
  };
  const auto focal = [&](const char* key, const char* angle, int side) -> std::optional<double> {
    if (const auto f = given(key)) return f;
    if (const auto a = given(angle)) return 0.5 * side / std::tan(0.5 * *a);
    return std::nullopt;
  };
  const auto fx = focal("fl_x", "camera_angle_x", lens.width);
  const auto fy = focal("fl_y", "camera_angle_y", lens.height);
  if (!fx && !fy) bad_input(file, place, "there is neither fl_x nor camera_angle_x");
  lens.k = {fx.value_or(fy.value_or(0)), fy.value_or(fx.value_or(0)), given("cx").value_or(0.5 * lens.width),
            given("cy").value_or(0.5 * lens.height)};
  if (!(lens.k.fx > 0 && lens.k.fy > 0)) bad_input(file, place, "the focal length is not positive");
  for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
    if (given(key).value_or(0) != 0) lens.distortion = "distortion (k1, k2, ...)";
  if (json.contains("camera_model") && json["camera_model"].is_string()) {
    const std::string model = json["camera_model"].get<std::string>();
    if (model.find("FISHEYE") != model.npos || model.find("EQUIRECTANGULAR") != model.npos)
      lens.distortion = "camera model " + model.substr(0, 40);
  }
  return lens;
}

std::string frame_name(std::size_t i) { return "frame " + std::to_string(i); }

void note_distortion(const std::string& distortion, CameraPath& path) {
  if (!distortion.empty())
    path.notes.push_back("the " + distortion + " of its lens is not applied: the picture is of a pinhole");
}

/// The numbers of a line, as blanks or commas separate them. False where something is no number.
bool numbers_of_line(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  const char *at = line.data(), *const end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    double value = 0;
    at = parse_number(at, end, value);
    if (!at || !(std::abs(value) <= farthest_pose)) return false;
    numbers.push_back(value);
    at = skip_blanks(at, end);
    if (at < end && *at == ',') ++at;
  }
  return true;
}

Camera camera_of_quaternion(const double* xyzw, const dvec3& position, const std::filesystem::path& file,
                            const std::string& place) {
  const double length =
      std::sqrt(xyzw[0] * xyzw[0] + xyzw[1] * xyzw[1] + xyzw[2] * xyzw[2] + xyzw[3] * xyzw[3]);
  if (!(std::abs(length - 1) < 0.01)) bad_input(file, place, "the quaternion qx qy qz qw is not of length 1");
  const double x = xyzw[0] / length, y = xyzw[1] / length, z = xyzw[2] / length, w = xyzw[3] / length;
  return camera_of_pose({1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                        {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                        {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}, position,
                        nullptr, file, place);
}

}  // namespace

Camera camera_of_pose(const dvec3& right, const dvec3& down, const dvec3& forward, const dvec3& position,
                      const Lens* lens, const std::filesystem::path& file, const std::string& place) {
  constexpr double tolerance = 0.01;  // of files with few decimals
  const double x = glm::length(right), y = glm::length(down), z = glm::length(forward);
  if (!(x > 0 && std::abs(y / x - 1) < tolerance && std::abs(z / x - 1) < tolerance) ||
      !(glm::dot(glm::cross(right / x, down / y), forward / z) > 1 - tolerance))
    bad_input(file, place, "the pose holds no rotation");
  if (!(std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}) <= farthest_pose))
    bad_input(file, place, "the camera stands beyond 1e15; no point can be seen from there");
  Camera camera;
  camera.position = position;
  camera.target = position + forward / z;
  camera.up = -down / y;
  if (lens) {
    camera.width = lens->width, camera.height = lens->height;
    camera.custom_intrinsics = lens->k;
    camera.fov_y = 2 * std::atan(0.5 * lens->height / lens->k.fy);
  }
  return camera;
}

bool is_transforms(const PoseJson& json) {
  return json.is_object() && json.contains("frames") && json["frames"].is_array();
}

CameraPath read_transforms(const PoseJson& json, const std::filesystem::path& file) {
  CameraPath path;
  path.are_pictures = true;
  const std::optional<Lens> shared = lens_of(json, file, "JSON");
  std::string distortion = shared ? shared->distortion : "";
  std::size_t with_lens = 0;
  for (const PoseJson& frame : json["frames"]) {
    const std::string place = frame_name(path.cameras.size());
    if (!frame.is_object()) bad_input(file, place, "it is no object with a 'transform_matrix'");
    // Three or four rows; the last says nothing.
    const bool has_last = frame.contains("transform_matrix") && frame["transform_matrix"].size() == 4;
    const std::vector<double> m = json_numbers(frame, "transform_matrix", has_last ? 16 : 12, file, place);
    const std::optional<Lens> own = lens_of(frame, file, place);
    const Lens* lens = own ? &*own : shared ? &*shared : nullptr;
    if (own && !own->distortion.empty()) distortion = own->distortion;
    with_lens += lens != nullptr;
    path.cameras.push_back(camera_of_pose({m[0], m[4], m[8]}, {-m[1], -m[5], -m[9]}, {-m[2], -m[6], -m[10]},
                                          {m[3], m[7], m[11]}, lens, file, place));
  }
  if (path.cameras.empty()) bad_input(file, "JSON", "'frames' is empty");
  path.has_size = with_lens == path.cameras.size();
  if (!path.has_size && with_lens > 0)
    bad_input(file, "JSON", "some frames have w and h and some have not; give them to all");
  if (!path.has_size && json.contains("camera_angle_x")) {
    path.fov_x = json_number(json["camera_angle_x"], "camera_angle_x", file, "JSON");
    if (!(*path.fov_x > 0 && *path.fov_x < 3.1)) bad_input(file, "JSON", "'camera_angle_x' is no angle");
  }
  if (json.contains("applied_transform"))
    path.notes.push_back("its poses lie in the frame behind its 'applied_transform', as its points do");
  note_distortion(distortion, path);
  return path;
}

bool is_open3d(const PoseJson& json) {
  return json.is_object() && json.contains("class_name") && json["class_name"].is_string();
}

CameraPath read_open3d(const PoseJson& json, const std::filesystem::path& file) {
  const std::string kind = json["class_name"].get<std::string>();
  if (kind == "ViewTrajectory")
    bad_input(file, "JSON",
              "a ViewTrajectory depends on the window that it was made in; save camera parameters instead "
              "(PinholeCameraTrajectory)");
  const bool is_one = kind == "PinholeCameraParameters";
  if (!is_one &&
      (kind != "PinholeCameraTrajectory" || !json.contains("parameters") || !json["parameters"].is_array()))
    bad_input(file, "JSON",
              "found a " + kind.substr(0, 40) + " of Open3D, expected a PinholeCameraTrajectory");
  const PoseJson list = is_one ? PoseJson::array({json}) : json["parameters"];
  CameraPath path;
  path.are_pictures = true;
  for (const PoseJson& one : list) {
    const std::string place = "camera " + std::to_string(path.cameras.size());
    if (!one.is_object() || !one.contains("intrinsic") || !one["intrinsic"].is_object() ||
        !one["intrinsic"].contains("width") || !one["intrinsic"].contains("height"))
      bad_input(file, place, "there is no 'intrinsic' with width and height");
    const PoseJson& intrinsic = one["intrinsic"];
    const std::vector<double> k = json_numbers(intrinsic, "intrinsic_matrix", 9, file, place);
    const std::vector<double> m = json_numbers(one, "extrinsic", 16, file, place);
    // Matrices are written column by column. The middle of its first pixel is (0, 0), that of ours a half.
    const Lens lens{json_pixels(intrinsic["width"], "width", file, place),
                    json_pixels(intrinsic["height"], "height", file, place),
                    {k[0], k[4], k[6] + 0.5, k[7] + 0.5},
                    ""};
    if (!(k[0] > 0 && k[4] > 0)) bad_input(file, place, "the focal length is not positive");
    const dvec3 right(m[0], m[4], m[8]), down(m[1], m[5], m[9]), forward(m[2], m[6], m[10]);
    const dvec3 position = -(right * m[12] + down * m[13] + forward * m[14]);
    path.cameras.push_back(camera_of_pose(right, down, forward, position, &lens, file, place));
  }
  if (path.cameras.empty()) bad_input(file, "JSON", "it holds no camera");
  return path;
}

CameraPath read_trajectory(const std::filesystem::path& file) {
  const File input(file);
  if (input.size() > largest_trajectory)
    bad_input(file, "byte 0", "larger than 256 MB; this is no camera path");
  const std::string text = input.read_text(0, std::size_t(input.size()));
  CameraPath path;
  path.are_pictures = true, path.has_size = false;
  std::vector<double> numbers, matrix;
  std::size_t kind = 0, line = 0, rows_left = 0;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view row(text.data() + at, end - at);
    at = end + 1;
    const std::size_t first = row.find_first_not_of(" \t\r");
    if (first == row.npos || row[first] == '#') continue;
    const std::string place = "line " + std::to_string(line + 1);
    if (!numbers_of_line(row, numbers)) bad_input(file, place, "something is no number of a camera path");
    if (kind == 0) kind = numbers.size();
    if (kind != 3 && kind != 8 && kind != 12)
      bad_input(file, place,
                "found " + counted(kind, "number") +
                    ", expected 8 (TUM: time tx ty tz qx qy qz qw), 12 (KITTI: rows of a pose) or a .log of "
                    "Open3D");
    // Of Open3D: three whole numbers, then the four rows of a matrix.
    const std::size_t expected = kind == 3 && rows_left > 0 ? 4 : kind;
    if (numbers.size() != expected)
      bad_input(file, place,
                "found " + counted(numbers.size(), "number") + ", expected " + std::to_string(expected));
    const std::vector<double>& n = numbers;
    if (kind == 8) {
      path.cameras.push_back(camera_of_quaternion(n.data() + 4, {n[1], n[2], n[3]}, file, place));
    } else if (kind == 12) {
      path.cameras.push_back(camera_of_pose({n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]},
                                            {n[3], n[7], n[11]}, nullptr, file, place));
    } else if (rows_left == 0) {
      rows_left = 4, matrix.clear();
    } else {
      matrix.insert(matrix.end(), n.begin(), n.end());
      const std::vector<double>& m = matrix;
      if (--rows_left == 0)
        path.cameras.push_back(camera_of_pose({m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]},
                                              {m[3], m[7], m[11]}, nullptr, file, place));
    }
  }
  if (rows_left > 0) bad_input(file, "line " + std::to_string(line), "the file ends within a matrix");
  if (path.cameras.empty()) bad_input(file, "line 1", "it holds no pose");
  return path;
}

}  // namespace sfumato::io
