#include "io/camera_json.h"

#include <cmath>

#include "core/error.h"
#include "io/atomic_writer.h"
#include "io/bounded_json.h"
#include "io/file.h"
#include "io/poses.h"

namespace sfumato::io {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw Error(ErrorCode::bad_input, where + ": " + what);
}

// As far as points may be from the origin; beyond, the squares of distances leave the range of a float.
constexpr double farthest = 1e15;

double number(const Json& value, const std::string& key, const std::string& where) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    refuse(where, "camera key '" + key + "' is not a number");
  if (std::abs(value.get<double>()) > farthest)
    refuse(where, "camera key '" + key + "' is beyond 1e15; no point can be seen from there");
  return value.get<double>();
}

double positive(const Json& value, const std::string& key, const std::string& where) {
  const double v = number(value, key, where);
  if (v <= 0) refuse(where, "camera key '" + key + "' must be positive");
  return v;
}

dvec3 vector(const Json& value, const std::string& key, const std::string& where) {
  if (!value.is_array() || value.size() != 3) refuse(where, "camera key '" + key + "' is not [x, y, z]");
  return {number(value[0], key, where), number(value[1], key, where), number(value[2], key, where)};
}

int pixels(const Json& value, const std::string& key, const std::string& where) {
  const double v = positive(value, key, where);
  if (v != std::floor(v) || v > 65536) refuse(where, "camera key '" + key + "' is not a size in pixels");
  return int(v);
}

Camera read(const Json& json, const std::string& where) {
  if (!json.is_object())
    refuse(where, "a camera is an object with position, target, up, fov_y_deg, width, height");
  Camera camera;
  Intrinsics k;
  int given = 0;
  for (const auto& [key, value] : json.items()) {
    if (key == "position")
      camera.position = vector(value, key, where);
    else if (key == "target")
      camera.target = vector(value, key, where);
    else if (key == "up")
      camera.up = vector(value, key, where);
    else if (key == "fov_y_deg")
      camera.fov_y = glm::radians(positive(value, key, where));
    else if (key == "height_world")
      camera.height_world = positive(value, key, where);
    else if (key == "width")
      camera.width = pixels(value, key, where);
    else if (key == "height")
      camera.height = pixels(value, key, where);
    else if (key == "fx")
      k.fx = positive(value, key, where), ++given;
    else if (key == "fy")
      k.fy = positive(value, key, where), ++given;
    else if (key == "cx")
      k.cx = number(value, key, where), ++given;
    else if (key == "cy")
      k.cy = number(value, key, where), ++given;
    else if (key == "projection" && value == "orthographic")
      camera.projection = Projection::orthographic;
    else if (key == "projection" && value != "perspective")
      refuse(where, "projection is perspective or orthographic");
    else if (key != "projection")
      refuse(where, "unknown camera key '" + key + "'");
  }
  for (const char* key : {"position", "target"})
    if (!json.contains(key)) refuse(where, std::string("the camera has no '") + key + "'");
  if (camera.orthographic() && given == 0 && !json.contains("height_world"))
    refuse(where, "an orthographic camera needs 'height_world'");
  if (given != 0 && given != 4) refuse(where, "intrinsics need all of fx fy cx cy");
  if (given == 4) camera.custom_intrinsics = k;
  if (camera.fov_y >= glm::radians(180.0)) refuse(where, "fov_y_deg must be below 180");
  if (glm::length(camera.target - camera.position) <= 0)
    refuse(where, "position and target are the same point");
  if (glm::length(camera.up) <= 0) refuse(where, "up is zero");
  return camera;
}

}  // namespace

std::string camera_to_json(const Camera& camera) {
  auto list = [](const dvec3& v) { return Json::array({v.x, v.y, v.z}); };
  Json json;
  json["position"] = list(camera.position);
  json["target"] = list(camera.target);
  json["up"] = list(camera.up);
  json["projection"] = camera.orthographic() ? "orthographic" : "perspective";
  if (camera.orthographic())
    json["height_world"] = camera.height_world;
  else
    json["fov_y_deg"] = glm::degrees(camera.fov_y);
  json["width"] = camera.width;
  json["height"] = camera.height;
  if (const auto& k = camera.custom_intrinsics)
    json["fx"] = k->fx, json["fy"] = k->fy, json["cx"] = k->cx, json["cy"] = k->cy;
  return json.dump(2);
}

Camera camera_from_json(std::string_view text, const std::string& where) {
  return read(parse_json(text, where), where);
}

Camera read_camera(const std::filesystem::path& file) { return read(load_json(file), file.string()); }

void write_camera(const std::filesystem::path& file, const Camera& camera) {
  AtomicWriter writer(file);
  writer.write(camera_to_json(camera) + "\n");
  writer.commit();
}

std::vector<Camera> CameraPath::seen_as(const Camera& view) const {
  std::vector<Camera> seen = cameras;
  if (has_size) return seen;
  for (Camera& camera : seen) {
    camera.width = view.width, camera.height = view.height, camera.fov_y = view.fov_y;
    if (fov_x) camera.fov_y = 2 * std::atan(std::tan(*fov_x / 2) * view.height / view.width);
  }
  return seen;
}

CameraPath read_camera_path(const std::filesystem::path& file) {
  const std::string head = File(file).read_text(0, 64), name = file.filename().string();
  if (name.starts_with("images") && !head.starts_with("{")) return read_colmap_images(file);
  const std::size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (!name.ends_with(".json") && (first == head.npos || (head[first] != '{' && head[first] != '[')))
    return read_trajectory(file);
  const Json json = load_json(file);
  if (is_transforms(json)) return read_transforms(json, file);
  if (is_open3d(json)) return read_open3d(json, file);
  const Json* list = json.is_object() && json.contains("cameras") ? &json["cameras"] : &json;
  if (!list->is_array() || list->empty())
    refuse(file.string(),
           "a camera path is {\"cameras\": [camera, ...]}, a transforms.json, or cameras of Open3D");
  CameraPath path;
  for (const Json& camera : *list)
    path.cameras.push_back(read(camera, file.string() + ": camera " + std::to_string(path.cameras.size())));
  return path;
}

}  // namespace sfumato::io
