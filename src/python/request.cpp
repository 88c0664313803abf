// What keywords ask for, through the table of options.
#include "session/request.h"

#include <algorithm>

#include "bindings.h"
#include "core/error.h"
#include "core/option_text.h"

namespace sfumato::python {
namespace {

/// A message of the command, with keywords in place of its options.
std::string in_keywords(const std::string& message) {
  std::string text;
  std::size_t at = 0;
  for (std::size_t dashes; (dashes = message.find("--", at)) != std::string::npos;) {
    const std::size_t end =
        std::min(message.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", dashes), message.size());
    const Option* option = find_option(message.substr(dashes + 2, end - dashes - 2));
    text += message.substr(at, dashes - at);
    text += option && !option->keyword.empty() ? option->keyword : message.substr(dashes, end - dashes);
    at = end;
  }
  return text + message.substr(at);
}

/// Options as the command names them, with their texts; `start` is the camera that a view begins from.
Request request_of(const Settings& options, const std::optional<Camera>& start) {
  Request request;
  for (const auto& [name, text] : options) set_option(request, name, text);
  request.view.start = start;
  try {
    resolve_view(request);
    check_camera(request, "the camera");
    check_color(request);
    (void)request.scene_options();
  } catch (const Error& error) {
    throw Error(error.code(), in_keywords(error.what()));
  }
  return request;
}

/// What a picture of this print scale says of it; nothing without one.
Settings paper_of(const Request& request) {
  if (!request.view.print_scale) return {};
  return {{"print-scale", number_text(*request.view.print_scale)}, {"dpi", number_text(request.dpi())}};
}

}  // namespace

void set_option(Request& request, const std::string& name, const std::string& text) {
  const Option* option = find_option(name);
  if (!option) throw Error(ErrorCode::usage, "there is no option '" + name + "'");
  option->set(request, option->keyword, text);
}

void bind_request(py::module_& module) {
  py::class_<Request>(module, "Request")
      .def(py::init(&request_of), py::arg("options"), py::arg("start") = py::none())
      .def_property_readonly("paper", &paper_of);
}

}  // namespace sfumato::python
