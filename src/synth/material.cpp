#include "synth/material.h"

#include <algorithm>
#include <cmath>

namespace sfumato::synth {
namespace {

double hash(std::int64_t x, std::int64_t y, std::int64_t z = 0) {
  const std::uint64_t key = std::uint64_t(x) * 0x9E3779B97F4A7C15ull ^
                            std::uint64_t(y) * 0xC2B2AE3D27D4EB4Full ^
                            std::uint64_t(z) * 0x165667B19E3779F9ull;
  return double(mix_bits(key + 0x27D4EB2Full) >> 11) * 0x1p-53;
}

double smooth(double t) { return t * t * (3 - 2 * t); }

/// Value noise in [-1, 1], about one feature a unit.
double noise(dvec3 p) {
  const dvec3 cell = glm::floor(p), f = p - cell;
  const std::int64_t x = std::int64_t(cell.x), y = std::int64_t(cell.y), z = std::int64_t(cell.z);
  const double u = smooth(f.x), v = smooth(f.y), w = smooth(f.z);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    sum += (i ? u : 1 - u) * (j ? v : 1 - v) * (k ? w : 1 - w) * hash(x + i, y + j, z + k);
  }
  return 2 * sum - 1;
}

/// Three octaves, in about [-1, 1].
double cloudy(dvec3 p) { return 0.55 * noise(p) + 0.3 * noise(2.03 * p + 7.1) + 0.15 * noise(4.1 * p + 3.7); }

vec3 mix(vec3 a, vec3 b, double t) { return glm::mix(a, b, float(std::clamp(t, 0.0, 1.0))); }

/// 0 in the joint (of half width `joint`), 1 on the piece; u and v are positions inside the piece in scene
/// units.
double off_joint(double u, double v, double width, double height, double joint) {
  const double edge = std::min(std::min(u, width - u), std::min(v, height - v));
  return smooth(std::clamp(edge / joint - 0.3, 0.0, 1.0));
}

struct Piece {
  double tint = 0;      ///< [-1, 1], one per piece
  double presence = 1;  ///< 0 in the joint
};

/// Rows of pieces `width` long and `height` high, each row shifted; `jitter` varies the lengths.
Piece masonry(dvec2 uv, double width, double height, double shift, double jitter, double joint) {
  const std::int64_t row = std::int64_t(std::floor(uv.y / height));
  const double offset = shift * double(row & 1) + jitter * hash(row, 17);
  const double along = uv.x / width + offset;
  const std::int64_t index = std::int64_t(std::floor(along));
  // Joints move by up to half the jitter, so no two stones need have one length.
  const double left = double(index) + 0.5 * jitter * hash(row, index),
               right = double(index) + 1 + 0.5 * jitter * hash(row, index + 1);
  const bool before = along < left;
  const std::int64_t id = before ? index - 1 : index;
  const double start = before ? double(index) - 1 + 0.5 * jitter * hash(row, index - 1) : left;
  const double end = before ? left : right;
  Piece piece;
  piece.tint = 2 * hash(row, id, 5) - 1;
  piece.presence =
      off_joint((along - start) * width, uv.y - double(row) * height, (end - start) * width, height, joint);
  return piece;
}

vec3 pieces(const Material& m, Piece piece, double mottling) {
  const double brightness = 1 + m.contrast * (piece.tint + 0.6 * mottling);
  // Bright pieces are a little warmer than dark ones, as fired clay and limestone are.
  const vec3 warm(1.0f + 0.25f * float(m.contrast * piece.tint), 1,
                  1.0f - 0.25f * float(m.contrast * piece.tint));
  return mix(m.second * float(1 + 0.3 * mottling), m.color * warm * float(brightness), piece.presence);
}

}  // namespace

vec3 albedo(const Material& m, const SurfacePoint& s, std::uint32_t primitive) {
  const dvec3 p = s.position;
  const double mottling = cloudy(3.0 * p / std::max(m.size, 1e-6) * 0.35);
  vec3 color = m.color;
  switch (m.pattern) {
    case Pattern::plain: color *= float(1 + m.contrast * mottling); break;
    case Pattern::checker: {
      const dvec3 cell = glm::floor((p + 1e-7) / m.size);
      const bool odd = std::int64_t(cell.x + cell.y + cell.z) & 1;
      color = (odd ? m.second : m.color) * float(1 + m.contrast * mottling);
      break;
    }
    case Pattern::bricks:
      color = pieces(m, masonry(s.uv, m.size, 0.32 * m.size, 0.5, 0, 0.035 * m.size), mottling);
      break;
    case Pattern::ashlar:
      color = pieces(m, masonry(s.uv, m.size, 0.5 * m.size, 0.5, 0.7, 0.02 * m.size), mottling);
      break;
    case Pattern::paving:
      color = pieces(m, masonry(s.uv, m.size, m.size, 0.5, 0.3, 0.025 * m.size), mottling);
      break;
    case Pattern::plaster: {
      // Stains are drawn out downwards, as rain does.
      const double streaks = cloudy(dvec3(1.7 * p.x, 1.7 * p.y, 0.35 * p.z));
      const double worn = std::max(0.0, cloudy(0.9 * p + 40.0) - 0.35);
      color = mix(m.color * float(1 + m.contrast * (0.6 * streaks + 0.4 * mottling)), m.second, 2.5 * worn);
      break;
    }
    case Pattern::roof_tiles: {
      const Piece tile = masonry(s.uv, m.size, 1.4 * m.size, 0, 0, 0.08 * m.size);
      // A tile is a half round: darker towards its sides and under its upper neighbour.
      const double across = s.uv.x / m.size - std::floor(s.uv.x / m.size) - 0.5;
      color = pieces(m, tile, mottling) * float(1 - 1.6 * across * across);
      break;
    }
    case Pattern::wood: {
      const double plank = std::floor(s.uv.x / m.size), inside = s.uv.x / m.size - plank;
      const double offset = hash(std::int64_t(plank), 3);
      const double grain =
          std::sin(40 * inside + 6 * cloudy(dvec3(4 * inside, 0.8 * s.uv.y / m.size + 9 * offset, plank)));
      color = mix(m.color, m.second, 0.35 + 0.3 * grain) * float(1 + m.contrast * (2 * offset - 1));
      if (std::min(inside, 1 - inside) < 0.02) color *= 0.4f;
      break;
    }
    case Pattern::grass: {
      const double blades = noise(p / (0.08 * m.size)), patches = cloudy(p / (3 * m.size));
      color = mix(m.color, m.second, 0.5 + 0.6 * patches) * float(1 + m.contrast * (blades + 0.5 * mottling));
      break;
    }
    case Pattern::leaf: {
      const double own = hash(primitive, 11), hue = hash(primitive, 23);
      color = mix(m.color, m.second, 0.65 * hue + 0.35 * (0.5 + 0.5 * cloudy(p / m.size)));
      color *= float(1 + m.contrast * (2 * own - 1));
      break;
    }
    case Pattern::marble: {
      const double vein = std::abs(std::sin(5 * p.z / m.size + 3 * p.x / m.size + 4 * cloudy(p / m.size)));
      color = mix(m.second, m.color, std::sqrt(vein)) * float(1 + m.contrast * mottling);
      break;
    }
    case Pattern::cloth: {
      const double u = s.uv.x / m.size, v = s.uv.y / m.size;
      const bool border = (std::int64_t(std::floor(u)) + std::int64_t(std::floor(v))) % 3 == 0;
      const double weave = 0.5 * (std::sin(60 * u) * std::sin(60 * v));
      color = (border ? m.second : m.color) * float(1 + m.contrast * (weave + 0.5 * mottling));
      break;
    }
  }
  if (m.dirt_height > 0 && p.z < m.dirt_height) {
    const double depth = 1 - std::max(p.z, 0.0) / m.dirt_height + 0.4 * mottling;
    color = mix(color, color * vec3(0.55f, 0.56f, 0.48f), smooth(std::clamp(depth, 0.0, 1.0)));
  }
  return glm::clamp(color, vec3(0.003f), vec3(0.97f));
}

double luminance(vec3 c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

Rgba8 to_srgb(vec3 linear, std::uint8_t alpha) {
  const auto encode = [](float v) {
    const double s = v <= 0.0031308f ? 12.92 * v : 1.055 * std::pow(double(v), 1 / 2.4) - 0.055;
    return std::uint8_t(std::clamp(s, 0.0, 1.0) * 255 + 0.5);
  };
  return {encode(linear.r), encode(linear.g), encode(linear.b), alpha};
}

vec3 from_srgb(int r, int g, int b) {
  const auto decode = [](int v) {
    const double s = v / 255.0;
    return float(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  };
  return {decode(r), decode(g), decode(b)};
}

}  // namespace sfumato::synth
