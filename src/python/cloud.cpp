#include "cloud.h"

#include <algorithm>
#include <memory>

#include "core/error.h"
#include "core/typed_attributes.h"
#include "io/memory.h"
#include "run.h"
#include "session/notes.h"
#include "synth/synth.h"

namespace sfumato::python {
namespace {

using CloudPtr = std::shared_ptr<Cloud>;

StoredType type_of(const py::array& array, const std::string& name) {
  const char kind = array.dtype().kind();
  const auto size = array.itemsize();
  const auto pick = [&](std::initializer_list<std::pair<int, StoredType>> types) {
    for (const auto& [bytes, type] : types)
      if (size == bytes) return type;
    throw Error(ErrorCode::usage, name + ": numbers of " + std::to_string(size) +
                                      " bytes are not read; give float32 or float64");
  };
  using enum StoredType;
  if (kind == 'f') return pick({{4, float32}, {8, float64}});
  if (kind == 'u' || kind == 'b') return pick({{1, uint8}, {2, uint16}, {4, uint32}, {8, uint64}});
  if (kind == 'i') return pick({{1, int8}, {2, int16}, {4, int32}, {8, int64}});
  throw Error(ErrorCode::usage, name + ": an array of kind '" + std::string(1, kind) + "' holds no numbers");
}

const char* name_of(StoredType type) {
  static const char* names[] = {"uint8", "int8",    "uint16",  "int16",  "uint32",
                                "int32", "float32", "float64", "uint64", "int64"};
  return names[int(type)];
}

/// `arrays`: names, one-dimensional arrays of one length in the machine's byte order, and whether they are
/// scalars whatever their names say.
CloudPtr from_columns(const std::vector<std::tuple<std::string, py::array, bool>>& arrays,
                      const std::optional<std::string>& up, const std::string& crs,
                      const py::object& progress) {
  std::vector<io::MemoryColumn> columns;
  std::size_t rows = 0;
  for (const auto& [name, array, is_scalar] : arrays) {
    rows = std::size_t(array.shape(0));
    columns.push_back({name, type_of(array, name), static_cast<const std::byte*>(array.data()),
                       std::size_t(array.strides(0)), is_scalar});
  }
  if (rows > 0xFFFFFFF0u)
    throw Error(ErrorCode::usage, "a cloud has at most 4,294,967,280 points; give a part of them");
  auto cloud = std::make_shared<Cloud>();
  cloud->up = up_axis(up);
  run(
      [&](Progress& reporter) {
        io::MemoryResult result = io::read_memory(columns, rows, reporter);
        scene::Scene& scene = cloud->scene;
        scene.notes = result.report.notes;
        scene.points_read = result.report.points;
        scene.cloud = std::move(result.cloud);
        scene.cloud.crs = crs;
        if (cloud->up) scene.cloud.set_up(*cloud->up);
        cloud->kept = std::move(result.kept);
      },
      progress);
  return cloud;
}

std::vector<std::string> write(Cloud& cloud, const std::string& file, const py::object& progress) {
  std::vector<std::string> notes;
  if (cloud.up) cloud.points().set_up(*cloud.up);
  run([&](Progress& reporter) { notes = io::write(file, cloud.points(), reporter).notes; }, progress);
  return notes;
}

CloudPtr synthesise(const std::string& name, const Settings& settings, const std::optional<std::string>& mesh,
                    const py::object& progress) {
  synth::SampleOptions options;
  ParamList parameters;
  options.describe(parameters);
  set_all(parameters, settings, "synth has no parameter");
  auto cloud = std::make_shared<Cloud>();
  run(
      [&](Progress& reporter) {
        const synth::Scene scene =
            mesh ? synth::make_mesh_scene(io::read_mesh(*mesh, reporter)) : synth::make_scene(name);
        cloud->scene.cloud = synth::sample(scene, options, reporter);
        cloud->scene.points_read = cloud->scene.cloud.size();
        cloud->up = scene.up;
      },
      progress);
  return cloud;
}

py::object positions(const CloudPtr& self, const py::object& owner) {
  auto& values = self->points().positions;
  return view(values.empty() ? nullptr : &values[0].x, {py::ssize_t(values.size()), 3}, owner);
}

/// World coordinates, double.
py::array world(const CloudPtr& self) {
  const PointCloud& cloud = self->points();
  py::array_t<double> out({py::ssize_t(cloud.size()), py::ssize_t(3)});
  double* to = out.mutable_data();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 p = cloud.world(i);
    to[3 * i] = p.x, to[3 * i + 1] = p.y, to[3 * i + 2] = p.z;
  }
  return out;
}

py::object scalar(const CloudPtr& self, const std::string& name, const py::object& owner) {
  ScalarField* field = self->points().scalar(name);
  if (!field) {
    std::vector<std::string> names;
    for (const ScalarField& each : self->points().scalars) names.push_back(each.name);
    refuse_name("the cloud has no scalar", name, names);
  }
  const auto count = py::ssize_t(field->values.size());
  if (field->offset == 0) return view(field->values.data(), {count}, owner);
  py::array_t<double> out(count);
  for (std::size_t i = 0; i < field->values.size(); ++i) out.mutable_data()[i] = field->value(i);
  return out;
}

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

void check_rows(const Cloud& cloud, const py::array& values, py::ssize_t width, const char* what) {
  const py::ssize_t rows = py::ssize_t(cloud.scene.cloud.size());
  if (values.ndim() == (width == 1 ? 1 : 2) && values.shape(0) == rows &&
      (width == 1 || values.shape(1) == width))
    return;
  std::string shape;
  for (int k = 0; k < int(values.ndim()); ++k) shape += (k ? ", " : "") + std::to_string(values.shape(k));
  throw Error(ErrorCode::usage, std::string(what) + ": found an array of shape (" + shape + "), expected (" +
                                    std::to_string(rows) +
                                    (width == 1 ? ",)" : ", " + std::to_string(width) + ")"));
}

void set_scalar(const CloudPtr& self, const std::string& name, const Floats& values) {
  check_rows(*self, values, 1, name.c_str());
  PointCloud& cloud = self->points();
  if (ScalarField* field = cloud.scalar(name)) {  // in place: arrays may be views of it
    field->offset = 0;
    std::copy(values.data(), values.data() + values.size(), field->values.begin());
  } else {
    cloud.set_scalar(
        {name, 0, std::vector<float>(values.data(), values.data() + values.size()), StoredType::float32});
  }
}

void set_normals(const CloudPtr& self, const Floats& values) {
  check_rows(*self, values, 3, "normals");
  std::vector<vec3>& normals = self->points().normals;
  normals.resize(self->points().size());  // moves nothing where there are normals
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const vec3 n = glm::make_vec3(values.data() + 3 * i);
    const float length = glm::length(n);
    normals[i] = length > 0 && std::isfinite(length) ? n / length : vec3(0);
  }
}

CloudPtr pick(const CloudPtr& self, const std::vector<std::uint32_t>& places) {
  for (std::uint32_t place : places)
    if (place >= self->points().size())
      throw Error(ErrorCode::usage, "there is no point " + std::to_string(place) + ": the cloud has " +
                                        std::to_string(self->points().size()));
  auto out = std::make_shared<Cloud>();
  out->scene.files = self->scene.files;
  out->scene.points_read = places.size();
  out->scene.file_names = self->scene.file_names;
  out->scene.cloud = select(self->points(), places);
  // A cloud of its own: its points are numbered anew, as those of a file that holds just them.
  out->scene.cloud.source_index = {};
  out->file = self->file;
  out->up = self->up;
  return out;
}

py::tuple tuple_of(const dvec3& v) { return py::make_tuple(v.x, v.y, v.z); }

}  // namespace

std::optional<UpAxis> up_axis(const std::optional<std::string>& text) {
  Request request;
  if (text) set_option(request, "up", *text);
  return request.points.up;
}

void bind_cloud(py::module_& module) {
  py::class_<Cloud, CloudPtr> type(module, "Cloud");
  for_each_attribute([&](const auto& each) {
    type.def(each.name, [](const py::object& self) -> py::object {
      using Each = std::remove_cvref_t<decltype(each)>;
      auto& values = Each::of(self.cast<CloudPtr>()->points());
      if (values.empty()) return py::none();
      std::vector<py::ssize_t> shape{py::ssize_t(values.size())};
      if (Each::width > 1) shape.push_back(Each::width);
      return view(reinterpret_cast<typename Each::Component*>(values.data()), shape, self);
    });
  });
  type.def("__len__", [](Cloud& self) { return self.points().size(); })
      .def("positions", [](const py::object& self) { return positions(self.cast<CloudPtr>(), self); })
      .def("world", &world)
      .def("scalar", [](const py::object& self,
                        const std::string& name) { return scalar(self.cast<CloudPtr>(), name, self); })
      .def("scalar_types",
           [](Cloud& self) {
             py::dict types;
             for (const ScalarField& field : self.points().scalars)
               types[py::str(field.name)] = name_of(field.type);
             return types;
           })
      .def("set_scalar", &set_scalar)
      .def("set_normals", &set_normals)
      .def("pick", &pick)
      .def("kept",
           [](const py::object& self) -> py::object {
             auto& kept = self.cast<CloudPtr>()->kept;
             if (kept.empty()) return py::none();
             return view(kept.data(), {py::ssize_t(kept.size())}, self);
           })
      .def_property(
          "origin", [](Cloud& self) { return tuple_of(self.points().origin); },
          [](Cloud& self, const std::array<double, 3>& v) {
            self.points().origin = {v[0], v[1], v[2]};
          })
      .def_property(
          "up",
          [](Cloud& self) -> std::optional<std::string> {
            return self.up ? std::optional(to_string(*self.up)) : std::nullopt;
          },
          [](Cloud& self, const std::optional<std::string>& text) {
            self.up = up_axis(text);
            if (!self.up) self.points().up_is_known = false;  // what was said before is taken back
          })
      .def_property(
          "crs", [](Cloud& self) { return self.points().crs; },
          [](Cloud& self, const std::string& text) { self.points().crs = text; })
      .def_property_readonly("notes", [](Cloud& self) { return notes_of_reading(self.scene); })
      .def_property_readonly("damage", [](Cloud& self) { return self.scene.damage; })
      .def_property_readonly("points_read", [](Cloud& self) { return self.scene.points_read; })
      .def_property_readonly("points_missing", [](Cloud& self) { return self.scene.points_missing; })
      .def_property_readonly("file", [](Cloud& self) { return self.file; })
      .def_property_readonly("bounds", [](Cloud& self) {
        const Bounds box = bounds(self.points());
        return py::make_tuple(tuple_of(box.min), tuple_of(box.max));
      });
  module.def("from_columns", &from_columns);
  module.def("write", &write);
  module.def("synth", &synthesise);
  module.def("scene_names", &synth::scene_names);
  module.def("synth_parameters", [] {
    synth::SampleOptions options;
    ParamList parameters;
    options.describe(parameters);
    return describe_all(parameters);
  });
  module.def("formats", [] {
    py::list rows;
    for (const io::FormatInfo& format : io::formats()) {
      py::dict row;
      row["name"] = format.name, row["extensions"] = format.extensions,
      row["description"] = format.description;
      row["can_read"] = format.can_read, row["can_write"] = format.can_write;
      rows.append(row);
    }
    return rows;
  });
}

}  // namespace sfumato::python
