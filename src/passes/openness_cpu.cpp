#include "passes/openness_cpu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/wide.h"
#include "passes/loops_cpu.h"
#include "passes/shaders_cpu.h"

namespace sfumato {
namespace {

using cpu::lanes;

constexpr int levels = Relief::levels;

// relief_pyramid.glsl.

/// Depth, 0 where nothing; share that is covered; detail, below 0 where unknown; the mean of the children's.
struct Level {
  Level(int width, int height)
      : depth(width, height), share(width, height), detail(width, height), mean(width, height) {}
  Image<float> depth, share, detail, mean;
};

struct Children {
  const float *depth, *share, *detail;
};

[[gnu::always_inline]] inline void join(const Children (&rows)[2], int count, float width_px,
                                        float pixels_per_unit, bool orthographic, float* depth, float* share,
                                        float* detail, float* mean) {
  constexpr float steepest = 4, least_share = 0.25f, most_detail = 0.25f;
  for (int i = 0; i < count; ++i) {
    float d[4], s[4], known[4], cover = 0, nearest = INFINITY, details = 0, measured = 0;
    for (int k = 0; k < 4; ++k) {
      const Children& row = rows[k / 2];
      const int at = 2 * i + k % 2;
      d[k] = row.depth[at], s[k] = row.share[at];
      known[k] = s[k] > 0 ? d[k] : INFINITY;
      nearest = std::min(nearest, known[k]);
      cover += s[k];
      const float of_child = row.detail[at];
      details += of_child >= 0 ? of_child : 0, measured += of_child >= 0 ? 1.0f : 0.0f;
    }
    const float pixel = (orthographic ? 1 : nearest) / pixels_per_unit;
    const float farthest = nearest + steepest * width_px * pixel;
    float front[4], sum = 0;
    for (int k = 0; k < 4; ++k) front[k] = known[k] <= farthest ? s[k] : 0, sum += front[k];
    const bool is_speck = sum < least_share * cover;
    float weighted = 0;
    sum = 0;
    for (int k = 0; k < 4; ++k) {
      const float counts = is_speck ? s[k] - front[k] : front[k];
      weighted += counts * d[k], sum += counts;
    }
    const bool is_whole = (s[0] > 0) & (s[1] > 0) & (s[2] > 0) & (s[3] > 0);
    const float unsteady =
        std::min(0.5f * std::abs(d[0] - d[1] - d[2] + d[3]), most_detail * width_px * pixel);
    depth[i] = sum > 0 ? weighted / sum : 0;
    share[i] = 0.25f * sum;
    detail[i] = is_whole ? unsteady : -1;
    mean[i] = measured > 0 ? details / measured : -1;
  }
}

SFUMATO_WIDE void join_squares(const Children (&rows)[2], int count, float width_px, float pixels_per_unit,
                               bool orthographic, float* depth, float* share, float* detail, float* mean) {
  join(rows, count, width_px, pixels_per_unit, orthographic, depth, share, detail, mean);
}

using Pyramid = std::vector<Level>;

Pyramid pyramid_of(const View& view, const Image<float>& depth) {
  const int last = 1 << levels, width = (depth.width() + last - 1) / last * last,
            height = (depth.height() + last - 1) / last * last;
  const float pixels_per_unit = float(view.camera().pixels_per_unit());
  const bool orthographic = view.camera().orthographic();
  Pyramid out;
  for (int l = 0; l < levels; ++l) {
    out.emplace_back(width >> (l + 1), height >> (l + 1));
    Level& level = out.back();
    const auto join_row = [&](const Children(&rows)[2], int y) {
      join_squares(rows, level.depth.width(), float(2 << l), pixels_per_unit, orthographic,
                   &level.depth.at(0, y), &level.share.at(0, y), &level.detail.at(0, y),
                   &level.mean.at(0, y));
    };
    cpu::for_each_row(level.depth.height(), [&](int y) {
      if (l > 0) {
        const Level& finer = out[std::size_t(l - 1)];
        const auto row = [&](int of) {
          return Children{finer.depth.row(of), finer.share.row(of), finer.detail.row(of)};
        };
        join_row({row(2 * y), row(2 * y + 1)}, y);
        return;
      }
      thread_local std::vector<float> pixels;
      pixels.assign(std::size_t(5 * width), 0.0f);  // depths and shares of two rows, and no detail
      float* none = &pixels[std::size_t(4 * width)];
      std::fill_n(none, width, -1.0f);
      for (int k = 0; k < 2; ++k) {
        if (2 * y + k >= depth.height()) break;
        const float* from = depth.row(2 * y + k);
        float *d = &pixels[std::size_t(2 * k * width)], *s = d + width;
        for (int x = 0; x < depth.width(); ++x)
          d[x] = from[x] < INFINITY ? from[x] : 0, s[x] = from[x] < INFINITY ? 1.0f : 0.0f;
      }
      const float* d = pixels.data();
      join_row({{d, d + width, none}, {d + 2 * width, d + 3 * width, none}}, y);
    });
  }
  return out;
}

// relief_occlusion.glsl.

/// Places in a row or column of the picture, each `away` from the centre of one of the finest squares, and
/// the squares of a level around them.
struct Places {
  Places(int count, float side, float away, int level, int size) {
    const float wide = float(2 << level);
    const int last = (size - 1) >> (level + 1);
    for (int i = 0; i < count; ++i) {
      const float place = (float(i) + 0.5f) * side + away, at = place / wide - 0.5f, floor = std::floor(at);
      const int first = int(floor);
      low.push_back(std::clamp(first, 0, last)), high.push_back(std::clamp(first + 1, 0, last));
      next.push_back(std::min(low.back() + 1, last));
      before.push_back(floor), t.push_back(at - floor);
      is_outside.push_back(place < 0 || place > float(size));
    }
    // Loops read whole groups.
    for (std::vector<std::int32_t>* each : {&low, &high, &next, &is_outside})
      each->resize(std::size_t(count + lanes));
    for (std::vector<float>* each : {&before, &t}) each->resize(std::size_t(count + lanes));
  }
  std::vector<std::int32_t> low, high, next;  ///< squares; `next` is beyond `low`, where there is one
  std::vector<float> before, t;  ///< the square before, also outside, and how much of the way to the next
  std::vector<std::int32_t> is_outside;
};

struct OpennessLoop {
  OpennessLoop(const View& view, const Relief::Options& options, const Pyramid& of)
      : look(options),
        octaves(Relief::octaves(options, view.picture_height())),
        pyramid(of),
        eye(view),
        side(octaves.square_px()),
        farthest_px(octaves.away_px(octaves.end - 1)),
        width(pyramid[std::size_t(octaves.finest)].depth.width()),
        height(pyramid[std::size_t(octaves.finest)].depth.height()) {
    const int columns = view.width(), rows = view.height();
    for (int l = 0; l < levels; ++l)
      noise_x.emplace_back(width, side, 0.0f, l, columns), noise_y.emplace_back(height, side, 0.0f, l, rows);
    level_of.resize(std::size_t(octaves.end));
    for (int o = octaves.first; o < octaves.end; ++o) {
      const float away_px = octaves.away_px(o);
      const int level = std::clamp(int(std::floor(std::log2(away_px))) - 2, octaves.finest, levels - 1);
      level_of[std::size_t(o)] = level;
      for (const vec2& way : ways) {
        const vec2 away = away_px * way;
        around_x.emplace_back(width, side, away.x, level, columns);
        around_y.emplace_back(height, side, away.y, level, rows);
      }
    }
  }

  /// noise_of, of squares side by side, with the details of level `up`.
  [[gnu::always_inline]] void find_noise(int x, int y, int up, float* out) const {
    const Places &columns = noise_x[std::size_t(up)], &rows = noise_y[std::size_t(up)];
    const std::size_t first = std::size_t(x), row = std::size_t(y);
    const Image<float>& mean = pyramid[std::size_t(up)].mean;
    const float *over = mean.row(rows.low[row]), *under = mean.row(rows.high[row]), down = rows.t[row];
    for (int i = 0; i < lanes; ++i) {
      const std::int32_t low = columns.low[first + std::size_t(i)],
                         high = columns.high[first + std::size_t(i)];
      const float along = columns.t[first + std::size_t(i)];
      const float details[4] = {over[low], over[high], under[low], under[high]},
                  weights[4] = {(1 - along) * (1 - down), along * (1 - down), (1 - along) * down,
                                along * down};
      float sum = 0, known = 0;
      for (int k = 0; k < 4; ++k) {
        const float counts = details[k] >= 0 ? weights[k] : 0;
        sum += counts * details[k], known += counts;
      }
      out[i] = known > 0 ? sum / known : 0;
    }
  }

  /// Squares side by side.
  struct Here {
    float depth[lanes], eye_x[lanes], eye_y[lanes], toward_x[lanes], toward_y[lanes], toward_z[lanes],
        reach[lanes];
  };

  /// How steeply what lies around places rises towards the camera, at most.
  [[gnu::always_inline]] void climb(int x, int y, std::size_t way, int level, const Here& here,
                                    const float* noise, float* rise) const {
    constexpr float in_reach = 1, beyond = 2;
    const Places &columns = around_x[way], &rows = around_y[way];
    const std::size_t first = std::size_t(x), row = std::size_t(y);
    if (rows.is_outside[row]) return;
    const Image<float>& depth = pyramid[std::size_t(level)].depth;
    const float *over = depth.row(rows.low[row]), *under = depth.row(rows.next[row]), down = rows.t[row];
    const float wide = float(2 << level), before_y = rows.before[row] + 0.5f;
    for (int i = 0; i < lanes; ++i) {
      const std::int32_t low = columns.low[first + std::size_t(i)],
                         next = columns.next[first + std::size_t(i)];
      const float along = columns.t[first + std::size_t(i)], own = here.depth[i];
      const float depths[4] = {over[low], over[next], under[low], under[next]};
      float weights[4] = {(1 - along) * (1 - down), along * (1 - down), (1 - along) * down, along * down};
      float covered = 0, sum = 0;
      for (int k = 0; k < 4; ++k) {
        const float d = depths[k],
                    t = (own - d - in_reach * here.reach[i]) / ((beyond - in_reach) * here.reach[i]),
                    in = std::min(std::max(t, 0.0f), 1.0f);
        weights[k] *= d > 0 ? 1 - in * in * (3 - 2 * in) : 0;
        covered += weights[k], sum += weights[k] * d;
      }
      const float inverse = 1 / std::max(covered, 1e-6f), there = inverse * sum;
      const float before_x = columns.before[first + std::size_t(i)] + 0.5f,
                  pixel_x = (before_x + inverse * (weights[1] + weights[3])) * wide,
                  pixel_y = (before_y + inverse * (weights[2] + weights[3])) * wide;
      const float scale = eye.orthographic ? 1 : there;
      const float dx = (pixel_x + eye.tile.x - eye.middle.x) / eye.focal.x * scale - here.eye_x[i],
                  dy = (pixel_y + eye.tile.y - eye.middle.y) / eye.focal.y * scale - here.eye_y[i],
                  dz = own - there;
      const float higher = dx * here.toward_x[i] + dy * here.toward_y[i] + dz * here.toward_z[i],
                  across = std::sqrt(std::max(dx * dx + dy * dy + dz * dz - higher * higher, 0.0f));
      const float slope = (higher - noise[i]) / std::max(across, 1e-30f);
      const float counts =
          slope > 0 ? std::min(std::max(2 * covered - 1, 0.0f), 1.0f) : 1;  // a rim is no wall
      const bool is_any = (covered > 0) & (columns.is_outside[first + std::size_t(i)] == 0);
      rise[i] = std::max(rise[i], is_any ? slope * counts : nothing);
    }
  }

  [[gnu::always_inline]] void row(int y, vec2* out) const {
    constexpr float threshold = 2, deviations = 3.5f;
    const float* depths = pyramid[std::size_t(octaves.finest)].depth.row(y);
    for (int x = 0; x < width; x += lanes) {
      const int n = std::min(lanes, width - x);
      Here here;
      bool is_any = false;
      for (int i = 0; i < lanes; ++i)
        here.depth[i] = i < n ? depths[x + i] : 0, is_any = is_any || here.depth[i] > 0;
      if (!is_any) continue;
      float of_points[lanes], chances[lanes];
      for (int i = 0; i < lanes; ++i) {
        const float d = here.depth[i], scale = eye.orthographic ? 1 : d, pixels = eye.pixels_at(d);
        const vec2 center = (vec2(x + i, y) + 0.5f) * side;
        const vec2 slope = (center + eye.tile - eye.middle) / eye.focal;
        const vec3 at(slope * scale, -d), toward = eye.to_camera(at);
        here.eye_x[i] = at.x, here.eye_y[i] = at.y;
        here.toward_x[i] = toward.x, here.toward_y[i] = toward.y, here.toward_z[i] = toward.z;
        here.reach[i] = farthest_px / pixels;
        of_points[i] = cpu::point_noise_at(look, at);
        chances[i] = look.spacing * glm::smoothstep(2.5f, 6.0f, look.spacing * pixels);
      }
      float details[levels][lanes];
      for (int l = octaves.finest; l < levels; ++l) find_noise(x, y, l, details[l]);
      float rises[compass][lanes];
      std::fill_n(rises[0], compass * lanes, nothing);
      std::size_t way = 0;
      for (int o = octaves.first; o < octaves.end; ++o) {
        const int l = level_of[std::size_t(o)];
        float noise[lanes];
        for (int i = 0; i < lanes; ++i)
          noise[i] = std::max(std::max(threshold * details[coarser(l + 1)][i], deviations * of_points[i]),
                              0.5f * chances[i]);
        for (int k = 0; k < compass; ++k) climb(x, y, way++, l, here, noise, rises[k]);
      }
      for (int i = 0; i < n; ++i) {
        if (!(here.depth[i] > 0)) continue;
        float blocked = 0;
        for (int k = 0; k < compass / 2; ++k) {
          const float rise = rises[k][i], fall = rises[k + compass / 2][i];
          const float cosine = (1 - rise * fall) / std::sqrt((1 + rise * rise) * (1 + fall * fall));
          if (rise + fall > 0) blocked += 0.5f - 0.5f * cosine;
        }
        const float noise = threshold * std::max(details[coarser(octaves.finest)][i],
                                                 details[coarser(octaves.finest + 1)][i]);
        out[x + i] = vec2(1 - 0.25f * blocked, std::max(noise, deviations * of_points[i]));
      }
    }
  }
  /// Whose details the noise of a level is measured by.
  static int coarser(int level) { return std::min(level + 2, levels - 1); }

  static constexpr int compass = 8;
  static constexpr float nothing = -1e3f, half = 0.70710678f;  // the rise of the background
  static constexpr std::array<vec2, compass> ways{vec2(1, 0),        vec2(half, half), vec2(0, 1),
                                                  vec2(-half, half), vec2(-1, 0),      vec2(-half, -half),
                                                  vec2(0, -1),       vec2(half, -half)};

  const Relief::Options& look;
  Relief::Octaves octaves;
  const Pyramid& pyramid;
  cpu::Eye eye;
  float side, farthest_px;
  int width, height;
  std::vector<int> level_of;               // by octave
  std::vector<Places> noise_x, noise_y;    // by level
  std::vector<Places> around_x, around_y;  // by octave and way
};

SFUMATO_WIDE void find_row(const OpennessLoop& loop, int y, vec2* out) { loop.row(y, out); }

}  // namespace

Image<vec2> find_openness(const View& view, const Relief::Options& options, const Image<float>& depth) {
  const Pyramid pyramid = pyramid_of(view, depth);
  const OpennessLoop loop(view, options, pyramid);
  Image<vec2> out(loop.width, loop.height, vec2(1, 0));
  cpu::for_each_row(loop.height, [&](int y) { find_row(loop, y, &out.at(0, y)); });
  return out;
}

}  // namespace sfumato
