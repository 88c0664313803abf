#include "ranks.h"

#include <sfumato/cloud.h>

#include <exception>

using sfumato::Image;
using sfumato::vec3;
using sfumato::vec4;
using sfumato::VisiblePoints;
using sfumato::analysis::CloudFacts;
using sfumato::analysis::Neighborhoods;
using sfumato::analysis::Surroundings;

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

Bytes BytesOf(const Surroundings& around) {
  Bytes bytes;
  put(bytes, around.dots), put(bytes, around.noise);
  return bytes;
}

void Take(Bytes& bytes, Surroundings& around) { take(bytes, around.dots), take(bytes, around.noise); }

/// Pixels that show something, and nothing of the others.
Bytes BytesOf(const VisiblePoints& visible) {
  Bytes bytes;
  const int width = visible.depth_bits.width(), height = visible.depth_bits.height();
  bytes.Put(width), bytes.Put(height), bytes.Put(!visible.normals.empty());
  std::vector<std::uint32_t> places, depths, numbers;
  std::vector<vec3> colors;
  std::vector<vec4> normals;
  for (std::size_t i = 0; i < visible.depth_bits.size(); ++i) {
    if (visible.depth_bits.data()[i] == VisiblePoints::nothing) continue;
    places.push_back(std::uint32_t(i));
    depths.push_back(visible.depth_bits.data()[i]);
    numbers.push_back(visible.number.data()[i]);
    colors.push_back(vec3(visible.colors.data()[i]));
    if (!visible.normals.empty()) normals.push_back(visible.normals.data()[i]);
  }
  bytes.PutAll(places), bytes.PutAll(depths), bytes.PutAll(numbers), bytes.PutAll(colors), bytes.PutAll(normals);
  return bytes;
}

void Take(Bytes& bytes, VisiblePoints& visible) {
  int width = 0, height = 0;
  bool has_normals = false;
  bytes.Take(width), bytes.Take(height), bytes.Take(has_normals);
  visible.depth_bits = Image<std::uint32_t>(width, height, VisiblePoints::nothing);
  visible.number = Image<std::uint32_t>(width, height, VisiblePoints::nothing);
  visible.colors = Image<vec4>(width, height, vec4(0));
  visible.normals = has_normals ? Image<vec4>(width, height, vec4(0, 0, 0, 1)) : Image<vec4>();
  std::vector<std::uint32_t> places, depths, numbers;
  std::vector<vec3> colors;
  std::vector<vec4> normals;
  bytes.TakeAll(places), bytes.TakeAll(depths), bytes.TakeAll(numbers), bytes.TakeAll(colors), bytes.TakeAll(normals);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t i = places[k];
    visible.depth_bits.data()[i] = depths[k], visible.number.data()[i] = numbers[k];
    visible.colors.data()[i] = vec4(colors[k], 1);
    if (has_normals) visible.normals.data()[i] = normals[k];
  }
}

bool Ranks::Any(bool holds) {
  if (Count() < 2) return holds;
  int own = holds, any = 0;
  Controller()->AllReduce(&own, &any, 1, vtkCommunicator::MAX_OP);
  return any != 0;
}

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

void Ranks::Broadcast(Bytes& bytes) {
  if (Count() < 2) return;
  vtkIdType length = vtkIdType(bytes.all.size());
  Controller()->Broadcast(&length, 1, 0);
  bytes.all.resize(std::size_t(length));
  Controller()->Broadcast(bytes.all.data(), length, 0);
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
