#include "input_options.h"

#include <algorithm>
#include <cctype>

#include "core/counted.h"
#include "core/error.h"
#include "session/preset.h"

namespace sfumato::cli {
namespace {

std::vector<int> parse_classes(const std::string& option, const std::string& text) {
  std::vector<int> codes;
  for (const std::string& code : split(text, ',')) {
    const long id = parse_whole(option, code, 0);
    if (id > 255)
      throw Error(ErrorCode::usage, option + ": class " + code + " is beyond 255, the last there is");
    codes.push_back(int(id));
  }
  return codes;
}

}  // namespace

void InputOptions::declare(CommandLine& line) {
  line.group("Points");
  line.text("--crop", crop_, "X0,Y0,Z0,X1,Y1,Z1", "only the points in this box, world coordinates");
  line.text("--crop-relative", crop_relative_, "X0,Y0,Z0,X1,Y1,Z1",
            "the same in shares of the whole box: 0,0,0,1,1,0.5 is the lower half");
  line.text("--show-classes", show_classes_, "N,N...", "only these classification codes");
  line.text("--hide-classes", hide_classes_, "N,N...|none",
            "classification codes left out, and withheld points (" + hide_classes_ +
                (hide_classes_ == "none" ? ")" : ": noise)"));
  line.texts("--filter", filters_, "\"SCALAR A..B\"",
             "only points in a range of a scalar, such as \"intensity 10..200\" or \"z 3..\"; may be given "
             "several times");
  line.text("--max-points", max_points_, "N",
            "a subsample of what is left, the same one every time (1e6, 250k, 2M)");
  line.text("--columns", columns_, "x,y,z,...",
            "names of the columns of text files, .npy rows and .bin floats, instead of a guess");
  if (draws_)
    line.flag("--vertices", vertices_,
              "of meshes (PLY, OBJ) the vertices alone, instead of points on the faces");
  line.flag("--strict", scene.read.strict,
            "refuse partly damaged files instead of skipping the damaged parts");
  line.text("--up", up_, "auto|+Z|-Z|+Y|...",
            "axis that points up (auto: from the file, else guessed from the shape)");
}

void InputOptions::check() {
  scene.read.samples_faces = draws_ && !vertices_;
  Selection& wanted = scene.selection;
  if (crop_ && crop_relative_)
    throw Error(ErrorCode::usage, "--crop and --crop-relative contradict each other: give one of them");
  if (crop_) wanted.crop = parse_box("--crop", *crop_);
  if (crop_relative_) wanted.crop_share = parse_box("--crop-relative", *crop_relative_);
  if (show_classes_) wanted.show_classes = parse_classes("--show-classes", *show_classes_);
  if (hide_classes_ != "none" && !hide_classes_.empty()) {
    wanted.hide_withheld = true;
    // Noise is left out unless somebody wants to see just that.
    for (int id : parse_classes("--hide-classes", hide_classes_))
      if (std::find(wanted.show_classes.begin(), wanted.show_classes.end(), id) == wanted.show_classes.end())
        wanted.hide_classes.push_back(id);
  }
  for (const std::string& text : filters_) wanted.filters.push_back(parse_filter(text));
  if (columns_) scene.read.columns = split(*columns_, ',');
  if (max_points_) scene.read.max_points = std::uint64_t(parse_whole("--max-points", *max_points_, 1));
  if (up_ && *up_ != "auto" && !(scene.up = parse_up_axis(*up_)))
    throw Error(ErrorCode::usage, "--up: '" + *up_ + "' is not one of auto +X -X +Y -Y +Z -Z");
}

void declare_transforms(CommandLine& line, Words& transforms) {
  line.texts("--transform", transforms, "\"N: 16 NUMBERS\"",
             "4x4 matrix that maps the N-th file to world coordinates, row by row, with commas");
}

std::vector<scene::SceneFile> placed_files(const Words& files, const Words& transforms) {
  std::vector<scene::SceneFile> placed = scene::files_of(files);
  for (const std::string& text : transforms) {
    const std::size_t colon = text.find(':');
    const auto wrong = [&](const std::string& why) {
      throw Error(ErrorCode::usage,
                  "--transform: '" + text + "': " + why +
                      "; write \"N: 16 numbers\", such as \"2: 1,0,0,12.5,0,1,0,3,0,0,1,0,0,0,0,1\"");
    };
    if (colon == std::string::npos && files.size() > 1) wrong("there is no colon after the file's number");
    const long n = colon == std::string::npos ? 1 : parse_whole("--transform", text.substr(0, colon), 1);
    if (std::size_t(n) > files.size())
      wrong(files.size() == 1 ? "there is 1 file" : "there are " + counted(files.size(), "file"));
    // Commas, blanks and lines alike: matrices are copied from other programs.
    std::string commas;
    for (const char c : text.substr(colon + 1)) {  // npos + 1 is 0
      const bool parts = c == ',' || std::isspace(static_cast<unsigned char>(c));
      if (!parts)
        commas += c;
      else if (!commas.empty() && commas.back() != ',')
        commas += ',';
    }
    if (commas.ends_with(',')) commas.pop_back();
    const std::vector<double> numbers = parse_numbers("--transform", commas, 16);
    placed[std::size_t(n - 1)].transform = transform_of_rows(numbers);
    if (!placed[std::size_t(n - 1)].transform)
      wrong("the last row of a transform is 0 0 0 1, and it flattens nothing");
  }
  return placed;
}

std::string unused_columns(const scene::Scene& scene, const scene::SceneOptions& options) {
  if (options.read.columns.empty()) return "";
  for (const io::ReadReport& report : scene.files)
    if (report.format == "text" || report.format == "pts" || report.format == "npy" ||
        report.format == "kitti")
      return "";
  return "--columns has no effect: " + scene.files.front().format + " files name their own columns";
}

std::string missing_points(std::uint64_t missing, std::uint64_t points) {
  return std::to_string(missing) + " of " + counted(points, "point") +
         (missing == 1 ? " is missing: it lies" : " are missing: they lie") +
         " in damaged parts (--strict refuses such files)";
}

}  // namespace sfumato::cli
