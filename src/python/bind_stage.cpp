#include <algorithm>
#include <memory>

#include "core/color.h"
#include "core/colormap.h"
#include "core/error.h"
#include "core/option_text.h"
#include "io/image_png.h"
#include "labels/contact_sheet.h"
#include "session/request.h"
#include "stage.h"

namespace sfumato::python {
namespace {

/// Frees what it holds on the thread that it lives on.
struct StageHandle {
  std::shared_ptr<Stage> stage;
  explicit StageHandle(std::shared_ptr<Stage> s) : stage(std::move(s)) {}
  StageHandle(const StageHandle&) = delete;
  StageHandle& operator=(const StageHandle&) = delete;
  ~StageHandle() { close(); }
  void close() {
    if (stage) free_gl(std::move(stage));
    stage.reset();
  }
  Stage& get() const {
    if (!stage) throw Error(ErrorCode::usage, "the renderer is closed");
    return *stage;
  }
};

ColorSettings colors_of(const py::dict& wishes) {
  ColorSettings color;
  std::optional<std::string> colormap, class_colors, name;
  take(wishes, "color_by", color.color_by), take(wishes, "colormap", colormap);
  if (colormap) Colormap::named(color.colormap = *colormap);
  take(wishes, "range", color.range);
  if (color.range && color.range->at(0) == color.range->at(1))
    throw Error(ErrorCode::usage, "range: it is empty");
  take(wishes, "class_colors", class_colors);
  if (class_colors) {
    Request request;
    find_option("class-colors")->set(request, "class_colors", *class_colors);
    color.class_colors = request.color.class_colors;
  }
  take(wishes, "exposure", color.exposure);
  if (color.exposure && !(*color.exposure >= 0.1 && *color.exposure <= 100))
    throw Error(ErrorCode::usage, "exposure: it is outside [0.1, 100]");
  take(wishes, "color", name);
  if (name) {
    if (color.color_by != "auto")
      throw Error(ErrorCode::usage, "color and color_by contradict each other: give one of them");
    if (!color.colormap.empty() || color.range)
      throw Error(ErrorCode::usage, "colormap and range do not go with one colour for all points");
    color.solid = to_rgba8(parse_color_of("color", *name));
  }
  return color;
}

StageOptions options_of(const std::string& technique, const Settings& parameters, const py::dict& wishes) {
  StageOptions options;
  options.technique = technique;
  options.parameters = parameters;
  options.color = colors_of(wishes);
  take(wishes, "preset_parameters", options.preset.parameters);
  take(wishes, "preset_file", options.preset.file);
  std::string background = "auto";
  take(wishes, "background", background);
  if (background == "transparent")
    options.transparent = true;
  else if (background != "auto")
    options.background = parse_color_of("background", background);
  std::vector<std::string> rules;
  take(wishes, "draw", rules);
  for (const std::string& rule : rules) options.draw.push_back(DrawRule::parse(rule));
  return options;
}

/// The cloud is what `opening` gave, and is handed over.
std::unique_ptr<StageHandle> open(const std::shared_ptr<Cloud>& cloud, const Opening& opening,
                                  const std::string& technique, const Settings& parameters,
                                  const py::dict& wishes, const py::object& progress) {
  auto stage = std::make_shared<Stage>(options_of(technique, parameters, wishes));
  // Before the work: what is raised after it must free the stage where its context is.
  auto handle = std::make_unique<StageHandle>(stage);
  run_gl(
      [&](gl::Context& context, Progress& reporter) {
        keep_gl(stage);
        try {
          stage->open(context, std::move(cloud->scene), opening.pose(), reporter);
        } catch (...) {
          stage->clear();
          throw;
        }
      },
      progress);
  return handle;
}

}  // namespace

ViewWishes view_wishes(const py::dict& wishes) {
  ViewWishes out;
  const auto take = [&](const char* key, auto& to) { python::take(wishes, key, to); };
  take("azimuth", out.azimuth), take("elevation", out.elevation), take("fov", out.fov);
  take("distance", out.distance), take("pixel_size", out.pixel_size), take("scale", out.print_scale);
  take("dpi", out.dpi), take("start", out.start), take("zoom", out.zoom), take("roll", out.roll);
  take("orthographic", out.orthographic), take("side", out.side), take("size", out.size);
  for (const auto& [key, value] :
       {std::pair("pixel_size", out.pixel_size), {"scale", out.print_scale}, {"dpi", out.dpi}})
    if (value && !(*value > 0)) throw Error(ErrorCode::usage, std::string(key) + ": it is not more than 0");
  if (out.pixel_size && out.print_scale)
    throw Error(ErrorCode::usage, "pixel_size and scale contradict each other: give one of them");
  if (out.elevation && std::abs(*out.elevation) > 90)
    throw Error(ErrorCode::usage, "elevation: it is outside [-90, 90] degrees");
  if (out.fov && !(*out.fov >= 0.001 && *out.fov <= 179))
    throw Error(ErrorCode::usage, "fov: it is outside [0.001, 179] degrees");
  if (out.distance && !(*out.distance > 0)) throw Error(ErrorCode::usage, "distance: it is not more than 0");
  const auto triple = [&](const char* key, std::optional<dvec3>& to) {
    std::optional<std::array<double, 3>> v;
    take(key, v);
    if (!v) return;
    to = dvec3(v->at(0), v->at(1), v->at(2));
    if (!(glm::length(*to) <= 2e15))
      throw Error(ErrorCode::usage, std::string(key) + ": it is beyond 1e15, where no point can be seen");
  };
  triple("position", out.position), triple("look_at", out.look_at), triple("direction", out.direction),
      triple("view_up", out.view_up);
  for (const auto& [name, value] : {std::pair("direction", out.direction), {"view_up", out.view_up}})
    if (value && glm::length(*value) <= 0)
      throw Error(ErrorCode::usage, std::string(name) + ": 0, 0, 0 is no direction");
  if (out.position && out.look_at && out.direction)
    throw Error(ErrorCode::usage,
                "direction and position with look_at contradict each other: give two of them");
  for (const auto& [name, given] :
       {std::pair("position", out.position.has_value()), {"direction", out.direction.has_value()}})
    if (given && (out.azimuth || out.elevation))
      throw Error(ErrorCode::usage,
                  std::string(name) + " and azimuth or elevation contradict each other: give one of them");
  if (out.position && out.distance)
    throw Error(ErrorCode::usage, "position and distance contradict each other: give one of them");
  if (out.zoom && !(*out.zoom > 0)) throw Error(ErrorCode::usage, "zoom: it is not more than 0");
  if (out.size && (out.size->first < 1 || out.size->second < 1))
    throw Error(ErrorCode::usage, "size: give width and height in pixels, both at least 1");
  if (out.start && out.start->custom_intrinsics && (out.size || out.fov || out.orthographic))
    throw Error(ErrorCode::usage,
                "size, fov and orthographic do not go with the intrinsics of a camera: they hold for its own "
                "width and height");
  return out;
}

namespace {

py::dict dict_of(const std::vector<Setting>& settings) {
  py::dict out;
  for (const Setting& setting : settings) out[py::str(setting.name)] = value_of(setting);
  return out;
}

std::shared_ptr<Shot> render(const StageHandle& self, const std::optional<Camera>& camera,
                             const std::pair<int, int>& size, const std::optional<std::string>& technique,
                             const Settings& parameters, const std::vector<std::string>& outputs,
                             const std::optional<Camera>& light_from, bool panorama,
                             const NamesAndValues& furniture, const py::object& progress) {
  ShotRequest request{camera,     size.first, size.second, technique, parameters,
                      light_from, panorama,   {},          {},        false};
  Request said;
  for (const auto& [name, value] : furniture)
    if (name == "print-scale")
      said.furniture.print_scale = parse_number(name, value);
    else if (name == "dpi")
      said.furniture.dpi = parse_number(name, value);
    else
      find_option(name)->set(said, name, value);
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
  const std::shared_ptr<Stage> stage = self.stage;
  auto shot = std::make_shared<Shot>();
  run_gl([&](gl::Context&, Progress& reporter) { stage->render(request, *shot, reporter); }, progress);
  return shot;
}

template <class T>
py::object image(Image<T>& values, std::vector<py::ssize_t> shape, auto* first, const py::object& owner) {
  if (values.empty()) return py::none();
  return view(first, std::move(shape), owner);
}

/// Pictures of one size side by side, each below its label.
std::shared_ptr<Shot> sheet_of(const std::vector<std::shared_ptr<Shot>>& shots,
                               const std::vector<std::string>& labels) {
  std::vector<labels::Panel> panels;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Image<Rgba8>& image = shots[i]->images.rgba8;
    if (image.empty())
      throw Error(ErrorCode::usage, "a picture has no rgba image; name it in outputs when rendering");
    if (image.width() != shots[0]->images.rgba8.width() || image.height() != shots[0]->images.rgba8.height())
      throw Error(ErrorCode::usage, "the pictures of a contact sheet have one size");
    panels.push_back({labels[i], image});
  }
  auto sheet = std::make_shared<Shot>();
  sheet->images.rgba8 = labels::contact_sheet(panels, shots[0]->background, shots[0]->transparent);
  sheet->camera = shots[0]->camera;
  sheet->transparent = shots[0]->transparent;
  sheet->background = shots[0]->background;
  sheet->color_by = shots[0]->color_by;
  for (const std::string& label : labels) sheet->technique += (sheet->technique.empty() ? "" : ",") + label;
  return sheet;
}

/// What a legend says; None where colours explain themselves.
py::object legend_of(const Shot& shot) {
  const Coloring& coloring = shot.coloring;
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
  py::list needs, own, shared;
  const Attributes attributes = look.technique->needs();
  if (attributes.has(Attribute::normal)) needs.append("normal");
  if (attributes.has(Attribute::radius)) needs.append("radius");
  if (attributes.has(Attribute::uncertainty)) needs.append("uncertainty");
  if (attributes.has(Attribute::cluster)) needs.append("cluster");
  const auto& all = look.parameters.all();
  for (std::size_t i = 0; i < all.size(); ++i)
    (i < look.own_count ? own : shared).append(python::describe(all[i]));
  out["needs"] = needs, out["parameters"] = own, out["shared_parameters"] = shared;
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

void bind_stage(py::module_& module) {
  py::class_<StageHandle>(module, "Stage")
      .def(py::init(&open))
      .def("render", &render)
      .def("set_color",
           [](const StageHandle& self, const py::dict& wishes) {
             const ColorSettings color = colors_of(wishes);
             self.get();
             const std::shared_ptr<Stage> stage = self.stage;
             run_gl([&](gl::Context&, Progress&) { stage->set_color(color); }, py::none());
           })
      .def("close", &StageHandle::close)
      .def_property_readonly(
          "technique", [](const StageHandle& self) { return self.get().choice().techniques.front()->name; })
      .def("__len__", [](const StageHandle& self) { return self.get().points(); });

  py::class_<Shot, std::shared_ptr<Shot>>(module, "Shot")
      .def("rgba",
           [](const py::object& self) {
             auto& i = self.cast<Shot&>().images.rgba8;
             return image(i, {i.height(), i.width(), 4}, &i.data()->r, self);
           })
      .def("linear",
           [](const py::object& self) {
             auto& i = self.cast<Shot&>().images.color_linear;
             return image(i, {i.height(), i.width(), 4}, &i.data()->x, self);
           })
      .def("depth",
           [](const py::object& self) {
             auto& i = self.cast<Shot&>().images.depth;
             return image(i, {i.height(), i.width()}, i.data(), self);
           })
      .def("index",
           [](const py::object& self) {
             auto& i = self.cast<Shot&>().index;
             return image(i, {i.height(), i.width()}, i.data(), self);
           })
      .def("normal",
           [](const py::object& self) {
             auto& i = self.cast<Shot&>().images.normal;
             return image(i, {i.height(), i.width(), 3}, &i.data()->x, self);
           })
      .def("save", &save)
      .def_readonly("camera", &Shot::camera)
      .def_readonly("transparent", &Shot::transparent)
      .def_readonly("technique", &Shot::technique)
      .def_readonly("reason", &Shot::reason)
      .def_property_readonly("parameters", [](const Shot& s) { return dict_of(s.parameters); })
      .def_property_readonly("analysis_parameters",
                             [](const Shot& s) { return dict_of(s.analysis_parameters); })
      .def_readonly("color_by", &Shot::color_by)
      .def_property_readonly("legend", &legend_of)
      .def_readonly("notes", &Shot::notes)
      .def_property_readonly(
          "background",
          [](const Shot& s) { return py::make_tuple(s.background.x, s.background.y, s.background.z); })
      .def_property_readonly("points_drawn", [](const Shot& s) { return s.images.points_drawn; });

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
  module.def("has_shadows", [](const std::string& technique, const Settings& parameters,
                               const py::dict& wishes, const Settings& on_top) {
    return Stage(options_of(technique, parameters, wishes)).has_shadows(on_top);
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
