#include "scene/scene.h"

#include "scene/assemble.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "core/error.h"
#include "core/subsample.h"
#include "io/las_fields.h"
#include "scene/leveled_scene.h"

namespace sfumato::scene {

namespace {

/// What is said of the temporary file of "-" is said of standard input.
std::string of_standard_input(std::string text, const std::string& path) {
  for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path))
    text.replace(at, path.size(), "standard input");
  return text;
}

}  // namespace

io::ReadResult read_file(const std::string& file, const io::ReadOptions& options, Progress& progress) {
  if (file != "-") return io::read(file, options, progress);
  const std::shared_ptr<StandardInput> input = StandardInput::get();
  const std::string path = input->path(progress);
  try {
    io::ReadResult result = io::read(path, options, progress);
    result.report.file = "standard input";
    for (std::string& part : result.report.damage) part = of_standard_input(part, path);
    return result;
  } catch (const Error& error) {
    throw Error(error.code(), of_standard_input(error.what(), path));
  }
}

namespace {

/// Points [first, last) came from LAS: dimensions that were left out because they are zero in all of them are
/// zero, not unknown, beside files that have them.
void restore_zeros(PointCloud& cloud, std::size_t first, std::size_t last) {
  for (const io::las::Field& dimension : io::las::standard_fields(8)) {
    ScalarField* field = dimension.is_left_out_as_zero() ? cloud.scalar(dimension.name) : nullptr;
    for (std::size_t i = first; field && i < last; ++i)
      if (std::isnan(field->values[i])) field->values[i] = float(-field->offset);
  }
}

Scene put_together(const std::vector<SceneFile>& files, const SceneOptions& options,
                   const std::function<io::ReadResult(std::size_t)>& read, bool may_be_empty) {
  Scene scene;
  std::vector<std::pair<std::size_t, std::size_t>> from_las;
  std::vector<bool> lack_colors;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i].name;
    io::ReadResult result = read(i);
    const std::string name = result.report.file.filename().string();
    for (const std::string& note : result.report.notes) scene.notes.push_back(file + ": " + note);
    for (const std::string& part : result.report.damage) {
      if (options.read.strict) throw Error(ErrorCode::bad_input, part);
      scene.damage.push_back(part + io::is_left_out);
    }
    scene.points_read += result.report.points;
    scene.points_missing += result.report.points_missing;
    scene.file_names.push_back(file == "-" ? "standard input" : name);
    if (result.cloud.empty() && !may_be_empty)
      throw Error(ErrorCode::bad_input, file + ": there is no point in it");
    const bool is_las = result.cloud.las.has_value();
    if (files[i].transform) transform(result.cloud, *files[i].transform);
    scene.files.push_back(std::move(result.report));
    if (files.size() == 1) {
      scene.cloud = std::move(result.cloud);
      break;
    }
    if (scene.files.size() > 1) {
      if (result.cloud.up != scene.cloud.up && !options.up)
        scene.notes.push_back(file + ": " + to_string(result.cloud.up) + " is up in it, " +
                              to_string(scene.cloud.up) + " in " + files[0].name +
                              ", which decides (--up says otherwise)");
      if (result.cloud.crs != scene.cloud.crs && !result.cloud.crs.empty() && !scene.cloud.crs.empty())
        scene.notes.push_back(file + ": its coordinate system is not that of " + files[0].name +
                              "; the numbers are put together as they are");
    }
    lack_colors.push_back(std::all_of(result.cloud.colors.begin(), result.cloud.colors.end(),
                                      [](const Rgba8& c) { return c.r == 0 && c.g == 0 && c.b == 0; }));
    // Tells the files of a scene apart; counts from 1 in their order.
    const float number = float(scene.files.size());
    result.cloud.set_scalar({"file", 0, std::vector<float>(result.cloud.size(), number), StoredType::uint16});
    if (is_las) from_las.emplace_back(scene.cloud.size(), scene.cloud.size() + result.cloud.size());
    append(scene.cloud, result.cloud);
  }
  if (std::count(lack_colors.begin(), lack_colors.end(), true) < std::ptrdiff_t(lack_colors.size()))
    for (std::size_t i = 0; i < lack_colors.size(); ++i)
      if (lack_colors[i])
        scene.notes.push_back(files[i].name +
                              ": has no colours beside files that have: its points are white");
  for (const auto& [first, last] : from_las) restore_zeros(scene.cloud, first, last);
  if (scene.cloud.empty())
    throw Error(
        ErrorCode::bad_input,
        files[0].name + ": no point is left in what was read of it; sfumato info shows where points are");
  if (!options.keep_degrees) scene.metres = options.metres ? options.metres : local_metres_of(scene.cloud);
  if (scene.metres) {
    scene.notes.push_back((files.size() == 1 ? files[0].name + ": " : std::string()) +
                          scene.metres->note(scene.cloud));
    scene.metres->apply(scene.cloud);
  }
  if (options.up) scene.cloud.set_up(*options.up);
  return scene;
}

/// `wanted` of all points: of each file, of which `kept` points were read, as large a share as of the others.
std::vector<std::uint32_t> even_share(const std::vector<std::uint64_t>& in_file,
                                      const std::vector<std::uint64_t>& kept, std::uint64_t wanted) {
  const double all = double(std::accumulate(in_file.begin(), in_file.end(), std::uint64_t(0)));
  std::vector<std::uint32_t> places;
  std::uint64_t first = 0, before = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    before += in_file[i];
    const auto until = std::uint64_t(std::llround(double(wanted) * double(before) / all));
    const std::uint64_t own = std::min(kept[i], until - std::min<std::uint64_t>(until, places.size()));
    if (own > 0) {
      const Subsample chosen(kept[i], own);
      for (std::uint64_t k = 0; k < own; ++k) places.push_back(std::uint32_t(first + chosen.place(k)));
    }
    first += kept[i];
  }
  return places;
}

/// Whether places, classes or values choose some of the points.
bool selects(const Selection& selection) {
  return selection.crop || selection.crop_share || !selection.show_classes.empty() ||
         !selection.filters.empty();
}

}  // namespace

void narrow(Scene& scene, const std::vector<SceneFile>& files, const SceneOptions& options) {
  constexpr std::size_t enough_for_upright = 65'536;
  if (selects(options.selection))
    scene.before_selection = std::make_shared<const PointCloud>(subsample(scene.cloud, enough_for_upright));
  const std::string whose = files.size() == 1 ? files[0].name + ": " : std::string();
  try {
    Selection selection = options.selection;
    if (selection.crop && scene.metres) selection.crop = scene.metres->moved(*selection.crop);
    const std::size_t before = scene.selected.cropped;  // of what is selected from again
    scene.selected = apply(selection, scene.cloud);
    scene.selected.cropped += before;
  } catch (const NothingSelected& error) {
    throw NothingSelected(whose + error.what());
  } catch (const Error& error) {
    throw Error(error.code(), whose + error.what());
  }
  scene.notes.insert(scene.notes.end(), scene.selected.notes.begin(), scene.selected.notes.end());
  if (options.read.max_points && scene.cloud.size() > *options.read.max_points)
    scene.cloud = subsample(scene.cloud, std::size_t(*options.read.max_points));
}

Scene assemble(const std::vector<SceneFile>& files, const SceneOptions& options,
               const std::function<io::ReadResult(std::size_t)>& read, bool may_be_empty) {
  Scene scene = put_together(files, options, read, may_be_empty);
  narrow(scene, files, options);
  return scene;
}

std::vector<SceneFile> files_of(const std::vector<std::string>& names) {
  std::vector<SceneFile> files;
  for (const std::string& name : names) files.push_back({name, {}});
  return files;
}

Scene read_scene(const std::vector<std::string>& names, const SceneOptions& options, Progress& progress) {
  return read_scene(files_of(names), options, progress);
}

Scene read_all(const std::vector<SceneFile>& files, const SceneOptions& options, Progress& progress) {
  io::ReadOptions read = options.read;
  // Whoever asks for a million points of a box wants them in the box.
  if (selects(options.selection)) read.max_points.reset();
  std::vector<std::uint64_t> in_file, kept;
  const auto read_one = [&](std::size_t i) {
    io::ReadResult result = read_file(files[i].name, read, progress);
    in_file.push_back(result.report.points);
    kept.push_back(result.cloud.size());
    return result;
  };
  Scene scene = put_together(files, options, read_one, false);
  if (read.max_points && kept.size() > 1 && scene.cloud.size() > *read.max_points)
    scene.cloud = select(scene.cloud, even_share(in_file, kept, *read.max_points));
  return scene;
}

std::optional<Scene> read_sample(const std::vector<SceneFile>& files, const SceneOptions& options,
                                 std::size_t points, Progress& progress) {
  try {
    if (const auto leveled = LeveledScene::open(files, options, default_memory, true)) {
      return leveled->points() < 4 * points ? std::nullopt : std::optional(leveled->coarse(points, progress));
    }
    std::vector<double> bytes;
    double all_bytes = 0;
    for (const SceneFile& file : files) {
      std::error_code error;
      const auto size = std::filesystem::file_size(file.name, error);
      all_bytes += bytes.emplace_back(error ? 0.0 : double(size));
    }
    std::vector<SceneFile> cut;
    std::vector<io::ReadResult> parts;
    for (std::size_t i = 0; i < files.size(); ++i) {
      const auto share = std::size_t(double(points) * bytes[i] / std::max(1.0, all_bytes));
      if (share == 0) continue;  // nor is standard input read twice
      if (auto part = io::read_excerpt(files[i].name, share, options.read, progress)) {
        cut.push_back(files[i]);
        parts.push_back(std::move(*part));
      }
    }
    if (cut.empty()) return std::nullopt;
    return assemble(cut, options, [&](std::size_t i) { return std::move(parts[i]); });
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

Scene read_scene(const std::vector<SceneFile>& files, const SceneOptions& options, Progress& progress) {
  Scene scene = read_all(files, options, progress);
  narrow(scene, files, options);
  return scene;
}

}  // namespace sfumato::scene
