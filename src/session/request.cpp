#include "session/request.h"

#include <algorithm>

#include "core/error.h"
#include "io/camera_json.h"

namespace sfumato {
namespace {

[[noreturn]] void refuse_request(const std::string& message) { throw Error(ErrorCode::usage, message); }

void refuse_pair(bool both, const std::string& what) {
  if (both) refuse_request(what + " contradict each other: give one of them");
}

}  // namespace

bool Request::stands_somewhere() const {
  return !camera_file.empty() || view.position || view.focal_point || view.look_at || view.distance ||
         view.zoom || view.start || panorama;
}

bool Request::moves_camera() const {
  return !camera_file.empty() || view.position || view.focal_point || view.view_up || view.direction ||
         view.azimuth || view.elevation || view.fov || view.zoom || view.look_at || view.distance;
}

scene::SceneOptions Request::scene_options() const {
  scene::SceneOptions options = points;
  options.read.samples_faces = !vertices && output_index.empty();  // points on faces are none of the input
  Selection& wanted = options.selection;
  refuse_pair(wanted.crop && wanted.crop_share, "--crop and --crop-relative");
  wanted.hide_withheld = !hide_classes.empty();
  for (int id : hide_classes)
    if (std::find(wanted.show_classes.begin(), wanted.show_classes.end(), id) == wanted.show_classes.end())
      wanted.hide_classes.push_back(id);
  return options;
}

void resolve_view(Request& request) {
  CameraRequest& view = request.view;
  if (!view.side.empty()) {
    refuse_pair(view.azimuth || view.elevation,
                "--view and --camera-azimuth-angle / --camera-elevation-angle");
    refuse_pair(view.position.has_value(), "--view and --camera-position");
    refuse_pair(view.direction.has_value(), "--view and --camera-direction");
    const NamedView side = find_view(view.side, "--view");
    view.azimuth = side.azimuth_deg, view.elevation = side.elevation_deg;
  }
  refuse_pair(view.look_at && view.focal_point, "--look-at and --camera-focal-point");
  refuse_pair(view.look_at && view.position, "--look-at and --camera-position");
  refuse_pair(view.distance && view.position, "--distance and --camera-position");
  refuse_pair(view.pixel_size && view.print_scale, "--pixel-size and --scale");
  if (view.print_scale && !(request.dpi() > 0)) refuse_request("--scale needs a --dpi of more than 0");
  for (const auto& [option, given] :
       {std::pair("--pixel-size", view.pixel_size.has_value()), {"--scale", view.print_scale.has_value()}}) {
    if (!given) continue;
    const std::string name = option;
    refuse_pair(request.panorama, name + " and --panorama");
    refuse_pair(view.zoom.has_value(), name + " and --zoom");
    refuse_pair(view.fov.has_value(), name + " and --camera-view-angle");
  }
  if (request.panorama) {
    refuse_pair(view.orthographic, "--panorama and --camera-orthographic");
    for (const auto& [option, given] : {std::pair("--zoom", view.zoom.has_value()),
                                        {"--roll", view.roll.has_value()},
                                        {"--camera-view-angle", view.fov.has_value()},
                                        {"--distance", view.distance.has_value()}})
      if (given)
        refuse_request(std::string(option) +
                       " does not go with --panorama, which shows everything around a place");
    if (view.size && view.size->first != 2 * view.size->second)
      refuse_request("--panorama is twice as wide as high: --resolution " +
                     std::to_string(2 * view.size->second) + "x" + std::to_string(view.size->second));
    view.first_size = {2048, 1024};
  }
  refuse_pair(view.position && (view.azimuth || view.elevation),
              "--camera-position and --camera-azimuth-angle / --camera-elevation-angle");
  refuse_pair(view.direction && (view.azimuth || view.elevation),
              "--camera-direction and --camera-azimuth-angle / --camera-elevation-angle");
  refuse_pair(view.position && view.focal_point && view.direction,
              "--camera-direction and --camera-position with --camera-focal-point");
}

void check_color(const Request& request) {
  const ColorSettings& color = request.color;
  if (!color.solid) return;
  refuse_pair(color.color_by != "auto", "--color and --color-by");
  for (const auto& [option, given] : {std::pair("--colormap", !color.colormap.empty()),
                                      {"--color-range", color.range.has_value()},
                                      {"--legend", request.furniture.legend}})
    if (given)
      refuse_request(std::string(option) + " does not go with --color, which paints every point alike");
}

void check_camera(const Request& request, const std::string& whose) {
  const CameraRequest& view = request.view;
  if (view.position && view.focal_point && *view.position == *view.focal_point)
    refuse_request("the camera's position and the place it looks at are the same point");
  if (!view.start || !view.start->custom_intrinsics) return;
  if (view.size)
    refuse_request("--resolution does not go with the intrinsics of " + whose +
                   ": they hold for its own width and height");
  if (view.fov || view.orthographic || view.pixel_size || view.print_scale)
    refuse_request(
        "--camera-view-angle, --camera-orthographic, --pixel-size and --scale do not go with the "
        "intrinsics of " +
        whose);
}

void read_camera_file(Request& request) {
  if (!request.camera_file.empty()) request.view.start = io::read_camera(request.camera_file);
  check_camera(request, request.camera_file.empty() ? "the preset's camera" : request.camera_file);
}

}  // namespace sfumato
