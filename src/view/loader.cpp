#include "view/loader.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "core/error.h"
#include "io/record_tap.h"
#include "scene/assemble.h"
#include "session/notes.h"

namespace sfumato::view {
namespace {

std::vector<ClassShare> classes_of(const PointCloud& cloud) {
  std::vector<ClassShare> shares;
  const ScalarField* field = cloud.scalar("classification");
  if (!field) return shares;
  std::map<int, std::size_t> counts;
  for (std::size_t i = 0; i < field->values.size(); ++i) ++counts[int(field->value(i))];
  for (const auto& [id, points] : counts) shares.push_back({id, points});
  return shares;
}

/// Spacing of the first picture of a view, in pixels, and the points that are worth waiting for without it.
constexpr double coarse_px = 3;
constexpr std::uint64_t least_coarse = 2'000'000;

/// How long a closed window's program waits for a read to notice.
constexpr std::chrono::seconds patience{2};
std::atomic<bool> left_work = false;

}  // namespace

class Loader::Work {
 public:
  explicit Work(std::function<void()> wake) : wake_(std::move(wake)) {}
  void run();
  void stop();
  /// Whether `run` came to its end.
  bool ends_within(std::chrono::seconds time);

  void load(LoadJob job);
  void cancel();
  std::optional<Loaded> take();
  Activity activity() const;

 private:
  class Watch;
  /// What all points of a job's files are read by.
  struct Key {
    std::vector<scene::SceneFile> files;
    std::vector<std::string> columns;
    std::optional<std::uint64_t> max_points;
    bool vertices = false;
    std::optional<UpAxis> up;
    bool operator==(const Key&) const = default;
  };
  /// Tells files from those that took their names since: inode, size, time in seconds and nanoseconds of
  /// each.
  using Stamps = std::vector<std::array<std::int64_t, 4>>;
  using LevelsKey = std::pair<Key, Stamps>;
  static Key key_of(const LoadJob& job);
  static Stamps stamps_of(const std::vector<scene::SceneFile>& files);
  void serve();
  Loaded read(const LoadJob& job, Watch& watch);
  Loaded read_levels(const LoadJob& job, scene::LeveledScene levels, const LevelsKey& key, Watch& watch);
  scene::Scene read_whole(const LoadJob& job, scene::SceneOptions options, Watch& watch);
  void give_sample(const LoadJob& job, Watch& watch);
  void give_more(const LoadJob& job);
  Loaded sample_of(const LoadJob& job, scene::Scene scene);
  void give(Loaded loaded);
  /// Shares, sample and words about a scene that is selected and stands upright.
  Loaded finish(scene::Scene scene, Loaded out);
  void wake() {
    if (!stop_) wake_();
  }

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable work_, end_;
  std::optional<LoadJob> job_;
  std::deque<Loaded> loaded_;
  Activity activity_;
  std::atomic<bool> stop_{false}, cancel_{false};
  bool ended_ = false;
  std::optional<scene::Scene> kept_;  ///< of the thread alone
  Key kept_key_;
  // Of files with levels, of the thread alone.
  std::shared_ptr<io::ChunkCache> nodes_;
  std::optional<LevelsKey> nodes_key_;
  std::vector<ClassShare> classes_;  ///< of their coarse levels and what was read since, whatever is selected
  std::shared_ptr<scene::StandardInput> standard_input_;  ///< kept, once it was named: it comes only once
  PointCloud first_sample_;                               ///< some of it, until the file is read
  std::optional<UpAxis> sample_up_;
  dvec3 sample_vertical_{0};
  std::unique_ptr<io::RecordTap> tap_;
};

class Loader::Work::Watch final : public Progress {
 public:
  explicit Watch(Work& work) : work_(work) {}
  void update(double fraction, std::string_view text) override {
    bool is_due = false;
    {
      const std::lock_guard lock(work_.mutex_);
      work_.activity_ = {fraction, std::string(text)};
      const auto now = std::chrono::steady_clock::now();
      is_due = now - last_wake_ > std::chrono::milliseconds(100);
      if (is_due) last_wake_ = now;
    }
    if (is_due) work_.wake();
    more(fraction);
  }
  bool cancelled() const override { return work_.stop_ || work_.cancel_; }

  /// Called now and then while points are read, from a thread that reads them.
  std::function<void()> on_more;

 private:
  void more(double fraction) {
    const std::unique_lock alone(more_mutex_, std::try_to_lock);
    const auto now = std::chrono::steady_clock::now();
    if (!alone || !on_more || fraction <= 0 || fraction > 0.9 || now - last_more_ < more_pause || cancelled())
      return;
    on_more();
    last_more_ = std::chrono::steady_clock::now();
  }

  static constexpr std::chrono::milliseconds more_pause{1500};
  std::mutex more_mutex_;
  std::chrono::steady_clock::time_point last_more_ = std::chrono::steady_clock::now();
  Work& work_;
  std::chrono::steady_clock::time_point last_wake_{};
};

Loader::Work::Key Loader::Work::key_of(const LoadJob& job) {
  const scene::SceneOptions& points = job.request.points;
  return {job.files, points.read.columns, points.read.max_points, job.request.vertices, points.up};
}

Loader::Work::Stamps Loader::Work::stamps_of(const std::vector<scene::SceneFile>& files) {
  Stamps stamps;
  for (const scene::SceneFile& file : files) {
    struct stat found {};
    if (::stat(file.name.c_str(), &found) == 0)
      stamps.push_back({std::int64_t(found.st_ino), std::int64_t(found.st_size),
                        std::int64_t(found.st_mtim.tv_sec), std::int64_t(found.st_mtim.tv_nsec)});
  }
  return stamps;
}

void Loader::Work::load(LoadJob job) {
  const std::lock_guard lock(mutex_);
  job_ = std::move(job);
  loaded_.clear();
  cancel_ = true;
  work_.notify_all();
}

void Loader::Work::cancel() {
  const std::lock_guard lock(mutex_);
  job_.reset();
  loaded_.clear();
  cancel_ = true;
}

std::optional<Loaded> Loader::Work::take() {
  const std::lock_guard lock(mutex_);
  if (loaded_.empty()) return std::nullopt;
  Loaded first = std::move(loaded_.front());
  loaded_.pop_front();
  return first;
}

Activity Loader::Work::activity() const {
  const std::lock_guard lock(mutex_);
  return activity_;
}

void Loader::Work::give(Loaded loaded) {
  {
    const std::lock_guard lock(mutex_);
    if (job_) return;  // nobody waits for this one any more
    loaded_.push_back(std::move(loaded));
    activity_ = {};
  }
  wake();
}

Loaded Loader::Work::sample_of(const LoadJob& job, scene::Scene scene) {
  Loaded out;
  out.id = job.id;
  out.is_sample = true;
  out.is_first = !sample_up_;
  Request request = job.request;
  if (sample_up_) request.points.up = sample_up_;  // later samples stand as the first does
  scene.levels.reset();
  Opening opening(request, std::move(scene));
  out.pose = opening.pose();
  if (sample_up_) out.pose.upright.vertical = sample_vertical_;
  sample_up_ = out.pose.upright.up, sample_vertical_ = out.pose.upright.vertical;
  out = finish(opening.take(), std::move(out));
  out.whole = {};
  out.points_shown = out.sample.cloud.size();
  out.notes.clear();  // those of the whole will say it
  return out;
}

void Loader::Work::give_sample(const LoadJob& job, Watch& watch) {
  std::optional<scene::Scene> sample =
      scene::read_sample(job.files, job.request.scene_options(), most_sample, watch);
  if (!sample) return;
  first_sample_ = subsample(sample->cloud, most_sample / 4);  // room for what comes by
  Loaded out = sample_of(job, std::move(*sample));
  watch.check();
  give(std::move(out));
}

/// What is read so far, with the first sample.
void Loader::Work::give_more(const LoadJob& job) {
  try {
    std::optional<io::ReadResult> more = tap_->so_far();
    if (!more) return;
    scene::Scene scene = scene::assemble(job.files, job.request.scene_options(),
                                         [&](std::size_t) { return std::move(*more); });
    append(scene.cloud, first_sample_);
    Loaded out = sample_of(job, std::move(scene));
    give(std::move(out));
  } catch (const std::exception&) {
    // The whole will come, or say why not.
  }
}

/// Too much to hold: what a view needs, the coarse levels before there is one.
Loaded Loader::Work::read_levels(const LoadJob& job, scene::LeveledScene levels, const LevelsKey& key,
                                 Watch& watch) {
  // What was decoded for the last views is not decoded again.
  if (job.anew || nodes_key_ != key) {
    nodes_ = std::make_shared<io::ChunkCache>(job.request.memory / scene::share_of_kept_nodes);
    nodes_key_.reset();  // until the classes are known: this may be cancelled
  }
  levels.keep_nodes(nodes_);
  std::optional<scene::Scene> all;
  if (!nodes_key_) {
    // What is selected is not all that there is to select from.
    all = levels.unselected_overview(watch);
    classes_ = classes_of(all->cloud);
    for (ClassShare& each : classes_) each.points = 0;  // coarse levels are no fair sample of the numbers
    nodes_key_ = key;
  }
  if (job.pose) levels.set_overview(job.overview);
  Opening opening = job.pose ? Opening(job.request, std::move(levels), *job.pose)
                             : Opening(job.request, std::move(levels), watch, std::move(all));
  Loaded known;
  known.id = job.id;
  known.follows_view = true;
  known.is_first = !job.seen;
  known.box = opening.levels().bounds();
  known.pose = opening.pose();
  scene::Scene overview = opening.take();
  known.overview = job.pose ? job.overview : overview.overview;
  const auto with = [&](scene::Scene scene, const copc::NodeSelection& nodes, bool is_coarse) {
    Loaded out = known;
    out.nodes = nodes;
    out.is_coarse = is_coarse;
    for (const ClassShare& each : classes_of(scene.cloud))
      if (std::none_of(classes_.begin(), classes_.end(),
                       [&](const ClassShare& c) { return c.id == each.id; }))
        classes_.push_back({each.id, 0});
    std::sort(classes_.begin(), classes_.end(),
              [](const ClassShare& a, const ClassShare& b) { return a.id < b.id; });
    out.classes = classes_;
    return finish(std::move(scene), std::move(out));
  };
  if (!job.seen) return with(std::move(overview), {}, true);
  overview = {};
  const std::vector<copc::View> views{{*job.seen, false}};
  const copc::NodeSelection fine = opening.levels().select(views, job.has_shadows),
                            coarse = opening.levels().select(views, job.has_shadows, coarse_px);
  if (job.shown && fine.reads_like(*job.shown)) {
    known.is_shown = true;
    return known;
  }
  if (fine.points > least_coarse && coarse.points < fine.points / 2)
    give(with(opening.read(coarse, watch), coarse, true));
  return with(opening.read(fine, watch), fine, false);
}

/// All points, whatever is selected. A file shows a sample of itself meanwhile.
scene::Scene Loader::Work::read_whole(const LoadJob& job, scene::SceneOptions options, Watch& watch) {
  for (const scene::SceneFile& file : job.files)
    if (file.name == "-" && !standard_input_) standard_input_ = scene::StandardInput::get();
  if (job.sample_first) give_sample(job, watch);
  watch.update(0, "reading");
  if (job.sample_first && job.files.size() == 1) {
    tap_ = std::make_unique<io::RecordTap>(most_sample);
    options.read.tap = tap_.get();
    watch.on_more = [&] { give_more(job); };
  }
  scene::Scene scene = scene::read_all(job.files, options, watch);
  watch.on_more = nullptr;
  tap_.reset();
  first_sample_ = {};
  return scene;
}

Loaded Loader::Work::read(const LoadJob& job, Watch& watch) {
  tap_.reset(), first_sample_ = {}, sample_up_.reset();  // of a file whose reading was cancelled
  const Key key = key_of(job);
  const bool is_kept = !job.anew && kept_ && key == kept_key_;
  if (!is_kept) kept_.reset(), watch.update(0, "reading");
  const scene::SceneOptions options = job.request.scene_options();
  if (!is_kept) {
    const LevelsKey levels_key(key, stamps_of(job.files));
    if (auto levels = scene::LeveledScene::open(job.files, options, job.request.memory))
      return read_levels(job, std::move(*levels), levels_key, watch);
  }
  nodes_.reset(), nodes_key_.reset();  // of other files
  scene::Scene scene = is_kept ? *kept_ : read_whole(job, options, watch);
  Loaded out;
  out.id = job.id;
  out.classes = classes_of(scene.cloud);
  out.box = bounds(scene.cloud);
  // A subsample of nothing selected is not what a selection starts from.
  if (!is_kept && scene.cloud.size() <= most_kept && !options.read.max_points) kept_ = scene, kept_key_ = key;
  scene::narrow(scene, job.files, options);
  Opening opening(job.request, std::move(scene), watch);
  out.pose = opening.pose();
  return finish(opening.take(), std::move(out));
}

Loaded Loader::Work::finish(scene::Scene scene, Loaded out) {
  if (out.classes.empty()) out.classes = classes_of(scene.cloud);
  if (out.box.diagonal() == 0) out.box = bounds(scene.cloud);
  for (const ScalarField& field : scene.cloud.scalars) out.scalars.push_back(field.name);
  out.notes = notes_of_reading(scene);
  if (out.pose.subject.room)
    out.notes.push_back(worded(note_on_cutaway(!out.pose.subject.room->outside.empty()), FrontEnd::viewer));
  if (const std::string note = note_on_levels(scene, FrontEnd::viewer); !note.empty())
    out.notes.push_back(note);
  out.points_read = scene.points_read;
  out.points_shown = scene.cloud.size();
  out.crs = scene.cloud.crs;
  for (const io::ReadReport& file : scene.files)
    if (out.formats.find(file.format) == std::string::npos)
      out.formats += (out.formats.empty() ? "" : ", ") + file.format;
  out.sample.file_names = scene.file_names;
  out.sample.cloud =
      subsample(scene.cloud,
                out.is_sample ? most_sample : std::clamp(scene.cloud.size() / 10, least_sample, most_sample));
  out.near = std::make_shared<const PointCloud>(out.sample.cloud);
  out.whole = std::move(scene);
  return out;
}

void Loader::Work::serve() {
  while (!stop_) {
    LoadJob job;
    {
      std::unique_lock lock(mutex_);
      work_.wait(lock, [&] { return stop_ || job_; });
      if (stop_) return;
      job = *std::exchange(job_, std::nullopt);
      cancel_ = false;
    }
    Watch watch(*this);
    Loaded loaded;
    try {
      loaded = read(job, watch);
    } catch (const Cancelled&) {
      const std::lock_guard lock(mutex_);
      activity_ = {};
      continue;
    } catch (...) {
      loaded.failure = failure_of(job.id, ErrorCode::io);
    }
    loaded.id = job.id;
    give(std::move(loaded));
  }
}

void Loader::Work::run() {
  serve();
  const std::lock_guard lock(mutex_);
  ended_ = true;
  end_.notify_all();
}

void Loader::Work::stop() {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  work_.notify_all();
}

bool Loader::Work::ends_within(std::chrono::seconds time) {
  std::unique_lock lock(mutex_);
  return end_.wait_for(lock, time, [&] { return ended_; });
}

std::vector<std::string> color_sources(const Loaded* scene) {
  std::vector<std::string> sources{"auto", "rgb", "elevation", "normal", "clay", "density"};
  if (!scene) return sources;
  for (const std::string& scalar : scene->scalars)
    if (std::find(sources.begin(), sources.end(), scalar) == sources.end()) sources.push_back(scalar);
  return sources;
}

Loader::Loader(std::function<void()> wake)
    : work_(std::make_shared<Work>(std::move(wake))), thread_([work = work_] { work->run(); }) {}

Loader::~Loader() {
  work_->stop();
  if (work_->ends_within(patience)) {
    thread_.join();
  } else {
    thread_.detach();
    left_work = true;
  }
}

bool Loader::has_left_work() { return left_work; }

void Loader::load(LoadJob job) { work_->load(std::move(job)); }
void Loader::cancel() { work_->cancel(); }
std::optional<Loaded> Loader::take() { return work_->take(); }
Activity Loader::activity() const { return work_->activity(); }

}  // namespace sfumato::view
