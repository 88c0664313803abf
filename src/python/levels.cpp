#include "levels.h"

#include <algorithm>

#include "cloud.h"
#include "core/error.h"
#include "run.h"
#include "scene/assemble.h"
#include "session/opening.h"
#include "session/preset.h"

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

/// All that is wanted of sources that are read whole.
scene::Scene scene_of(const Sources& sources, const scene::SceneOptions& options, Progress& progress) {
  if (sources.only_files()) return scene::read_scene(sources.files, options, progress);
  io::ReadOptions each = options.read;
  each.max_points.reset();  // holds for all together
  const auto read_one = [&](std::size_t i) {
    return sources.clouds[i] ? result_of(*sources.clouds[i], sources.files[i].name)
                             : scene::read_file(sources.files[i].name, each, progress);
  };
  return scene::assemble(sources.files, options, read_one);
}

CloudPtr read(const py::list& items, const Request& request, bool every_attribute,
              const py::object& progress) {
  scene::SceneOptions options = request.scene_options();
  options.read.every_attribute = every_attribute;
  const Sources sources = sources_of(items);
  auto cloud = std::make_shared<Cloud>();
  cloud->up = options.up;
  if (!sources.clouds.front()) cloud->file = sources.files.front().name;
  run([&](Progress& reporter) { cloud->scene = scene_of(sources, options, reporter); }, progress);
  return cloud;
}

std::unique_ptr<Levels> open_levels(const py::list& items, const Request& request) {
  const Sources sources = sources_of(items);
  auto found = scene::LeveledScene::open(sources.files, request.scene_options(), request.memory, true);
  if (found) return std::make_unique<Levels>(Levels{std::move(*found), sources.files.front().name});
  for (const scene::SceneFile& file : sources.files)
    if (!copc::is_tree(file.name))
      throw Error(ErrorCode::usage,
                  file.name +
                      ": it is no octree (COPC, EPT, Potree 2), which alone can be read in parts; sfumato "
                      "build makes one, sfumato.read reads all of it");
  throw Error(ErrorCode::usage, "files that are moved cannot be read in parts");
}

std::unique_ptr<Opening> opened(const std::function<Opening(Progress&)>& open, const py::object& progress) {
  std::unique_ptr<Opening> opening;
  run([&](Progress& reporter) { opening = std::make_unique<Opening>(open(reporter)); }, progress);
  return opening;
}

std::unique_ptr<Opening> open_files(const py::list& items, const Request& request,
                                    const py::object& progress) {
  const Sources sources = sources_of(items);
  return opened(
      [&](Progress& reporter) {
        return sources.only_files()
                   ? Opening(request, sources.files, reporter)
                   : Opening(request, scene_of(sources, request.scene_options(), reporter), reporter);
      },
      progress);
}

/// `own`: a cloud of the user is copied, for rendering sorts its points.
std::unique_ptr<Opening> open_cloud(const CloudPtr& cloud, bool own, Request request,
                                    const py::object& progress) {
  if (!request.points.up) request.points.up = cloud->up;
  return opened(
      [&](Progress& reporter) {
        if (cloud->scene.cloud.empty())
          throw Error(ErrorCode::bad_input, "the cloud has no points to render");
        scene::Scene scene = own ? cloud->scene : std::move(cloud->scene);
        scene::narrow(scene, {}, request.scene_options());
        return Opening(request, std::move(scene), reporter);
      },
      progress);
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

CloudPtr cloud_of(const std::function<scene::Scene(Progress&)>& read_it, const py::object& progress,
                  const std::string& file = {}) {
  auto cloud = std::make_shared<Cloud>();
  cloud->file = file;
  run([&](Progress& reporter) { cloud->scene = read_it(reporter); }, progress);
  return cloud;
}

Camera first_view_of(const Opening& self, int width, int height) {
  return first_view(self.pose(), width, height);
}

/// The same, as far back as a turn needs.
Camera first_of_turn(const Opening& self, int width, int height) {
  Camera camera = first_view_of(self, width, height);
  step_back(camera, self.pose().vertical(), self.pose().subject);
  return camera;
}

}  // namespace

dmat4 transform_of(const std::vector<double>& rows) {
  if (rows.size() != 16) throw Error(ErrorCode::usage, "transform: give a matrix of shape (4, 4)");
  if (const auto transform = transform_of_rows(rows)) return *transform;
  throw Error(ErrorCode::usage, "transform: the last row of a transform is 0 0 0 1, and it flattens nothing");
}

void bind_levels(py::module_& module) {
  py::class_<Levels>(module, "Levels")
      .def(py::init(&open_levels))
      .def("__len__", [](const Levels& self) { return self.scene.points(); })
      .def_property_readonly("bounds", &bounds_of)
      .def_property_readonly("levels", &levels)
      .def_property_readonly("crs", [](const Levels& self) { return self.scene.trees().front().crs; })
      .def_property_readonly("file", [](const Levels& self) { return self.file; })
      .def("coarse",
           [](const Levels& self, std::uint64_t count, const py::object& progress) {
             return cloud_of([&](Progress& reporter) { return self.scene.coarse(count, reporter); }, progress,
                             self.file);
           })
      .def("read", [](const Levels& self, const std::vector<Camera>& cameras, bool panorama, bool has_shadows,
                      const py::object& progress) {
        const std::vector<copc::View> views = copc::views_of(cameras, panorama);
        return cloud_of([&](Progress& reporter) { return self.scene.read(views, has_shadows, reporter); },
                        progress, self.file);
      });
  py::class_<Opening>(module, "Opening")
      .def(py::init(&open_files))
      .def(py::init(&open_cloud))
      .def(py::init([](const Levels& levels, const Request& request, const py::object& progress) {
        return opened([&](Progress& reporter) { return Opening(request, levels.scene, reporter); }, progress);
      }))
      .def_property_readonly("has_levels", &Opening::has_levels)
      .def("first_view", &first_view_of)
      .def("first_of_turn", &first_of_turn)
      .def("view",
           [](const Opening& self, const Request& request) { return view_of(self.pose(), request.view); })
      .def("inside", &Opening::inside)
      .def_property_readonly("up", [](const Opening& self) { return to_string(self.pose().upright.up); })
      .def_property_readonly("up_vector",
                             [](const Opening& self) {
                               const dvec3 up = up_vector(self.pose().upright.up);
                               return py::make_tuple(up.x, up.y, up.z);
                             })
      .def_property_readonly("vertical",  // of the first view
                             [](const Opening& self) {
                               const dvec3 up = self.pose().vertical();
                               return py::make_tuple(up.x, up.y, up.z);
                             })
      // Whether one cloud within the budget holds what all of these cameras show.
      .def("holds", [](const Opening& self, const std::vector<Camera>& cameras,
                       bool has_shadows) { return self.holds(cameras, has_shadows); })
      .def("take",
           [](Opening& self) {
             auto cloud = std::make_shared<Cloud>();
             cloud->scene = self.take();
             return cloud;
           })
      .def("read", [](const Opening& self, const std::vector<Camera>& cameras, bool panorama,
                      bool has_shadows, const py::object& progress) {
        const auto nodes = self.levels().select(copc::views_of(cameras, panorama), has_shadows);
        return cloud_of([&](Progress& reporter) { return self.read(nodes, reporter); }, progress);
      });
  module.def("read", &read);
}

}  // namespace sfumato::python
