// The module sfumato._engine: what the package in src/python/sfumato is written on.
#include <cstring>
#include <filesystem>
#include <new>

#include "bindings.h"
#include "core/error.h"
#include "core/version.h"
#include "run.h"

namespace sfumato::python {
namespace {

const char* word_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage: return "usage";
    case ErrorCode::bad_input: return "bad_input";
    case ErrorCode::partial: return "partial";
    case ErrorCode::no_gl: return "no_gl";
    case ErrorCode::out_of_memory: return "out_of_memory";
    case ErrorCode::io: return "io";
    case ErrorCode::internal: return "internal";
    case ErrorCode::interrupted: return "interrupted";
  }
  return "usage";
}

void raise(ErrorCode code, const char* what) {
  const py::object type = py::module_::import("sfumato._error").attr("Error");
  // Names of files may be in any encoding.
  const py::object text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(what, py::ssize_t(std::strlen(what)), "replace"));
  const py::object error = type(text, word_of(code));
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const Error& error) {
    raise(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    raise(ErrorCode::out_of_memory,
          "out of memory; rendering takes less with fewer points (max_points of read)");
  } catch (const std::filesystem::filesystem_error& error) {
    raise(ErrorCode::io, error.what());
  }
}

}  // namespace
}  // namespace sfumato::python

PYBIND11_MODULE(_engine, module) {
  using namespace sfumato::python;
  pybind11::register_exception_translator(translate);
  bind_camera(module);
  bind_request(module);
  bind_cloud(module);
  bind_analysis(module);
  bind_cloud_renderer(module);
  bind_levels(module);
  bind_looks(module);
  module.def("version", &sfumato::version);
  module.def("stop", &stop_gl);
}
