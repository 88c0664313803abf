#include "render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/error.h"
#include "core/lower_case.h"
#include "io/atomic_writer.h"
#include "io/byte_source.h"
#include "video.h"

namespace sfumato::cli {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, message); }

}  // namespace

void RenderOptions::declare(CommandLine& line) {
  line.positionals("FILE", files, "point clouds; several are one scene");
  declare_group(line, *this, "Output");
  common.declare(line);
  std::string group = "Output";
  for (const Option& option : request_options()) {
    if (option.group == "Output") continue;
    if (option.group != group) line.group(group = option.group);
    declare_option(line, *this, option, option.help);
  }
}

namespace {

bool is_picture(const std::string& extension) {
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".webp" ||
         extension == ".tif" || extension == ".tiff";
}

bool has_part(const std::string& pattern, const std::string& name) {
  return pattern.find("{" + name) != std::string::npos;
}

}  // namespace

void RenderOptions::check_outputs(std::size_t technique_count) {
  // Two techniques and their names in -o: a picture each, no sheet.
  if (technique_count > 1 && output_panels.empty() && has_part(output, "technique"))
    std::swap(output_panels, output);
  const std::string extension = extension_of(output);
  if (is_video(output)) {
    if (path.empty() && !sequence) refuse("-o " + output + ": a video needs --path or --sequence");
    if (technique_count > 1 || no_background || each)
      refuse("-o " + output + ": a video is of one technique, one scene and opaque");
    require_ffmpeg(output);
  }
  if (!output.empty() && !is_video(output) && !is_picture(extension) && extension != ".exr" &&
      extension != ".npy")
    refuse("-o " + output + ": pictures are written as .png, .jpg, .webp, .tif, .exr or .npy");
  const bool has_jpeg = extension == ".jpg" || extension == ".jpeg";
  if (no_background && has_jpeg)
    refuse("--no-background: a JPEG cannot be transparent; write a .png or .webp");
  if (quality && !has_jpeg && extension != ".webp")
    refuse("--quality goes with .jpg and .webp; a .png is lossless");
  if (!output_panels.empty()) {
    if (extension_of(output_panels) != ".png")
      refuse("--output-panels " + output_panels + ": panels are written as .png");
    if (file_name(output_panels, {0, "a", ""}) == file_name(output_panels, {0, "b", ""}))
      refuse("--output-panels " + output_panels + ": write {technique} where the technique's name goes");
  }
  if (technique_count > 1) {
    if (!output.empty() && !is_picture(extension))
      refuse("-o " + output + ": a contact sheet of several techniques is a .png");
    if (!output_depth.empty() || !output_normal.empty() || !output_index.empty())
      refuse("--output-depth, --output-index and --output-normal need a single technique");
  }
  if (const std::string depth = extension_of(output_depth);
      !output_depth.empty() && depth != ".npy" && depth != ".exr" && depth != ".png")
    refuse("--output-depth " + output_depth + ": depth is written as .npy, .exr or .png (16 bit)");
  if (depth_unit.metres > 0 && extension_of(output_depth) != ".png")
    refuse("--depth-unit is of --output-depth NAME.png; .npy and .exr hold scene units");
  for (const auto& [option, file] :
       {std::pair("--output-normal ", output_normal), std::pair("--output-index ", output_index)})
    if (!file.empty() && extension_of(file) != ".npy")
      refuse(option + file + ": the array is written as .npy");
  if (panorama && !output_index.empty()) refuse("--output-index is of one view: leave out --panorama");
  if (!furniture.empty() && (extension == ".exr" || extension == ".npy")) {
    const Furniture& f = furniture;
    refuse(std::string(f.legend          ? "--legend"
                       : f.scale_bar     ? "--scale-bar"
                       : f.north_arrow   ? "--north-arrow"
                       : f.grid          ? "--grid"
                       : f.title.empty() ? "--caption"
                                         : "--title") +
           " goes with .png, .jpg and .webp only (and .tif), whose pixels are colours");
  }
  if (world_file && (output.empty() || is_video(output) || io::is_standard_output(output)))
    refuse("--world-file needs a picture: add -o PLAN.png");
  furniture.print_scale = view.print_scale.value_or(0), furniture.dpi = dpi();
  // A map lies over others: it covers what it shows.
  if ((extension == ".tif" || extension == ".tiff") && !background) no_background = true;
  if (json && io::is_standard_output(output))
    refuse("--json and -o " + output + " both write to standard output");
}

void RenderOptions::check_window(std::size_t technique_count) const {
  if (has_output()) {
    if (watch) refuse("--watch belongs to the window: leave out -o, or --watch");
    return;
  }
#ifndef SFUMATO_VIEWER
  throw Error(
      ErrorCode::no_gl,
      "this sfumato is built without its window (libglfw3-dev, libimgui-dev): add -o OUT.png to render "
      "to a picture");
#endif
  if (technique_count > 1)
    refuse("a window shows one technique at a time: name one, or add -o OUT.png for a sheet of all");
  for (const auto& [option, given] : {std::pair("--each", each),
                                      {"--path", !path.empty()},
                                      {"--panorama", panorama},
                                      {"--save-scene", !save_scene.empty()},
                                      {"--no-background", no_background},
                                      {"--world-file", world_file},
                                      {"--vertical-exaggeration", exaggeration.has_value()},
                                      {"--save-preset", !save_preset.empty()},
                                      {"--json", json},
                                      {"--timings", timings}})
    if (given) refuse(std::string(option) + " goes with pictures, not with the window: add -o OUT.png");
}

void RenderOptions::check(std::size_t technique_count) {
  if (!scene.empty() && !preset.empty())
    refuse("--scene and --preset contradict each other: a scene is a preset with files");
  if (files.empty()) refuse("no file given: sfumato FILE... -o OUT.png (sfumato --help)");
  std::error_code error;
  if (!has_output() && files.size() == 1 && files[0] != "-" && !io::is_remote(files[0]) &&
      !std::filesystem::exists(files[0], error) && files[0].find_first_of("*?[") == std::string::npos)
    throw Error(ErrorCode::io, files[0] + ": there is no such file; check the name");
  check_window(technique_count);
  common.apply();
  check_outputs(technique_count);
  resolve_view(*this);
  (void)scene_options();
  if (gpu_memory)  // One budget: that of the points that both have room for.
    memory = std::min(memory, std::max<std::uint64_t>(1, *gpu_memory / scene::gpu_memory_of_point) *
                                  scene::memory_of_point);
  if (each && !(save_preset.empty() && save_scene.empty()))
    refuse("--save-preset and --save-scene keep what one picture shows: leave out --each");
  if (sequence && each) refuse("--sequence and --each contradict each other: give one of them");
  if ((sequence || each) && !path.empty())
    refuse(std::string(sequence ? "--sequence shows its files from one camera"
                                : "--each makes one picture a file") +
           ": leave out --path");
  if (path.empty()) {
    if (frames || degrees) refuse("--frames and --degrees need --path");
  } else {
    if (degrees && path != "orbit") refuse("--degrees goes with --path orbit");
    if (path != "orbit") poses = io::read_camera_path(path);
  }
  for (const std::string& file :
       {output, output_panels, output_depth, output_index, output_normal, output_camera}) {
    if (file.empty() || is_video(file)) continue;
    const std::string first = file_name(file, {0, "t", "a"});
    if (first == file) {
      if (sequence || !path.empty())
        refuse("'" + file + "' names one file for all frames: write {n:04} where the frame's number goes");
      if (each)
        refuse("'" + file + "' names one file for all pictures: write {stem} where the file's name goes");
      continue;
    }
    const bool numbered = sequence || each || !path.empty();
    if (!numbered && has_part(file, "n"))
      refuse("'" + file + "': {n} numbers the pictures of --path, --sequence or --each; there is one here");
    if (!each && files.size() > 1 && has_part(file, "stem"))
      refuse("'" + file +
             "': {stem} is the name of one file; several are one scene unless --each makes pictures of them");
    if ((sequence || !path.empty()) && file_name(file, {0, "t", "a"}) == file_name(file, {1, "t", "a"}))
      refuse("'" + file + "' names one file for all frames: write {n:04} where the frame's number goes");
  }
  check_color(*this);
}

void RenderOptions::expand_files() {
  files = scene::expand_inputs(files);
  const std::vector<scene::SceneFile> moved = placed_files(files, transforms);
  for (std::size_t n = 0; n < moved.size(); ++n) {
    if (!moved[n].transform) continue;
    if (scene_files.size() < files.size()) scene_files.resize(files.size());
    scene_files[n] = moved[n];
  }
}

scene::SceneFile RenderOptions::placed(std::size_t n) const {
  scene::SceneFile file{files[n], {}};
  if (n < scene_files.size() && scene_files[n].name == file.name) file.transform = scene_files[n].transform;
  return file;
}

std::vector<scene::SceneFile> RenderOptions::placed() const {
  std::vector<scene::SceneFile> all;
  for (std::size_t n = 0; n < files.size(); ++n) all.push_back(placed(n));
  return all;
}

NameParts RenderOptions::parts(int n, const std::string& technique_name) const {
  const std::size_t file = each || sequence ? std::size_t(n) : 0;
  return {n, technique_name.empty() ? technique : technique_name, stem_of(files[file])};
}

std::string extension_of(const std::string& file) {
  if (io::is_standard_output(file)) return ".png";
  return lower_case(std::filesystem::path(file).extension().string());
}

std::string file_name(const std::string& pattern, const NameParts& parts) {
  if (pattern.find_first_of("{}") == std::string::npos) return pattern;
  // Three digits in braces would be a width of a hundred and more; no frame's number has so many.
  for (std::size_t i = 0, digits = 0, open = 0; i < pattern.size(); ++i) {
    open = pattern[i] == '{' ? 1 : pattern[i] == '}' ? 0 : open;
    digits = open && std::isdigit(static_cast<unsigned char>(pattern[i])) ? digits + 1 : 0;
    if (digits == 3)
      refuse("'" + pattern + "' is no file name template: {n:04} gives the frame's number four digits");
  }
  try {
    return fmt::format(fmt::runtime(pattern), fmt::arg("n", parts.n), fmt::arg("technique", parts.technique),
                       fmt::arg("stem", parts.stem));
  } catch (const fmt::format_error&) {
    refuse("'" + pattern +
           "' is no file name template: there are {stem} (the input's name), {n:04} (its number) and "
           "{technique}; write {{ "
           "for a brace");
  }
}

std::string stem_of(const std::string& file) {
  if (file == "-") return "standard-input";
  std::string name = std::filesystem::path(file).filename().string();
  for (const char* last : {".laz", ""}) {  // of .copc.laz both
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos || dot == 0) break;
    const bool laz = extension_of(name) == ".laz";
    if (*last == 0 && extension_of(name) != ".copc") break;
    name.resize(dot);
    if (!laz) break;
  }
  return name;
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
