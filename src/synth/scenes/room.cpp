// A living room with dark and bright materials, seen by ten RGB-D cameras from its middle and its corners.
#include <cmath>

#include "synth/builder.h"

namespace sfumato::synth {
namespace {

constexpr double width = 5.4, depth = 4.4, height = 2.7;

struct Room {
  Builder b{"room"};
  Finish plaster, accent, ceiling, parquet, white, oak, walnut, black, sofa, cushion, rug, curtain, glass,
      brass, shade, terracotta, leaf, bark, marble;

  Room() {
    const auto make = [this](Pattern pattern, vec3 color, vec3 second, double size, double contrast,
                             std::uint8_t class_id) {
      return Finish{b.material({pattern, color, second, size, contrast, 0}), class_id};
    };
    plaster =
        make(Pattern::plaster, from_srgb(228, 220, 206), from_srgb(214, 204, 188), 2.0, 0.04, class_building);
    accent =
        make(Pattern::plaster, from_srgb(112, 138, 142), from_srgb(104, 128, 130), 1.5, 0.06, class_building);
    ceiling = make(Pattern::plain, from_srgb(240, 238, 232), vec3(0), 1.5, 0.03, class_ceiling);
    parquet = make(Pattern::wood, from_srgb(182, 132, 84), from_srgb(138, 92, 56), 0.14, 0.18, class_ground);
    white = make(Pattern::plain, from_srgb(238, 236, 230), vec3(0), 0.5, 0.03, class_furniture);
    oak = make(Pattern::wood, from_srgb(198, 158, 108), from_srgb(166, 122, 78), 0.22, 0.10, class_furniture);
    walnut = make(Pattern::wood, from_srgb(98, 66, 46), from_srgb(66, 42, 30), 0.25, 0.12, class_furniture);
    black = make(Pattern::plain, from_srgb(26, 26, 28), vec3(0), 0.3, 0.2, class_furniture);
    sofa = make(Pattern::cloth, from_srgb(62, 78, 102), from_srgb(54, 70, 94), 0.05, 0.12, class_furniture);
    cushion =
        make(Pattern::cloth, from_srgb(206, 148, 62), from_srgb(222, 178, 104), 0.06, 0.1, class_furniture);
    rug = make(Pattern::cloth, from_srgb(158, 62, 54), from_srgb(216, 192, 160), 0.22, 0.12, class_furniture);
    curtain =
        make(Pattern::cloth, from_srgb(206, 196, 178), from_srgb(190, 178, 160), 0.12, 0.06, class_furniture);
    glass =
        make(Pattern::marble, from_srgb(178, 208, 228), from_srgb(150, 190, 216), 2.5, 0.02, class_building);
    brass = make(Pattern::plain, from_srgb(176, 140, 72), vec3(0), 0.2, 0.1, class_furniture);
    shade = make(Pattern::plain, from_srgb(244, 226, 190), vec3(0), 0.2, 0.04, class_furniture);
    terracotta = make(Pattern::plain, from_srgb(176, 98, 68), vec3(0), 0.15, 0.12, class_furniture);
    leaf =
        make(Pattern::leaf, from_srgb(92, 140, 66), from_srgb(42, 92, 48), 0.4, 0.25, class_high_vegetation);
    bark = make(Pattern::plain, from_srgb(110, 86, 60), vec3(0), 0.1, 0.2, class_high_vegetation);
    marble =
        make(Pattern::marble, from_srgb(226, 222, 214), from_srgb(150, 146, 142), 0.4, 0.04, class_furniture);
  }

  /// Walls, seen from inside: the window in the back (y = depth), a door in the front, a coloured left wall.
  void shell() {
    const dvec3 up(0, 0, 1);
    const Opening window{1.5, 3.9, 0.85, 2.3, false}, door{3.9, 4.8, 0, 2.05, false};
    b.wall(0, width, 0, height, depth, -1, plaster, {window});
    b.wall(0, width, 0, height, 0, 1, plaster, {door});
    b.quad({0, 0.5 * depth, 0.5 * height}, {0, 1, 0}, up, 0.5 * depth, 0.5 * height, accent);
    b.quad({width, 0.5 * depth, 0.5 * height}, {0, -1, 0}, up, 0.5 * depth, 0.5 * height, plaster);
    b.floor(0, width, 0, depth, 0, parquet);
    b.floor(0, width, 0, depth, height, ceiling, -1);

    b.reveal(window, depth, 0.22, white);
    b.wall(window.x_min, window.x_max, window.y_min, window.y_max, depth + 0.2, -1, glass);
    for (double x : {1.5, 2.28, 3.06, 3.84})
      b.box({x, depth + 0.12, 0.85}, {x + 0.06, depth + 0.2, 2.3}, white);
    b.box({1.4, depth - 0.14, 0.8}, {4.0, depth, 0.85}, marble);
    b.reveal(door, -0.12, 0.12, white);
    b.wall(door.x_min, door.x_max, 0, door.y_max, -0.1, 1, oak);
    for (double x : {door.x_min - 0.1, door.x_max}) b.box({x, 0, 0}, {x + 0.1, 0.03, 2.05}, white);
    b.box({door.x_min - 0.1, 0, 2.05}, {door.x_max + 0.1, 0.03, 2.15}, white);
    b.sphere({4.0, -0.04, 1.0}, 0.035, brass);
    // Skirting boards and a picture rail.
    b.box({0, depth - 0.015, 0}, {width, depth, 0.09}, white);
    b.box({width - 0.015, 0, 0}, {width, depth, 0.09}, white);
    b.box({0, 0, 0}, {0.015, depth, 0.09}, white);
    b.box({0, 0, 0}, {door.x_min - 0.1, 0.015, 0.09}, white);
    // Curtains: upright rolls of cloth on a rod.
    b.cone({1.0, depth - 0.1, 2.42}, {1, 0, 0}, 3.4, 0.018, 0.018, brass);
    for (double start : {1.05, 3.85})
      for (int fold = 0; fold < 7; ++fold)
        b.cone({start + 0.075 * fold, depth - 0.1 + 0.02 * (fold % 2), 0.06}, up, 2.36, 0.05, 0.04, curtain);
  }

  /// A sofa along the left wall, looking to +x.
  void seats() {
    b.box({0.12, 1.1, 0.12}, {1.02, 3.3, 0.42}, sofa);
    b.box({0.08, 1.1, 0.12}, {0.34, 3.3, 0.86}, sofa);
    for (double y : {0.92, 3.3}) {
      b.box({0.1, y, 0.12}, {1.0, y + 0.18, 0.58}, sofa);
      b.cone({0.1, y + 0.09, 0.58}, {1, 0, 0}, 0.9, 0.09, 0.09, sofa);
      b.disc({1.0, y + 0.09, 0.58}, {1, 0, 0}, 0.09, sofa);
    }
    for (double y : {1.13, 2.22}) b.box({0.32, y, 0.42}, {1.0, y + 1.05, 0.54}, sofa);
    for (double x : {0.2, 0.92})
      for (double y : {1.0, 3.4}) b.cone({x, y, 0}, {0, 0, 1}, 0.12, 0.025, 0.03, walnut);
    b.place({0.5, 1.42, 0.73}, 0.3);
    b.sphere({0, 0, 0}, 0.19, cushion);
    b.place({0.5, 3.02, 0.73}, -0.2);
    b.sphere({0, 0, 0}, 0.19, cushion);
    b.place({});
    // An armchair turned towards the middle: a shell of a cylinder around a seat.
    b.place({4.35, 1.35, 0}, glm::radians(155.0));
    for (bool inside : {false, true}) {
      Primitive& back =
          b.cone({0, 0, 0.3}, {0, 0, 1}, 0.5, inside ? 0.34 : 0.42, inside ? 0.38 : 0.46, cushion);
      back.x = b.to_world({-1, 0, 0}) - b.to_world(dvec3(0));
      back.y = glm::cross(back.z, back.x);
      back.d = 0.6 * M_PI;
      back.inward = inside;
    }
    b.cone({0, 0, 0.18}, {0, 0, 1}, 0.24, 0.4, 0.4, cushion);
    b.disc({0, 0, 0.42}, {0, 0, 1}, 0.4, cushion);
    for (int leg = 0; leg < 4; ++leg)
      b.cone({0.27 * std::cos(leg * 0.5 * M_PI + 0.8), 0.27 * std::sin(leg * 0.5 * M_PI + 0.8), 0}, {0, 0, 1},
             0.2, 0.015, 0.025, walnut);
    b.place({});
  }

  void table() {
    b.floor(1.35, 3.65, 1.1, 3.2, 0.012, rug);
    b.place({2.35, 2.15, 0});
    b.cone({0, 0, 0.38}, {0, 0, 1}, 0.04, 0.55, 0.55, oak);
    b.disc({0, 0, 0.42}, {0, 0, 1}, 0.55, oak);
    b.disc({0, 0, 0.38}, {0, 0, -1}, 0.55, oak);
    for (int leg = 0; leg < 3; ++leg) {
      const double angle = leg * 2 * M_PI / 3 + 0.4;
      const dvec3 foot(0.42 * std::cos(angle), 0.42 * std::sin(angle), 0.01),
          top(0.28 * std::cos(angle), 0.28 * std::sin(angle), 0.38);
      b.cone(foot, glm::normalize(top - foot), glm::length(top - foot), 0.018, 0.026, walnut);
    }
    b.sphere({0.12, 0.05, 0.5}, 0.16, marble, -0.5, 0.1);  // a bowl with fruit
    b.sphere({0.12, 0.05, 0.51}, 0.15, marble, -0.5, 0.05).inward = true;
    b.sphere({0.09, 0.02, 0.5}, 0.045, cushion);
    b.sphere({0.17, 0.06, 0.5}, 0.045, terracotta);
    b.sphere({0.1, 0.1, 0.5}, 0.042, leaf);
    b.place({2.1, 2.3, 0.42}, 0.5);
    b.box({-0.12, -0.085, 0}, {0.12, 0.085, 0.025}, terracotta);
    b.box({-0.1, -0.08, 0.025}, {0.11, 0.075, 0.045}, white);
    b.place({});
  }

  /// Shelves with books on the right wall.
  void shelves() {
    const double y0 = 2.35, y1 = 3.95, back = width, front = width - 0.3, top = 2.1;
    for (double y : {y0, 0.5 * (y0 + y1) - 0.012, y1 - 0.025})
      b.box({front, y, 0}, {back, y + 0.025, top}, oak);
    for (int level = 0; level <= 6; ++level)
      b.box({front, y0, 0.04 + level * 0.34}, {back, y1, 0.065 + level * 0.34}, oak);
    b.quad({back - 0.005, 0.5 * (y0 + y1), 0.5 * top}, {0, -1, 0}, {0, 0, 1}, 0.5 * (y1 - y0), 0.5 * top,
           walnut);
    const int colors[10][3] = {{146, 52, 48},   {38, 66, 96}, {206, 190, 150}, {60, 92, 70},
                               {178, 124, 60},  {90, 60, 96}, {224, 220, 208}, {44, 44, 50},
                               {120, 142, 150}, {190, 90, 50}};
    Finish covers[10];
    for (int i = 0; i < 10; ++i)
      covers[i] = {b.material({Pattern::plain, from_srgb(colors[i][0], colors[i][1], colors[i][2]), vec3(0),
                               0.1, 0.1}),
                   class_furniture};
    Random random(1, Stream::layout, 7);
    for (int level = 0; level < 6; ++level)
      for (double start : {y0 + 0.03, 0.5 * (y0 + y1) + 0.02}) {
        double y = start;
        const double end = start + 0.5 * (y1 - y0) - 0.06;
        const double full = random.uniform(0.55, 1.0) * (end - start) + start;
        while (true) {
          const double thick = random.uniform(0.018, 0.05), tall = random.uniform(0.19, 0.29);
          if (y + thick > full) break;
          const double set_back = random.uniform(0.02, 0.07);
          b.box({front + set_back, y, 0.065 + level * 0.34},
                {back - 0.02, y + thick - 0.001, 0.065 + level * 0.34 + tall},
                covers[std::size_t(random.uniform() * 10)]);
          y += thick;
        }
        if (end - y > 0.2)
          b.sphere({front + 0.14, end - 0.1, 0.065 + level * 0.34 + 0.08}, 0.08, level % 2 ? brass : marble);
      }
  }

  /// A low board with a television on the front wall, a plant, lamps, pictures.
  void things() {
    b.box({1.1, 0.02, 0.18}, {3.1, 0.46, 0.52}, walnut);
    for (double x : {1.12, 1.78, 2.44}) b.box({x, 0.46, 0.2}, {x + 0.63, 0.475, 0.5}, white);
    for (double x : {1.2, 2.95})
      for (double y : {0.1, 0.38}) b.cone({x, y, 0}, {0, 0, 1}, 0.18, 0.02, 0.03, black);
    b.box({1.35, 0.1, 0.62}, {2.85, 0.14, 1.46}, black);
    b.box({1.9, 0.08, 0.52}, {2.3, 0.3, 0.54}, black);
    b.box({2.06, 0.1, 0.54}, {2.14, 0.14, 0.62}, black);

    b.place({0.5, 0.5, 0});  // a plant in the corner
    b.cone({0, 0, 0}, {0, 0, 1}, 0.34, 0.15, 0.21, terracotta);
    b.torus({0, 0, 0.34}, {0, 0, 1}, 0.21, 0.02, terracotta);
    b.disc({0, 0, 0.3}, {0, 0, 1}, 0.205, bark);
    Random random(2, Stream::layout, 8);
    for (int i = 0; i < 26; ++i) {
      const double angle = random.uniform(0, 2 * M_PI), tilt = random.uniform(0.1, 0.7),
                   length = random.uniform(0.5, 1.15);
      const dvec3 axis(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
      b.cone({0, 0, 0.3}, axis, length, 0.008, 0.004, bark);
      for (int k = 0; k < 7; ++k) {
        const double turn = random.uniform(0, 2 * M_PI);
        const dvec3 u = any_normal_to(axis), out = std::cos(turn) * u + std::sin(turn) * glm::cross(axis, u);
        b.disc(dvec3(0, 0, 0.3) + length * random.uniform(0.45, 1.0) * axis + 0.06 * out,
               glm::normalize(0.5 * out + axis + dvec3(0, 0, 0.5)), random.uniform(0.04, 0.07), leaf);
      }
    }
    b.place({0.45, 3.95, 0});  // a floor lamp
    b.cone({0, 0, 0}, {0, 0, 1}, 0.03, 0.16, 0.14, brass);
    b.disc({0, 0, 0.03}, {0, 0, 1}, 0.14, brass);
    b.cone({0, 0, 0.03}, {0, 0, 1}, 1.5, 0.012, 0.012, brass);
    b.cone({0, 0, 1.38}, {0, 0, 1}, 0.32, 0.24, 0.14, shade);
    b.cone({0, 0, 1.38}, {0, 0, 1}, 0.32, 0.235, 0.135, shade).inward = true;
    b.place({2.35, 2.15, 0});  // a hanging lamp
    b.cone({0, 0, 2.28}, {0, 0, 1}, 0.42, 0.006, 0.006, black);
    b.sphere({0, 0, 2.12}, 0.17, shade);
    b.place({});

    const int paints[3][6] = {
        {198, 148, 84, 84, 110, 128}, {150, 70, 58, 224, 200, 160}, {70, 96, 92, 214, 206, 176}};
    int k = 0;
    for (double y : {1.35, 2.2, 3.05}) {  // pictures above the sofa
      const int* c = paints[k++];
      const Finish art{
          b.material({Pattern::marble, from_srgb(c[0], c[1], c[2]), from_srgb(c[3], c[4], c[5]), 0.5, 0.1}),
          class_furniture};
      b.box({0, y - 0.31, 1.3}, {0.03, y + 0.31, 2.0}, k == 2 ? black : walnut);
      b.quad({0.0305, y, 1.65}, {0, 1, 0}, {0, 0, 1}, 0.26, 0.3, art);
    }
  }

  Camera view(dvec3 position, dvec3 target) const {
    Camera camera;
    camera.position = position;
    camera.target = target;
    camera.width = 640;
    camera.height = 480;
    camera.custom_intrinsics = Intrinsics{525, 525, 320, 240};  // a Kinect's
    return camera;
  }
};

}  // namespace

Scene make_room() {
  Room room;
  room.shell();
  room.seats();
  room.table();
  room.shelves();
  room.things();
  // Ten pictures that overlap like those of a hand-held walk around the table, looking down, level and up in
  // turn, and one more to judge them by.
  std::vector<Camera>& cameras = room.b.scene.cameras;
  const dvec3 middle(0.5 * width, 0.5 * depth, 0);
  for (int i = 0; i < 10; ++i) {
    const double angle = 2 * M_PI * i / 10 + 0.3;
    const dvec3 out(std::cos(angle), std::sin(angle), 0);
    const double target_heights[] = {0.15, 0.9, 2.3};
    const dvec3 target = middle + dvec3(i % 3 ? 1.6 : 0.7, i % 3 ? 1.4 : 0.6, 0) * out;
    cameras.push_back(room.view(middle + dvec3(-1.55, -1.3, 0) * out + dvec3(0, 0, 1.45 + 0.1 * (i % 2)),
                                target + dvec3(0, 0, target_heights[i % 3])));
  }
  room.b.scene.held_out = room.view({3.9, 1.0, 1.55}, {1.0, 2.9, 0.75});
  room.b.scene.natural = Sampling::cameras;
  return std::move(room.b.scene);
}

}  // namespace sfumato::synth
