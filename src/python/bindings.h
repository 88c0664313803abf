// What the parts of the module add to it, and what they share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "core/param.h"
#include "session/request.h"

namespace sfumato::python {

namespace py = pybind11;

void bind_camera(py::module_& module);
void bind_cloud(py::module_& module);
void bind_analysis(py::module_& module);
void bind_cloud_renderer(py::module_& module);
void bind_levels(py::module_& module);
void bind_looks(py::module_& module);
void bind_request(py::module_& module);

/// By its long name; errors name the keyword. Throws Error(usage) for texts that are none of its values.
void set_option(Request& request, const std::string& name, const std::string& text);

using Settings = std::vector<std::pair<std::string, std::string>>;

/// A value of a parameter, which outlives the parameter.
struct Setting {
  std::string name;
  ParamKind kind;
  bool can_be_auto;
  std::string text;
};
/// With what automatic values became.
std::vector<Setting> resolved(const ParamList& parameters);
/// As Python's own kind of value.
py::object value_of(const Setting& setting);
/// name, kind, default, choices, range, auto, unit, help, paper.
py::dict describe(const Param& param);
/// Throws Error(usage) that names the nearest of `names`.
[[noreturn]] void refuse_name(const std::string& what, const std::string& name,
                              const std::vector<std::string>& names);

/// Throws Error(usage) for a name that is none of theirs: "`whose` 'nme'; did you mean 'name'?".
void set_all(ParamList& parameters, const Settings& settings, const std::string& whose);
py::list describe_all(const ParamList& parameters);

/// A view of memory that `owner` keeps.
template <class T>
py::array view(T* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  return py::array(py::dtype::of<T>(), std::move(shape), data, owner);
}

}  // namespace sfumato::python
