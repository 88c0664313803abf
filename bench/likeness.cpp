#include "likeness.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/vec.h"

namespace sfumato::bench {
namespace {

bool covers(const Rgba8& c) { return c.a >= 128; }

/// Colours times weight, and weight, blurred: what does not count stays out of what does.
Image<vec4> blurred(const Image<Rgba8>& picture, const Image<std::uint8_t>& counts, float sigma) {
  const int width = picture.width(), height = picture.height(), reach = int(std::ceil(3 * sigma));
  std::vector<float> weights(std::size_t(reach) + 1);
  for (int k = 0; k <= reach; ++k) weights[std::size_t(k)] = std::exp(-0.5f * float(k * k) / (sigma * sigma));
  Image<vec4> rows(width, height), out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      vec4 sum(0);
      for (int k = std::max(-reach, -x); k <= std::min(reach, width - 1 - x); ++k) {
        if (!counts.at(x + k, y)) continue;
        const Rgba8 c = picture.at(x + k, y);
        sum += weights[std::size_t(std::abs(k))] * vec4(c.r, c.g, c.b, 1);
      }
      rows.at(x, y) = sum;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      vec4 sum(0);
      for (int k = std::max(-reach, -y); k <= std::min(reach, height - 1 - y); ++k)
        sum += weights[std::size_t(std::abs(k))] * rows.at(x, y + k);
      out.at(x, y) = sum.w > 0 ? vec4(vec3(sum) / sum.w, sum.w) : vec4(0);
    }
  return out;
}

float lightness(const vec4& c) { return 0.299f * c.x + 0.587f * c.y + 0.114f * c.z; }

Image<std::uint8_t> covered_by(const Image<Rgba8>& picture) {
  Image<std::uint8_t> mask(picture.width(), picture.height());
  for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = covers(picture.data()[i]);
  return mask;
}

/// Pixels whose square of 2 `reach` + 1 is marked (`all`), or some of it is. `outside`: what lies around the
/// picture counts as marked.
Image<std::uint8_t> grown(const Image<std::uint8_t>& mask, int reach, bool all, bool outside = false) {
  const int width = mask.width(), height = mask.height();
  Image<std::uint8_t> rows(width, height), out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool every = true, any = false;
      for (int k = -reach; k <= reach; ++k) {
        const bool covered = x + k >= 0 && x + k < width ? bool(mask.at(x + k, y)) : outside;
        every &= covered, any |= covered;
      }
      rows.at(x, y) = all ? every : any;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool every = true, any = false;
      for (int k = -reach; k <= reach; ++k) {
        const bool covered = y + k >= 0 && y + k < height ? bool(rows.at(x, y + k)) : outside;
        every &= covered, any |= covered;
      }
      out.at(x, y) = all ? every : any;
    }
  return out;
}

std::size_t groups_of(Image<std::uint8_t> marked) {
  std::size_t groups = 0;
  std::vector<ivec2> open;
  for (int y = 0; y < marked.height(); ++y)
    for (int x = 0; x < marked.width(); ++x) {
      if (!marked.at(x, y)) continue;
      ++groups;
      open.assign(1, ivec2(x, y));
      marked.at(x, y) = 0;
      while (!open.empty()) {
        const ivec2 at = open.back();
        open.pop_back();
        for (int k = 0; k < 9; ++k) {
          const ivec2 next = at + ivec2(k % 3 - 1, k / 3 - 1);
          if (next.x < 0 || next.y < 0 || next.x >= marked.width() || next.y >= marked.height()) continue;
          if (std::exchange(marked.at(next.x, next.y), std::uint8_t(0))) open.push_back(next);
        }
      }
    }
  return groups;
}

}  // namespace

Likeness likeness(const Image<Rgba8>& painting, const Image<Rgba8>& picture, const Image<Rgba8>& measured,
                  float sigma) {
  const int width = picture.width(), height = picture.height();
  for (const Image<Rgba8>* other : {&painting, &measured})
    if (other->width() != width || other->height() != height)
      throw Error(ErrorCode::usage, "a painting and its pictures must have one size");
  Likeness out;
  Image<std::uint8_t> both(width, height), specks(width, height);
  const Image<std::uint8_t> surface = covered_by(picture), near = grown(surface, 1, false);
  const Image<std::uint8_t> scanned = grown(grown(covered_by(measured), 5, false), 5, true, true);
  Image<std::uint8_t> closed = surface;
  for (std::size_t i = 0; i < closed.size(); ++i) closed.data()[i] &= scanned.data()[i];
  closed = grown(closed, 3, true);
  std::size_t covered = 0, beyond = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool here = covers(picture.at(x, y)), painted = covers(painting.at(x, y));
      both.at(x, y) = here && painted;
      covered += here;
      beyond += painted && !near.at(x, y);
      if (closed.at(x, y) && !painted) specks.at(x, y) = 1, ++out.specks;
    }
  out.speck_groups = groups_of(specks);
  out.overshoot = double(beyond) / double(std::max<std::size_t>(covered, 1));

  const Image<vec4> a = blurred(painting, both, sigma), b = blurred(picture, both, sigma);
  double ab = 0, aa = 0, bb = 0, color = 0, shift = 0, n = 0;
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      if (!both.at(x, y)) continue;
      color += glm::distance(vec3(a.at(x, y)), vec3(b.at(x, y)));
      shift += lightness(a.at(x, y)) - lightness(b.at(x, y));
      ++n;
      if (!both.at(x - 1, y) || !both.at(x + 1, y) || !both.at(x, y - 1) || !both.at(x, y + 1)) continue;
      auto gradient = [&](const Image<vec4>& i) {
        return glm::dvec2(lightness(i.at(x + 1, y)) - lightness(i.at(x - 1, y)),
                          lightness(i.at(x, y + 1)) - lightness(i.at(x, y - 1)));
      };
      const glm::dvec2 ga = gradient(a), gb = gradient(b);
      ab += glm::dot(ga, gb), aa += glm::dot(ga, ga), bb += glm::dot(gb, gb);
    }
  out.gradients = aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
  out.color = color / std::max(n, 1.0);
  out.lightness = shift / std::max(n, 1.0);

  // Windows of 4 sigma, half overlapping, of pixels that both cover.
  const int window = std::max(8, int(std::lround(4 * sigma)));
  double sum = 0, count = 0;
  for (int top = 0; top + window <= height; top += window / 2)
    for (int left = 0; left + window <= width; left += window / 2) {
      double m = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      for (int y = top; y < top + window; ++y)
        for (int x = left; x < left + window; ++x) {
          if (!both.at(x, y)) continue;
          const double la = lightness(a.at(x, y)), lb = lightness(b.at(x, y));
          ++m, ma += la, mb += lb, va += la * la, vb += lb * lb, cov += la * lb;
        }
      if (m < 0.5 * window * window) continue;
      ma /= m, mb /= m;
      va = va / m - ma * ma, vb = vb / m - mb * mb, cov = cov / m - ma * mb;
      const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;  // (0.01 and 0.03 of 255)^2
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
      ++count;
    }
  out.structure = sum / std::max(count, 1.0);
  return out;
}

}  // namespace sfumato::bench
