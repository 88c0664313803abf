// images.txt and images.bin of COLMAP with the cameras beside them: world to camera as a quaternion w x y z
// and a translation; x right, y down, z forward; pixel centres at half integers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "core/error.h"
#include "io/file.h"
#include "io/format.h"
#include "io/poses.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t largest_images = std::uint64_t(4) << 30;  // with the points that the pictures see

struct CameraModel {
  const char* name;
  int parameters;
  bool has_one_focal;
};

/// By COLMAP's numbers (src/colmap/sensor/models.h).
constexpr std::array<CameraModel, 12> colmap_models = {{{"SIMPLE_PINHOLE", 3, true},
                                                        {"PINHOLE", 4, false},
                                                        {"SIMPLE_RADIAL", 4, true},
                                                        {"RADIAL", 5, true},
                                                        {"OPENCV", 8, false},
                                                        {"OPENCV_FISHEYE", 8, false},
                                                        {"FULL_OPENCV", 12, false},
                                                        {"FOV", 5, false},
                                                        {"SIMPLE_RADIAL_FISHEYE", 4, true},
                                                        {"RADIAL_FISHEYE", 5, true},
                                                        {"THIN_PRISM_FISHEYE", 12, false},
                                                        {"RAD_TAN_THIN_PRISM_FISHEYE", 16, false}}};

Lens lens_of_model(const CameraModel& model, double width, double height, const std::vector<double>& p,
                   const std::filesystem::path& file, const std::string& place) {
  if (!(width >= 1 && width <= 65536 && height >= 1 && height <= 65536))
    bad_input(file, place, "the size of the pictures is not within 65536");
  Lens lens;
  lens.width = int(width), lens.height = int(height);
  const std::size_t n = model.has_one_focal ? 1 : 2;
  lens.k = {p[0], p[n - 1], p[n], p[n + 1]};
  if (!(lens.k.fx > 0 && lens.k.fy > 0 && std::isfinite(lens.k.cx) && std::isfinite(lens.k.cy)))
    bad_input(file, place, "the intrinsics are no numbers of a lens");
  const std::string_view name = model.name;
  const bool is_bent =
      std::any_of(p.begin() + std::ptrdiff_t(n + 2), p.end(), [](double v) { return v != 0; });
  if (name.find("FISHEYE") != name.npos || is_bent)
    lens.distortion = "distortion (" + std::string(name) + ")";
  return lens;
}

using Lenses = std::map<std::uint32_t, Lens>;

struct Picture {
  std::string name;
  Camera camera;
  std::string distortion;
};

/// The numbers of a binary file in their order, each checked against its end.
class ColmapBytes {
 public:
  explicit ColmapBytes(const std::filesystem::path& file) : file_(file) {
    const File input(file);
    if (input.size() > largest_images)
      bad_input(file, "byte 0", "larger than 4 GB; this is no file of COLMAP");
    bytes_ = input.read_text(0, std::size_t(input.size()));
  }
  template <class T>
  T take() {
    T value;
    need(sizeof value);
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string word() {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == bytes_.npos) need(bytes_.size());
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return text;
  }
  void skip(std::uint64_t count, std::uint64_t size) {
    if (count > bytes_.size() / size) need(bytes_.size() + 1);
    need(std::size_t(count * size));
    at_ += std::size_t(count * size);
  }
  std::string place() const { return "byte " + std::to_string(at_); }

 private:
  void need(std::size_t count) const {
    if (count > bytes_.size() - at_)
      bad_input(file_, place(), "the file ends here; it is cut short or damaged, fetch it again");
  }
  std::filesystem::path file_;
  std::string bytes_;
  std::size_t at_ = 0;
};

Lenses read_lenses_bin(const std::filesystem::path& file) {
  ColmapBytes in(file);
  Lenses lenses;
  for (auto left = in.take<std::uint64_t>(); left > 0; --left) {
    const std::string place = in.place();
    const auto id = in.take<std::uint32_t>();
    const auto model = in.take<std::int32_t>();
    if (model < 0 || model >= int(colmap_models.size()))
      bad_input(file, place, "there is no camera model " + std::to_string(model) + " of COLMAP");
    const auto width = in.take<std::uint64_t>(), height = in.take<std::uint64_t>();
    std::vector<double> p(std::size_t(colmap_models[std::size_t(model)].parameters));
    for (double& value : p) value = in.take<double>();
    lenses[id] =
        lens_of_model(colmap_models[std::size_t(model)], double(width), double(height), p, file, place);
  }
  return lenses;
}

Lenses read_lenses_text(const std::filesystem::path& file) {
  const File input(file);
  std::istringstream lines(input.read_text(0, std::size_t(std::min(input.size(), largest_images))));
  Lenses lenses;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = "line " + std::to_string(++number);
    if (line.find_first_not_of(" \t\r") == line.npos || line[0] == '#') continue;
    std::istringstream words(line);
    std::uint32_t id = 0;
    std::string name;
    double width = 0, height = 0;
    if (!(words >> id >> name >> width >> height))
      bad_input(file, place, "expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
    const auto model = std::find_if(colmap_models.begin(), colmap_models.end(),
                                    [&](const auto& m) { return name == m.name; });
    if (model == colmap_models.end())
      bad_input(file, place, "there is no camera model '" + name.substr(0, 40) + "' of COLMAP");
    std::vector<double> p(std::size_t(model->parameters));
    for (double& value : p)
      if (!(words >> value))
        bad_input(file, place, name + " has " + std::to_string(model->parameters) + " parameters");
    lenses[id] = lens_of_model(*model, width, height, p, file, place);
  }
  return lenses;
}

Picture picture_of(const std::string& name, const double* q, const dvec3& t, std::uint32_t camera,
                   const Lenses& lenses, const std::filesystem::path& file, const std::string& place) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) < 0.01)) bad_input(file, place, "the quaternion qw qx qy qz is not of length 1");
  const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
  // Rows of the rotation from the world: the axes of the camera in it.
  const dvec3 right(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
      down(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
      forward(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y));
  const auto lens = lenses.find(camera);
  if (lens == lenses.end())
    bad_input(file, place,
              "there is no camera " + std::to_string(camera) + " in the file of cameras beside it");
  return {name,
          camera_of_pose(right, down, forward, -(right * t.x + down * t.y + forward * t.z), &lens->second,
                         file, place),
          lens->second.distortion};
}

std::vector<Picture> read_images_bin(const std::filesystem::path& file, const Lenses& lenses) {
  ColmapBytes in(file);
  std::vector<Picture> pictures;
  for (auto left = in.take<std::uint64_t>(); left > 0; --left) {
    const std::string place = in.place();
    in.take<std::uint32_t>();
    double q[4], t[3];
    for (double& value : q) value = in.take<double>();
    for (double& value : t) value = in.take<double>();
    const auto camera = in.take<std::uint32_t>();
    const std::string name = in.word();
    pictures.push_back(picture_of(name, q, {t[0], t[1], t[2]}, camera, lenses, file, place));
    const auto points = in.take<std::uint64_t>();
    in.skip(points, 2 * sizeof(double) + sizeof(std::int64_t));
  }
  return pictures;
}

std::vector<Picture> read_images_text(const std::filesystem::path& file, const Lenses& lenses) {
  const File input(file);
  if (input.size() > largest_images) bad_input(file, "byte 0", "larger than 4 GB; this is no file of COLMAP");
  std::istringstream lines(input.read_text(0, std::size_t(input.size())));
  std::vector<Picture> pictures;
  std::size_t number = 0;
  for (std::string line, points; std::getline(lines, line);) {
    const std::string place = "line " + std::to_string(++number);
    if (line.find_first_not_of(" \t\r") == line.npos || line[0] == '#') continue;
    std::istringstream words(line);
    std::uint32_t id = 0, camera = 0;
    double q[4], t[3];
    words >> id >> q[0] >> q[1] >> q[2] >> q[3] >> t[0] >> t[1] >> t[2] >> camera >> std::ws;
    std::string name;
    if (!words || !std::getline(words, name))
      bad_input(file, place, "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    pictures.push_back(picture_of(name, q, {t[0], t[1], t[2]}, camera, lenses, file, place));
    if (std::getline(lines, points)) ++number;  // what the picture sees; may be empty
  }
  return pictures;
}

}  // namespace

CameraPath read_colmap_images(const std::filesystem::path& file) {
  const bool is_text = file.extension() == ".txt";
  std::error_code error;
  std::filesystem::path cameras = file.parent_path() / (is_text ? "cameras.txt" : "cameras.bin");
  if (!std::filesystem::exists(cameras, error)) {
    const std::filesystem::path other = file.parent_path() / (is_text ? "cameras.bin" : "cameras.txt");
    if (!std::filesystem::exists(other, error))
      bad_input(file, "byte 0", "there is no " + cameras.filename().string() + " beside it");
    cameras = other;
  }
  const Lenses lenses = cameras.extension() == ".txt" ? read_lenses_text(cameras) : read_lenses_bin(cameras);
  std::vector<Picture> pictures = is_text ? read_images_text(file, lenses) : read_images_bin(file, lenses);
  if (pictures.empty()) bad_input(file, "byte 0", "it holds no picture");
  std::stable_sort(pictures.begin(), pictures.end(),
                   [](const Picture& a, const Picture& b) { return a.name < b.name; });
  CameraPath path;
  path.are_pictures = true;
  std::string distortion;
  for (const Picture& picture : pictures) {
    path.cameras.push_back(picture.camera);
    if (distortion.empty()) distortion = picture.distortion;
  }
  if (!distortion.empty())
    path.notes.push_back("the " + distortion + " of its lens is not applied: the picture is of a pinhole");
  return path;
}

std::optional<UpAxis> up_of_pictures(const std::filesystem::path& points) {
  constexpr double agree = 0.5;               // as long is the mean of directions all over half a sphere
  constexpr std::uintmax_t most = 256 << 20;  // bytes, a second at most: the convention is as good as always
  const std::filesystem::path folder = points.parent_path();
  for (const char* name : {"images.bin", "images.txt", "sparse/images.bin", "sparse/images.txt"}) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(folder / name, error);
    if (error || size > most) continue;
    try {
      const CameraPath path = read_colmap_images(folder / name);
      dvec3 up(0);
      for (const Camera& camera : path.cameras) up += camera.up / double(path.cameras.size());
      if (!(glm::length(up) > agree)) continue;
      int axis = 0;
      for (int k = 1; k < 3; ++k)
        if (std::abs(up[k]) > std::abs(up[axis])) axis = k;
      return UpAxis(2 * axis + (up[axis] > 0 ? 0 : 1));
    } catch (const Error&) {  // is no reason not to see the points
    }
  }
  return std::nullopt;
}

}  // namespace sfumato::io
