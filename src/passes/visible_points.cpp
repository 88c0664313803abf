#include "passes/visible_points.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <tuple>
#include <utility>

#include "core/error.h"

namespace sfumato {

Image<float> VisiblePoints::depth() const {
  Image<float> depth(depth_bits.width(), depth_bits.height(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (depth_bits.data()[i] != nothing) depth.data()[i] = std::bit_cast<float>(depth_bits.data()[i]);
  return depth;
}

void VisiblePoints::add_round(VisiblePoints next) {
  const auto take = [](auto& own, auto& other) {
    if (!other.empty()) own = std::move(other);
  };
  if (!depth_bits.empty() && !next.depth_bits.empty()) {
    in_front.push_back(  // nobody merges them again: without numbers
        {std::exchange(depth_bits, {}), {}, std::exchange(colors, {}), std::exchange(normals, {})});
    in_front.back().serial = serial;
  }
  static std::atomic<std::uint64_t> last = 0;  // pictures may be put together on several threads
  serial = ++last;
  take(depth_bits, next.depth_bits), take(number, next.number);
  take(colors, next.colors), take(normals, next.normals), take(places, next.places);
  take(nearest, next.nearest), take(vouching, next.vouching);
  take(color_sum, next.color_sum), take(normal_sum, next.normal_sum);
  if (!next.bins.empty()) bins_serial = serial;
  take(bins, next.bins), take(bin_sums, next.bin_sums);
  outliers += next.outliers;
  for (Values& kind : next.values) values.push_back(std::move(kind));
  if (!next.seen_through.empty()) seen_through = std::move(next.seen_through);
}

bool VisiblePoints::SeenThrough::operator<(const SeenThrough& other) const {
  const auto key = [](const SeenThrough& p) {
    return std::tie(p.number, p.place.x, p.place.y, p.place.z, p.field, p.radius);
  };
  return key(*this) < key(other);
}

namespace {

template <class T>
void require_same_size(const Image<T>& a, const Image<T>& b) {
  if (a.width() != b.width() || a.height() != b.height())
    throw Error(ErrorCode::usage, "parts of different sizes cannot be merged: draw them with one camera");
}

template <class T, class Join>
void merge_pixels(Image<T>& into, const Image<T>& of, const Join& join) {
  require_same_size(into, of);
  for (std::size_t i = 0; i < into.size(); ++i) into.data()[i] = join(into.data()[i], of.data()[i]);
}

/// Both by pixel and number. A sum ends at the largest.
std::vector<VisiblePoints::Bin> merged_bins(const std::vector<VisiblePoints::Bin>& a,
                                            const std::vector<VisiblePoints::Bin>& b) {
  using Bin = VisiblePoints::Bin;
  const auto place = [](const Bin& bin) { return std::pair(bin.pixel, bin.number); };
  std::vector<Bin> out(a.size() + b.size());
  std::ranges::merge(a, b, out.begin(), {}, place, place);
  std::size_t count = 0;
  for (const Bin& bin : out) {
    if (count == 0 || place(out[count - 1]) != place(bin)) {
      out[count++] = bin;
      continue;
    }
    const std::uint64_t sum = std::uint64_t(out[count - 1].weight) + bin.weight;
    out[count - 1].weight = std::uint32_t(std::min<std::uint64_t>(sum, 0xffffffffu));
  }
  out.resize(count);
  return out;
}

/// Both in order.
template <class T>
std::vector<T> merged_in_order(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<T> out(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), out.begin());
  return out;
}

void merge_values(std::vector<VisiblePoints::Values>& into, const std::vector<VisiblePoints::Values>& of) {
  if (into.size() != of.size())
    throw Error(ErrorCode::usage, "parts of different rounds cannot be merged: ask all in the same order");
  for (std::size_t k = 0; k < into.size(); ++k) {
    into[k].sample = merged_in_order(into[k].sample, of[k].sample), into[k].count += of[k].count;
    into[k].least = std::min(into[k].least, of[k].least), into[k].most = std::max(into[k].most, of[k].most);
  }
}

}  // namespace

void merge(VisiblePoints& into, const VisiblePoints& of) {
  const auto nearer = [](auto a, auto b) { return std::min(a, b); };
  const auto sum = [](const vec4& a, const vec4& b) { return a + b; };
  into.serial = into.bins_serial = 0;
  merge_pixels(into.nearest, of.nearest, nearer);
  merge_pixels(into.vouching, of.vouching, nearer);
  merge_pixels(into.color_sum, of.color_sum, sum);
  merge_pixels(into.normal_sum, of.normal_sum, sum);
  merge_values(into.values, of.values);
  into.seen_through = merged_in_order(into.seen_through, of.seen_through);
  into.bins = merged_bins(into.bins, of.bins), into.outliers += of.outliers;
  merge_pixels(into.bin_sums, of.bin_sums, [](VisiblePoints::BinSums a, const VisiblePoints::BinSums& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
    return a;
  });
  require_same_size(into.depth_bits, of.depth_bits), require_same_size(into.places, of.places);
  const vec4 none(0, 0, 0, 1);
  if (into.normals.empty() && !of.normals.empty())
    into.normals = Image<vec4>(into.depth_bits.width(), into.depth_bits.height(), none);
  for (std::size_t i = 0; i < into.depth_bits.size(); ++i) {
    // Positive floats sort as their bits do.
    const std::pair own(into.depth_bits.data()[i], into.number.data()[i]),
        other(of.depth_bits.data()[i], of.number.data()[i]);
    if (!(other < own)) continue;
    into.depth_bits.data()[i] = other.first, into.number.data()[i] = other.second;
    into.colors.data()[i] = of.colors.data()[i];
    if (!into.places.empty()) into.places.data()[i] = of.places.data()[i];
    if (!into.normals.empty()) into.normals.data()[i] = of.normals.empty() ? none : of.normals.data()[i];
  }
}

}  // namespace sfumato
