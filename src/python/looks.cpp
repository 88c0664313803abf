// Presets and scenes as files.
#include <optional>

#include "bindings.h"
#include "cloud.h"
#include "core/error.h"
#include "core/param.h"
#include "session/choice.h"
#include "session/preset.h"
#include "session/request.h"

namespace sfumato::python {
namespace {

py::list list_of(const NamesAndValues& values) {
  py::list rows;
  for (const auto& [name, value] : values) rows.append(py::make_tuple(name, value));
  return rows;
}

py::dict load(const std::string& file) {
  const Preset preset = load_preset(file);
  py::dict out;
  out["technique"] = preset.technique;
  out["options"] = list_of(preset.options);
  out["parameters"] = list_of(preset.parameters);
  out["camera"] = preset.camera;
  py::list files;
  for (const scene::SceneFile& each : preset.files) {
    files.append(py::make_tuple(
        each.name, each.transform ? py::object(py::cast(rows_of(*each.transform))) : py::none()));
  }
  out["files"] = files;
  return out;
}

/// `given`: options as the command spells them; `files`: names and 16 numbers or None.
void save(const std::string& file, const std::string& technique, const Settings& parameters,
          const NamesAndValues& given, const std::optional<Camera>& camera, const py::list& files) {
  Choice choice(technique);
  for (const auto& [name, value] : parameters) {
    const std::size_t dot = name.find('.');
    for (const auto& look : choice.techniques)
      if (dot == std::string::npos || name.substr(0, dot) == look->name)
        if (Param* param = look->parameters.find(name.substr(dot == std::string::npos ? 0 : dot + 1)))
          param->set(value);
    if (Param* param = choice.prepare_parameters.find(name)) param->set(value);
  }
  std::vector<scene::SceneFile> placed;
  for (const py::handle& each : files) {
    const auto pair = each.cast<py::tuple>();
    placed.push_back({pair[0].cast<std::string>(), {}});
    if (!pair[1].is_none()) placed.back().transform = transform_of(pair[1].cast<std::vector<double>>());
  }
  const py::gil_scoped_release release;
  save_preset(file, choice.looks(), choice.prepare_parameters, given, camera, placed, choice.automatic());
}

/// Name, keyword, kind of value, and of what the options are that presets keep.
py::list options() {
  using Scope = Option::Scope;
  py::list rows;
  for (const Option& option : request_options()) {
    const bool is_view = option.scope == Scope::view || option.scope == Scope::camera;
    if (option.scope != Scope::command)
      rows.append(py::make_tuple(option.name(), option.keyword, option.value,
                                 is_view                       ? "view"
                                 : option.scope == Scope::file ? "file"
                                                               : "look"));
  }
  return rows;
}

/// As the table of options writes what it reads there, so that every front end takes the same for the same;
/// nothing where that is as by default.
std::optional<std::string> option_text(const std::string& where, const std::string& name,
                                       const std::string& text) {
  const Option& option = *find_option(name);
  Request request;
  try {
    option.set(request, where, text);
  } catch (const Error& error) {
    const std::string says = error.what();
    throw Error(ErrorCode::bad_input, says.starts_with(where) ? says : where + ": " + says);
  }
  const std::vector<std::string> texts = option.texts(request);
  return texts.empty() ? std::nullopt : std::optional(texts.front());
}

}  // namespace

void bind_looks(py::module_& module) {
  module.def("options", &options);
  module.def("load_preset", &load);
  module.def("option_text", &option_text);
  module.def("save_preset", &save);
  module.def("parse_count", &parse_count);
}

}  // namespace sfumato::python
