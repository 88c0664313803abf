// The demo: the court of a country house. An arcaded wing with a gate at the back (+y), another at the right
// (+x), a round tower in their corner, low walls to the left and in front, a fountain, beds, and a tree in
// front.
#include <cmath>

#include "synth/builder.h"

namespace sfumato::synth {
namespace {

constexpr double court_x = 9.4, court_y = 7.2;  // half size of the court
constexpr double wing_depth = 3, wall_top = 6;  // of the two wings
constexpr double bay = 2.4, arch_radius = 1.02, spring = 2.45, arcade_top = 3.95;

struct Court {
  Builder b{"courtyard"};
  Finish limestone, trim, plaster, ashlar, brick, tiles, wood, glass, paving, gravel, grass, soil, bark, leaf,
      hedge, water, bronze, clay;

  Court() {
    const auto make = [this](Pattern pattern, vec3 color, vec3 second, double size, double contrast,
                             double dirt, std::uint8_t class_id) {
      return Finish{b.material({pattern, color, second, size, contrast, dirt}), class_id};
    };
    limestone = make(Pattern::plain, from_srgb(222, 207, 180), vec3(0), 0.6, 0.10, 0.7, class_stonework);
    trim = make(Pattern::plain, from_srgb(232, 221, 199), vec3(0), 0.8, 0.07, 0, class_stonework);
    plaster = make(Pattern::plaster, from_srgb(226, 178, 118), from_srgb(190, 160, 130), 1.5, 0.10, 0.9,
                   class_building);
    ashlar = make(Pattern::ashlar, from_srgb(186, 168, 140), from_srgb(128, 116, 100), 0.62, 0.16, 0.8,
                  class_building);
    brick = make(Pattern::bricks, from_srgb(172, 102, 78), from_srgb(182, 156, 136), 0.44, 0.20, 0.5,
                 class_building);
    tiles = make(Pattern::roof_tiles, from_srgb(186, 96, 62), from_srgb(104, 52, 38), 0.24, 0.22, 0,
                 class_building);
    wood =
        make(Pattern::wood, from_srgb(118, 80, 50), from_srgb(78, 50, 32), 0.16, 0.14, 0.3, class_stonework);
    glass = make(Pattern::plain, from_srgb(66, 84, 96), vec3(0), 0.5, 0.25, 0, class_building);
    paving =
        make(Pattern::paving, from_srgb(190, 180, 164), from_srgb(128, 120, 106), 0.6, 0.13, 0, class_ground);
    gravel = make(Pattern::plain, from_srgb(168, 152, 124), vec3(0), 0.12, 0.16, 0, class_ground);
    grass = make(Pattern::grass, from_srgb(112, 148, 62), from_srgb(74, 112, 48), 0.7, 0.18, 0,
                 class_low_vegetation);
    soil =
        make(Pattern::grass, from_srgb(136, 140, 84), from_srgb(150, 134, 100), 1.0, 0.14, 0, class_ground);
    bark = make(Pattern::plain, from_srgb(104, 84, 66), vec3(0), 0.1, 0.3, 0, class_high_vegetation);
    leaf = make(Pattern::leaf, from_srgb(126, 164, 58), from_srgb(58, 112, 48), 1.1, 0.25, 0,
                class_high_vegetation);
    hedge = make(Pattern::leaf, from_srgb(88, 128, 66), from_srgb(40, 84, 46), 0.5, 0.25, 0,
                 class_high_vegetation);
    water = make(Pattern::marble, from_srgb(96, 148, 156), from_srgb(60, 112, 128), 1.2, 0.05, 0,
                 class_furniture);
    clay = make(Pattern::plain, from_srgb(188, 106, 72), vec3(0), 0.12, 0.12, 0, class_furniture);
    bronze = make(Pattern::plain, from_srgb(92, 128, 112), from_srgb(0, 0, 0), 0.2, 0.2, 0, class_furniture);
  }

  Finish as(Finish finish, ClassId class_id) const { return {finish.material, class_id}; }

  void column(double x, double y) {
    const dvec3 up(0, 0, 1);
    b.box({x - 0.25, y - 0.25, 0}, {x + 0.25, y + 0.25, 0.16}, limestone);
    b.torus({x, y, 0.22}, up, 0.17, 0.06, limestone);
    b.cone({x, y, 0.22}, up, 1.86, 0.17, 0.145, limestone);
    b.torus({x, y, 2.06}, up, 0.145, 0.03, limestone);
    b.cone({x, y, 2.08}, up, 0.24, 0.15, 0.24, limestone);
    b.box({x - 0.26, y - 0.26, 2.32}, {x + 0.26, y + 0.26, spring}, trim);
  }

  Opening arch(double x) const { return {x - arch_radius, x + arch_radius, spring, spring, true}; }

  /// Half a ring of stone around an arch, and its keystone.
  void archivolt(double x, double z, double radius, double y) {
    Primitive& ring = b.torus({x, y, z}, {0, -1, 0}, radius + 0.1, 0.055, trim);
    ring.x = b.to_world({0, 0, 1}) - b.to_world(dvec3(0));
    ring.y = glm::cross(ring.z, ring.x);
    ring.c = 0.5 * M_PI;
    b.box({x - 0.11, y - 0.09, z + radius - 0.05}, {x + 0.11, y + 0.02, z + radius + 0.34}, trim);
  }

  /// An upright window with stone frame, sill, pane and glazing bars, in a wall at y whose back is deeper.
  Opening window(double x, double z, double width, double height, double y) {
    const Opening o{x - 0.5 * width, x + 0.5 * width, z, z + height, false};
    const double deep = y + 0.22;
    b.reveal(o, y, 0.25, trim);
    b.wall(o.x_min, o.x_max, z, z + height, deep, -1, glass);
    b.box({x - 0.03, deep - 0.04, z}, {x + 0.03, deep, z + height}, trim);
    for (double part : {0.36, 0.7})
      b.box({o.x_min, deep - 0.04, z + part * height - 0.02}, {o.x_max, deep, z + part * height + 0.02},
            trim);
    b.box({o.x_min - 0.14, y - 0.1, z - 0.12}, {o.x_max + 0.14, y + 0.02, z}, trim);
    b.box({o.x_min - 0.14, y - 0.07, z + height}, {o.x_max + 0.14, y + 0.02, z + height + 0.16}, trim);
    b.box({o.x_min - 0.12, y - 0.04, z}, {o.x_min, y + 0.02, z + height}, trim);
    b.box({o.x_max, y - 0.04, z}, {o.x_max + 0.12, y + 0.02, z + height}, trim);
    return o;
  }

  /// Two shutters beside a window.
  void shutters(const Opening& o, double y) {
    const double width = 0.48 * (o.x_max - o.x_min);
    for (double x : {o.x_min - 0.14 - width, o.x_max + 0.14})
      b.box({x, y - 0.05, o.y_min}, {x + width, y, o.y_max}, as(bronze, class_stonework));
  }

  /// The bays of a wing in its own frame: the court's side is y = 0, bays from x0 on.
  void arcade(double x0, int bays) {
    const double x1 = x0 + bays * bay;
    std::vector<Opening> front, back, windows;
    for (int i = 0; i < bays; ++i) {
      const double x = x0 + (i + 0.5) * bay;
      front.push_back(arch(x));
      b.reveal(front.back(), 0, 0.4, limestone);
      archivolt(x, spring, arch_radius, 0);
      windows.push_back(window(x, 4.35, 0.86, 1.15, 0));
      shutters(windows.back(), 0);
    }
    for (int i = 0; i <= bays; ++i) {
      column(x0 + i * bay, 0.2);
      if (i < bays)
        b.floor(x0 + i * bay, x0 + i * bay + 0.5 * bay - arch_radius, 0, 0.4, spring, limestone, -1);
      if (i > 0) b.floor(x0 + i * bay - 0.5 * bay + arch_radius, x0 + i * bay, 0, 0.4, spring, limestone, -1);
    }
    b.wall(x0, x1, spring, arcade_top, 0, -1, as(limestone, class_stonework), front);
    b.wall(x0, x1, spring, arcade_top, 0.4, 1, as(plaster, class_stonework), front);
    b.wall(x0, x1, arcade_top, wall_top, 0, -1, plaster, windows);
    b.box({x0, -0.09, arcade_top - 0.09}, {x1, 0.01, arcade_top + 0.09}, trim);
    b.floor(x0, x1, 0.4, wing_depth - 0.4, arcade_top - 0.1, as(plaster, class_ceiling), -1);
  }

  /// What a wing has over its whole length: inner wall with doors, outer wall, cornice and roof.
  void wing(double x0, double x1, const std::vector<double>& doors, const std::vector<Opening>& passages) {
    std::vector<Opening> inner = passages;
    for (double x : doors) {
      const Opening door{x - 0.55, x + 0.55, 0, 2.0, true};
      inner.push_back(door);
      b.reveal(door, wing_depth - 0.4, 0.25, trim);
      b.wall(x - 0.55, x + 0.55, 0, 2.6, wing_depth - 0.2, -1, wood);
      archivolt(x, 2.0, 0.55, wing_depth - 0.4);
    }
    b.wall(x0, x1, 0, arcade_top - 0.1, wing_depth - 0.4, -1, as(plaster, class_stonework), inner);
    b.wall(x0, x1, 0, wall_top, wing_depth, 1, ashlar, passages);
    // Cornice in two steps, then a roof that overhangs both walls.
    b.box({x0, -0.12, wall_top - 0.22}, {x1, 0.02, wall_top - 0.1}, trim);
    b.box({x0, -0.24, wall_top - 0.1}, {x1, 0.02, wall_top + 0.04}, trim);
    const double rise = 1.25, half = 0.5 * (wing_depth + 0.8), length = std::hypot(half, rise);
    const double middle = 0.5 * (x0 + x1), ridge_y = 0.5 * wing_depth, z = wall_top + 0.04 + 0.5 * rise;
    b.quad({middle, ridge_y - 0.5 * half, z}, {1, 0, 0}, {0, half / length, rise / length}, 0.5 * (x1 - x0),
           0.5 * length, tiles);
    b.quad({middle, ridge_y + 0.5 * half, z}, {-1, 0, 0}, {0, -half / length, rise / length}, 0.5 * (x1 - x0),
           0.5 * length, tiles);
    b.cone({x0, ridge_y, wall_top + 0.04 + rise}, {1, 0, 0}, x1 - x0, 0.11, 0.11, as(tiles, class_building));
    b.floor(x0, x1, -0.4, wing_depth + 0.4, wall_top + 0.04, as(wood, class_building), -1);
    for (double side : {-1.0, 1.0}) {  // end walls and gables
      const double x = side < 0 ? x0 : x1, flat = 0.5 * (wall_top + 0.04);
      b.quad({x, ridge_y, flat}, {0, side, 0}, {0, 0, 1}, ridge_y, flat, ashlar);
      b.quad({x, ridge_y, z}, {0, side, 0}, {0, 0, 1}, half, 0.5 * rise, plaster).c = 0;
    }
  }

  /// Upright triangle of stone at the end of a roof or over the gate.
  void gable(double x0, double x1, double z, double rise, double y, int facing, Finish finish) {
    Primitive& p = b.wall(x0, x1, z, z + rise, y, facing, finish);
    p.c = 0;
  }

  /// The gate: a taller block that stands a little in front of its wing, open through and through.
  void gate(double x) {
    const double half = 2.2, front = -0.45, top = 7.0, radius = 1.45, start = 2.9;
    const Opening way{x - radius, x + radius, 0, start, true};
    b.reveal(way, front, wing_depth - front, limestone);
    b.wall(x - half, x + half, 0, top, front, -1, as(ashlar, class_stonework), {way});
    b.quad({x - half, 0.5 * (front + wing_depth), 0.5 * top}, {0, -1, 0}, {0, 0, 1},
           0.5 * (wing_depth - front), 0.5 * top, plaster);
    b.quad({x + half, 0.5 * (front + wing_depth), 0.5 * top}, {0, 1, 0}, {0, 0, 1},
           0.5 * (wing_depth - front), 0.5 * top, plaster);
    b.wall(x - half, x + half, 0, top, wing_depth + 0.02, 1, as(ashlar, class_building), {way});
    archivolt(x, start, radius, front);
    b.box({x - radius - 0.3, front - 0.06, start - 0.16}, {x - radius + 0.02, front + 0.02, start}, trim);
    b.box({x + radius - 0.02, front - 0.06, start - 0.16}, {x + radius + 0.3, front + 0.02, start}, trim);
    for (double side : {-1.0, 1.0}) {  // engaged columns that carry the pediment
      const double cx = x + side * (half - 0.3), cy = front - 0.12;
      b.box({cx - 0.24, cy - 0.2, 0}, {cx + 0.24, cy + 0.2, 0.5}, limestone);
      b.torus({cx, cy, 0.54}, {0, 0, 1}, 0.15, 0.05, limestone);
      b.cone({cx, cy, 0.5}, {0, 0, 1}, 4.3, 0.16, 0.135, limestone);
      b.cone({cx, cy, 4.75}, {0, 0, 1}, 0.2, 0.14, 0.22, limestone);
      b.box({cx - 0.23, cy - 0.2, 4.95}, {cx + 0.23, cy + 0.2, 5.1}, trim);
    }
    b.box({x - half - 0.12, front - 0.36, 5.1}, {x + half + 0.12, front + 0.02, 5.45}, trim);
    b.disc({x, front - 0.01, 6.2}, {0, -1, 0}, 0.45, glass);
    b.torus({x, front, 6.2}, {0, -1, 0}, 0.5, 0.07, trim);
    b.box({x - half - 0.18, front - 0.3, top}, {x + half + 0.18, wing_depth + 0.2, top + 0.18}, trim);
    const double rise = 1.3, wide = half + 0.18;
    gable(x - wide, x + wide, top + 0.18, rise, front - 0.05, -1, as(plaster, class_stonework));
    gable(x - wide, x + wide, top + 0.18, rise, wing_depth + 0.1, 1, as(plaster, class_stonework));
    const double slope = std::hypot(wide, rise), depth = 0.5 * (wing_depth + 0.1 - (front - 0.05)) + 0.15;
    const double cy = 0.5 * (front - 0.05 + wing_depth + 0.1);
    for (double side : {-1.0, 1.0})
      b.quad({x + side * 0.5 * wide, cy, top + 0.2 + 0.5 * rise}, {0, side, 0},
             {-side * wide / slope, 0, rise / slope}, depth, 0.5 * slope, tiles);
    b.sphere({x, front, top + 0.2 + rise + 0.22}, 0.2, trim);
    for (double side : {-1.0, 1.0}) {
      b.cone({x + side * wide, front - 0.1, top + 0.18}, {0, 0, 1}, 0.35, 0.12, 0.08, trim);
      b.sphere({x + side * wide, front - 0.1, top + 0.62}, 0.15, trim);
    }
  }

  void tower(double x, double y) {
    const dvec3 up(0, 0, 1);
    const double radius = 2.35, height = 10.2;
    b.cone({x, y, 0}, up, 0.7, radius + 0.18, radius, ashlar);
    b.cone({x, y, 0.7}, up, height - 0.7, radius, radius, brick);
    for (double z : {wall_top + 0.55, height - 0.35}) b.torus({x, y, z}, up, radius, 0.11, trim);
    b.cone({x, y, height}, up, 0.28, radius, radius + 0.36, trim);
    b.cone({x, y, height + 0.28}, up, 3.7, radius + 0.5, 0.04, tiles);
    b.sphere({x, y, height + 4.1}, 0.2, bronze);
    b.cone({x, y, height + 4.2}, up, 0.9, 0.04, 0.01, bronze);
    for (int i = 0; i < 8; ++i) {  // narrow windows below the roof
      const double angle = (i + 0.5) * M_PI / 4;
      b.place({x, y, 0}, angle);
      const double z = 7.9, r = radius + 0.02;
      b.box({-0.32, -r - 0.06, z}, {0.32, -r + 0.2, z + 1.25}, trim);
      b.wall(-0.2, 0.2, z + 0.12, z + 1.12, -r - 0.07, -1, glass);
      b.place({});
    }
  }

  void low_wall(double length) {  // along x from 0, thickness 0.4 around y = 0
    b.box({0, -0.2, 0}, {length, 0.2, 0.85}, ashlar);
    b.box({-0.02, -0.28, 0.85}, {length + 0.02, 0.28, 0.99}, as(trim, class_building));
  }

  void pier(double x, double y, double height) {
    b.box({x - 0.35, y - 0.35, 0}, {x + 0.35, y + 0.35, height}, as(ashlar, class_building));
    b.box({x - 0.45, y - 0.45, height}, {x + 0.45, y + 0.45, height + 0.14}, trim);
    b.sphere({x, y, height + 0.42}, 0.3, trim);
  }

  void fountain(double x, double y) {
    const dvec3 up(0, 0, 1);
    b.place({x, y, 0});
    b.cone({0, 0, 0}, up, 0.12, 2.05, 2.05, limestone);
    b.disc({0, 0, 0.12}, up, 2.05, limestone).b = 1.5;
    b.cone({0, 0, 0.12}, up, 0.42, 1.6, 1.68, limestone);
    b.torus({0, 0, 0.56}, up, 1.66, 0.1, trim);
    b.cone({0, 0, 0.12}, up, 0.42, 1.54, 1.58, limestone).inward = true;
    b.disc({0, 0, 0.44}, up, 1.58, water);
    b.cone({0, 0, 0.4}, up, 0.75, 0.26, 0.16, limestone);
    b.torus({0, 0, 0.75}, up, 0.2, 0.06, limestone);
    b.cone({0, 0, 1.15}, up, 0.24, 0.16, 0.82, limestone);
    b.torus({0, 0, 1.4}, up, 0.8, 0.06, trim);
    b.disc({0, 0, 1.38}, up, 0.8, water);
    b.cone({0, 0, 1.38}, up, 0.5, 0.1, 0.07, limestone);
    b.sphere({0, 0, 2.0}, 0.2, bronze);
    b.place({});
  }

  /// A lawn inside a kerb.
  void bed(double x0, double x1, double y0, double y1) {
    b.box({x0, y0, 0}, {x1, y1, 0.14}, limestone);
    b.box({x0 + 0.16, y0 + 0.16, 0.14}, {x1 - 0.16, y1 - 0.16, 0.2}, grass);
  }

  void pot(double x, double y, std::uint64_t seed) {
    b.place({x, y, 0});
    b.cone({0, 0, 0}, {0, 0, 1}, 0.5, 0.22, 0.32, clay);
    b.torus({0, 0, 0.5}, {0, 0, 1}, 0.32, 0.045, clay);
    add_bush(b, {0, 0, 0.95}, {0.42, 0.42, 0.46}, 700, 0.045, seed, hedge);
    b.place({});
  }

  void bench(double x, double y, double yaw) {
    b.place({x, y, 0}, yaw);
    const Finish seat = as(wood, class_furniture), stone = as(limestone, class_furniture);
    b.box({-0.85, -0.25, 0.42}, {0.85, 0.25, 0.5}, seat);
    for (double side : {-0.62, 0.62}) b.box({side - 0.09, -0.2, 0}, {side + 0.09, 0.2, 0.42}, stone);
    b.place({});
  }
};

}  // namespace

Scene make_courtyard() {
  Court c;
  Builder& b = c.b;
  const double inner_x = court_x + wing_depth, inner_y = court_y + wing_depth;

  // Ground: flagstones in the court, a gravel path through both gates, meadow around.
  b.floor(-court_x, inner_x, -court_y, inner_y, 0, c.paving);
  Primitive& meadow = b.floor(-11.5, 14.5, -9.5, 12.5, 0, c.soil);
  const double cx = 1.5, cy = 1.5;  // its centre
  meadow.openings = {{-court_x - cx, inner_x - cx, -court_y - cy, inner_y - cy, false},
                     {-1.5 - cx, 1.5 - cx, -9.5 - cy, -court_y - cy, false},
                     {-1.5 - cx, 1.5 - cx, inner_y - cy, 12.5 - cy, false}};
  b.floor(-1.5, 1.5, -9.5, -court_y, 0, c.gravel);
  b.floor(-1.5, 1.5, inner_y, 12.5, 0, c.gravel);

  const double gate_half = 2.2;
  b.place({0, court_y, 0});
  c.arcade(-court_x, 3);
  c.arcade(gate_half, 3);
  c.wing(-court_x, court_x, {-7, 7}, {{-1.45, 1.45, 0, 2.9, true}});
  c.gate(0);
  b.place({court_x, court_y, 0}, -0.5 * M_PI);
  c.arcade(0, 6);
  c.wing(0, 2 * court_y, {3.6, 8.4, 10.8}, {});
  b.place({});
  c.tower(court_x + 0.5 * wing_depth, court_y + 0.5 * wing_depth);

  // Low walls to the left and in front, with a second gate between piers.
  b.place({-court_x, -court_y, 0}, 0.5 * M_PI);
  c.low_wall(2 * court_y);
  b.place({-court_x, -court_y, 0});
  c.low_wall(court_x - 1.9);
  b.place({1.9, -court_y, 0});
  c.low_wall(court_x - 1.9);
  b.place({});
  for (double x : {-1.9, 1.9}) c.pier(x, -court_y, 2.5);
  c.pier(-court_x, -court_y, 1.5);

  c.fountain(0, 0);
  for (double x : {-7.6, 2.4})
    for (double y : {-5.3, 1.5}) c.bed(x, x + 5.2, y, y + 3.8);
  std::uint64_t seed = 10;
  for (double x : {-1.9, 1.9}) c.pot(x, court_y - 1.1, seed++);
  for (double x : {-2.0, 2.0})
    for (double y : {-1.9, 1.9}) c.pot(x, y, seed++);
  for (double y : {-3.6, 3.6}) c.bench(8.4, y, 0.5 * M_PI);
  c.bench(-5, 0.6, 0);
  b.place({-6.2, 3.9, 0.2});
  add_bush(b, {0, 0, 2.3}, {0.62, 0.62, 2.2}, 5000, 0.06, 31, c.hedge);
  b.place({6.4, 4.2, 0.2});
  add_bush(b, {0, 0, 1.9}, {0.55, 0.55, 1.8}, 4000, 0.06, 32, c.hedge);
  b.place({-5.9, -4.1, 0.2});
  add_bush(b, {0, 0, 0.5}, {0.8, 0.7, 0.55}, 2500, 0.05, 33, c.hedge);
  b.place({4.7, -3.5, 0.2});
  TreeShape tree;
  tree.height = 6.6, tree.crown_radius = 2.5, tree.trunk_radius = 0.2, tree.leaves = 26000,
  tree.leaf_radius = 0.062;
  add_tree(b, tree, c.bark, c.leaf);
  b.place({});

  // Two stations in the court, and one on a mast outside, which sees the roofs.
  b.scene.scanners = {{-4.4, -0.5, 1.7}, {1.2, -6.2, 1.7}, {-6.5, -9.2, 12}};
  b.scene.natural = Sampling::scanners;
  return std::move(b.scene);
}

}  // namespace sfumato::synth
