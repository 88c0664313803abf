#include "analysis/cloud_facts.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <tuple>
#include <utility>

#include "analysis/quantiles.h"
#include "core/symmetric3.h"

namespace sfumato::analysis {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// SplitMix64 (Steele et al. 2014) of what came before and a number.
std::uint64_t mixed(std::uint64_t hash, std::uint64_t number) {
  hash += number + 0x9e3779b97f4a7c15;
  hash = (hash ^ hash >> 30) * 0xbf58476d1ce4e5b9;
  hash = (hash ^ hash >> 27) * 0x94d049bb133111eb;
  return hash ^ hash >> 31;
}

std::uint64_t mixed(std::uint64_t hash, double number) {
  return mixed(hash, std::bit_cast<std::uint64_t>(number + 0.0));  // -0 is 0
}

std::uint64_t mixed(std::uint64_t hash, const std::string& text) {
  for (const char c : text) hash = mixed(hash, std::uint64_t(std::uint8_t(c)));
  return hash;
}

/// A field and the hash of its name.
struct Named {
  const ScalarField* field;
  std::uint64_t name;
};

std::vector<Named> fields_by_name(const PointCloud& cloud) {
  std::vector<Named> fields;
  for (const ScalarField& field : cloud.scalars) fields.push_back({&field, mixed(0, field.name)});
  std::sort(fields.begin(), fields.end(),
            [](const Named& a, const Named& b) { return a.field->name < b.field->name; });
  return fields;
}

/// What a point lacks is not in its hash: others may have it.
std::uint64_t hash_of(const PointCloud& cloud, const std::vector<Named>& fields, std::size_t i) {
  std::uint64_t hash = analysis::hash_of(cloud.world(i));
  if (!cloud.colors.empty() && cloud.colors[i] != no_color)
    hash = mixed(mixed(hash, std::uint64_t(1)), std::uint64_t(std::bit_cast<std::uint32_t>(cloud.colors[i])));
  if (!cloud.normals.empty() && cloud.normals[i] != vec3(0))
    for (int k = 0; k < 3; ++k) hash = mixed(hash, double(cloud.normals[i][k]));
  if (!cloud.radii.empty() && cloud.radii[i] != 0) hash = mixed(hash, double(cloud.radii[i]));
  for (const Named& each : fields)
    if (const double value = each.field->value(i); !std::isnan(value))
      hash = mixed(mixed(hash, each.name), value);
  return hash;
}

CloudFacts::Point point_of(const PointCloud& cloud, const std::vector<Named>& fields, std::size_t i,
                           std::uint64_t hash) {
  CloudFacts::Point point;
  point.hash = hash, point.place = cloud.world(i);
  if (!cloud.normals.empty()) point.normal = cloud.normals[i];
  if (!cloud.colors.empty()) point.color = cloud.colors[i];
  if (!cloud.radii.empty()) point.radius = cloud.radii[i];
  for (const Named& each : fields) point.values.push_back(each.field->value(i));
  return point;
}

/// The first of those that are sorted, each once.
template <class T>
void keep_first(std::vector<T>& sorted, std::size_t count) {
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() > count) sorted.resize(count);
}

template <class T>
void merge_first(std::vector<T>& into, const std::vector<T>& of, std::size_t count) {
  std::vector<T> both;
  std::merge(into.begin(), into.end(), of.begin(), of.end(), std::back_inserter(both));
  keep_first(both, count);
  into = std::move(both);
}

void add_sample(CloudFacts& facts, const PointCloud& cloud, std::size_t most_sampled) {
  constexpr std::size_t run = 1'000'000;
  const std::vector<Named> fields = fields_by_name(cloud);
  std::uint64_t limit = ~std::uint64_t(0);
  std::vector<std::uint64_t> hashes;
  for (std::size_t first = 0; first < cloud.size(); first += run) {
    hashes.resize(std::min(run, cloud.size() - first));
    tbb::parallel_for(std::size_t(0), hashes.size(),
                      [&](std::size_t i) { hashes[i] = hash_of(cloud, fields, first + i); });
    std::vector<std::pair<std::uint64_t, std::size_t>> low;
    for (std::size_t i = 0; i < hashes.size(); ++i)
      if (hashes[i] <= limit) low.emplace_back(hashes[i], first + i);
    std::sort(low.begin(), low.end());
    const auto is_one = [&](const auto& a, const auto& b) {
      return a.first == b.first && cloud.positions[a.second] == cloud.positions[b.second];
    };
    low.erase(std::unique(low.begin(), low.end(), is_one), low.end());
    if (low.size() > most_sampled) low.resize(most_sampled);
    for (const auto& [hash, i] : low) facts.sample.push_back(point_of(cloud, fields, i, hash));
    std::sort(facts.sample.begin(), facts.sample.end());
    keep_first(facts.sample, most_sampled);
    if (facts.sample.size() == most_sampled) limit = facts.sample.back().hash;
  }
}

/// Rows of values in the order of other names.
void order_values(CloudFacts& facts, const std::map<std::string, ScalarFacts>& names) {
  std::vector<std::size_t> from;
  for (const auto& [name, of] : names) {
    const auto found = facts.scalars.find(name);
    from.push_back(found == facts.scalars.end() ? facts.scalars.size()
                                                : std::size_t(std::distance(facts.scalars.begin(), found)));
  }
  for (CloudFacts::Point& point : facts.sample) {
    std::vector<double> values;
    for (const std::size_t k : from) values.push_back(k < point.values.size() ? point.values[k] : no_value);
    point.values = std::move(values);
  }
}

}  // namespace

std::uint64_t hash_of(const dvec3& place) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };  // -0 is 0
  return mixed(0, bits(place.x) * 0x9e3779b97f4a7c15 + bits(place.y) * 0xbf58476d1ce4e5b9 +
                      bits(place.z) * 0x94d049bb133111eb);
}

std::uint64_t hash_of(std::span<const std::uint8_t> record) {
  std::uint64_t hash = 0;
  for (std::size_t at = 0; at < record.size(); at += sizeof hash) {
    std::uint64_t word = 0;
    std::memcpy(&word, record.data() + at, std::min(sizeof word, record.size() - at));
    hash = mixed(hash, word);
  }
  return hash;
}

bool is_sampled(const dvec3& place, std::uint64_t points) {
  constexpr std::uint64_t all = ~std::uint64_t(0);
  return points <= CloudFacts::most_sampled || hash_of(place) <= all / points * CloudFacts::most_sampled;
}

bool CloudFacts::Point::operator<(const Point& other) const {
  return std::tie(hash, place.x, place.y, place.z) <
         std::tie(other.hash, other.place.x, other.place.y, other.place.z);
}

bool CloudFacts::Place::operator<(const Place& other) const {
  return std::tie(hash, place.x, place.y, place.z) <
         std::tie(other.hash, other.place.x, other.place.y, other.place.z);
}

std::vector<CloudFacts::Place> places_in(const PointCloud& cloud) {
  using Places = std::vector<CloudFacts::Place>;
  constexpr std::uint64_t all = ~std::uint64_t(0);
  // Hashes are even: twice as many as are wanted lie below this, unless points share places.
  const std::size_t rest = cloud.size() / (2 * CloudFacts::most_places);
  for (std::uint64_t limit = rest > 1 ? all / rest : all;; limit = limit > all / 8 ? all : limit * 8) {
    Places low = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, cloud.size(), 65'536), Places(),
        [&](const auto& range, Places found) {
          for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (const CloudFacts::Place place{analysis::hash_of(cloud.world(i)), cloud.world(i)};
                place.hash <= limit)
              found.push_back(place);
          return found;
        },
        [](Places a, const Places& b) {
          a.insert(a.end(), b.begin(), b.end());
          return a;
        });
    std::sort(low.begin(), low.end());
    keep_first(low, CloudFacts::most_places);
    if (low.size() == CloudFacts::most_places || limit == all) return low;
  }
}

CloudFacts facts_of(const PointCloud& cloud, std::size_t most_sampled) {
  CloudFacts facts;
  facts.points = cloud.size();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    facts.least = glm::min(facts.least, cloud.world(i)), facts.most = glm::max(facts.most, cloud.world(i));
  for (const Rgba8& color : cloud.colors) facts.with_color += color != no_color;
  for (const vec3& normal : cloud.normals) facts.with_normal += normal != vec3(0);
  for (const float radius : cloud.radii) facts.with_radius += radius > 0;
  for (const ScalarField& field : cloud.scalars) {
    ScalarFacts& of = facts.scalars[field.name];
    for (std::size_t i = 0; i < field.values.size(); ++i) {
      const double value = field.value(i);
      if (std::isnan(value)) continue;
      ++of.count, of.least = std::min(of.least, value), of.most = std::max(of.most, value);
      if (field.name == "classification") ++facts.classes[int(value)];
    }
  }
  add_sample(facts, cloud, most_sampled);
  facts.places = places_in(cloud);
  return facts;
}

void merge(CloudFacts& into, const CloudFacts& of, std::size_t most_sampled) {
  into.points += of.points, into.with_color += of.with_color;
  into.with_normal += of.with_normal, into.with_radius += of.with_radius;
  into.least = glm::min(into.least, of.least), into.most = glm::max(into.most, of.most);
  for (const auto& [id, points] : of.classes) into.classes[id] += points;
  std::map<std::string, ScalarFacts> scalars = into.scalars;
  for (const auto& [name, facts] : of.scalars) {
    ScalarFacts& all = scalars[name];
    all.count += facts.count;
    all.least = std::min(all.least, facts.least), all.most = std::max(all.most, facts.most);
  }
  CloudFacts other;
  other.scalars = of.scalars, other.sample = of.sample;
  order_values(into, scalars), order_values(other, scalars);
  into.scalars = std::move(scalars);
  merge_first(into.sample, other.sample, most_sampled);
  merge_first(into.places, of.places, CloudFacts::most_places);
}

PointCloud sample_of(const CloudFacts& facts) {
  PointCloud cloud;
  if (facts.sample.empty()) return cloud;
  cloud.origin = glm::floor(facts.least);
  for (const auto& [name, of] : facts.scalars) cloud.scalars.push_back({name, of.count ? of.least : 0, {}});
  for (const CloudFacts::Point& point : facts.sample) {
    cloud.positions.emplace_back(point.place - cloud.origin);
    if (facts.with_color > 0) cloud.colors.push_back(point.color);
    if (facts.with_normal > 0) cloud.normals.push_back(point.normal);
    if (facts.with_radius > 0) cloud.radii.push_back(point.radius);
    for (std::size_t k = 0; k < cloud.scalars.size(); ++k)
      cloud.scalars[k].values.push_back(float(point.values[k] - cloud.scalars[k].offset));
  }
  return cloud;
}

namespace {

/// A point of a neighbourhood, ordered by its distance.
struct Near {
  double distance2;
  dvec3 place;
  bool operator<(const Near& other) const {
    return std::tie(distance2, place.x, place.y, place.z) <
           std::tie(other.distance2, other.place.x, other.place.y, other.place.z);
  }
  bool operator==(const Near& other) const { return place == other.place; }
};

std::vector<dvec3> nearest_of(std::vector<Near> all, std::size_t count) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<dvec3> places;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) places.push_back(all[i].place);
  return places;
}

/// All that may be among the nearest, as far as floats tell.
class PlacesNear {
 public:
  static constexpr bool merges_coincident = true;
  /// `size`: how far the place is from the origin.
  PlacesNear(std::span<const vec3> positions, std::size_t count, float size)
      : positions_(positions), count_(count), size_(size) {}
  float limit() const { return limit_; }
  void add(std::uint32_t id, float distance2) {
    const std::uint64_t key = sort_key(distance2, id);
    seen_.push_back(key);
    for (auto same = std::lower_bound(nearest_.begin(), nearest_.end(), sort_key(distance2, 0));
         same != nearest_.end() && distance2_of(*same) == distance2; ++same)
      if (positions_[id_of(*same)] == positions_[id]) return;
    nearest_.insert(std::upper_bound(nearest_.begin(), nearest_.end(), key), key);
    if (nearest_.size() > count_) nearest_.pop_back();
    if (nearest_.size() < count_) return;
    // Points as near as this are no farther from the origin than that, and rounded so much.
    const float farthest = std::sqrt(distance2_of(nearest_.back())) * 1.00001f,
                reach = farthest + 4 * std::numeric_limits<float>::epsilon() * (size_ + farthest);
    limit_ = std::nextafter(reach * reach, std::numeric_limits<float>::infinity());
  }
  /// Calls `use(id)`.
  template <class Use>
  void each(const Use& use) const {
    for (const std::uint64_t key : seen_)
      if (distance2_of(key) <= limit_) use(id_of(key));
  }

 private:
  std::vector<std::uint64_t> seen_;  ///< sort_key; the first of them before the limit was known
  std::span<const vec3> positions_;
  std::size_t count_;
  float size_, limit_ = std::numeric_limits<float>::infinity();
  std::vector<std::uint64_t> nearest_;  ///< sort_key, ascending
};

}  // namespace

std::vector<dvec3> first_places(const std::vector<CloudFacts::Place>& places, std::size_t count) {
  std::vector<dvec3> first;
  for (std::size_t i = 0; i < std::min(count, places.size()); ++i) first.push_back(places[i].place);
  return first;
}

Neighborhoods neighborhoods_of(const NeighborTree& tree, const dvec3& origin, std::vector<dvec3> places,
                               std::size_t count) {
  const std::span<const vec3> positions = tree.positions();
  Neighborhoods around{std::move(places), {}};
  around.nearest.resize(around.places.size());
  tbb::parallel_for(std::size_t(0), around.places.size(), [&](std::size_t k) {
    const dvec3& place = around.places[k];
    const vec3 local(place - origin);
    PlacesNear found(positions, count, glm::length(local));
    tree.search(local, found);
    std::vector<Near> all;
    found.each([&](std::uint32_t id) {
      const dvec3 at = origin + dvec3(positions[id]), away = at - place;
      all.push_back({glm::dot(away, away), at});
    });
    around.nearest[k] = nearest_of(std::move(all), count);
  });
  return around;
}

void merge(Neighborhoods& into, const Neighborhoods& of, std::size_t count) {
  for (std::size_t k = 0; k < into.places.size(); ++k) {
    std::vector<Near> all;
    for (const auto* each : {&std::as_const(into).nearest[k], &of.nearest[k]})
      for (const dvec3& at : *each) {
        const dvec3 away = at - into.places[k];
        all.push_back({glm::dot(away, away), at});
      }
    into.nearest[k] = nearest_of(std::move(all), count);
  }
}

float spacing_of(const Neighborhoods& around) {
  constexpr std::size_t eighth = 8;
  std::vector<float> spacings;
  for (std::size_t k = 0; k < around.places.size(); ++k)
    if (const auto& nearest = around.nearest[k]; nearest.size() > 1) {
      const dvec3& last = nearest[std::min(eighth, nearest.size() - 1)];
      spacings.push_back(float(glm::distance(last, around.places[k]) * std::sqrt(M_PI / eighth)));
    }
  return quantile(spacings, 0.5);
}

float residual_of(const Neighborhoods& around) {
  std::vector<float> residuals;
  for (const std::vector<dvec3>& nearest : around.nearest) {
    if (nearest.size() < 4) continue;
    dvec3 mean(0);
    for (const dvec3& at : nearest) mean += (at - nearest.front()) / double(nearest.size());
    Symmetric3 m;
    for (const dvec3& at : nearest) {
      const dvec3 d = at - nearest.front() - mean;
      m.xx += d.x * d.x, m.xy += d.x * d.y, m.xz += d.x * d.z;
      m.yy += d.y * d.y, m.yz += d.y * d.z, m.zz += d.z * d.z;
    }
    residuals.push_back(float(std::sqrt(std::max(0.0, eigenvalues(m).z) / double(nearest.size()))));
  }
  return quantile(residuals, 0.5);
}

}  // namespace sfumato::analysis
