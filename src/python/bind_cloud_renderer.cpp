#include <algorithm>
#include <memory>

#include "core/colormap.h"
#include "core/error.h"
#include "core/option_text.h"
#include "io/image_png.h"
#include "labels/contact_sheet.h"
#include "session/request.h"
#include "cloud_renderer.h"

namespace sfumato::python {
namespace {

/// Frees what it holds on the thread that it lives on.
struct RendererHandle {
  std::shared_ptr<CloudRenderer> renderer;
  explicit RendererHandle(std::shared_ptr<CloudRenderer> s) : renderer(std::move(s)) {}
  RendererHandle(const RendererHandle&) = delete;
  RendererHandle& operator=(const RendererHandle&) = delete;
  ~RendererHandle() { close(); }
  void close() {
    if (renderer) free_gl(std::move(renderer));
    renderer.reset();
  }
  CloudRenderer& get() const {
    if (!renderer) throw Error(ErrorCode::usage, "the renderer is closed");
    return *renderer;
  }
};

/// `preset_file` is for messages.
CloudRendererOptions options_of(const Request& request, const Settings& parameters,
                                const Settings& preset_parameters, const std::string& preset_file) {
  CloudRendererOptions options{request, parameters, {}};
  options.preset.parameters = preset_parameters, options.preset.file = preset_file;
  return options;
}

/// The cloud is what `opening` gave, and is handed over.
std::unique_ptr<RendererHandle> open(const std::shared_ptr<Cloud>& cloud, const Opening& opening,
                                     const Request& request, const Settings& parameters,
                                     const Settings& preset_parameters, const std::string& preset_file,
                                     const py::object& progress) {
  auto renderer =
      std::make_shared<CloudRenderer>(options_of(request, parameters, preset_parameters, preset_file));
  // Before the work: what is raised after it must free the renderer where its context is.
  auto handle = std::make_unique<RendererHandle>(renderer);
  run_gl(
      [&](gl::Context& context, Progress& reporter) {
        keep_gl(renderer);
        try {
          renderer->open(context, std::move(cloud->scene), opening.pose(), reporter);
        } catch (...) {
          renderer->clear();
          throw;
        }
      },
      progress);
  return handle;
}

py::dict dict_of(const std::vector<Setting>& settings) {
  py::dict out;
  for (const Setting& setting : settings) out[py::str(setting.name)] = value_of(setting);
  return out;
}

std::shared_ptr<RenderedPicture> render(const RendererHandle& self, const std::optional<Camera>& camera,
                                        const std::pair<int, int>& size,
                                        const std::optional<std::string>& technique,
                                        const Settings& parameters, const std::vector<std::string>& outputs,
                                        const std::optional<Camera>& light_from, bool panorama,
                                        const NamesAndValues& furniture, const py::object& progress) {
  PictureRequest request{camera,     size.first, size.second, technique, parameters,
                         light_from, panorama,   {},          {},        false};
  Request said;
  for (const auto& [name, value] : furniture)
    if (name == "print-scale")
      said.furniture.print_scale = parse_number(name, value);
    else if (name == "dpi")
      said.furniture.dpi = parse_number(name, value);
    else
      set_option(said, name, value);
  request.furniture = said.furniture;
  if (size.first < 1 || size.second < 1)
    throw Error(ErrorCode::usage, "size: give width and height in pixels, both at least 1");
  request.wants.color = false;
  for (const std::string& output : outputs) {
    if (output == "rgba")
      request.wants.color = true;
    else if (output == "linear")
      request.wants.color_linear = true;
    else if (output == "depth")
      request.wants.depth = true;
    else if (output == "normal")
      request.wants.normal = true;
    else if (output == "index")
      request.index = request.wants.depth = true;
    else
      refuse_name("there is no output", output, {"rgba", "linear", "depth", "normal", "index"});
  }
  self.get();
  // Another thread may close the renderer meanwhile.
  const std::shared_ptr<CloudRenderer> renderer = self.renderer;
  auto picture = std::make_shared<RenderedPicture>();
  run_gl([&](gl::Context&, Progress& reporter) { renderer->render(request, *picture, reporter); }, progress);
  return picture;
}

/// The image that `find` gives of a picture as an array of (height, width), or (height, width, channels);
/// None where it was not asked for.
template <class Number>
auto array_of(auto find) {
  return [find](const py::object& self) -> py::object {
    auto& image = find(self.cast<RenderedPicture&>());
    if (image.empty()) return py::none();
    std::vector<py::ssize_t> shape{image.height(), image.width()};
    if (constexpr auto channels = sizeof(*image.data()) / sizeof(Number); channels > 1)
      shape.push_back(py::ssize_t(channels));
    return view(reinterpret_cast<Number*>(image.data()), std::move(shape), self);
  };
}

/// Pictures of one size side by side, each below its label.
std::shared_ptr<RenderedPicture> sheet_of(const std::vector<std::shared_ptr<RenderedPicture>>& pictures,
                                          const std::vector<std::string>& labels) {
  std::vector<labels::Panel> panels;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Image<Rgba8>& image = pictures[i]->images.rgba8;
    if (image.empty())
      throw Error(ErrorCode::usage, "a picture has no rgba image; name it in outputs when rendering");
    if (image.width() != pictures[0]->images.rgba8.width() ||
        image.height() != pictures[0]->images.rgba8.height())
      throw Error(ErrorCode::usage, "the pictures of a contact sheet have one size");
    panels.push_back({labels[i], image});
  }
  auto sheet = std::make_shared<RenderedPicture>();
  sheet->images.rgba8 = labels::contact_sheet(panels, pictures[0]->background, pictures[0]->transparent);
  sheet->camera = pictures[0]->camera;
  sheet->transparent = pictures[0]->transparent;
  sheet->background = pictures[0]->background;
  sheet->color_by = pictures[0]->color_by;
  for (const std::string& label : labels) sheet->technique += (sheet->technique.empty() ? "" : ",") + label;
  return sheet;
}

/// What a legend says; None where colours explain themselves.
py::object legend_of(const RenderedPicture& picture) {
  const Coloring& coloring = picture.coloring;
  py::dict out;
  out["title"] = coloring.source;
  if (coloring.kind == ColorKind::scalar) {
    out["low"] = coloring.low, out["high"] = coloring.high;
    out["colormap"] = coloring.places.empty() ? coloring.colormap : coloring.ramp().text();
    return out;
  }
  if (coloring.swatches.empty()) return py::none();
  py::list rows;
  for (const Swatch& swatch : coloring.swatches)
    rows.append(py::make_tuple(swatch.label, py::make_tuple(swatch.color.r, swatch.color.g, swatch.color.b),
                               swatch.points));
  out["swatches"] = rows;
  return out;
}

py::dict describe(const TechniqueInfo& info) {
  const Look look(info);
  py::dict out;
  out["name"] = info.name;
  out["summary"] = info.summary;
  py::list own, shared;
  const auto& all = look.parameters.all();
  for (std::size_t i = 0; i < all.size(); ++i)
    (i < look.own_count ? own : shared).append(python::describe(all[i]));
  out["needs"] = names_of(look.technique->needs());
  out["parameters"] = own, out["shared_parameters"] = shared;
  return out;
}

}  // namespace

std::vector<Setting> resolved(const ParamList& parameters) {
  std::vector<Setting> settings;
  for (const Param& param : parameters.all())
    settings.push_back({param.name, param.kind, param.can_be_auto, param.resolved()});
  return settings;
}

py::object value_of(const Setting& setting) {
  const std::string& text = setting.text;
  const auto number = [](const std::string& word) { return py::float_(py::str(word)); };
  if (text == "auto" && setting.can_be_auto) return py::str(text);
  switch (setting.kind) {
    case ParamKind::boolean: return py::bool_(text == "true");
    case ParamKind::integer: return py::int_(py::str(text));
    case ParamKind::real: return number(text);
    case ParamKind::real_list:
    case ParamKind::vector3: {
      py::list values;
      for (std::size_t at = 0; !text.empty() && at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        values.append(number(text.substr(at, end - at)));
        at = end + 1;
      }
      return py::tuple(values);
    }
    default: return py::str(text);
  }
}

void set_all(ParamList& parameters, const Settings& settings, const std::string& whose) {
  std::vector<std::string> names;
  for (const Param& param : parameters.all()) names.push_back(param.name);
  for (const auto& [name, value] : settings) {
    Param* param = parameters.find(name);
    if (!param) refuse_name(whose, name, names);
    param->set(value);
  }
}

py::list describe_all(const ParamList& parameters) {
  py::list rows;
  for (const Param& param : parameters.all()) rows.append(describe(param));
  return rows;
}

py::dict describe(const Param& param) {
  py::dict out;
  out["name"] = param.name;
  out["kind"] = kind_name(param.kind);
  out["default"] = value_of({param.name, param.kind, param.can_be_auto, param.default_text});
  out["choices"] = py::tuple(py::cast(param.choices));
  out["range"] = param.min || param.max ? py::object(py::make_tuple(param.min, param.max)) : py::none();
  out["auto"] = param.can_be_auto;
  out["unit"] = param.unit_text, out["help"] = param.help_text, out["paper"] = param.paper_text;
  return out;
}

void refuse_name(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  const std::string near = nearest_word(name, names);
  std::string all;
  for (const std::string& each : names) all += (all.empty() ? "" : ", ") + each;
  throw Error(ErrorCode::usage, what + " '" + name + "'" +
                                    (!near.empty()        ? "; did you mean '" + near + "'?"
                                     : names.size() <= 12 ? "; there are: " + (all.empty() ? "none" : all)
                                                          : ""));
}

void bind_cloud_renderer(py::module_& module) {
  py::class_<RendererHandle>(module, "CloudRenderer")
      .def(py::init(&open))
      .def("render", &render)
      .def("set_color",
           [](const RendererHandle& self, const Request& request) {
             self.get();
             const std::shared_ptr<CloudRenderer> renderer = self.renderer;
             run_gl([&](gl::Context&, Progress&) { renderer->set_color(request.color); }, py::none());
           })
      .def("close", &RendererHandle::close)
      .def_property_readonly(
          "technique",
          [](const RendererHandle& self) { return self.get().choice().techniques.front()->name; })
      .def("__len__", [](const RendererHandle& self) { return self.get().points(); });

  py::class_<RenderedPicture, std::shared_ptr<RenderedPicture>>(module, "RenderedPicture")
      .def("rgba", array_of<std::uint8_t>([](RenderedPicture & p) -> auto& { return p.images.rgba8; }))
      .def("linear", array_of<float>([](RenderedPicture & p) -> auto& { return p.images.color_linear; }))
      .def("depth", array_of<float>([](RenderedPicture & p) -> auto& { return p.images.depth; }))
      .def("index", array_of<std::int64_t>([](RenderedPicture & p) -> auto& { return p.index; }))
      .def("normal", array_of<float>([](RenderedPicture & p) -> auto& { return p.images.normal; }))
      .def("save", &save)
      .def_readonly("camera", &RenderedPicture::camera)
      .def_readonly("transparent", &RenderedPicture::transparent)
      .def_readonly("technique", &RenderedPicture::technique)
      .def_readonly("reason", &RenderedPicture::reason)
      .def_property_readonly("parameters", [](const RenderedPicture& s) { return dict_of(s.parameters); })
      .def_property_readonly("analysis_parameters",
                             [](const RenderedPicture& s) { return dict_of(s.analysis_parameters); })
      .def_readonly("color_by", &RenderedPicture::color_by)
      .def_property_readonly("legend", &legend_of)
      .def_readonly("notes", &RenderedPicture::notes)
      .def_property_readonly("background",
                             [](const RenderedPicture& s) {
                               return py::make_tuple(s.background.x, s.background.y, s.background.z);
                             })
      .def_property_readonly("points_drawn", [](const RenderedPicture& s) { return s.images.points_drawn; });

  module.def("techniques", [] {
    py::list rows;
    for (const TechniqueInfo& info : all_techniques()) rows.append(describe(info));
    return rows;
  });
  module.def("find_technique", [](const std::string& name) { return find_technique(name).name; });
  module.def("analysis_parameters", [] {
    analysis::PrepareOptions options;
    ParamList parameters;
    options.describe(parameters);
    return describe_all(parameters);
  });
  module.def("colormap_names", &Colormap::names);
  module.def("colormap", [](const std::string& name, int count) {
    const Colormap map = Colormap::named(name);
    py::array_t<std::uint8_t> out({py::ssize_t(count), py::ssize_t(3)});
    std::uint8_t* to = out.mutable_data();
    for (int i = 0; i < count; ++i, to += 3) {
      const Rgba8 color = map.at(count > 1 ? double(i) / (count - 1) : 0.5);
      to[0] = color.r, to[1] = color.g, to[2] = color.b;
    }
    return out;
  });
  module.def("contact_sheet", &sheet_of);
  // Asked before anything is read.
  module.def("has_shadows", [](const Request& request, const Settings& parameters,
                               const Settings& preset_parameters, const std::string& preset_file,
                               const Settings& on_top) {
    return CloudRenderer(options_of(request, parameters, preset_parameters, preset_file)).has_shadows(on_top);
  });
  module.def("nearest_word", [](const std::string& word, const std::vector<std::string>& candidates) {
    return nearest_word(word, candidates);
  });
  module.def("write_png",
             [](const std::string& file, const py::array_t<std::uint8_t, py::array::c_style>& rgba) {
               Image<Rgba8> out(int(rgba.shape(1)), int(rgba.shape(0)));
               std::copy(rgba.data(), rgba.data() + rgba.size(), &out.data()->r);
               io::write_png(file, out, true);
             });
}

}  // namespace sfumato::python
