// Building in two passes over the points. The first reads the files and sorts the records into bins, the
// cells of a coarse level of the octree; what memory does not hold waits on the disk. The second makes the
// nodes of one stretch of bins after the other, as many at once as memory and threads allow; the roots of the
// stretches are joined to the levels above.
#include "copc/build.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>

#include "copc/attributes.h"
#include "copc/bins.h"
#include "copc/file_writer.h"
#include "copc/ordered_output.h"
#include "copc/sources.h"
#include "core/subsample.h"

namespace sfumato::copc {
namespace {

// Of the memory: work at hand, and roots that wait (bins.h has the rest).
constexpr double share_of_work = 0.4, share_of_roots = 0.1;
// Points of a stretch made at once: enough to be worth a start, few enough for all threads to have some.
constexpr std::uint64_t most_at_once = 1 << 20;
// A stretch takes its records, their places, order and marks, and what is gathered and compressed of them.
constexpr std::uint64_t work_per_point = 40, work_per_stretch = 24 << 20;
// Of what is computed: places, their order, neighbours and results (memory.h of analysis).
constexpr std::uint64_t work_of_attributes = 160;
constexpr int most_levels_at_once = 6;

struct FalseBounds {
  std::string name;
};

class Builder {
 public:
  Builder(std::filesystem::path output, const BuildOptions& options, Progress& progress)
      : output_(std::move(output)),
        options_(options),
        progress_(progress),
        gate_(std::uint64_t(share_of_work * double(options.memory))) {}

  BuildReport run(const std::vector<std::filesystem::path>& files) {
    open(files);
    const std::optional<Bounds> claimed = claimed_bounds();
    const bool must_count = options_.box && options_.max_points;
    if (!claimed || must_count)
      scan();
    else
      box_ = *claimed;
    prepare();
    try {
      read_points();
    } catch (const FalseBounds& lie) {
      report_.notes.push_back(lie.name +
                              ": points lie outside the box that its header names; it was read twice");
      scan();
      prepare();
      read_points();
    }
    if (points_ == 0)
      throw Error(ErrorCode::bad_input, options_.box
                                            ? "no point lies in --box; sfumato info FILE shows where they are"
                                            : sources_[0]->name + ": there is no point in it");
    make_nodes();
    report_.points = points_;
    report_.bytes = file_->finish(cube_, summary_);
    report_.nodes = file_->nodes();
    report_.levels = file_->levels();
    report_.spacing = cube_.size / grid_size;
    return std::move(report_);
  }

 private:
  struct Reading {
    std::size_t source, part;
    std::uint64_t first;  ///< of all points, or of those in the box once they are counted
  };

  void open(const std::vector<std::filesystem::path>& files) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      progress_.check();
      progress_.update(double(i) / double(files.size()), "opening files");
      sources_.push_back(open_source(files[i], output_, options_.memory / 2, progress_));
      const Source& source = *sources_.back();
      for (const std::string& note : source.notes) report_.notes.push_back(source.name + ": " + note);
      for (std::size_t part = 0; part < source.parts().size(); ++part) {
        readings_.push_back({i, part, report_.points_read});
        report_.points_read += source.parts()[part].count;
      }
    }
    if (report_.points_read == 0)
      throw Error(ErrorCode::bad_input, sources_[0]->name + ": there is no point in it");
    in_box_ = report_.points_read;
    unite_colors();
  }

  /// Files of 8, 12 and 16 bits, and without colours, side by side: 16 bits, and white for those without.
  void unite_colors() {
    color_bits_.assign(sources_.size(), std::nullopt);
    if (sources_.size() < 2) return;
    std::vector<int> bits;
    for (const auto& source : sources_) bits.push_back(color_bits_of(*source, progress_));
    const auto [least, most] = std::minmax_element(bits.begin(), bits.end());
    if (*least == *most) return;
    for (std::size_t i = 0; i < bits.size(); ++i) {
      color_bits_[i] = bits[i];
      if (bits[i] == 0)
        report_.notes.push_back(sources_[i]->name +
                                ": has no colours beside files that have: its points are white");
      else if (bits[i] < 16)
        report_.notes.push_back(sources_[i]->name + ": its colours are " + std::to_string(bits[i]) +
                                "-bit and are brought to 16 bits");
    }
  }

  std::optional<Bounds> claimed_bounds() const {
    std::optional<Bounds> all;
    for (const auto& source : sources_) {
      if (source->header().count == 0) continue;
      std::optional<Bounds> box = source->bounds();
      if (!box) return std::nullopt;
      // Headers round, and some writers keep fewer digits than coordinates have.
      const dvec3 step = glm::abs(source->header().scale);
      box->min -= step, box->max += step;
      if (all)
        all->min = glm::min(all->min, box->min), all->max = glm::max(all->max, box->max);
      else
        all = box;
    }
    return all;
  }

  bool is_wanted(const dvec3& world) const {
    if (!options_.box) return true;
    for (int axis = 0; axis < 3; ++axis)
      if (!(world[axis] >= options_.box->min[axis] && world[axis] <= options_.box->max[axis])) return false;
    return true;
  }

  static dvec3 world_of(const std::uint8_t* record, const io::las::Header& header) {
    dvec3 world;
    for (int axis = 0; axis < 3; ++axis)
      world[axis] = io::las::get<std::int32_t>(record + 4 * axis) * header.scale[axis] + header.offset[axis];
    return world;
  }

  /// Where the wanted points really are, and how many.
  void scan() {
    std::vector<std::uint64_t> counts(readings_.size(), 0);
    std::vector<Bounds> boxes(readings_.size());
    io::las::parallel_tasks(
        readings_.size(), progress_, "looking for the points' bounds", [&](std::size_t i) {
          const Source& source = *sources_[readings_[i].source];
          source.read(readings_[i].part, [&](std::uint64_t, const std::uint8_t* records, std::size_t count) {
            progress_.check();
            for (std::size_t k = 0; k < count; ++k) {
              const dvec3 world = world_of(records + k * source.header().record_length, source.header());
              if (!is_wanted(world)) continue;
              boxes[i].min = counts[i] ? glm::min(boxes[i].min, world) : world;
              boxes[i].max = counts[i] ? glm::max(boxes[i].max, world) : world;
              ++counts[i];
            }
          });
        });
    in_box_ = 0;
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      readings_[i].first = in_box_;
      if (counts[i] == 0) continue;
      if (in_box_ == 0) box_ = boxes[i];
      box_.min = glm::min(box_.min, boxes[i].min), box_.max = glm::max(box_.max, boxes[i].max);
      in_box_ += counts[i];
    }
    if (in_box_ == 0)
      throw Error(ErrorCode::bad_input, "no point lies in --box; sfumato info FILE shows where they are");
    is_scanned_ = true;
  }

  void prepare() {
    Bounds box = box_;
    if (options_.box && !is_scanned_) {
      box.min = glm::max(box.min, options_.box->min);
      box.max = glm::min(box.max, options_.box->max);
      for (int axis = 0; axis < 3; ++axis)
        if (box.min[axis] > box.max[axis])
          throw Error(ErrorCode::bad_input, "no point lies in --box; sfumato info FILE shows where they are");
    }
    std::vector<io::las::Header> headers;
    std::vector<std::string> names;
    for (const auto& source : sources_) {
      headers.push_back(source->header());
      names.push_back(source->name);
    }
    schema_ = choose_schema(headers, names, box);
    add_computed_fields(schema_, options_.attributes);
    if (options_.average_colors && schema_.format < 7)
      schema_.notes.push_back("the files have no colours to average");
    report_.notes.insert(report_.notes.end(), schema_.notes.begin(), schema_.notes.end());
    maps_.clear();
    bool is_exact = true;
    for (std::size_t i = 0; i < headers.size(); ++i)
      is_exact &= maps_.emplace_back(headers[i], schema_, color_bits_[i]).is_exact();
    if (!is_exact)
      report_.notes.push_back(
          "the files are stored in different steps: points move by up to half of the finest");
    cube_ = Cube::around(box, schema_.scale);
    locator_.emplace(schema_, cube_);
    points_ = 0;
    wanted_ = std::min<std::uint64_t>(in_box_, options_.max_points.value_or(in_box_));
    const double work = share_of_work * double(options_.memory) / 2;
    at_once_ = std::clamp<std::uint64_t>(std::uint64_t(work) / (schema_.record_length + work_of_a_point()),
                                         leave_room, most_at_once);
    refuse_small_disk();
    file_.emplace(output_,
                  schema_);  // now, as an output that cannot be written should not take an hour to say so
  }

  void refuse_small_disk() const {
    const std::uint64_t needed = wanted_ * schema_.record_length;
    if (double(needed) <= share_of_bins * double(options_.memory) || options_.box) return;
    struct statvfs disk {};
    const std::filesystem::path folder = output_.has_parent_path() ? output_.parent_path() : ".";
    if (::statvfs(folder.c_str(), &disk) != 0) return;
    const double room = double(disk.f_bavail) * double(disk.f_frsize);
    if (room >= double(needed)) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  ": the build needs about %.3g GB beside it for a while, and %.3g GB are free; ",
                  1.3 * double(needed) / 1e9, room / 1e9);
    throw Error(ErrorCode::io, output_.string() + text + "free room or write to another disk");
  }

  int levels_for(std::uint64_t points) const {
    int levels = 0;
    if (points <= at_once_) return 0;
    // Points lie on surfaces mostly: a level has four times as many cells with points as the one above.
    for (std::uint64_t bins = 1; bins * points_per_bin < points && levels < most_levels_at_once; bins *= 4)
      ++levels;
    return std::max(levels, 1);
  }

  std::unique_ptr<Bins> new_bins(const Key& region, int level) const {
    return std::make_unique<Bins>(region, level, output_, options_.memory, schema_.computes() && level > 0);
  }

  void read_points() {
    bin_level_ = levels_for(wanted_);
    bins_ = new_bins(Key{}, bin_level_);
    std::atomic<std::uint64_t> kept{0};
    const Subsample all(in_box_, wanted_);
    io::las::parallel_tasks(readings_.size(), progress_, "reading points", [&](std::size_t i) {
      const Reading& reading = readings_[i];
      const Source& source = *sources_[reading.source];
      const RecordMap& map = maps_[reading.source];
      const dvec3 low = box_.min, high = box_.max;
      std::uint64_t number = reading.first;
      Sorter sorter(*bins_, *locator_, schema_.record_length);
      source.read(reading.part, [&](std::uint64_t, const std::uint8_t* records, std::size_t count) {
        progress_.check();
        std::uint64_t taken = 0;
        for (std::size_t k = 0; k < count; ++k) {
          const std::uint8_t* record = records + k * source.header().record_length;
          const dvec3 world = world_of(record, source.header());
          if (!is_wanted(world)) continue;
          for (int axis = 0; axis < 3; ++axis)
            if (!(world[axis] >= low[axis] && world[axis] <= high[axis])) throw FalseBounds{source.name};
          if (!all.takes(number++)) continue;
          map.convert(record, sorter.next());
          sorter.put();
          ++taken;
        }
        kept += taken;
        sorter.flush();
      });
    });
    points_ = kept;
  }

  /// The bins below `key` in order, cut into stretches that are made at once; `heavy` are bins too large for
  /// that.
  struct Plan {
    struct Stretch {
      Key key;
      std::uint64_t points;
      std::vector<Key> bins;
    };
    std::vector<Stretch> stretches, heavy;
  };

  void cut(const Key& key, std::span<const std::pair<Key, std::uint64_t>> bins, int level, Plan& plan) const {
    std::uint64_t points = 0;
    for (const auto& bin : bins) points += bin.second / schema_.record_length;
    if (points == 0) return;
    if (points <= at_once_ || key.level == level) {
      Plan::Stretch stretch{key, points, {}};
      for (const auto& bin : bins) stretch.bins.push_back(bin.first);
      (points <= at_once_ || key.level >= deepest_level ? plan.stretches : plan.heavy)
          .push_back(std::move(stretch));
      return;
    }
    std::array<std::vector<std::pair<Key, std::uint64_t>>, 8> children;
    const int shift = level - key.level - 1;
    for (const auto& bin : bins)
      children[(bin.first.x >> shift & 1) | (bin.first.y >> shift & 1) << 1 | (bin.first.z >> shift & 1) << 2]
          .push_back(bin);
    for (unsigned octant = 0; octant < 8; ++octant) cut(key.child(octant), children[octant], level, plan);
  }

  std::uint64_t work_of_a_point() const {
    return work_per_point + (schema_.computes() ? work_of_attributes : 0);
  }
  std::uint64_t work_of(std::uint64_t points) const {
    const std::uint64_t sampled = std::min<std::uint64_t>(points, 2 * RecordSample::most);
    return points * (schema_.record_length + work_of_a_point()) + work_per_stretch +
           2 * sampled * (schema_.record_length + sizeof(std::uint64_t));
  }

  void make_nodes() {
    roots_ = std::make_unique<Spool>(output_.parent_path(), output_,
                                     std::uint64_t(share_of_roots * double(options_.memory)));
    make_region(*bins_);
    bins_.reset();
    // What nobody took is the root's own.
    NodeMaker maker(schema_, *locator_, progress_, options_.average_colors);
    maker.encode(Key{}, maker.add(roots_->load(Key{})));
    for (const EncodedNode& node : maker.nodes) file_->append(node);
    summary_.add(maker.summary);
    add_sample();
  }

  void add_sample() {
    NodeMaker maker(schema_, *locator_, progress_);
    maker.encode(Key{}, maker.add(summary_.sample.first(RecordSample::size_for(points_))));
    if (!maker.nodes.empty()) file_->set_sample(std::move(maker.nodes.front()));
  }

  /// Every node below `region`, whose own points come to lie in `roots_`.
  void make_region(Bins& bins) {
    Plan plan;
    const auto all = bins.points.bins();
    cut(bins.region, all, bins.level, plan);
    std::vector<Key> done;
    for (const Plan::Stretch& heavy : plan.heavy) {
      divide(heavy, bins);
      done.push_back(heavy.key);
    }
    OrderedOutput output(*file_, summary_);
    io::las::parallel_tasks(plan.stretches.size(), progress_, "building levels", [&](std::size_t i) {
      const Plan::Stretch& stretch = plan.stretches[i];
      const Gate::Pass pass(gate_, work_of(stretch.points));
      progress_.check();
      NodeMaker maker(schema_, *locator_, progress_, options_.average_colors);
      std::vector<std::uint8_t> records;
      if (stretch.bins.size() == 1) {
        records = bins.points.load(stretch.bins[0]);
      } else {
        records.reserve(stretch.points * schema_.record_length);
        for (const Key& key : stretch.bins) {
          const std::vector<std::uint8_t> bytes = bins.points.load(key);
          records.insert(records.end(), bytes.begin(), bytes.end());
        }
      }
      if (schema_.computes()) compute_fields(schema_, records, halo_of(stretch, bins), progress_);
      maker.take(std::move(records));
      roots_->append(stretch.key, maker.records_of(maker.build(stretch.key)));
      output.deliver(i, maker);
    });
    for (const Plan::Stretch& stretch : plan.stretches) done.push_back(stretch.key);
    join_up(bins.region, std::move(done));
  }

  /// What lies around a stretch, once, and without what lies in it.
  std::vector<std::uint8_t> halo_of(const Plan::Stretch& stretch, Bins& bins) const {
    std::vector<std::uint8_t> halo;
    if (!bins.halos) return halo;
    const std::size_t length = schema_.record_length;
    for (const Key& key : stretch.bins) {
      const std::vector<std::uint8_t> bytes = bins.halos->load(key);
      for (auto at = bytes.begin(); at != bytes.end(); at += std::ptrdiff_t(length))
        if ((*locator_)(&*at).node(stretch.key.level) != stretch.key)
          halo.insert(halo.end(), at, at + std::ptrdiff_t(length));
    }
    if (stretch.bins.size() == 1) return halo;
    // One near an edge is a neighbour of several bins.
    std::vector<const std::uint8_t*> order;
    for (std::size_t at = 0; at < halo.size(); at += length) order.push_back(halo.data() + at);
    const auto compare = [&](const std::uint8_t* a, const std::uint8_t* b) {
      return std::memcmp(a, b, length);
    };
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return compare(a, b) < 0; });
    order.erase(std::unique(order.begin(), order.end(), [&](auto a, auto b) { return compare(a, b) == 0; }),
                order.end());
    std::vector<std::uint8_t> once;
    for (const std::uint8_t* record : order) once.insert(once.end(), record, record + length);
    return once;
  }

  /// A bin of more points than are made at once: sorted again, into cells of deeper levels.
  void divide(const Plan::Stretch& heavy, Bins& bins) {
    const int level = std::min(deepest_level, heavy.key.level + levels_for(heavy.points));
    const std::unique_ptr<Bins> finer = new_bins(heavy.key, level);
    Sorter sorter(*finer, *locator_, schema_.record_length);
    for (Spool* spool : {&bins.points, bins.halos ? &*bins.halos : nullptr}) {
      if (!spool) continue;
      Spool::Bin bin = spool->take(heavy.key);
      const double whole = double(bin.size);
      while (true) {
        progress_.check();
        progress_.update(whole > 0 ? 1 - double(bin.size) / whole : 1, "dividing a dense part");
        const std::vector<std::uint8_t> records = spool->load_some(bin, 4 << 20, schema_.record_length);
        if (records.empty()) break;
        for (std::size_t at = 0; at < records.size(); at += schema_.record_length) {
          std::copy_n(records.data() + at, schema_.record_length, sorter.next());
          sorter.put(spool != &bins.points);
        }
        sorter.flush();
      }
    }
    make_region(*finer);
  }

  /// From the roots of stretches up to `region`, a level at a time.
  void join_up(const Key& region, std::vector<Key> keys) {
    int deepest = region.level;
    for (const Key& key : keys) deepest = std::max(deepest, key.level);
    for (int level = deepest; level > region.level; --level) {
      std::map<Key, std::vector<Key>> families;
      std::vector<Key> others;
      for (const Key& key : keys) {
        if (key.level == level)
          families[key.parent()].push_back(key);
        else
          others.push_back(key);
      }
      const std::vector<std::pair<Key, std::vector<Key>>> tasks(families.begin(), families.end());
      OrderedOutput output(*file_, summary_);
      io::las::parallel_tasks(tasks.size(), progress_, "joining levels", [&](std::size_t i) {
        const auto& [parent, children] = tasks[i];
        std::vector<Spool::Bin> taken;
        std::uint64_t size = 0;
        for (const Key& child : children) size += taken.emplace_back(roots_->take(child)).size;
        const Gate::Pass pass(gate_, work_of(size / schema_.record_length));
        NodeMaker maker(schema_, *locator_, progress_, options_.average_colors);
        std::array<std::vector<std::uint32_t>, 8> points;
        for (std::size_t k = 0; k < children.size(); ++k) {
          const Key& child = children[k];
          points[(child.x & 1) | (child.y & 1) << 1 | (child.z & 1) << 2] =
              maker.add(roots_->load(std::move(taken[k])));
        }
        roots_->append(parent, maker.records_of(maker.join(parent, points)));
        output.deliver(i, maker);
      });
      for (const auto& [parent, children] : tasks) others.push_back(parent);
      keys = std::move(others);
    }
  }

  static constexpr std::uint64_t leave_room = 4 * leaf_limit;

  const std::filesystem::path output_;
  const BuildOptions options_;
  Progress& progress_;
  BuildReport report_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<Reading> readings_;
  std::uint64_t in_box_ = 0, wanted_ = 0, points_ = 0, at_once_ = most_at_once;
  bool is_scanned_ = false;
  Bounds box_;
  Schema schema_;
  std::optional<FileWriter> file_;
  std::vector<RecordMap> maps_;
  std::vector<std::optional<int>> color_bits_;  ///< of each source, where they differ
  Cube cube_;
  std::optional<Locator> locator_;
  int bin_level_ = 0;
  std::unique_ptr<Bins> bins_;
  std::unique_ptr<Spool> roots_;
  Gate gate_;
  Summary summary_;
};

}  // namespace

BuildReport build(const std::vector<std::filesystem::path>& files, const std::filesystem::path& output,
                  const BuildOptions& options, Progress& progress) {
  return Builder(output, options, progress).run(files);
}

}  // namespace sfumato::copc
