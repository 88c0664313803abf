#include "ranks.h"

#include <sfumato/cloud.h>

#include <cmath>
#include <exception>
#include <limits>

using sfumato::Image;
using sfumato::PointCloud;
using sfumato::vec3;
using sfumato::vec4;
using sfumato::VisiblePoints;
using sfumato::analysis::CloudFacts;
using sfumato::analysis::Neighborhoods;
using sfumato::analysis::NeighborhoodFacts;

namespace {

constexpr int tag = 4242;

/// Points of ParaView's data have no scalars, which are coloured before.
struct SamplePoint {
  std::uint64_t hash;
  sfumato::dvec3 place;
  vec3 normal;
  float radius;
  sfumato::Rgba8 color;
};

void put(Bytes& bytes, const Neighborhoods& around) {
  bytes.PutAll(around.places);
  for (const auto& nearest : around.nearest) bytes.PutAll(nearest);
}

void take(Bytes& bytes, Neighborhoods& around) {
  bytes.TakeAll(around.places);
  around.nearest.resize(around.places.size());
  for (auto& nearest : around.nearest) bytes.TakeAll(nearest);
}

}  // namespace

Bytes BytesOf(const CloudFacts& facts) {
  Bytes bytes;
  for (const std::uint64_t count : {facts.points, facts.with_color, facts.with_normal, facts.with_radius})
    bytes.Put(count);
  bytes.Put(facts.least), bytes.Put(facts.most);
  std::vector<SamplePoint> sample;
  for (const CloudFacts::Point& p : facts.sample) sample.push_back({p.hash, p.place, p.normal, p.radius, p.color});
  bytes.PutAll(sample), bytes.PutAll(facts.places);
  return bytes;
}

void Take(Bytes& bytes, CloudFacts& facts) {
  for (std::uint64_t* count : {&facts.points, &facts.with_color, &facts.with_normal, &facts.with_radius})
    bytes.Take(*count);
  bytes.Take(facts.least), bytes.Take(facts.most);
  std::vector<SamplePoint> sample;
  bytes.TakeAll(sample), bytes.TakeAll(facts.places);
  for (const SamplePoint& p : sample) facts.sample.push_back({p.hash, p.place, p.normal, p.color, p.radius, {}});
}

Bytes BytesOf(const NeighborhoodFacts& around) {
  Bytes bytes;
  for (const Neighborhoods* each : {&around.dots, &around.noise, &around.anywhere}) put(bytes, *each);
  return bytes;
}

void Take(Bytes& bytes, NeighborhoodFacts& around) {
  for (Neighborhoods* each : {&around.dots, &around.noise, &around.anywhere}) take(bytes, *each);
}

namespace {

/// Which pixels show something, and then nothing of the others.
template <class T, class Shows>
std::vector<std::uint32_t> PutPlaces(Bytes& bytes, const Image<T>& image, const Shows& shows) {
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < image.size(); ++i)
    if (shows(image.data()[i])) places.push_back(std::uint32_t(i));
  bytes.Put(image.width()), bytes.Put(image.height()), bytes.PutAll(places);
  return places;
}

template <class T, class Value>
void PutPixels(Bytes& bytes, const Image<T>& image, const std::vector<std::uint32_t>& places, const Value& value) {
  std::vector<decltype(value(T()))> values;
  values.reserve(places.size());
  for (const std::uint32_t i : places) values.push_back(value(image.data()[i]));
  bytes.PutAll(values);
}

struct Places {
  int width = 0, height = 0;
  std::vector<std::uint32_t> places;
  explicit Places(Bytes& bytes) { bytes.Take(width), bytes.Take(height), bytes.TakeAll(places); }
};

template <class Sent, class T, class Value>
void TakePixels(Bytes& bytes, const Places& at, Image<T>& image, const T& none, const Value& value) {
  std::vector<Sent> values;
  bytes.TakeAll(values);
  image = Image<T>(at.width, at.height, none);
  for (std::size_t k = 0; k < values.size(); ++k) image.data()[at.places[k]] = value(values[k]);
}

}  // namespace

Bytes BytesOf(const VisiblePoints& visible) {
  const auto whole = [](const auto& value) { return value; };
  const auto is_there = [](std::uint32_t bits) { return bits != VisiblePoints::nothing; };
  Bytes bytes;
  const auto points = PutPlaces(bytes, visible.depth_bits, is_there);
  PutPixels(bytes, visible.depth_bits, points, whole), PutPixels(bytes, visible.number, points, whole);
  PutPixels(bytes, visible.colors, points, [](const vec4& color) { return vec3(color); });
  bytes.Put(!visible.normals.empty());
  if (!visible.normals.empty()) PutPixels(bytes, visible.normals, points, whole);
  bytes.Put(!visible.places.empty());
  if (!visible.places.empty()) PutPixels(bytes, visible.places, points, [](const vec4& place) { return vec3(place); });
  const auto hits = PutPlaces(bytes, visible.nearest, [](float distance) { return std::isfinite(distance); });
  PutPixels(bytes, visible.nearest, hits, whole);
  PutPlaces(bytes, visible.vouching, is_there);  // whether, and not how far away
  const auto surface = PutPlaces(bytes, visible.color_sum, [](const vec4& sum) { return sum.w > 0; });
  PutPixels(bytes, visible.color_sum, surface, whole), PutPixels(bytes, visible.normal_sum, surface, whole);
  bytes.Put(visible.outliers), bytes.PutAll(visible.bins);
  const auto sums = PutPlaces(bytes, visible.bin_sums, [](const VisiblePoints::BinSums& sum) { return sum[0] > 0; });
  PutPixels(bytes, visible.bin_sums, sums, whole);
  bytes.PutAll(visible.seen_through), bytes.Put(visible.values.size());
  for (const VisiblePoints::Values& kind : visible.values) {
    bytes.PutAll(kind.sample), bytes.Put(kind.count);
    bytes.Put(kind.least), bytes.Put(kind.most);
  }
  return bytes;
}

void Take(Bytes& bytes, VisiblePoints& visible) {
  const auto whole = [](const auto& value) { return value; };
  const Places points(bytes);
  TakePixels<std::uint32_t>(bytes, points, visible.depth_bits, VisiblePoints::nothing, whole);
  TakePixels<std::uint32_t>(bytes, points, visible.number, VisiblePoints::nothing, whole);
  TakePixels<vec3>(bytes, points, visible.colors, vec4(0), [](const vec3& color) { return vec4(color, 1); });
  bool has_normals = false, has_places = false;
  bytes.Take(has_normals);
  if (has_normals) TakePixels<vec4>(bytes, points, visible.normals, vec4(0, 0, 0, 1), whole);
  bytes.Take(has_places);
  if (has_places)
    TakePixels<vec3>(bytes, points, visible.places, VisiblePoints::nowhere, [](const vec3& place) { return vec4(place, 0); });
  TakePixels<float>(bytes, Places(bytes), visible.nearest, std::numeric_limits<float>::infinity(), whole);
  const Places vouching(bytes);
  visible.vouching = Image<std::uint32_t>(vouching.width, vouching.height, VisiblePoints::nothing);
  for (const std::uint32_t i : vouching.places) visible.vouching.data()[i] = 0;
  const Places surface(bytes);
  TakePixels<vec4>(bytes, surface, visible.color_sum, vec4(0), whole);
  TakePixels<vec4>(bytes, surface, visible.normal_sum, vec4(0), whole);
  bytes.Take(visible.outliers), bytes.TakeAll(visible.bins);
  TakePixels<VisiblePoints::BinSums>(bytes, Places(bytes), visible.bin_sums, {}, whole);
  bytes.TakeAll(visible.seen_through);
  std::size_t kinds = 0;
  bytes.Take(kinds);
  visible.values.resize(kinds);
  for (VisiblePoints::Values& kind : visible.values) {
    bytes.TakeAll(kind.sample), bytes.Take(kind.count);
    bytes.Take(kind.least), bytes.Take(kind.most);
  }
}

/// Points of ParaView's data have nothing else.
Bytes BytesOf(const PointCloud& points) {
  Bytes bytes;
  bytes.Put(points.origin), bytes.PutAll(points.positions), bytes.PutAll(points.normals);
  bytes.PutAll(points.colors), bytes.PutAll(points.source_index);
  return bytes;
}

void Take(Bytes& bytes, PointCloud& points) {
  bytes.Take(points.origin), bytes.TakeAll(points.positions), bytes.TakeAll(points.normals);
  bytes.TakeAll(points.colors), bytes.TakeAll(points.source_index);
}

int Ranks::Most(int own) {
  if (Count() < 2) return own;
  int most = 0;
  Controller()->AllReduce(&own, &most, 1, vtkCommunicator::MAX_OP);
  return most;
}

bool Ranks::Any(bool holds) { return Most(holds) != 0; }

void Ranks::Together(const std::function<void()>& work) {
  std::exception_ptr wrong;
  try {
    work();
  } catch (...) {
    wrong = std::current_exception();
  }
  const bool any = Any(wrong != nullptr);
  if (wrong) std::rethrow_exception(wrong);
  if (any) throw sfumato::Error(sfumato::ErrorCode::no_gl, "another rank could not draw its part: see its message");
}

void Ranks::Broadcast(Bytes& bytes, int from) {
  if (Count() < 2) return;
  vtkIdType length = vtkIdType(bytes.all.size());
  Controller()->Broadcast(&length, 1, from);
  bytes.all.resize(std::size_t(length));
  Controller()->Broadcast(bytes.all.data(), length, from);
}

void Ranks::Send(const Bytes& bytes, int to) {
  const vtkIdType length = vtkIdType(bytes.all.size());
  Controller()->Send(&length, 1, to, tag);
  Controller()->Send(bytes.all.data(), length, to, tag);
}

Bytes Ranks::Receive(int from) {
  vtkIdType length = 0;
  Controller()->Receive(&length, 1, from, tag);
  Bytes bytes;
  bytes.all.resize(std::size_t(length));
  Controller()->Receive(bytes.all.data(), length, from, tag);
  return bytes;
}

sfumato::analysis::Share Ranks::DealOut(const PointCloud& part, const sfumato::WholeCloud& whole) {
  using sfumato::analysis::points_near;
  std::vector<sfumato::Bounds> regions;
  std::vector<PointCloud> parts;
  auto pieces = std::vector<Bytes>(std::size_t(Count()));
  Together([&] {
    regions = sfumato::analysis::regions_of(whole.sample, pieces.size());
    const double reach = sfumato::analysis::reach_of(whole);
    for (std::size_t rank = 0; rank < pieces.size(); ++rank)
      if (int(rank) == Own())
        parts.push_back(points_near(part, regions[rank], reach));
      else
        pieces[rank] = BytesOf(points_near(part, regions[rank], reach));
  });
  // In pairs, each rank in one at a time, so that nobody waits for a rank that waits for it.
  for (int step = 1; step / 2 < Count(); ++step) {
    const int other = Own() ^ step;
    if (other >= Count()) continue;
    Bytes& piece = pieces[std::size_t(other)];
    if (Own() < other) Send(piece, other);
    Bytes theirs = Receive(other);
    if (Own() > other) Send(piece, other);
    piece = std::move(theirs);
  }
  sfumato::analysis::Share share;
  Together([&] {
    for (std::size_t rank = 0; rank < pieces.size(); ++rank)
      if (int(rank) != Own()) Take(pieces[rank], parts.emplace_back());
    share = sfumato::analysis::share_of(parts, regions[std::size_t(Own())]);
  });
  share.own.origin = share.around.origin = whole.origin;
  return share;
}
