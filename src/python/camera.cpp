#include <array>

#include "bindings.h"
#include "io/camera_json.h"
#include "session/first_view.h"
#include "session/preset.h"

namespace sfumato::python {
namespace {

using Triple = std::array<double, 3>;

dvec3 vec(const Triple& v) { return {v[0], v[1], v[2]}; }
py::tuple tuple_of(const dvec3& v) { return py::make_tuple(v.x, v.y, v.z); }

template <dvec3 Camera::*Member>
void triple(py::class_<Camera>& type, const char* name) {
  type.def_property(
      name, [](const Camera& self) { return tuple_of(self.*Member); },
      [](Camera& self, const Triple& v) { self.*Member = vec(v); });
}

/// Column-major in glm, row-major in numpy.
py::array matrix(const dmat4& m) { return py::array_t<double>({4, 4}, rows_of(m).data()); }

}  // namespace

void bind_camera(py::module_& module) {
  py::class_<Camera> type(module, "Camera");
  type.def(py::init<>()).def(py::init<const Camera&>());
  triple<&Camera::position>(type, "position");
  triple<&Camera::target>(type, "target");
  triple<&Camera::up>(type, "up");
  type.def_property(
          "fov", [](const Camera& self) { return glm::degrees(self.fov_y); },
          [](Camera& self, double degrees) { self.fov_y = glm::radians(degrees); })
      .def_readwrite("height_world", &Camera::height_world)
      .def_property("orthographic", &Camera::orthographic,
                    [](Camera& self, bool on) {
                      self.projection = on ? Projection::orthographic : Projection::perspective;
                    })
      .def_property(
          "size", [](const Camera& self) { return std::pair(self.width, self.height); },
          [](Camera& self, const std::pair<int, int>& size) {
            self.width = size.first, self.height = size.second;
          })
      .def_property(
          "custom_intrinsics",
          [](const Camera& self) -> std::optional<std::array<double, 4>> {
            if (!self.custom_intrinsics) return std::nullopt;
            const Intrinsics& k = *self.custom_intrinsics;
            return std::array{k.fx, k.fy, k.cx, k.cy};
          },
          [](Camera& self, const std::optional<std::array<double, 4>>& k) {
            if (k)
              self.custom_intrinsics = Intrinsics{(*k)[0], (*k)[1], (*k)[2], (*k)[3]};
            else
              self.custom_intrinsics.reset();
          })
      .def_property_readonly("intrinsics",
                             [](const Camera& self) {
                               const Intrinsics k = self.intrinsics();
                               return py::make_tuple(k.fx, k.fy, k.cx, k.cy);
                             })
      .def_property_readonly("direction", [](const Camera& self) { return tuple_of(self.direction()); })
      .def("view_matrix", [](const Camera& self) { return matrix(self.view()); })
      .def("resized", &Camera::resized)
      .def("to_json", &io::camera_to_json)
      .def_static("from_json", [](const std::string& text) { return io::camera_from_json(text, "camera"); })
      .def_static("load", [](const std::string& file) { return io::read_camera(file); })
      .def("save", [](const Camera& self, const std::string& file) { io::write_camera(file, self); })
      .def("magnify", [](Camera& self, double factor) { magnify(self, factor); })
      .def("roll", [](Camera& self, double degrees) { roll(self, glm::radians(degrees)); });
  module.def("orbit", [](const Camera& start, const Triple& up, int frames, double degrees) {
    return orbit(start, vec(up), frames, degrees);
  });
  module.def("interpolate", &interpolate);
  module.def("read_camera_path", [](const std::string& file) {
    const io::CameraPath path = io::read_camera_path(file);
    return std::pair(path.cameras, path.are_pictures);
  });
}

}  // namespace sfumato::python
