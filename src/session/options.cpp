// The one table of what a picture can be asked for.
#include <algorithm>
#include <fstream>
#include <iterator>
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
using Scope = Option::Scope;

class Table {
 public:
  std::vector<Option> rows;

  /// Heading of the options that follow, and what most of them are.
  void group(const std::string& title, Scope scope) { title_ = title, scope_ = scope; }

  /// `set` gets request, option and text.
  template <class Set>
  Table& text(const std::string& names, const std::string& metavar, const std::string& help, Set set) {
    Option row{names, metavar, help, title_, Option::Kind::text, scope_, "", "", set};
    rows.push_back(std::move(row));
    return *this;
  }
  Table& text(const std::string& names, const std::string& metavar, const std::string& help,
              std::string Request::*member) {
    return text(names, metavar, help, [member](Request& r, Text, Text text) { r.*member = text; });
  }
  /// `member` gives the value of a request.
  template <class Member>
  Table& flag(const std::string& names, const std::string& help, Member member) {
    text(names, "", help, [member](Request& r, Text, Text text) { std::invoke(member, r) = text == "true"; });
    rows.back().kind = Option::Kind::flag;
    return python("flag");
  }
  /// `append` gets request and text.
  template <class Member, class Parse>
  Table& texts(const std::string& names, const std::string& metavar, const std::string& help, Member member,
               Parse parse) {
    text(names, metavar, help,
         [member, parse](Request& r, Text, Text text) { std::invoke(member, r).push_back(parse(text)); });
    rows.back().kind = Option::Kind::texts;
    rows.back().clear = [member](Request& r) { std::invoke(member, r).clear(); };
    return python("texts");
  }
  Table& is(Scope scope) {
    rows.back().scope = scope;
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
  std::string title_;
  Scope scope_ = Scope::command;
};

std::string same(Text text) { return text; }

std::optional<vec3> color_or_none(Text option, Text text) {
  return text.empty() ? std::nullopt : std::optional(parse_color_of(option, text));
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
      &Request::technique);
  t.texts("--draw", "\"SELECTION: TECHNIQUE [name=value ...]\"",
          "draw selected points by another technique, such as \"classification 3-5: soft opacity=0.2\"; "
          "the first that selects a point wins (sfumato help draw)",
          &Request::draw, [](Text text) { return DrawRule::parse(text); })
      .is(Scope::look);
  t.text(
      "-o,--output", "FILE",
      "the picture: .png .jpg .webp (sRGB), .tif (sRGB; a plan is a GeoTIFF, clear where nothing is), .exr "
      "(linear, Z, normals), .npy (linear RGBA); - is standard output",
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
  t.text("--depth-unit", "m|cm|mm|in|ft|METRES",
         "what one step of a depth .png is (its range in 65535 steps); beyond 65535 of them all is 65535",
         [](Request& r, Text option, Text text) {
           r.depth_unit = unit_named(text);
           if (r.depth_unit.metres > 0 || text.empty()) return;
           r.depth_unit = {text + " m", parse_positive(option, text)};
         });
  t.text("--output-index", "FILE.npy",
         "int64 HxW: which point of the input is seen, from 0 on and file after file, -1 where none is",
         &Request::output_index);
  t.text("--output-normal", "FILE.npy", "float32 HxWx3, world, facing the camera, 0 where none",
         &Request::output_normal);
  t.text("--output-camera", "FILE.json", "the camera of the picture", &Request::output_camera);
  t.text("--quality", "1..100", "of .jpg and .webp; 100 makes .webp lossless (90)",
         [](Request& r, Text option, Text text) {
           r.quality.reset();
           if (text.empty()) return;
           r.quality = int(std::min(parse_whole(option, text, 1), 1000L));
           if (*r.quality > 100) throw Error(ErrorCode::usage, option + ": '" + text + "' is not in 1..100");
         })
      .is(Scope::file);
  t.text("--path", "FILE|orbit",
         "camera path: one picture a frame, -o frame_{n:04}.png, or a video, -o NAME.mp4 (by ffmpeg); poses "
         "of transforms.json, COLMAP (images.txt or .bin), TUM, KITTI and Open3D are pictures of their own",
         &Request::path);
  t.text("--frames", "N", "pictures of the path (120, or one each pose)",
         [](Request& r, Text option, Text text) {
           r.frames = int(std::min(parse_whole(option, text, 1), 1'000'000L));
         });
  t.text("--degrees", "D", "arc of the orbit (360)",
         [](Request& r, Text option, Text text) { r.degrees = parse_number(option, text); });
  t.flag("--sequence",
         "files are frames: one picture each, from the camera of the first, with one colour range for all, "
         "-o frame_{n:04}.png",
         &Request::sequence);
  t.text("--preset", "FILE.json", "options and parameters saved before; those given here win",
         &Request::preset);
  t.text("--save-preset", "FILE.json", "save what reproduces this picture", &Request::save_preset);
  t.text("--scene", "FILE.json", "files, --draw, look and camera saved before; those given here win",
         &Request::scene);
  t.text("--save-scene", "FILE.json", "save the files as well", &Request::save_scene);
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

/// A text that becomes an optional value of the view.
template <class T, class Parse>
auto of_view(std::optional<T> ViewWishes::*member, Parse parse) {
  return [member, parse](Request& r, Text option, Text text) { r.view.*member = parse(option, text); };
}

void add_view(Table& t) {
  const auto vector = parse_vector;
  const auto positive = parse_positive;
  const auto number = [](Text option, Text text) { return parse_number(option, text); };
  const auto direction = [](Text option, Text text) {
    const dvec3 v = parse_vector(option, text);
    if (glm::length(v) <= 0) throw Error(ErrorCode::usage, option + ": 0,0,0 is no direction");
    return v;
  };
  const auto degrees_in = [](double low, double high) {
    return [=](Text option, Text text) { return parse_degrees(option, text, low, high); };
  };
  t.group("View", Scope::camera);
  t.text("--resolution", "WxH", "picture size in pixels (1280x720)",
         of_view(&ViewWishes::size, [](Text option, Text text) { return parse_resolution(option, text); }))
      .python("size", "size");
  t.text("--view", "front|back|left|right|top|bottom|iso", "the side to look from",
         [](Request& r, Text option, Text text) { find_view(text, option), r.view.side = text; })
      .python("text", "side");
  t.text("--zoom", "F", "show things F times as large (1)", of_view(&ViewWishes::zoom, positive))
      .python("number");
  t.text("--roll", "DEG", "turn the camera about its direction of view, counter-clockwise (0)",
         of_view(&ViewWishes::roll, number))
      .python("number");
  t.text("--look-at", "X,Y,Z", "look at this place from the same side", of_view(&ViewWishes::look_at, vector))
      .is(Scope::command);
  t.text("--distance", "D", "how far from the place looked at, scene units",
         of_view(&ViewWishes::distance, positive))
      .python("number");
  t.text("--scale", "1:N", "print scale of an orthographic view",
         of_view(&ViewWishes::print_scale,
                 [](Text option, Text text) {
                   const double n = text.starts_with("1:") ? parse_number(option, text.substr(2)) : 0;
                   if (!(n > 0))
                     throw Error(ErrorCode::usage, option + ": '" + text + "' is no scale; write 1:200");
                   return n;
                 }))
      .is(Scope::view)
      .python("text");
  t.text("--dpi", "N", "pixels an inch on paper, kept in .png, .jpg and .tif (300 with --scale)",
         of_view(&ViewWishes::dpi,
                 [](Text option, Text text) {
                   const double dpi = parse_number(option, text);
                   if (dpi > 0 && !(dpi >= 1 && dpi <= 100'000))
                     throw Error(ErrorCode::usage, option + ": '" + text + "' is not in 1..100000");
                   return dpi;
                 }))
      .is(Scope::view)
      .python("number");
  t.text("--pixel-size", "D",
         "scene units per pixel of an orthographic view; without --resolution the picture is as large as "
         "the scan",
         of_view(&ViewWishes::pixel_size, positive))
      .is(Scope::view)
      .python("number");
  t.text("--vertical-exaggeration", "F", "heights F times as large, those of legends stay true (1)",
         [](Request& r, Text option, Text text) {
           r.exaggeration = parse_number(option, text);
           if (!(*r.exaggeration >= 0.001 && *r.exaggeration <= 1000))
             throw Error(ErrorCode::usage, option + ": '" + text + "' is not in 0.001..1000");
         })
      .is(Scope::look)
      .python("number");
  t.flag("--whole", "keep the ceiling and near walls of a room, and frame all points but outliers",
         &Request::whole)
      .is(Scope::look);
  t.flag("--panorama",
         "all around --camera-position in one picture twice as wide as high (2048x1024, equirectangular)",
         &Request::panorama)
      .is(Scope::command);

  t.group("Camera (single options win over --camera)", Scope::camera);
  t.text("--camera", "FILE.json", "position, target, up, fov_y_deg, width, height in world coordinates",
         &Request::camera_file)
      .is(Scope::command);
  t.text("--camera-position", "X,Y,Z", "where the camera stands", of_view(&ViewWishes::position, vector))
      .python("numbers", "position");
  t.text("--camera-focal-point", "X,Y,Z", "what it looks at", of_view(&ViewWishes::focal_point, vector))
      .python("numbers", "look_at");
  t.text("--camera-view-up", "X,Y,Z", "direction that is up in the picture",
         of_view(&ViewWishes::view_up, direction))
      .python("numbers", "view_up");
  t.text("--camera-direction", "X,Y,Z", "direction of view", of_view(&ViewWishes::direction, direction))
      .python("numbers", "direction");
  t.text("--camera-azimuth-angle", "DEG", "turn about the up axis, 0 from the front (what suits the scan)",
         of_view(&ViewWishes::azimuth, number))
      .python("number", "azimuth");
  t.text("--camera-elevation-angle", "DEG", "height above the horizon, -90 to 90 (what suits the scan)",
         of_view(&ViewWishes::elevation, degrees_in(-90, 90)))
      .python("number", "elevation");
  t.text("--camera-view-angle", "DEG", "full vertical angle: a smaller one zooms in (45)",
         of_view(&ViewWishes::fov, degrees_in(0.001, 179)))
      .python("number", "fov");
  t.flag("--camera-orthographic", "orthographic projection", [](Request& r) -> bool& {
     return r.view.orthographic;
   }).python("flag", "orthographic");
}

void add_points(Table& t) {
  const auto kept = [](auto Selection::*member, auto parse) {
    return [=](Request& r, Text option, Text text) { r.points.selection.*member = parse(option, text); };
  };
  t.group("Points", Scope::look);
  t.text("--crop", "X0,Y0,Z0,X1,Y1,Z1", "only the points in this box, world coordinates",
         kept(&Selection::crop, parse_box))
      .is(Scope::place)
      .python("numbers");
  t.text("--crop-relative", "X0,Y0,Z0,X1,Y1,Z1",
         "the same in shares of the whole box: 0,0,0,1,1,0.5 is the lower half",
         kept(&Selection::crop_share, parse_box))
      .python("numbers");
  t.text("--show-classes", "N,N...", "only these classification codes",
         kept(&Selection::show_classes, parse_classes))
      .python("integers");
  t.text("--hide-classes", "N,N...|none",
         "classification codes to leave out, with withheld points (7,18: noise)",
         [](Request& r, Text option, Text text) { r.hide_classes = parse_classes(option, text); })
      .python("integers");
  t.texts(
       "--filter", "\"SCALAR A..B\"",
       "only points in a range of a scalar, such as \"intensity 10..200\" or \"z 3..\"; may be given "
       "several times",
       [](Request & r) -> auto& { return r.points.selection.filters; },
       [](Text text) { return parse_filter(text); })
      .python("texts", "filters");
  t.text("--max-points", "N", "a subsample of what is left, the same one every time (1e6, 250k, 2M)",
         [](Request& r, Text option, Text text) {
           r.points.read.max_points = std::uint64_t(parse_whole(option, text, 1));
         })
      .python("count");
  t.text("--columns", "x,y,z,...",
         "names of the columns of text files, .npy rows and .bin floats, instead of a guess",
         [](Request& r, Text, Text text) { r.points.read.columns = split(text, ','); })
      .python("words");
  t.flag("--vertices", "of meshes (PLY, OBJ) the vertices alone, instead of points on the faces",
         &Request::vertices);
  t.flag("--strict", "refuse partly damaged files instead of skipping the damaged parts",
         [](Request& r) -> bool& { return r.points.read.strict; })
      .is(Scope::command);
  t.text("--up", "auto|+Z|-Z|+Y|...",
         "axis that points up (auto: from the file, else guessed from the shape)",
         [](Request& r, Text option, Text text) {
           r.points.up.reset();
           if (text != "auto" && !(r.points.up = parse_up_axis(text)))
             throw Error(ErrorCode::usage, option + ": '" + text + "' is not one of auto +X -X +Y -Y +Z -Z");
         })
      .python("text");
  t.text("--memory", "BYTES",
         "memory for the points of COPC files; of larger files only what the view shows is read (4G)",
         [](Request& r, Text option, Text text) { r.memory = std::uint64_t(parse_whole(option, text, 1)); })
      .is(Scope::command);
  t.text(
       "--gpu-memory", "BYTES", "the same on the graphics card (as much as --memory allows)",
       [](Request& r, Text option, Text text) { r.gpu_memory = std::uint64_t(parse_whole(option, text, 1)); })
      .is(Scope::file);
}

void add_colours(Table& t) {
  t.group("Colour", Scope::look);
  t.text("--color-by", "NAME",
         "auto, rgb, intensity, classification, elevation, density, normal, file, any scalar; rgb*intensity: "
         "the product",
         [](Request& r, Text, Text text) { r.color.color_by = text; })
      .python("text");
  t.text("--color", "COLOUR", "one colour for all points: a name, #hex or R,G,B",
         [](Request& r, Text option, Text text) {
           const auto color = color_or_none(option, text);
           r.color.solid = color ? std::optional(to_rgba8(*color)) : std::nullopt;
         })
      .python("text");
  std::string maps;
  for (const std::string& name : Colormap::names()) maps += (maps.empty() ? "" : " ") + name;
  t.text("--colormap", "NAME",
         maps +
             " (gray for intensity, land for heights, else viridis); NAME_r runs backwards; "
             "white,#ff8800,black: your own",
         [](Request& r, Text, Text text) {
           if (!text.empty()) Colormap::named(text);
           r.color.colormap = text;
         })
      .python("text");
  t.text("--color-range", "A,B",
         "values at the ends of the colour map (2-98 % of the points, nearly all of heights)",
         [](Request& r, Text option, Text text) {
           r.color.range.reset();
           if (text.empty()) return;
           const std::vector<double> v = parse_numbers(option, text, 2, "A,B");
           if (v[0] == v[1]) throw Error(ErrorCode::usage, option + ": '" + text + "' is empty");
           r.color.range = {v[0], v[1]};
         })
      .python("numbers", "range");
  t.text("--class-colors", "2=#aa7744,6=orange",
         "colours of classes, by code or name; or a file with one CLASS=COLOUR per line",
         [](Request& r, Text option, Text text) {
           try {
             r.color.class_colors =
                 text.empty() ? std::map<int, Rgba8>() : parse_class_colors(text_or_file(text));
           } catch (const Error& error) {
             throw Error(ErrorCode::usage, option + ": " + error.what());
           }
         })
      .python("text");
  t.text("--exposure", "F", "brightness of the file's own colours, 1: as they are (what suits them)",
         [](Request& r, Text option, Text text) {
           r.color.exposure.reset();
           if (text.empty()) return;
           r.color.exposure = parse_number(option, text);
           if (!(*r.color.exposure >= 0.1 && *r.color.exposure <= 100))
             throw Error(ErrorCode::usage, option + ": '" + text + "' is outside [0.1, 100]");
         })
      .python("number");
  t.text("--background-color", "COLOUR", "a name, #hex or R,G,B from 0 to 1 (white)",
         [](Request& r, Text option, Text text) { r.background = color_or_none(option, text); })
      .python("text", "background");
  t.flag("--no-background", "transparent where nothing is", &Request::no_background).python("", "background");

  t.group("In the picture", Scope::look);
  for (const FurnitureOption& option : furniture_options()) {
    const std::string name = option.name;
    Furniture plain;
    t.text("--" + name, option.metavar, option.help, [name](Request& r, Text, Text text) {
       try {
         set(r.furniture, name, text);
       } catch (const Error& error) {
         throw Error(ErrorCode::usage, "--" + std::string(error.what()));
       }
     }).python("furniture");
    if (flag_of(plain, name)) t.rows.back().kind = Option::Kind::flag;
  }
}

}  // namespace

const std::vector<Option>& request_options() {
  static const std::vector<Option> rows = [] {
    Table table;
    add_output(table), add_view(table), add_points(table), add_colours(table);
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

}  // namespace sfumato
