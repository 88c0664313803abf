#include "levels.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "run.h"
#include "scene/assemble.h"
#include "session/standpoint.h"

namespace sfumato::python {
namespace {

using CloudPtr = std::shared_ptr<Cloud>;

/// Files, or clouds of Python, and where their points go.
struct Sources {
  std::vector<scene::SceneFile> files;
  std::vector<CloudPtr> clouds;  ///< of each; nothing for files
  bool only_files() const {
    return std::all_of(clouds.begin(), clouds.end(), [](const CloudPtr& cloud) { return !cloud; });
  }
};

/// `items`: pairs of a name or a cloud, and 16 numbers or None. Names of folders and patterns stand for
/// several files.
Sources sources_of(const py::list& items) {
  Sources sources;
  for (const py::handle& item : items) {
    const auto pair = item.cast<py::tuple>();
    std::optional<dmat4> transform;
    if (!pair[1].is_none()) transform = transform_of(pair[1].cast<std::vector<double>>());
    if (!py::isinstance<py::str>(pair[0])) {
      sources.clouds.push_back(pair[0].cast<CloudPtr>());
      sources.files.push_back({"cloud " + std::to_string(sources.files.size() + 1), transform});
      continue;
    }
    for (const std::string& name : scene::expand_inputs({pair[0].cast<std::string>()})) {
      sources.files.push_back({name, transform});
      sources.clouds.push_back(nullptr);
    }
  }
  if (sources.files.empty()) throw Error(ErrorCode::usage, "no file given");
  return sources;
}

scene::SceneOptions options_of(const std::vector<std::string>& columns,
                               const std::optional<std::uint64_t>& max_points,
                               const std::optional<std::string>& up, const py::dict& wishes,
                               bool every_attribute, bool strict) {
  scene::SceneOptions options;
  options.read.columns = columns;
  options.read.max_points = max_points;
  options.read.every_attribute = every_attribute;
  options.read.strict = strict;
  options.selection = selection_of(wishes);
  options.up = up_axis(up);
  return options;
}

/// A copy of a cloud as if it had been read.
io::ReadResult result_of(const Cloud& cloud, const std::string& name) {
  io::ReadResult result;
  result.cloud = cloud.scene.cloud;
  result.cloud.source_index = {};
  if (cloud.up) result.cloud.set_up(*cloud.up);
  result.report.file = name;
  result.report.points = result.report.points_finite = result.cloud.size();
  return result;
}

CloudPtr read(const py::list& items, const std::vector<std::string>& columns,
              const std::optional<std::uint64_t>& max_points, const std::optional<std::string>& up,
              const py::dict& wishes, bool every_attribute, bool strict, bool vertices,
              const py::object& progress) {
  scene::SceneOptions options = options_of(columns, max_points, up, wishes, every_attribute, strict);
  options.read.samples_faces = !vertices;
  const Sources sources = sources_of(items);
  auto cloud = std::make_shared<Cloud>();
  cloud->up = options.up;
  if (!sources.clouds.front()) cloud->file = sources.files.front().name;
  run(
      [&](Progress& reporter) {
        if (sources.only_files()) {
          cloud->scene = scene::read_scene(sources.files, options, reporter);
          return;
        }
        io::ReadOptions each = options.read;
        each.max_points.reset();  // holds for all together
        const auto read_one = [&](std::size_t i) {
          return sources.clouds[i] ? result_of(*sources.clouds[i], sources.files[i].name)
                                   : scene::read_file(sources.files[i].name, each, reporter);
        };
        cloud->scene = scene::assemble(sources.files, options, read_one);
      },
      progress);
  return cloud;
}

/// Nothing where the files are to be read whole, unless `always`.
std::unique_ptr<Levels> open(const py::list& items, const std::vector<std::string>& columns,
                             const std::optional<std::uint64_t>& max_points,
                             const std::optional<std::uint64_t>& memory, const std::optional<std::string>& up,
                             const py::dict& wishes, bool always, bool strict) {
  const scene::SceneOptions options = options_of(columns, max_points, up, wishes, false, strict);
  const Sources sources = sources_of(items);
  if (!sources.only_files()) return nullptr;
  auto found =
      scene::LeveledScene::open(sources.files, options, memory.value_or(scene::default_memory), always);
  if (!found && always) {
    for (const scene::SceneFile& file : sources.files)
      if (!copc::is_tree(file.name))
        throw Error(ErrorCode::usage,
                    file.name +
                        ": it is no octree (COPC, EPT, Potree 2), which alone can be read in parts; sfumato build "
                        "makes one, sfumato.read reads all of it");
    throw Error(ErrorCode::usage, "files that are moved cannot be read in parts");
  }
  if (!found) return nullptr;
  return std::make_unique<Levels>(Levels{std::move(*found), sources.files.front().name});
}

py::tuple bounds_of(const Levels& self) {
  const Bounds all = self.scene.bounds();
  return py::make_tuple(py::make_tuple(all.min.x, all.min.y, all.min.z),
                        py::make_tuple(all.max.x, all.max.y, all.max.z));
}

py::list levels(const Levels& self) {
  py::list rows;
  for (const copc::LevelFacts& level : copc::levels_of(self.scene.trees().front()))
    rows.append(py::make_tuple(level.points, level.spacing));
  return rows;
}

CloudPtr cloud_of(const Levels& self, const std::function<scene::Scene(Progress&)>& read_it,
                  const py::object& progress) {
  auto cloud = std::make_shared<Cloud>();
  cloud->file = self.file;
  run([&](Progress& reporter) { cloud->scene = read_it(reporter); }, progress);
  return cloud;
}

}  // namespace

dmat4 transform_of(const std::vector<double>& rows) {
  dmat4 matrix;
  if (rows.size() != 16) throw Error(ErrorCode::usage, "transform: give a matrix of shape (4, 4)");
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = rows[std::size_t(4 * row + column)];
  const bool finite = std::all_of(rows.begin(), rows.end(), [](double v) { return std::isfinite(v); });
  if (!finite || matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1 ||
      !(std::abs(glm::determinant(matrix)) > 1e-300))
    throw Error(ErrorCode::usage,
                "transform: the last row of a transform is 0 0 0 1, and it flattens nothing");
  return matrix;
}

void bind_levels(py::module_& module) {
  py::class_<Stand>(module, "Stand")
      .def("first_view", &StandMethods::first_view)
      .def("first_of_turn", &StandMethods::first_of_turn)
      .def("view", &StandMethods::view)
      .def("inside", &StandMethods::inside)
      .def_property_readonly("up", [](const Stand& self) { return to_string(self.pose.upright.up); })
      .def_property_readonly("up_vector", &StandMethods::up_vector);
  py::class_<Levels>(module, "Levels")
      .def("__len__", [](const Levels& self) { return self.scene.points(); })
      .def_property_readonly("bounds", &bounds_of)
      .def_property_readonly("levels", &levels)
      .def_property_readonly("crs", [](const Levels& self) { return self.scene.trees().front().crs; })
      .def_property_readonly("file", [](const Levels& self) { return self.file; })
      // From the coarse levels, as the command does.
      .def("stand",
           [](Levels& self, const std::optional<std::string>& up, bool whole, const py::object& progress) {
             const std::optional<UpAxis> asked = up_axis(up);
             Stand stand;
             run(
                 [&](Progress& reporter) {
                   scene::Scene scene = self.scene.overview(reporter);
                   stand.pose = stand_upright(scene, asked, !whole);
                   stand.place = place_inside(scene.cloud);
                 },
                 progress);
             return stand;
           })
      .def("coarse",
           [](const Levels& self, std::uint64_t count, const py::object& progress) {
             return cloud_of(
                 self, [&](Progress& reporter) { return self.scene.coarse(count, reporter); }, progress);
           })
      .def("read",
           [](const Levels& self, const std::vector<Camera>& cameras, bool panorama, bool has_shadows,
              const py::object& progress) {
             const std::vector<copc::View> views = copc::views_of(cameras, panorama);
             return cloud_of(
                 self, [&](Progress& reporter) { return self.scene.read(views, has_shadows, reporter); },
                 progress);
           })
      // Whether one cloud within the budget holds what all of these cameras show.
      .def("holds", [](const Levels& self, const std::vector<Camera>& cameras, bool has_shadows) {
        return self.scene.select(copc::views_of(cameras), has_shadows).is_complete();
      });
  module.def("read", &read);
  module.def("open", &open);
}

}  // namespace sfumato::python
