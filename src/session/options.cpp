// The one table of what a picture can be asked for.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

#include "core/color.h"
#include "core/colormap.h"
#include "core/error.h"
#include "core/option_text.h"
#include "session/choice.h"
#include "session/request.h"

namespace sfumato {
namespace {

using Text = const std::string&;
using Texts = std::vector<std::string>;
using Scope = Option::Scope;

constexpr std::pair<const char*, Corner> corners[] = {{"bottom-right", Corner::bottom_right},
                                                      {"bottom-left", Corner::bottom_left},
                                                      {"top-right", Corner::top_right},
                                                      {"top-left", Corner::top_left}};

/// Values as `set` takes them.
std::string said(const std::string& text) { return text; }
std::string said(bool on) { return on ? "true" : "false"; }
std::string said(double value) { return number_text(value); }
template <std::integral T>
std::string said(T value) {
  return std::to_string(value);
}
std::string said(const dvec3& v) {
  return number_text(v.x) + "," + number_text(v.y) + "," + number_text(v.z);
}
std::string said(const Bounds& box) { return said(box.min) + "," + said(box.max); }
std::string said(const std::array<double, 2>& range) {
  return number_text(range[0]) + "," + number_text(range[1]);
}
std::string said(const std::pair<int, int>& size) {
  return std::to_string(size.first) + "x" + std::to_string(size.second);
}
std::string said(const Rgba8& color) { return hex_of(color); }
std::string said(const vec3& color) {
  const std::string hex = said(to_rgba8(color));
  return parse_color(hex) == color
             ? hex
             : number_text(color.x) + "," + number_text(color.y) + "," + number_text(color.z);
}
std::string said(const std::map<int, Rgba8>& colors) {
  std::string text;
  for (const auto& [id, color] : colors)
    text += (text.empty() ? "" : ",") + std::to_string(id) + "=" + said(color);
  return text;
}
std::string said(const std::vector<int>& classes) { return classes_text(classes); }
std::string said(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}
std::string said(UpAxis up) { return to_string(up); }
std::string said(const DrawRule& rule) { return rule.text; }
std::string said(const Filter& filter) {
  const auto end = [](double value) { return std::isfinite(value) ? number_text(value) : ""; };
  return filter.scalar + " " + end(filter.low) + ".." + end(filter.high);
}
std::string said(const LengthUnit& unit) {
  if (!(unit.metres > 0)) return "";
  return unit_named(unit.symbol) == unit ? unit.symbol : number_text(unit.metres);
}
std::string said(Corner corner) {
  for (const auto& [name, each] : corners)
    if (each == corner) return name;
  return "";
}
template <class T>
std::string said(const std::optional<T>& value) {
  return value ? said(*value) : "";
}

struct Say {
  template <class T>
  std::string operator()(const T& value) const {
    return said(value);
  }
};

class Table {
 public:
  std::vector<Option> rows;

  /// Heading of the options that follow, and what most of them are.
  void group(const std::string& title, Scope scope) { title_ = title, scope_ = scope; }

  /// `member` gives the value of a request; `parse` reads it of option and text, and `say` writes it.
  template <class Member, class Parse, class Write = Say>
  Table& value(const std::string& names, const std::string& metavar, const std::string& help, Member member,
               Parse parse, Write say = {}) {
    Option row{names, metavar, help, title_, Option::Kind::text, scope_, false, "", "", {}, {}, {}};
    row.set = [=](Request& r, Text option, Text text) { std::invoke(member, r) = parse(option, text); };
    row.reset = [=](Request& r) { std::invoke(member, r) = std::invoke(member, plain()); };
    row.texts = [=](const Request& r) {
      const auto& now = std::invoke(member, r);
      return now == std::invoke(member, plain()) ? Texts() : Texts{say(now)};
    };
    rows.push_back(std::move(row));
    return *this;
  }
  template <class Member>
  Table& text(const std::string& names, const std::string& metavar, const std::string& help, Member member) {
    return value(names, metavar, help, member, [](Text, Text text) { return text; });
  }
  template <class Member>
  Table& flag(const std::string& names, const std::string& help, Member member) {
    value(names, "", help, member, [](Text option, Text text) { return parse_flag(option, text); });
    rows.back().kind = Option::Kind::flag;
    return python("flag");
  }
  /// `member` is a list; `parse` reads one of it.
  template <class Member, class Parse>
  Table& texts(const std::string& names, const std::string& metavar, const std::string& help, Member member,
               Parse parse) {
    using List = std::decay_t<std::invoke_result_t<Member, Request&>>;
    const auto no_list = [](Text, Text) { return List(); };
    value(names, metavar, help, member, no_list, [](const List&) { return std::string(); });
    rows.back().kind = Option::Kind::texts;
    rows.back().set = [=](Request& r, Text, Text text) { std::invoke(member, r).push_back(parse(text)); };
    rows.back().texts = [=](const Request& r) {
      Texts all;
      for (const auto& each : std::invoke(member, r)) all.push_back(said(each));
      return all;
    };
    return python("texts");
  }
  /// No text is the default.
  Table& or_nothing() {
    rows.back().set = [set = rows.back().set, reset = rows.back().reset](Request& r, Text option, Text text) {
      text.empty() ? reset(r) : set(r, option, text);
    };
    return *this;
  }
  Table& is(Scope scope) {
    rows.back().scope = scope;
    return *this;
  }
  Table& served() {
    rows.back().served = true;
    return *this;
  }
  /// Its kind of value there, and its keyword where that is not the option's name.
  Table& python(const std::string& value, std::string keyword = {}) {
    if (keyword.empty())
      std::replace_copy(rows.back().names.begin() + long(rows.back().names.find("--")) + 2,
                        rows.back().names.end(), std::back_inserter(keyword), '-', '_');
    rows.back().value = value, rows.back().keyword = keyword;
    return *this;
  }

 private:
  static const Request& plain() {
    static const Request request;
    return request;
  }

  std::string title_;
  Scope scope_ = Scope::command;
};

/// A member of a member.
template <class Outer, class T>
auto in(Outer Request::*outer, T Outer::*inner) {
  return [=](auto& r) -> auto& { return (r.*outer).*inner; };
}

std::string same(Text text) { return text; }

double number(Text option, Text text) { return parse_number(option, text); }
template <class T>
auto count_up_to(long most) {
  return [=](Text option, Text text) { return T(std::min(parse_whole(option, text, 1), most)); };
}
const auto count = count_up_to<std::uint64_t>(std::numeric_limits<long>::max());
auto within(double low, double high) {
  return [=](Text option, Text text) {
    const double value = parse_number(option, text);
    if (!(value >= low && value <= high))
      throw Error(ErrorCode::usage,
                  option + ": '" + text + "' is not in " + number_text(low) + ".." + number_text(high));
    return value;
  };
}

/// The text, or what is in the file of that name.
std::string text_or_file(Text text) {
  std::ifstream file(text);
  if (!file) return text;
  return {std::istreambuf_iterator<char>(file), {}};
}

void add_output(Table& t) {
  t.group("Output", Scope::command);
  t.text(
       "-t,--technique", "NAME[,NAME...]|all",
       "technique (" + default_technique() + ": what suits the scan); several give a labelled contact sheet",
       &Request::technique)
      .python("text")
      .served();
  t.texts("--draw", "\"SELECTION: TECHNIQUE [name=value ...]\"",
          "draw selected points by another technique, such as \"classification 3-5: soft opacity=0.2\"; "
          "the first that selects a point wins (sfumato help draw)",
          &Request::draw, [](Text text) { return DrawRule::parse(text); })
      .is(Scope::look)
      .served();
  t.text("-o,--output", "FILE",
         "the picture: .png .jpg .webp (sRGB), .tif (sRGB; a plan is a GeoTIFF, transparent where nothing "
         "is), .exr (linear, Z, normals), .npy (linear RGBA); - is standard output",
         &Request::output);
  t.flag("--world-file", "the georeference of a plan beside its picture, as NAME.pgw", &Request::world_file)
      .is(Scope::file);
  t.flag("--each", "one picture per file, -o '{stem}.png'; a bad file does not stop the others",
         &Request::each);
  t.text("--output-panels", "NAME_{technique}.png", "the panels of a contact sheet as single pictures too",
         &Request::output_panels);
  t.text("--output-depth", "FILE",
         "depth along the view axis: .npy or .exr (float32, inf where nothing), .png (16 bit)",
         &Request::output_depth);
  t.value("--depth-unit", "m|cm|mm|in|ft|METRES",
          "unit of one step of a depth .png (default: its range in 65535 steps); larger depths are 65535",
          &Request::depth_unit, [](Text option, Text text) {
            const LengthUnit unit = unit_named(text);
            if (unit.metres > 0 || text.empty()) return unit;
            return LengthUnit{text + " m", parse_positive(option, text)};
          });
  t.text("--output-index", "FILE.npy",
         "int64 HxW: index of the visible input point, counted from 0 over all files; -1 where there is none",
         &Request::output_index);
  t.text("--output-normal", "FILE.npy", "float32 HxWx3, world, facing the camera, 0 where none",
         &Request::output_normal);
  t.text("--output-camera", "FILE.json", "the camera of the picture", &Request::output_camera);
  t.value("--quality", "1..100", "quality of .jpg and .webp; 100 makes .webp lossless (90)",
          &Request::quality,
          [](Text option, Text text) {
            const long quality = parse_whole(option, text, 1);
            if (quality > 100) throw Error(ErrorCode::usage, option + ": '" + text + "' is not in 1..100");
            return int(quality);
          })
      .or_nothing()
      .is(Scope::file);
  t.text("--path", "FILE|orbit",
         "camera path: one picture a frame, -o frame_{n:04}.png, or a video, -o NAME.mp4 (by ffmpeg); poses "
         "of transforms.json, COLMAP (images.txt or .bin), TUM, KITTI and Open3D are pictures of their own",
         &Request::path);
  t.value("--frames", "N", "pictures of the path (120, or one each pose)", &Request::frames,
          count_up_to<int>(1'000'000));
  t.value("--degrees", "D", "arc of the orbit (360)", &Request::degrees, number);
  t.flag("--sequence",
         "files are frames: one picture each, from the camera of the first, with one colour range for all, "
         "-o frame_{n:04}.png",
         &Request::sequence);
  t.text("--preset", "FILE.json", "options and parameters saved before; options on the command line win",
         &Request::preset);
  t.text("--save-preset", "FILE.json", "save the options that reproduce this picture", &Request::save_preset);
  t.text("--scene", "FILE.json",
         "files, --draw, look and camera saved before; options on the command line win", &Request::scene);
  t.text("--save-scene", "FILE.json", "as --save-preset, with the files", &Request::save_scene);
  t.texts("--transform", "\"N: 16 NUMBERS\"",
          "4x4 matrix that maps the N-th file to world coordinates, row by row, with commas",
          &Request::transforms, same);
  t.flag("--watch", "the window reads files again when they change", &Request::watch).is(Scope::file);
  t.text("--shader-dir", "FOLDER",
         "a checkout whose shaders are used in place of those built in; the window compiles them again "
         "when they change",
         &Request::shader_folder);
  t.flag("--timings", "time of every pass", &Request::timings);
  t.flag("--json", "report on standard output", &Request::json);
}

void add_view(Table& t) {
  const auto vector = parse_vector;
  const auto positive = parse_positive;
  const auto of_view = [](auto CameraRequest::*member) { return in(&Request::view, member); };
  const auto direction = [](Text option, Text text) {
    const dvec3 v = parse_vector(option, text);
    if (glm::length(v) <= 0) throw Error(ErrorCode::usage, option + ": 0,0,0 is no direction");
    return v;
  };
  const auto degrees_in = [](double low, double high) {
    return [=](Text option, Text text) { return parse_degrees(option, text, low, high); };
  };
  t.group("View", Scope::camera);
  t.value("--resolution", "WxH", "picture size in pixels (1280x720)", of_view(&CameraRequest::size),
          [](Text option, Text text) { return parse_resolution(option, text); })
      .python("size", "size")
      .served();
  t.value("--view", "front|back|left|right|top|bottom|iso", "the side to look from",
          of_view(&CameraRequest::side), [](Text option, Text text) { return find_view(text, option), text; })
      .python("text", "side")
      .served();
  t.value("--zoom", "F", "show things F times as large (1)", of_view(&CameraRequest::zoom), positive)
      .python("number")
      .served();
  t.value("--roll", "DEG", "turn the camera about its direction of view, counter-clockwise (0)",
          of_view(&CameraRequest::roll), number)
      .python("number")
      .served();
  t.value("--look-at", "X,Y,Z", "look at this place from the same side", of_view(&CameraRequest::look_at),
          vector)
      .is(Scope::command)
      .python("numbers")
      .served();
  t.value("--distance", "D", "distance from the camera to the place it looks at, scene units",
          of_view(&CameraRequest::distance), positive)
      .python("number")
      .served();
  t.value(
       "--scale", "1:N", "print scale of an orthographic view", of_view(&CameraRequest::print_scale),
       [](Text option, Text text) {
         const double n = text.starts_with("1:") ? parse_number(option, text.substr(2)) : 0;
         if (!(n > 0)) throw Error(ErrorCode::usage, option + ": '" + text + "' is no scale; write 1:200");
         return n;
       },
       [](const std::optional<double>& n) { return "1:" + number_text(n.value_or(1)); })
      .is(Scope::view)
      .python("text");
  t.value("--dpi", "N", "pixels an inch on paper, kept in .png, .jpg and .tif (300 with --scale)",
          of_view(&CameraRequest::dpi),
          [](Text option, Text text) {
            const double dpi = parse_number(option, text);
            if (dpi > 0 && !(dpi >= 1 && dpi <= 100'000))
              throw Error(ErrorCode::usage, option + ": '" + text + "' is not in 1..100000");
            return dpi;
          })
      .is(Scope::view)
      .python("number");
  t.value("--pixel-size", "D",
          "scene units per pixel of an orthographic view; without --resolution the picture is as large as "
          "the scan",
          of_view(&CameraRequest::pixel_size), positive)
      .is(Scope::view)
      .python("number");
  t.value("--vertical-exaggeration", "F", "multiply heights by F; legends keep true heights (1)",
          &Request::exaggeration, within(0.001, 1000))
      .is(Scope::look)
      .python("number");
  t.flag("--whole", "keep the ceiling and near walls of a room, and frame all points but outliers",
         &Request::whole)
      .is(Scope::look)
      .served();
  t.flag("--panorama",
         "all around --camera-position in one picture twice as wide as high (2048x1024, equirectangular)",
         &Request::panorama)
      .is(Scope::command);

  t.group("Camera (single options win over --camera)", Scope::camera);
  t.text("--camera", "FILE.json", "position, target, up, fov_y_deg, width, height in world coordinates",
         &Request::camera_file)
      .is(Scope::command);
  t.value("--camera-position", "X,Y,Z", "where the camera stands", of_view(&CameraRequest::position), vector)
      .python("numbers", "position")
      .served();
  t.value("--camera-focal-point", "X,Y,Z", "what it looks at", of_view(&CameraRequest::focal_point), vector)
      .python("numbers", "look_at")
      .served();
  t.value("--camera-view-up", "X,Y,Z", "direction that is up in the picture",
          of_view(&CameraRequest::view_up), direction)
      .python("numbers", "view_up")
      .served();
  t.value("--camera-direction", "X,Y,Z", "direction of view", of_view(&CameraRequest::direction), direction)
      .python("numbers", "direction")
      .served();
  t.value("--camera-azimuth-angle", "DEG", "turn about the up axis, 0 from the front (what suits the scan)",
          of_view(&CameraRequest::azimuth), number)
      .python("number", "azimuth")
      .served();
  t.value("--camera-elevation-angle", "DEG", "height above the horizon, -90 to 90 (what suits the scan)",
          of_view(&CameraRequest::elevation), degrees_in(-90, 90))
      .python("number", "elevation")
      .served();
  t.value("--camera-view-angle", "DEG", "full vertical angle: a smaller one zooms in (45)",
          of_view(&CameraRequest::fov), degrees_in(0.001, 179))
      .python("number", "fov")
      .served();
  t.flag("--camera-orthographic", "orthographic projection", of_view(&CameraRequest::orthographic))
      .python("flag", "orthographic")
      .served();
}

void add_points(Table& t) {
  const auto kept = [](auto Selection::*member) {
    return [=](auto& r) -> auto& { return r.points.selection.*member; };
  };
  const auto read = [](auto io::ReadOptions::*member) {
    return [=](auto& r) -> auto& { return r.points.read.*member; };
  };
  t.group("Points", Scope::look);
  t.value("--crop", "X0,Y0,Z0,X1,Y1,Z1", "only the points in this box, world coordinates",
          kept(&Selection::crop), parse_box)
      .is(Scope::place)
      .python("numbers")
      .served();
  t.value("--crop-relative", "X0,Y0,Z0,X1,Y1,Z1",
          "--crop in shares of the whole box: 0,0,0,1,1,0.5 is the lower half", kept(&Selection::crop_share),
          parse_box)
      .python("numbers")
      .served();
  t.value("--show-classes", "N,N...", "only these classification codes", kept(&Selection::show_classes),
          parse_classes)
      .python("integers")
      .served();
  t.value("--hide-classes", "N,N...|none",
          "classification codes to leave out, with withheld points (7,18: noise)", &Request::hide_classes,
          parse_classes)
      .python("integers")
      .served();
  t.texts("--filter", "\"SCALAR A..B\"",
          "only points in a range of a scalar, such as \"intensity 10..200\" or \"z 3..\"; may be given "
          "several times",
          kept(&Selection::filters), [](Text text) { return parse_filter(text); })
      .python("texts", "filters")
      .served();
  t.value("--max-points", "N", "at most N of the selected points, the same ones every time (1e6, 250k, 2M)",
          read(&io::ReadOptions::max_points), count)
      .python("count")
      .served();
  t.value("--columns", "x,y,z,...",
          "names of the columns of text files, .npy rows and .bin floats, instead of a guess",
          read(&io::ReadOptions::columns), [](Text, Text text) { return split(text, ','); })
      .python("words");
  t.flag("--vertices",
         "of meshes (PLY, OBJ, OFF, STL, VTK, Draco) the vertices alone, instead of points on the faces",
         &Request::vertices)
      .served();
  t.flag("--strict", "refuse partly damaged files instead of skipping the damaged parts",
         read(&io::ReadOptions::strict))
      .is(Scope::command);
  t.value("--up", "auto|+Z|-Z|+Y|...",
          "axis that points up (auto: from the file, else guessed from the shape)",
          in(&Request::points, &scene::SceneOptions::up),
          [](Text option, Text text) {
            const std::optional<UpAxis> up = text == "auto" ? std::nullopt : parse_up_axis(text);
            if (text != "auto" && !up)
              throw Error(ErrorCode::usage, option + ": '" + text + "' is not one of auto +X -X +Y -Y +Z -Z");
            return up;
          })
      .python("text")
      .served();
  t.value("--memory", "BYTES",
          "memory for the points of COPC files; of larger files only what the view shows is read (4G)",
          &Request::memory, count)
      .is(Scope::command)
      .python("count");
  t.value("--gpu-memory", "BYTES", "--memory for the graphics card (as much as --memory allows)",
          &Request::gpu_memory, count)
      .is(Scope::file);
}

void add_colours(Table& t) {
  const auto of_color = [](auto ColorSettings::*member) { return in(&Request::color, member); };
  const auto color = [](Text option, Text text) { return parse_color_of(option, text); };
  t.group("Colour", Scope::look);
  t.text("--color-by", "NAME",
         "auto, rgb, intensity, classification, elevation, density, normal, file, any scalar; rgb*intensity: "
         "the product",
         of_color(&ColorSettings::color_by))
      .python("text")
      .served();
  t.value("--color", "COLOUR", "one colour for all points: a name, #hex or R,G,B",
          of_color(&ColorSettings::solid),
          [](Text option, Text text) { return to_rgba8(parse_color_of(option, text)); })
      .or_nothing()
      .python("text")
      .served();
  std::string maps;
  for (const std::string& name : Colormap::names()) maps += (maps.empty() ? "" : " ") + name;
  t.value("--colormap", "NAME",
          maps +
              " (gray for intensity, land for heights, there spread by numbers of points, else viridis); "
              "NAME_r runs backwards; white,#ff8800,black: your own",
          of_color(&ColorSettings::colormap), [](Text, Text text) { return Colormap::named(text), text; })
      .or_nothing()
      .python("text")
      .served();
  t.value("--color-range", "A,B",
          "values at the ends of the colour map (2-98 % of the points, 0.1-99.9 % for heights)",
          of_color(&ColorSettings::range),
          [](Text option, Text text) {
            const std::vector<double> v = parse_numbers(option, text, 2, "A,B");
            if (v[0] == v[1]) throw Error(ErrorCode::usage, option + ": '" + text + "' is empty");
            return std::array{v[0], v[1]};
          })
      .or_nothing()
      .python("numbers", "range")
      .served();
  t.value("--class-colors", "2=#aa7744,6=orange",
          "colours of classes, by code or name; or a file with one CLASS=COLOUR per line",
          of_color(&ColorSettings::class_colors),
          [](Text option, Text text) {
            try {
              return parse_class_colors(text_or_file(text));
            } catch (const Error& error) {
              throw Error(ErrorCode::usage, option + ": " + error.what());
            }
          })
      .or_nothing()
      .python("text");
  t.value("--exposure", "F", "brightness of the file's own colours, 1: as they are (what suits them)",
          of_color(&ColorSettings::exposure), within(0.1, 100))
      .or_nothing()
      .python("number")
      .served();
  t.value("--background-color", "COLOUR",
          "a name, #hex or R,G,B from 0 to 1 (dark grey, slate for photographs; white for clay, other dark "
          "colours, charcoal, watercolor, shadows on a ground)",
          &Request::background, color)
      .or_nothing()
      .python("text", "background")
      .served();
  t.flag("--no-background", "transparent where nothing is", &Request::no_background).python("", "background");
}

void add_furniture(Table& t) {
  const auto drawn = [](auto Furniture::*member) { return in(&Request::furniture, member); };
  const auto legend = [](auto LegendLook::*member) {
    return [=](auto& r) -> auto& { return r.furniture.legend_look.*member; };
  };
  const auto flag = [&](const char* name, const char* help, bool Furniture::*member) -> Table& {
    return t.flag(name, help, drawn(member)).python("furniture");
  };
  t.group("In the picture", Scope::look);
  flag("--legend", "explain the colours in the picture", &Furniture::legend).served();
  t.text("--legend-title", "TEXT", "title of the legend (what the colours show)", legend(&LegendLook::title))
      .python("furniture");
  t.text("--legend-unit", "UNIT", "after the title (for elevations that of the file's CRS)",
         legend(&LegendLook::unit))
      .python("furniture");
  t.value("--legend-place", "bottom-right|bottom-left|top-right|top-left",
          "corner of the legend (bottom-right)", legend(&LegendLook::corner),
          [](Text option, Text text) {
            for (const auto& [name, corner] : corners)
              if (text == name) return corner;
            throw Error(ErrorCode::usage,
                        option + ": '" + text +
                            "' is no corner: write bottom-right, bottom-left, top-right or top-left");
          })
      .python("furniture");
  t.value("--legend-size", "F", "the legend F times as large, 0.3 to 4 (1)", legend(&LegendLook::size),
          within(0.3, 4))
      .python("furniture");
  flag("--scale-bar", "a bar of a round length, in orthographic views", &Furniture::scale_bar);
  flag("--north-arrow", "an arrow to the north, which is +Y of the file (of a y-up file -Z)",
       &Furniture::north_arrow);
  flag("--grid", "a grid of round coordinates, in plans (--view top --camera-orthographic)",
       &Furniture::grid);
  t.text("--title", "TEXT", "above the picture", drawn(&Furniture::title)).python("furniture");
  t.text("--caption", "TEXT", "below the picture", drawn(&Furniture::caption)).python("furniture");
  t.text("--unit", "m|ft|ft-us|km|cm|mm|NAME", "unit of the coordinates (that of the file's CRS)",
         drawn(&Furniture::unit))
      .python("furniture");
}

}  // namespace

const std::vector<Option>& request_options() {
  static const std::vector<Option> rows = [] {
    Table table;
    add_output(table), add_view(table), add_points(table), add_colours(table), add_furniture(table);
    return std::move(table.rows);
  }();
  return rows;
}

const Option* find_option(std::string_view name) {
  static const std::map<std::string, const Option*, std::less<>> by_name = [] {
    std::map<std::string, const Option*, std::less<>> all;
    for (const Option& option : request_options()) all[option.name()] = &option;
    return all;
  }();
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : found->second;
}

void set(Request& request, std::string_view name, const std::string& value) {
  const Option* option = find_option(name);
  if (!option) throw Error(ErrorCode::usage, "there is no option '" + std::string(name) + "'");
  option->set(request, "--" + option->name(), value);
}

std::string text_of(const Request& request, std::string_view name) {
  const std::vector<std::string> texts = find_option(name)->texts(request);
  return texts.empty() ? "" : texts.front();
}

}  // namespace sfumato
