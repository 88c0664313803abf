#include "camera_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/camera_json.h"

namespace sfumato::cli {
namespace {

void degrees_in(const char* option, const std::string& text, double low, double high) {
  const double value = parse_number(option, text);
  if (value < low || value > high)
    throw Error(ErrorCode::usage, fmt::format("{}: {} degrees is outside [{}, {}]", option, text, low, high));
}

void positive(const char* option, const std::string& text) {
  if (parse_number(option, text) <= 0)
    throw Error(ErrorCode::usage, fmt::format("{}: '{}' is not more than 0", option, text));
}

}  // namespace

void CameraOptions::declare(CommandLine& line) {
  line.group("View");
  line.text("--resolution", resolution, "WxH", "picture size in pixels (1280x720)");
  line.text("--view", view, "front|back|left|right|top|bottom|iso", "the side to look from");
  line.text("--zoom", zoom, "F", "show things F times as large (1)");
  line.text("--roll", roll_deg, "DEG", "turn the camera about its direction of view, counter-clockwise (0)");
  line.text("--look-at", look_at, "X,Y,Z", "look at this place from the same side");
  line.text("--distance", distance, "D", "how far from the place looked at, scene units");
  line.text("--scale", scale, "1:N",
            "print scale of a parallel view: the picture has the right size on paper");
  line.text("--dpi", dpi_text, "N",
            "pixels an inch on paper, kept in .png, .jpg and .tif (300 with --scale)");
  line.text(
      "--pixel-size", pixel_size, "D",
      "scene units that a pixel of a parallel view shows; without --resolution the picture is as large as "
      "the scan");
  line.text("--vertical-exaggeration", exaggeration_text, "F",
            "heights F times as large, those of legends stay true (1)");
  line.flag("--whole", whole, "keep the ceiling and near walls of a room, and frame all points but outliers");
  line.flag("--panorama", panorama,
            "all around --camera-position in one picture twice as wide as high (2048x1024, equirectangular)");
  line.group("Camera (single options win over --camera)");
  line.text("--camera", file, "FILE.json",
            "position, target, up, fov_y_deg, width, height in world coordinates");
  line.text("--camera-position", position, "X,Y,Z", "where the camera stands");
  line.text("--camera-focal-point", focal_point, "X,Y,Z", "what it looks at");
  line.text("--camera-view-up", view_up, "X,Y,Z", "direction that is up in the picture");
  line.text("--camera-direction", direction, "X,Y,Z", "direction of view");
  line.text("--camera-azimuth-angle", azimuth_deg, "DEG",
            "turn about the up axis, 0 from the front (what suits the scan)");
  line.text("--camera-elevation-angle", elevation_deg, "DEG",
            "height above the horizon, -90 to 90 (what suits the scan)");
  line.text("--camera-view-angle", view_angle_deg, "DEG", "full vertical angle: a smaller one zooms in (45)");
  line.flag("--camera-orthographic", orthographic, "parallel projection");
}

std::optional<dvec3> CameraOptions::vector(const char* option, const std::optional<std::string>& text) const {
  if (!text) return std::nullopt;
  const std::vector<double> v = parse_numbers(option, *text, 3, "X,Y,Z");
  for (double number : v)
    if (std::abs(number) > 1e15)
      throw Error(ErrorCode::usage,
                  std::string(option) + ": '" + *text + "' is beyond 1e15, where no point can be seen");
  return dvec3(v[0], v[1], v[2]);
}

void CameraOptions::check() {
  auto refuse_pair = [](bool both, const char* what) {
    if (both) throw Error(ErrorCode::usage, std::string(what) + " contradict each other: give one of them");
  };
  if (view) {
    refuse_pair(azimuth_deg || elevation_deg, "--view and --camera-azimuth-angle / --camera-elevation-angle");
    refuse_pair(position.has_value(), "--view and --camera-position");
    refuse_pair(direction.has_value(), "--view and --camera-direction");
    const NamedView side = find_view(*view, "--view");
    azimuth_deg = fmt::format("{}", side.azimuth_deg), elevation_deg = fmt::format("{}", side.elevation_deg);
  }
  refuse_pair(look_at && focal_point, "--look-at and --camera-focal-point");
  refuse_pair(look_at && position, "--look-at and --camera-position");
  refuse_pair(distance && position, "--distance and --camera-position");
  vector("--look-at", look_at);
  if (pixel_size) positive("--pixel-size", *pixel_size);
  refuse_pair(pixel_size && scale, "--pixel-size and --scale");
  if (dpi() > 0 && !(dpi() >= 1 && dpi() <= 100'000))
    throw Error(ErrorCode::usage, "--dpi: '" + *dpi_text + "' is not in 1..100000");
  print_scale(), vertical_exaggeration();
  for (const auto& [option, given] :
       {std::pair("--pixel-size", pixel_size.has_value()), {"--scale", scale.has_value()}}) {
    if (!given) continue;
    const std::string name = option;
    refuse_pair(panorama, (name + " and --panorama").c_str());
    refuse_pair(zoom.has_value(), (name + " and --zoom").c_str());
    refuse_pair(view_angle_deg.has_value(), (name + " and --camera-view-angle").c_str());
  }
  if (zoom) positive("--zoom", *zoom);
  if (distance) positive("--distance", *distance);
  if (roll_deg) parse_number("--roll", *roll_deg);
  if (panorama) {
    refuse_pair(orthographic, "--panorama and --camera-orthographic");
    for (const auto& [option, given] : {std::pair("--zoom", zoom.has_value()),
                                        {"--roll", roll_deg.has_value()},
                                        {"--camera-view-angle", view_angle_deg.has_value()},
                                        {"--distance", distance.has_value()}})
      if (given)
        throw Error(
            ErrorCode::usage,
            std::string(option) + " does not go with --panorama, which shows everything around a place");
    if (resolution) {
      const auto [width, height] = parse_resolution("--resolution", *resolution);
      if (width != 2 * height)
        throw Error(ErrorCode::usage, fmt::format("--panorama is twice as wide as high: --resolution {}x{}",
                                                  2 * height, height));
    }
  }
  refuse_pair(position && (azimuth_deg || elevation_deg),
              "--camera-position and --camera-azimuth-angle / --camera-elevation-angle");
  refuse_pair(direction && (azimuth_deg || elevation_deg),
              "--camera-direction and --camera-azimuth-angle / --camera-elevation-angle");
  refuse_pair(position && focal_point && direction,
              "--camera-direction and --camera-position with --camera-focal-point");
  vector("--camera-position", position);
  vector("--camera-focal-point", focal_point);
  for (const auto& [option, text] :
       {std::pair("--camera-view-up", view_up), std::pair("--camera-direction", direction)})
    if (const auto v = vector(option, text); v && glm::length(*v) <= 0)
      throw Error(ErrorCode::usage, std::string(option) + ": 0,0,0 is no direction");
  if (azimuth_deg) parse_number("--camera-azimuth-angle", *azimuth_deg);
  if (elevation_deg) degrees_in("--camera-elevation-angle", *elevation_deg, -90, 90);
  if (view_angle_deg) degrees_in("--camera-view-angle", *view_angle_deg, 0.001, 179);
  if (resolution) parse_resolution("--resolution", *resolution);
}

double CameraOptions::print_scale() const {
  if (!scale) return 0;
  const double value = scale->starts_with("1:") ? parse_number("--scale", scale->substr(2)) : 0;
  if (!(value > 0)) throw Error(ErrorCode::usage, "--scale: '" + *scale + "' is no scale; write 1:200");
  return value;
}

double CameraOptions::dpi() const { return dpi_text ? parse_number("--dpi", *dpi_text) : scale ? 300 : 0; }

double CameraOptions::vertical_exaggeration() const {
  if (!exaggeration_text) return 1;
  const double factor = parse_number("--vertical-exaggeration", *exaggeration_text);
  if (!(factor >= 0.001 && factor <= 1000))
    throw Error(ErrorCode::usage,
                "--vertical-exaggeration: '" + *exaggeration_text + "' is not in 0.001..1000");
  return factor;
}

bool CameraOptions::moves_camera() const {
  return file || position || focal_point || view_up || direction || azimuth_deg || elevation_deg ||
         view_angle_deg || zoom || look_at || distance;
}

ViewWishes CameraOptions::wishes() const {
  ViewWishes out;
  const auto number = [](const char* option, const std::optional<std::string>& text) {
    return text ? std::optional(parse_number(option, *text)) : std::nullopt;
  };
  if (file || preset) out.start = file ? io::read_camera(*file) : *preset;
  out.azimuth = number("--camera-azimuth-angle", azimuth_deg);
  out.elevation = number("--camera-elevation-angle", elevation_deg);
  out.fov = number("--camera-view-angle", view_angle_deg);
  out.distance = number("--distance", distance);
  out.position = vector("--camera-position", position);
  out.direction = vector("--camera-direction", direction);
  out.view_up = vector("--camera-view-up", view_up);
  out.focal_point = vector("--camera-focal-point", focal_point);
  out.look_at = vector("--look-at", look_at);
  out.zoom = number("--zoom", zoom).value_or(1);
  out.roll = number("--roll", roll_deg).value_or(0);
  out.orthographic = orthographic;
  out.pixel_size = number("--pixel-size", pixel_size);
  if (scale) out.print_scale = print_scale(), out.dpi = dpi();
  out.upright = view.has_value();
  if (resolution) out.size = parse_resolution("--resolution", *resolution);
  if (panorama) out.first_size = {2048, 1024};
  return out;
}

Camera CameraOptions::resolve(const Pose& pose) const {
  const ViewWishes all = wishes();
  if (all.start && all.start->custom_intrinsics) {
    const std::string name = file ? *file : "the preset's camera";
    if (all.size)
      throw Error(ErrorCode::usage, "--resolution does not go with the intrinsics of " + name +
                                        ": they hold for its own width and height");
    if (all.fov || orthographic || all.pixel_size || all.print_scale)
      throw Error(ErrorCode::usage,
                  "--camera-view-angle, --camera-orthographic, --pixel-size and --scale do not go with the "
                  "intrinsics of " +
                      name);
  }
  return view_of(pose, all);
}

}  // namespace sfumato::cli
