// Several files become one scene: read, put together, reduced to what is wanted.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/prepared_cloud.h"
#include "core/selection.h"
#include "io/io.h"
#include "scene/degrees.h"

namespace sfumato::scene {

/// A file of a scene, and where its points go.
struct SceneFile {
  std::string name;
  std::optional<dmat4> transform;  ///< world from file
  bool operator==(const SceneFile&) const = default;
};

struct SceneOptions {
  io::ReadOptions read;
  Selection selection;
  std::optional<UpAxis> up;  ///< wins over what the files say
  bool keep_degrees =
      false;  ///< x and y that are degrees stay so; otherwise the scene is in metres (degrees.h)
  std::optional<LocalMetres> metres;  ///< those of an earlier scene, which is seen by the same camera
  bool operator==(const SceneOptions&) const = default;
};

/// What was read of files with levels.
struct LevelsReport {
  std::uint64_t points = 0, points_needed = 0,
                points_in_files = 0;  ///< needed: by the view, without a budget
  std::size_t nodes = 0, nodes_needed = 0, nodes_in_files = 0;
  double widest_px = 0;  ///< the widest spacing in pixels that the budget left; 0 when it left nothing out
  bool is_complete() const { return points == points_needed; }
};

/// Points from everywhere in the files.
struct Overview : PointCloud {
  /// Where the points are a random sample of all of them that the files bring, on which colours are measured:
  /// the coarse levels, which are even in space and so tell of surfaces more than a sample as sparse. Null:
  /// the points are those, and what is in view has a say.
  std::shared_ptr<const PointCloud> levels;
};

struct Scene {
  PointCloud cloud;
  std::vector<io::ReadReport> files;
  std::uint64_t points_read = 0;     ///< in the files
  std::uint64_t points_missing = 0;  ///< of those, in parts that are damaged and left out
  SelectionReport selected;
  std::optional<LocalMetres> metres;   ///< what became of x and y that were degrees
  std::vector<std::string> notes;      ///< of readers ("FILE: ..."), of putting together and of selecting
  std::vector<std::string> damage;     ///< of files, the parts that are left out, and why: a line each
  std::optional<LevelsReport> levels;  ///< of a scene that was read by its levels (scene/leveled_scene.h)
  /// Of such a scene, where it is known. What follows from the whole, as the ends of a colour map, is
  /// measured there, so that every view has the same.
  std::shared_ptr<const Overview> overview;
  /// Where the points are a part of a cloud, and others have the rest: what the whole decides
  /// (analysis/whole.h).
  std::shared_ptr<const WholeCloud> whole;
  /// Points of the others around those, of which the attributes of surfaces are computed at once
  /// (analysis::prepare_part). Nothing: only what does not need them can be drawn.
  std::optional<PointCloud> around;
  /// Where places or values chose some of the points, a sample of all: which way is up is asked of the whole.
  std::shared_ptr<const PointCloud> before_selection;
  std::vector<std::string> file_names;  ///< without folders; of several files the scalar `file` counts from 1
};

/// `io::read`, and "-" is standard input.
io::ReadResult read_file(const std::string& file, const io::ReadOptions& options = {},
                         Progress& progress = no_progress());

/// Several files get the origin of the first and the scalar `file`. `read.max_points` holds for the whole
/// scene, after the selection. Throws Error(bad_input) when a file has no points or none is left.
Scene read_scene(const std::vector<SceneFile>& files, const SceneOptions& options,
                 Progress& progress = no_progress());
Scene read_scene(const std::vector<std::string>& files, const SceneOptions& options,
                 Progress& progress = no_progress());

/// Its two halves, for whoever selects again from what was read: first all points of the files (`max_points`
/// of them where nothing is selected), then `narrow`, which keeps those that are wanted.
Scene read_all(const std::vector<SceneFile>& files, const SceneOptions& options,
               Progress& progress = no_progress());
void narrow(Scene& scene, const std::vector<SceneFile>& files, const SceneOptions& options);
/// About `points` of the points of large files, from everywhere in them, without reading the files: COPC by
/// its coarsest levels, others by `io::read_excerpt`; files that cannot be cut so are left out. Nothing when
/// that leaves none, and nothing that is wrong with a file is said: reading it does.
std::optional<Scene> read_sample(const std::vector<SceneFile>& files, const SceneOptions& options,
                                 std::size_t points, Progress& progress = no_progress());
/// Files that stand where their points say.
std::vector<SceneFile> files_of(const std::vector<std::string>& names);

/// The files that words name: folders (every file in them that can be read, by name), patterns with * ? [ ]
/// when no file has that very name, and names as they are. Throws Error(io) when a folder or a pattern names
/// nothing.
std::vector<std::string> expand_inputs(const std::vector<std::string>& words);

/// "-" as a file: what standard input holds, in a temporary file without a name while somebody keeps it. It
/// can be read once only, so whoever may need it again keeps it.
class StandardInput {
 public:
  /// The one that is kept already, or a new one.
  static std::shared_ptr<StandardInput> get();
  ~StandardInput();
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;
  /// Of the file, with all that standard input holds. Throws Cancelled when `progress` asks for it, also
  /// while nothing comes; the next call goes on from there.
  const std::string& path(const Progress& progress = no_progress());

 private:
  StandardInput();
  void take(const Progress& progress);

  std::mutex mutex_;
  int handle_ = -1;
  std::string path_;
  bool is_whole_ = false;
  std::optional<Error> failure_;
};

}  // namespace sfumato::scene
