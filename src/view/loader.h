// Reads scenes on a thread of its own, and selects again from what it read without reading it twice.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "session/opening.h"
#include "view/render_client.h"

namespace sfumato::view {

struct LoadJob {
  std::uint64_t id = 0;
  Request request;
  std::vector<scene::SceneFile> files;
  bool anew = false;          ///< the files changed on the disk
  bool sample_first = false;  ///< gives a sample of large files before they are read
  /// What files with levels are read for; nothing: their coarsest levels.
  std::optional<Camera> seen;
  bool has_shadows = false;  ///< then what is out of view counts too
  // What is known where nothing but the view changed.
  std::optional<Pose> pose;
  std::shared_ptr<const scene::Overview> overview;
  std::optional<copc::NodeSelection> shown;  ///< need not be read again
};

/// What was read, ready to be shown.
struct Loaded {
  std::uint64_t id = 0;
  bool is_sample = false;  ///< of files that are still being read: there is no `whole`
  bool is_first = true;    ///< of the samples
  scene::Scene whole;
  scene::Scene sample;                     ///< of at most `sample_points` points
  std::shared_ptr<const PointCloud> near;  ///< the sample's points once more, for what the hand touches
  Pose pose;
  /// Also those that are hidden; empty without a classification. Of files with levels those of the coarsest
  /// and of what views have shown since, without numbers of points.
  std::vector<ClassShare> classes;
  std::vector<std::string> scalars;
  std::vector<std::string> notes;
  std::uint64_t points_read = 0, points_shown = 0;
  Bounds box;  ///< of all points, also those that are left out
  std::string crs, formats;
  /// Files with levels are read for a view: another one shows more of them (`LoadJob::seen`).
  bool follows_view = false;
  bool is_coarse = false;  ///< more of the same view comes
  bool is_shown = false;   ///< the view shows no more than `LoadJob::shown`: there are no points here
  std::optional<copc::NodeSelection> nodes;
  std::shared_ptr<const scene::Overview> overview;
  std::optional<Failure> failure;  ///< then nothing else holds
};

/// What a scene, if there is one, can be coloured by.
std::vector<std::string> color_sources(const Loaded* scene);

class Loader {
 public:
  /// `wake` is called from the thread when there is news, and never after the loader is gone.
  explicit Loader(std::function<void()> wake);
  /// Stops what is being read. A read that hangs, as from a network path that is gone, is left to the end of
  /// the process: a window that is closed is closed.
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Whether the thread of one that is gone may still run: then a window that was closed ends the process by
  /// std::_Exit, without taking apart what that thread uses. After an error it ends as always.
  static bool has_left_work();

  /// The newest wins.
  void load(LoadJob job);
  /// Nobody waits for what is being read.
  void cancel();
  /// In their order: a sample, where there is one, or the view coarsely, then the whole or what was wrong
  /// with it.
  std::optional<Loaded> take();
  Activity activity() const;

  /// A tenth of the points, at least so many and at most so many: as many as software GL moves.
  static constexpr std::size_t least_sample = 100'000, most_sample = 250'000;
  /// Scenes up to this size stay in memory as they were read, so that a class is shown again at once.
  static constexpr std::size_t most_kept = 4'000'000;

 private:
  class Work;
  std::shared_ptr<Work> work_;  ///< the thread's as well, which may outlive the loader
  std::thread thread_;
};

}  // namespace sfumato::view
