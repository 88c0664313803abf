#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/attributes.h"
#include "analysis/clusters.h"
#include "analysis/distances.h"
#include "analysis/prepare.h"
#include "cloud.h"
#include "core/error.h"
#include "run.h"
#include "session/shadow_factors.h"

namespace sfumato::python {
namespace {

using CloudPtr = std::shared_ptr<Cloud>;

/// A copy of the points with their own numbers, sorted and measured.
PreparedCloud prepare(const Cloud& cloud, Attributes needs, Attributes anew, const Settings& settings,
                      Progress& progress) {
  analysis::PrepareOptions options;
  ParamList parameters;
  options.describe(parameters);
  set_all(parameters, settings, "the analysis has no parameter");
  PointCloud points = cloud.scene.cloud;
  if (points.empty()) throw Error(ErrorCode::bad_input, "the cloud has no points");
  points.source_index = {};
  if (anew.has(Attribute::normal)) points.normals = {};
  if (anew.has(Attribute::radius)) points.radii = {};
  if (anew.has(Attribute::uncertainty))
    std::erase_if(points.scalars, [](const auto& s) {
      return s.name == "uncertainty" || s.name == analysis::stored_uncertainty;
    });
  return analysis::prepare(std::move(points), needs, options, progress);
}

/// Values in the order of the cloud; `nothing` for points that share a place with too many others.
template <class T>
py::array_t<T> in_order(const Cloud& cloud, const PreparedCloud& prepared, py::ssize_t width, T nothing,
                        const auto& value) {
  const auto count = py::ssize_t(cloud.scene.cloud.size());
  py::array_t<T> out(width == 1 ? std::vector<py::ssize_t>{count} : std::vector<py::ssize_t>{count, width});
  T* to = out.mutable_data();
  std::fill(to, to + count * width, nothing);
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i)
    for (py::ssize_t k = 0; k < width; ++k)
      to[py::ssize_t(prepared.cloud.source_index[i]) * width + k] = value(i, k);
  return out;
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

py::object normals(const CloudPtr& cloud, const Settings& settings, const py::object& progress) {
  PreparedCloud prepared;
  run([&](Progress& p) { prepared = prepare(*cloud, Attribute::normal, Attribute::normal, settings, p); },
      progress);
  return in_order<float>(*cloud, prepared, 3, nan,
                         [&](std::size_t i, py::ssize_t k) { return prepared.cloud.normals[i][int(k)]; });
}

py::object uncertainty(const CloudPtr& cloud, const Settings& settings, const py::object& progress) {
  PreparedCloud prepared;
  run(
      [&](Progress& p) {
        prepared =
            prepare(*cloud, Attribute::uncertainty, Attribute::uncertainty | Attribute::radius, settings, p);
      },
      progress);
  const ScalarField& field = *prepared.cloud.scalar("uncertainty");
  return in_order<float>(*cloud, prepared, 1, nan,
                         [&](std::size_t i, py::ssize_t) { return float(field.value(i)); });
}

double spacing(const CloudPtr& cloud, const py::object& progress) {
  double found = 0;
  run([&](Progress& p) { found = double(prepare(*cloud, {}, {}, {}, p).median_spacing); }, progress);
  return found;
}

/// What was given under a name; `to` stays where that is nothing or None.
template <class T>
void take(const py::dict& given, const char* name, T& to) {
  if (given.contains(name) && !given[name].is_none()) to = given[name].cast<T>();
}

py::object clusters(const CloudPtr& cloud, const py::dict& request, const py::object& progress) {
  analysis::ClusterOptions options;
  take(request, "neighbors", options.neighbors), take(request, "min_size", options.min_size);
  take(request, "point_threshold", options.point_threshold);
  take(request, "region_threshold", options.region_threshold);
  take(request, "gap", options.gap);
  take(request, "angle", options.angle_deg), take(request, "bend", options.bend_deg);
  if (options.neighbors < 1 || options.min_size < 1)
    throw Error(ErrorCode::usage, "neighbors and min_size are at least 1");
  PreparedCloud prepared;
  analysis::Clusters found;
  run(
      [&](Progress& p) {
        const bool colored = !cloud->scene.cloud.colors.empty();
        prepared = prepare(*cloud, colored ? Attributes() : Attributes(Attribute::normal), {}, {}, p);
        const analysis::NeighborGraph graph(prepared.cloud.positions, options.neighbors, p);
        found = analysis::grow_clusters(prepared.cloud, graph, prepared.median_spacing, options, p);
      },
      progress);
  return in_order<std::int32_t>(*cloud, prepared, 1, -1,
                                [&](std::size_t i, py::ssize_t) { return std::int32_t(found.label[i]); });
}

py::object shadow_factors(const CloudPtr& cloud, const Settings& settings, const py::object& progress) {
  RenderSettings shared;
  ParamList parameters;
  shared.describe(parameters);
  set_all(parameters, settings, "light and shadows have no parameter");
  std::vector<float> factors;
  run_gl([&](gl::Context& context,
             Progress& p) { factors = sfumato::shadow_factors(context, cloud->scene.cloud, shared, p); },
         progress);
  return py::array_t<float>(py::ssize_t(factors.size()), factors.data());
}

py::object distances(const CloudPtr& cloud, const CloudPtr& to, std::optional<double> scale,
                     const py::object& progress) {
  if (scale && !(*scale > 0)) throw Error(ErrorCode::usage, "scale: it is not more than 0");
  std::vector<float> found;
  run(
      [&](Progress& p) {
        const PointCloud &points = cloud->scene.cloud, &others = to->scene.cloud;
        found = scale ? analysis::signed_distances(points, others, *scale, p)
                      : analysis::nearest_distances(points, others, p);
      },
      progress);
  return py::array_t<float>(py::ssize_t(found.size()), found.data());
}

}  // namespace

void bind_analysis(py::module_& module) {
  module.def("normals", &normals);
  module.def("uncertainty", &uncertainty);
  module.def("spacing", &spacing);
  module.def("clusters", &clusters);
  module.def("shadow_factors", &shadow_factors);
  module.def("distances", &distances);
}

}  // namespace sfumato::python
