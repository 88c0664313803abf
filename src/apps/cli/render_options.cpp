#include "render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/colormap.h"
#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::cli {
namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::usage, message);
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace

void RenderOptions::declare(CommandLine& line) {
  line.positionals("FILE", files, "point clouds; several are one scene");
  line.group("Output");
  line.text("-t,--technique", technique, "NAME[,NAME...]",
            "technique (" + default_technique() +
                "); several give a labelled contact sheet. See: sfumato techniques");
  line.text("-o,--output", output, "FILE",
            "picture: .png (sRGB), .exr (linear, Z, normals), .npy (linear RGBA)");
  line.text("--output-panels", output_panels, "NAME_{technique}.png",
            "each technique's own picture as well, of the same rendering as the contact sheet");
  line.text("--output-depth", output_depth, "FILE.npy",
            "float32 HxW, depth along the view axis, inf where nothing");
  line.text("--output-normal", output_normal, "FILE.npy",
            "float32 HxWx3, world, facing the camera, 0 where none");
  line.text("--output-camera", output_camera, "FILE.json", "the camera of the picture");
  line.text("--path", path, "FILE.json|orbit", "camera path: one picture a frame, -o frame_{n:04}.png");
  line.text("--frames", frames, "N", "pictures of the path (120)");
  line.text("--degrees", degrees, "D", "arc of the orbit (360)");
  line.flag("--sequence", sequence,
            "files are frames: one picture each from one camera, -o frame_{n:04}.png");
  line.text("--preset", preset, "FILE.json", "options and parameters saved before; those given here win");
  line.text("--save-preset", save_preset, "FILE.json", "save what reproduces this picture");
  line.flag("--timings", timings, "time of every pass");
  line.flag("--json", json, "report on standard output");
  line.flag("--quiet", quiet, "no progress, no notes");
  line.flag("--version", version, "print the version");
  camera.declare(line);
  line.group("Reading");
  line.text("--up", up, "+Z|-Z|+Y|...", "axis that points up (from the file or its format)");
  line.text("--max-points", max_points, "N", "a subsample, the same one every time");
  line.text("--columns", columns, "x,y,z,...", "text files: names of the columns, instead of the guess");
  line.text("--hide-classes", hide_classes, "N,N...|none", "classification codes left out (7,18: noise)");
  line.group("Colour");
  line.text("--color-by", color.color_by, "NAME",
            "auto, rgb, intensity, classification, elevation, normal, any scalar");
  line.text("--colormap", color.colormap, "NAME",
            join(Colormap::names()) + " (gray for intensity, else viridis)");
  line.text("--color-range", color_range, "A,B",
            "values at the ends of the colour map (2-98 % of the points)");
  line.flag("--legend", legend, "explain the colours in the picture");
  line.text("--background-color", background_color, "R,G,B", "sRGB 0..1 (1,1,1)");
  line.flag("--no-background", no_background, "transparent where nothing is");
}

void RenderOptions::check(std::size_t technique_count) {
  if (files.empty()) refuse("no file given: sfumato FILE... -o OUT.png (sfumato --help)");
  if (!has_output()) refuse("there is no viewer in this version: add -o OUT.png to render to a picture");
  const std::string extension = extension_of(output);
  if (!output.empty() && extension != ".png" && extension != ".exr" && extension != ".npy")
    refuse("-o " + output + ": pictures are written as .png, .exr or .npy");
  if (!output_panels.empty()) {
    if (extension_of(output_panels) != ".png")
      refuse("--output-panels " + output_panels + ": panels are written as .png");
    if (frame_name(output_panels, 0, "a") == frame_name(output_panels, 0, "b"))
      refuse("--output-panels " + output_panels + ": write {technique} where the technique's name goes");
  }
  if (technique_count > 1) {
    if (!output.empty() && extension != ".png")
      refuse("-o " + output + ": a contact sheet of several techniques is a .png");
    if (!output_depth.empty() || !output_normal.empty())
      refuse("--output-depth and --output-normal need a single technique");
  }
  for (const auto& [option, file] :
       {std::pair("--output-depth", output_depth), std::pair("--output-normal", output_normal)})
    if (!file.empty() && extension_of(file) != ".npy")
      refuse(std::string(option) + " " + file + ": the array is written as .npy");
  if (legend && (extension == ".exr" || extension == ".npy")) refuse("--legend goes with .png only");
  if (json && io::is_standard_output(output)) refuse("--json and -o " + output + " both write to standard output");
  camera.check();
  if (sequence && !path.empty()) refuse("--sequence shows its files from one camera: leave out --path");
  if (path.empty()) {
    if (!frames.empty() || !degrees.empty()) refuse("--frames and --degrees need --path");
  } else {
    frame_count = frames.empty() ? 120 : int(std::min(parse_whole("--frames", frames, 1), 1'000'000L));
    if (!degrees.empty() && path != "orbit") refuse("--degrees goes with --path orbit");
    if (!degrees.empty()) orbit_degrees = parse_number("--degrees", degrees);
  }
  if (sequence || !path.empty()) {
    for (const std::string& file : {output, output_panels, output_depth, output_normal, output_camera})
      if (!file.empty() && (frame_name(file, 0) == frame_name(file, 1)))
        refuse("'" + file + "' names one file for all frames: write {n:04} where the frame's number goes");
  }
  if (!up.empty() && !(up_axis = parse_up_axis(up)))
    refuse("--up: '" + up + "' is not one of +X -X +Y -Y +Z -Z");
  if (!background_color.empty()) {
    const std::vector<double> v = parse_numbers("--background-color", background_color, 3);
    for (double c : v)
      if (c < 0 || c > 1) refuse("--background-color: '" + background_color + "' is not in 0..1");
    background = vec3(float(v[0]), float(v[1]), float(v[2]));
  }
  if (!color_range.empty()) {
    const std::vector<double> v = parse_numbers("--color-range", color_range, 2);
    if (v[0] == v[1]) refuse("--color-range: '" + color_range + "' is empty");
    color.range = {v[0], v[1]};
  }
  if (!color.colormap.empty()) Colormap::named(color.colormap);
  if (!hide_classes.empty() && hide_classes != "none")
    for (const std::string& code : split(hide_classes, ','))
      hidden_classes.push_back(int(parse_whole("--hide-classes", code, 0)));
  if (!columns.empty()) read.columns = split(columns, ',');
  if (!max_points.empty()) read.max_points = std::uint64_t(parse_whole("--max-points", max_points, 1));
}

std::string extension_of(const std::string& file) {
  if (io::is_standard_output(file)) return ".png";
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

std::string frame_name(const std::string& pattern, int n, const std::string& technique) {
  // Three digits in braces would be a width of a hundred and more; no frame's number has so many.
  for (std::size_t i = 0, digits = 0, open = 0; i < pattern.size(); ++i) {
    open = pattern[i] == '{' ? 1 : pattern[i] == '}' ? 0 : open;
    digits = open && std::isdigit(static_cast<unsigned char>(pattern[i])) ? digits + 1 : 0;
    if (digits == 3) refuse("'" + pattern + "' is no file name template: {n:04} gives the frame's number four digits");
  }
  try {
    return fmt::format(fmt::runtime(pattern), fmt::arg("n", n), fmt::arg("technique", technique));
  } catch (const fmt::format_error& error) {
    refuse("'" + pattern + "' is no file name template (" + error.what() +
           "): write {n:04} for the frame's number");
  }
}

std::string peek(const Words& words, char short_name, const std::string& long_name) {
  std::string found;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") break;
    const bool is_short = short_name && word.size() >= 2 && word[0] == '-' && word[1] == short_name;
    if (word == "--" + long_name || (is_short && word.size() == 2)) {
      if (i + 1 < words.size()) found = words[i + 1];
    } else if (word.starts_with("--" + long_name + "=")) {
      found = word.substr(long_name.size() + 3);
    } else if (is_short) {
      found = word.substr(2);
    }
  }
  return found;
}

}  // namespace sfumato::cli
