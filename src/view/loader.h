// Reads scenes on a thread of its own, and selects again from what it read without reading it twice.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "io/record_tap.h"
#include "scene/leveled_scene.h"
#include "session/session.h"
#include "view/painter.h"

namespace sfumato::view {

struct LoadJob {
  std::uint64_t id = 0;
  std::vector<scene::SceneFile> files;
  scene::SceneOptions options;
  bool cutaway = true;                           ///< rooms are seen without the walls before them
  std::uint64_t memory = scene::default_memory;  ///< of the points of COPC files
  bool anew = false;                             ///< the files changed on the disk
  bool sample_first = false;                     ///< gives a sample of large files before they are read
  /// What files with levels are read for; nothing: their coarsest levels.
  std::optional<Camera> seen;
  bool has_shadows = false;  ///< then what is out of view counts too
  // What is known where nothing but the view changed.
  std::optional<Pose> pose;
  std::shared_ptr<const PointCloud> overview;
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
  std::vector<ClassShare> classes;  ///< also those that are hidden; empty without a classification
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
  std::shared_ptr<const PointCloud> overview;
  std::optional<Failure> failure;  ///< then nothing else holds
};

class Loader {
 public:
  explicit Loader(std::function<void()> wake);
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// The newest wins.
  void load(LoadJob job);
  /// Nobody waits for what is being read.
  void call_off();
  /// In their order: a sample, where there is one, or the view coarsely, then the whole or what was wrong
  /// with it.
  std::optional<Loaded> take();
  Activity activity() const;

  /// A tenth of the points, at least so many and at most so many: as many as software GL moves.
  static constexpr std::size_t least_sample = 100'000, most_sample = 250'000;
  /// Scenes up to this size stay in memory as they were read, so that a class is shown again at once.
  static constexpr std::size_t most_kept = 4'000'000;

 private:
  class Watch;
  void run();
  Loaded read(const LoadJob& job, Watch& watch);
  Loaded read_levels(const LoadJob& job, scene::LeveledScene files, Watch& watch);
  void give_sample(const LoadJob& job, Watch& watch);
  void give_more(const LoadJob& job);
  Loaded sample_of(const LoadJob& job, scene::Scene scene);
  void give(Loaded loaded);
  /// Shares, sample and words about a scene that is selected and stands upright.
  Loaded finish(scene::Scene scene, Loaded out);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::optional<LoadJob> job_;
  std::deque<Loaded> loaded_;
  Activity activity_;
  std::atomic<bool> stop_{false}, cancel_{false};
  std::optional<scene::Scene> kept_;  ///< of the thread alone
  std::string kept_key_;
  // Of files with levels, of the thread alone.
  std::shared_ptr<io::ChunkCache> nodes_;
  std::string nodes_key_;
  PointCloud first_sample_;  ///< some of it, until the file is read
  std::optional<UpAxis> sample_up_;
  std::unique_ptr<io::RecordTap> tap_;
  std::thread thread_;
};

}  // namespace sfumato::view
