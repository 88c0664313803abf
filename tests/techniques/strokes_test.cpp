// Strokes: frames, brushes, the sorted strokes against a fold in double, and that strokes stay where they
// are.
#include "techniques/strokes/stroke_set.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numbers>

#include "passes/screen_pass.h"
#include "reference/stroke_scenes.h"
#include "techniques/strokes/tangent.h"

using namespace sfumato;
using namespace sfumato::strokes;
using namespace sfumato::testing;

namespace {

std::vector<vec3> many_normals() {
  std::mt19937 random(1);
  std::normal_distribution<float> gauss(0, 1);
  std::vector<vec3> normals;
  for (int i = 0; i < 20000; ++i)
    normals.push_back(glm::normalize(vec3(gauss(random), gauss(random), gauss(random))));
  for (int axis = 0; axis < 3; ++axis)
    for (float sign : {-1.0f, 1.0f}) {
      vec3 n(0);
      n[axis] = sign;
      normals.push_back(n);
    }
  for (float x : {-1e-7f, 1e-7f}) normals.push_back(glm::normalize(vec3(x, 0.6f, -0.8f)));
  return normals;
}

double frame_error(const vec3& n, const TangentFrame& f) {
  const dvec3 m(n), t(f.along), b(f.across);
  return std::max({std::abs(glm::length(t) - 1), std::abs(glm::length(b) - 1), std::abs(glm::dot(t, b)),
                   std::abs(glm::dot(t, m)), std::abs(glm::dot(b, m)), glm::length(glm::cross(t, b) - m)});
}

TEST(Tangent, FramesAreOrthonormalAndRightHanded) {
  std::mt19937 random(2);
  std::normal_distribution<float> gauss(0, 1);
  for (const vec3& n : many_normals()) {
    // 1e-5: some 80 roundings of float.
    ASSERT_LT(frame_error(n, householder_frame(n)), 1e-5) << n.x << " " << n.y << " " << n.z;
    ASSERT_LT(frame_error(n, eberly_frame(n)), 1e-5);
    const vec3 any(gauss(random), gauss(random), gauss(random));
    const TangentFrame laid = frame_along(n, any);
    ASSERT_LT(frame_error(n, laid), 1e-5);
    ASSERT_GE(glm::dot(laid.along, householder_frame(n).along), 0);
    ASSERT_LT(frame_error(n, frame_along(n, n)), 1e-5);  // no direction in the plane: the Householder frame
  }
}

// dos Anjos 2017, Alg. 1 as printed: the sign of t_z where n_x < 0, and b as it stands.
TEST(Tangent, ThePrintedFormulaFails) {
  double worst = 0;
  for (const vec3& n : many_normals()) {
    if (n.x >= 0) continue;
    const float c = 1 / (n.x - 1);
    const TangentFrame printed{{n.y, 1 + n.y * n.y * c, -n.y * n.z * c},
                               {n.z, n.y * n.z * c, 1 + n.z * n.z * c}};
    worst = std::max(worst, frame_error(n, printed));
  }
  EXPECT_GT(worst, 0.5);
}

TEST(Tangent, JumpsWhereTheBranchesMeet) {
  for (float angle = 0.1f; angle < 6.2f; angle += 0.3f) {
    const vec3 n(0, std::cos(angle), std::sin(angle)), left = glm::normalize(n - vec3(1e-6f, 0, 0));
    EXPECT_NEAR(glm::distance(householder_frame(n).along, householder_frame(left).along), 2 * std::abs(n.y),
                1e-5);
    // b is turned in the second branch: -(b + jump) instead of b + jump.
    EXPECT_NEAR(glm::distance(householder_frame(n).across, -householder_frame(left).across),
                2 * std::abs(n.z), 1e-5);
  }
}

TEST(Strokes, AreAsLargeAsTheirLength) {
  ParamList params;
  const auto technique = find_technique("strokes").create();
  technique->describe(params);
  for (const Param& param : params.all()) EXPECT_EQ(param.is_point_size, param.name == "stroke_length");
}

TEST(Seed, StaysWithThePlace) {
  const double quantum = seed_quantum(0.1);
  EXPECT_EQ(quantum, std::exp2(std::round(std::log2(0.1 / 16))));
  EXPECT_EQ(seed_quantum(0.11), quantum);  // the next frame of a sequence
  EXPECT_NE(seed_quantum(1.3), quantum);   // another cloud
  // What reading through another origin changes does not matter, also for large coordinates and for zeros.
  for (const dvec3& p : {dvec3(635589.01, 848886.45, 400.02), dvec3(0, 0, 0), dvec3(-1.25, 3.5, 1e-9)})
    EXPECT_EQ(seed_of(p, quantum), seed_of(p + dvec3(1e-8, -1e-8, 1e-9), quantum));
  EXPECT_NE(seed_of({0, 0, 0}, quantum), seed_of({0, 0, 0.1}, quantum));
}

std::uint32_t pcg3d(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  x = x * 1664525u + 1013904223u, y = y * 1664525u + 1013904223u, z = z * 1664525u + 1013904223u;
  x += y * z, y += z * x, z += x * y;
  x ^= x >> 16, y ^= y >> 16, z ^= z >> 16;
  return x + y * z;
}

/// Alpha of the brush at (u, v) by the paper's sum, in double.
double brush_alpha(const Brush& b, std::uint32_t variant, double u, double v) {
  double z = 0, theta = 0;
  for (int column = 0; column < b.columns; ++column) {
    if (column > 0)
      theta += glm::radians(double(b.noise_deg)) *
               (2 * double(pcg3d(variant, std::uint32_t(column), 77) >> 8) / 16777216.0 - 1);
    for (int row = 0; row < b.rows; ++row) {
      const double du = u - (0.5 + (column - 0.5 * (b.columns - 1)) * b.center_separation);
      const double dv = v - (0.5 + (row - 0.5 * (b.rows - 1)) * b.center_separation);
      const double x = std::cos(theta) * du - std::sin(theta) * dv,
                   y = std::sin(theta) * du + std::cos(theta) * dv;
      z += b.amplitude * std::exp(-0.5 * std::pow(std::abs(x / b.sigma_x), b.shape_exponent)) *
           std::exp(-0.5 * std::pow(std::abs(y / b.sigma_y), b.shape_exponent));
    }
  }
  return std::min(z, 1.0);
}

class StrokesTest : public GlTest {
 protected:
  static Brush figure(Style style) {
    Parameters p;
    p.style = style;
    return p.resolve_brush();
  }
};
constexpr int tile = BrushPicture::tile_size;

TEST_F(StrokesTest, BrushesAreThePapersFormula) {
  BrushPicture picture;
  for (Style style : {Style::figure_4b, Style::figure_4c, Style::figure_4d, Style::pointillist}) {
    Brush brush = figure(style);
    for (float noise : {brush.noise_deg, 0.0f}) {
      brush.noise_deg = noise;
      picture.update(brush);
      const Image<vec4> image = picture.texture().download<vec4>();
      for (std::uint32_t variant : {0u, 13u, 63u})
        for (int y = 0; y < tile; ++y)
          for (int x = 0; x < tile; ++x) {
            const float alpha = image.at(int(variant % 8) * tile + x, int(variant / 8) * tile + y).x;
            // 1e-4: pow and exp of llvmpipe are good to some 1e-6, times A = 8 and a steep exponent.
            ASSERT_NEAR(alpha, brush_alpha(brush, variant, (x + 0.5) / tile, (y + 0.5) / tile), 1e-4)
                << x << "," << y;
          }
    }
  }
}

TEST_F(StrokesTest, SwappedSigmasSwapTheAxes) {
  Brush brush =
      figure(Style::figure_4c);  // lambda = 2.7: a negative base without abs() would be a NaN on the left
  brush.noise_deg = 0;
  BrushPicture picture;
  picture.update(brush);
  const Image<vec4> image = picture.texture().download<vec4>();
  std::swap(brush.sigma_x, brush.sigma_y);
  picture.update(brush);
  const Image<vec4> swapped = picture.texture().download<vec4>();
  double difference = 0;
  for (int y = 0; y < tile; ++y)
    for (int x = 0; x < tile; ++x) {
      ASSERT_TRUE(std::isfinite(image.at(x, y).x));
      ASSERT_NEAR(image.at(x, y).x, swapped.at(y, x).x, 1e-5);
      difference += std::abs(image.at(x, y).x - image.at(y, x).x);
    }
  EXPECT_GT(difference, 10);  // the brush is not symmetric by itself
}

TEST_F(StrokesTest, AnAmplitudeAboveOneIsAPlateau) {
  Brush brush = figure(Style::figure_4b);
  brush.rows = brush.columns = 1;
  brush.center_separation = 0;
  BrushPicture picture;
  picture.update(brush);
  const Image<vec4> image = picture.texture().download<vec4>();
  const double edge = brush.sigma_x * std::pow(2 * std::log(8.0), 1 / 3.0);  // 1.61 sigma
  for (int x = 0; x < tile; ++x) {
    const double away = std::abs((x + 0.5) / tile - 0.5);
    if (away < edge - 0.02) EXPECT_EQ(image.at(x, tile / 2).x, 1) << x;
    if (away > edge + 0.02) EXPECT_LT(image.at(x, tile / 2).x, 1) << x;
  }
  // The share of the quad that is painted agrees with the picture.
  double sum = 0;
  for (int y = 0; y < tile; ++y)
    for (int x = 0; x < tile; ++x) sum += image.at(x, y).x / (tile * tile);
  EXPECT_NEAR(picture.share(), sum, 0.01);
}

/// The strokes of a view as stored for drawing (stroke_record.glsl).
struct Record {
  dvec3 center, along, across, normal, color;
  float key;
  std::uint32_t variant, source;
};
std::vector<Record> records_of(const StrokeSet& strokes) {
  std::vector<glm::uvec4> texels(strokes.count() * std::size_t(6));
  strokes.records().buffer().download(texels.data(), texels.size() * 16);
  auto vector = [](const glm::uvec4& t) {
    return dvec3(std::bit_cast<float>(t.x), std::bit_cast<float>(t.y), std::bit_cast<float>(t.z));
  };
  std::vector<Record> out;
  for (std::size_t k = 0; k < texels.size(); k += 6)
    out.push_back({vector(texels[k]), vector(texels[k + 1]), vector(texels[k + 2]), vector(texels[k + 3]),
                   vector(texels[k + 4]), std::bit_cast<float>(texels[k].w), texels[k + 1].w,
                   texels[k + 5].x});
  return out;
}

struct Set {  // strokes of a view without the technique around them
  BrushPicture brush;
  StrokeData data;
  StrokeSet strokes;
  void update(StrokeScene& drawn, const View& view, const Look& look, const Brush& b, float noise) {
    brush.update(b);
    data.update(*drawn.gpu, Tangent::householder, seed_quantum(drawn.gpu->median_spacing()), no_progress());
    strokes.update(*drawn.gpu, data, view, look, brush, noise, false, false);
  }
};

// The whole way against the paper's sum and an "over" from the back, in double: few strokes, more than 64 px
// wide, so that the brush's picture is read at its finest level.
TEST_F(StrokesTest, SortedStrokesAreTheFoldOfTheFormula) {
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  for (int i = 0; i < 9; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), uniform(random)});
    cloud.normals.push_back(glm::normalize(vec3(0.4f * uniform(random), -1, 0.4f * uniform(random))));
    cloud.colors.push_back(
        {std::uint8_t(40 + 20 * i), std::uint8_t(230 - 20 * i), std::uint8_t(60 * (i % 4)), 255});
  }
  for (Style style : {Style::figure_4b, Style::figure_4d}) {
    StrokeScene drawn(cloud);
    const char* names[] = {"figure_4b", "figure_4c", "figure_4d"};
    drawn.set("style", names[int(style) - int(Style::figure_4b)]);
    drawn.set("stroke_length", "45");
    drawn.set("opacity", "0.7");
    drawn.set("two_layers", "false");
    drawn.set("underpainting", "false");  // translucent strokes alone
    ASSERT_TRUE(drawn.step());
    const Image<vec4> picture = drawn.picture();

    Parameters parameters;
    parameters.style = style;
    Look look = parameters.resolve_look();
    look.length_percent = 45, look.opacity = 0.7f;
    const Brush brush = parameters.resolve_brush();
    const View view(drawn.camera, drawn.prepared.cloud.origin);
    Set set;
    set.update(drawn, view, look, brush, brush.noise_deg);
    std::vector<Record> records = records_of(set.strokes);
    ASSERT_GT(records.size(), 3u);
    std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) { return a.key > b.key; });
    double worst = 0, mean = 0;
    const Intrinsics k = drawn.camera.intrinsics();
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 112; ++x) {
        const dvec3 ray((x + 0.5 - k.cx) / k.fx, -(y + 0.5 - k.cy) / k.fy, -1);
        glm::dvec4 color(0);
        for (const Record& r : records) {
          const dvec3 offset = ray * (glm::dot(r.center, r.normal) / glm::dot(ray, r.normal)) - r.center;
          const double u = glm::dot(offset, r.along) / glm::dot(r.along, r.along);
          const double v = glm::dot(offset, r.across) / glm::dot(r.across, r.across);
          if (std::max(std::abs(u), std::abs(v)) >= 1) continue;
          const double alpha = 0.7 * brush_alpha(brush, r.variant, 0.5 + 0.5 * u, 0.5 + 0.5 * v);
          color = glm::dvec4(alpha * r.color, alpha) + (1 - alpha) * color;
        }
        const double d = glm::length(glm::dvec4(picture.at(x, y)) - color);
        worst = std::max(worst, d);
        mean += d / (112 * 80);
      }
    // The picture of the brush is linear between samples 1/64 apart: where alpha bends off its plateau one
    // stroke is off by up to a tenth, and two may bend in one pixel; what is left of the light below 0.005 is
    // dropped.
    EXPECT_LT(worst, 0.2);
    EXPECT_LT(mean, 0.004);
  }
}

TEST_F(StrokesTest, StrokesStayPutWhenTheCameraMoves) {
  StrokeScene drawn(two_spheres());
  Parameters parameters;
  const Look look = parameters.resolve_look();
  const Brush brush = parameters.resolve_brush();
  Set set;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> first;
  std::size_t common = 0;
  for (double shift : {0.0, 0.03}) {
    Camera camera = drawn.camera;
    camera.position.x += shift;
    const View view(camera, drawn.prepared.cloud.origin);
    set.update(drawn, view, look, brush, brush.noise_deg);
    const glm::dmat3 back = glm::transpose(glm::dmat3(view.eye_from_cloud()));
    std::vector<std::uint32_t> place(drawn.prepared.cloud.size());
    for (std::uint32_t i = 0; i < place.size(); ++i) place[drawn.prepared.cloud.source_index[i]] = i;
    for (const Record& r : records_of(set.strokes)) {
      const vec3 n = drawn.prepared.cloud.normals[place[r.source]];
      const TangentFrame frame = householder_frame(n);
      const dvec3 t = glm::normalize(back * r.along);
      const double theta = std::atan2(glm::dot(t, dvec3(frame.across)), glm::dot(t, dvec3(frame.along)));
      EXPECT_LE(std::abs(theta), glm::radians(brush.noise_deg + 0.1));
      const auto [found, is_new] = first.insert({{r.source, r.variant}, theta});
      if (!is_new && shift > 0) {
        EXPECT_NEAR(found->second, theta, 1e-3);  // normals of 16 bits, turned into two eyes
        ++common;
      }
    }
  }
  // The same points are strokes of the same brush; a few leave the view or change sides of their chance.
  EXPECT_GT(common, 0.95 * set.strokes.count());
}

// A dim scan whose colours are raised still has its own; an attribute's colours are lit.
TEST_F(StrokesTest, LightFallsOnColoursThatStandForSomething) {
  PointCloud cloud = two_spheres();
  std::mt19937 random(6);
  cloud.colors.resize(cloud.size());
  for (Rgba8& c : cloud.colors)
    c = {std::uint8_t(random() % 90), std::uint8_t(random() % 70), std::uint8_t(random() % 50), 255};
  StrokeScene drawn(cloud);
  drawn.settings.shading = Shading::lit;
  const std::vector<Rgba8> own = drawn.prepared.cloud.colors;
  std::vector<Rgba8> raised = own, attribute = own;
  for (Rgba8& c : raised)
    for (std::uint8_t* channel : {&c.r, &c.g, &c.b}) *channel = std::uint8_t(2 * *channel);
  for (std::size_t i = 0; i < own.size(); ++i)
    attribute[i] = {std::uint8_t(drawn.prepared.cloud.positions[i].z > 0 ? 200 : 90), 80, 120, 255};
  auto painted = [&](const std::vector<Rgba8>& colors, const char* lighting) {
    drawn.gpu = std::make_unique<GpuCloud>(drawn.prepared, colors);
    drawn.set("lighting", lighting);
    drawn.step();
    const Image<vec4> picture = drawn.picture();
    return std::vector<vec4>(picture.data(), picture.data() + picture.size());
  };
  EXPECT_TRUE(painted(own, "auto") == painted(own, "off"));
  EXPECT_TRUE(painted(raised, "auto") == painted(raised, "off"));
  EXPECT_TRUE(painted(attribute, "auto") == painted(attribute, "on"));
  EXPECT_FALSE(painted(raised, "on") == painted(raised, "off"));
}

// A scanner's shadow: between a near thing and the wall far behind it nothing was measured. A slit of a few
// pixels is painted like the wall, a wide one stays open.
TEST_F(StrokesTest, UnderpaintingClosesSlitsBesideNearThings) {
  auto scene = [](float wall_from) {  // the near half ends at x = 0, the wall as seen from the camera
                                      // `wall_from` px beside it
    PointCloud cloud;
    auto add = [&](float x, float y, float z, Rgba8 color) {
      cloud.positions.push_back({x, y, z});
      cloud.normals.push_back({0, -1, 0});
      cloud.colors.push_back(color);
    };
    for (int i = 0; i < 250; ++i)
      for (int j = 0; j < 200; ++j) {
        add(-0.01f * float(i), 0, 0.01f * float(j) - 1, {200, 40, 40, 255});
        add(wall_from + 0.05f * float(i), 16, 0.05f * float(j) - 5, {40, 40, 200, 255});
      }
    return cloud;
  };
  auto middle_row = [&](float wall_from) {
    StrokeScene drawn(scene(wall_from));
    drawn.step();
    const Image<vec4> picture = drawn.picture();
    int open = 0;
    float red = -1;
    for (int x = 0; x < picture.width(); ++x) {
      const vec4 c = picture.at(x, 40);
      open += c.a < 0.5f;
      if (x > 57 && x < 61) red = std::max(red, c.r - c.b);
    }
    return std::pair{open, red};
  };
  // A pixel of the wall is 0.2 wide.
  const auto [slit_open, slit_red] = middle_row(0.5f);
  EXPECT_EQ(slit_open, 0);
  EXPECT_LT(slit_red, 0) << "by the wall, not by what stands before it";
  EXPECT_GT(middle_row(4).first, 8);
}

/// Both passes of underpaint.glsl over a picture of these colours and depths, one after the other.
class Underpainting {
 public:
  explicit Underpainting(int size)
      : size_(size), one_(size), two_(size), view_(front_camera(size, size), dvec3(0)) {
    pass_.set("reach", 7).set("spacing", 0.0f);
    view_.bind();
  }
  /// The picture after the first and after the second.
  std::array<Image<vec4>, 2> paint(const Image<vec4>& color, const Image<float>& depth) {
    one_.color.upload(color), one_.depth.upload(depth);
    one_.normal.upload(Image<vec4>(size_, size_, vec4(0, 0, 1, 1)));
    Image<vec4> first = run(false, one_, two_);
    return {std::move(first), run(true, two_, one_)};
  }

 private:
  struct Surface {
    explicit Surface(int size)
        : color("color", GL_RGBA32F, size, size),
          depth("depth", GL_R32F, size, size),
          normal("normal", GL_RGBA32F, size, size) {}
    gl::Texture color, depth, normal;
  };
  Image<vec4> run(bool teeth, const Surface& from, const Surface& to) {
    pass_.set("teeth", teeth)
        .run({&from.color, &from.depth, &from.normal}, {&to.color, &to.depth, &to.normal});
    return to.color.download<vec4>();
  }

  int size_;
  Surface one_, two_;
  View view_;
  ScreenPass pass_{"techniques/strokes/underpaint.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F}};
};

// Beside a near thing the far wall ends in a ragged line: rows whose slit is no wider than a stroke alternate
// with rows whose slit is. The first pass leaves a comb, the second hardly anything of it; a wide shadow
// stays open.
TEST_F(StrokesTest, UnderpaintingLeavesNoCombs) {
  constexpr int size = 40, near_end = 10;
  Underpainting underpainting(size);
  auto open_of = [](const Image<vec4>& picture) {
    int open = 0;
    for (int y = 4; y < size - 4; ++y)
      for (int x = near_end; x < near_end + 12; ++x) open += picture.at(x, y).a < 0.5f;
    return open;
  };
  auto passes = [&](int narrow, int wide) {  // px of the shadow, in two rows of four and in the others
    Image<vec4> color(size, size, vec4(0));
    Image<float> depth(size, size, std::numeric_limits<float>::infinity());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        if (x < near_end)
          color.at(x, y) = {1, 0, 0, 1}, depth.at(x, y) = 2;
        else if (x >= near_end + (y % 4 < 2 ? narrow : wide))
          color.at(x, y) = {0, 0, 1, 1}, depth.at(x, y) = 20;
    const auto [first, second] = underpainting.paint(color, depth);
    return std::pair{open_of(first), open_of(second)};
  };
  const auto [comb, left] = passes(7, 12);
  EXPECT_GT(comb, 80);
  EXPECT_LE(left, 20) << "where the comb meets the near thing";
  EXPECT_EQ(passes(20, 20), (std::pair{12 * (size - 8), 12 * (size - 8)}));
}

// Outlines stay where they are: a bay between two parts that stick out lies open to the background. A hole as
// wide, with paint all around, is closed, and so is a slit that runs along an axis.
TEST_F(StrokesTest, UnderpaintingStaysWithinOutlines) {
  constexpr int size = 64, top = 20;
  Underpainting underpainting(size);
  /// Pixels closed of those `is_open` says, in a surface below `top`.
  auto closed = [&](auto&& is_open) {
    Image<vec4> color(size, size, vec4(0));
    Image<float> depth(size, size, std::numeric_limits<float>::infinity());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        if (y >= top && !is_open(x, y)) color.at(x, y) = {1, 0, 0, 1}, depth.at(x, y) = 2;
    const Image<vec4> picture = underpainting.paint(color, depth)[1];
    int count = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) count += color.at(x, y).a == 0 && picture.at(x, y).a > 0.5f;
    return count;
  };
  EXPECT_EQ(closed([](int, int) { return false; }), 0);
  auto bay = [](int x, int y) { return x >= 28 && x < 38 && y < 50; };
  auto hole = [](int x, int y) { return x >= 28 && x < 38 && y >= 28 && y < 38; };
  auto slit = [](int x, int y) { return x >= 28 && x < 32 && y >= 24; };
  EXPECT_LE(closed(bay), 8) << "in its corners";
  EXPECT_EQ(closed(hole), 100);
  EXPECT_EQ(closed(slit), 4 * (size - 24));
}

// The same points in another file, some of them at the same places in other colours.
TEST_F(StrokesTest, TheOrderOfTheFileDoesNotShow) {
  PointCloud cloud = two_spheres();
  cloud.normals.clear();
  std::mt19937 random(9);
  cloud.colors.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i] = glm::round(cloud.positions[i] * 50.0f) / 50.0f;  // ties among neighbours
    cloud.colors[i] = {std::uint8_t(60 * int(2 * cloud.positions[i].x + 3) / 2 + int(random() % 10)),
                       std::uint8_t(random() % 8), 90, 255};
  }
  std::vector<std::uint32_t> order(cloud.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  PointCloud shuffled = select(cloud, order);
  shuffled.source_index.clear();
  StrokeScene one(std::move(cloud)), two(std::move(shuffled));
  for (const char* style : {"oil", "figure_4b", "watercolor"}) {
    one.settings.shading = two.settings.shading = Shading::lit;
    one.set("style", style), two.set("style", style);
    one.step(), two.step();
    const Image<vec4> a = one.picture(), b = two.picture();
    std::size_t painted = 0, unlike = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      painted += a.data()[i].a > 0, unlike += a.data()[i] != b.data()[i];
    EXPECT_GT(painted, 1000u) << style;
    EXPECT_EQ(unlike, 0u) << style;
  }
}

// A sequence: the second frame holds a sphere that moved, in another order; the wall behind it does not
// notice.
TEST_F(StrokesTest, ASequenceKeepsStrokesThatDidNotMove) {
  auto scene = [](float x, unsigned seed) {
    PointCloud cloud;
    for (int i = 0; i < 140; ++i)
      for (int j = 0; j < 100; ++j) {
        cloud.positions.push_back({0.02f * float(i) - 1.4f, 1, 0.02f * float(j) - 1});
        cloud.normals.push_back({0, -1, 0});
        cloud.colors.push_back({std::uint8_t(i / 14 * 25), 120, std::uint8_t(j / 10 * 25), 255});
      }
    append(cloud, sphere_cloud(3000, 0.2f, vec3(x, 0, 0)));
    std::vector<std::uint32_t> order(cloud.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    return select(cloud, order);
  };
  Renderer renderer(context());
  auto technique = find_technique("strokes").create();
  RenderOutput out[2];
  for (int frame = 0; frame < 2; ++frame) {
    show(renderer, scene(frame == 0 ? -0.5f : -0.3f, unsigned(frame)), technique->needs());
    out[frame] = renderer.render(*technique, front_camera(112, 80), {}, all_outputs());
  }
  std::size_t same = 0, moved = 0, still = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 112; ++x) {
      const bool equal = glm::length(out[0].color_linear.at(x, y) - out[1].color_linear.at(x, y)) < 1e-3f;
      if (x > 62 && out[0].depth.at(x, y) > 4.5f)
        ++still, same += equal;  // right of the sphere's way
      else
        moved += !equal;
    }
  EXPECT_GT(still, 2000u);
  EXPECT_GT(double(same), 0.99 * double(still));
  EXPECT_GT(moved, 50u);
}

TEST_F(StrokesTest, StylesDifferAndExplicitValuesWin) {
  Parameters p;
  const Brush oil = p.resolve_brush();
  p.style = Style::pointillist;
  EXPECT_FALSE(p.resolve_brush() == oil);
  p.amplitude.user = 2.5f;
  p.brush_rows.user = 5;
  for (Style style : {Style::oil, Style::watercolor, Style::figure_4c}) {
    p.style = style;
    EXPECT_EQ(p.resolve_brush().amplitude, 2.5f);
    EXPECT_EQ(p.resolve_brush().rows, 5);
  }
  ParamList list;
  p.describe(list);
  EXPECT_EQ(list.find("amplitude")->get(), "2.5");
  EXPECT_EQ(list.find("sigma_x")->get(), "auto");
  EXPECT_EQ(list.find("sigma_x")->resolved(), "0.142");  // Figure 4(c)
}

// Fewer points, larger strokes: a decimated cloud covers as much of the picture.
TEST_F(StrokesTest, SizesFollowTheSpacing) {
  double covered[2];
  int k = 0;
  for (std::size_t count : {20000u, 700u}) {
    StrokeScene drawn(sphere_cloud(count));
    ASSERT_TRUE(drawn.step());
    covered[k] = 0;
    for (const vec4& c : drawn.picture()) covered[k] += c.a;
    ++k;
  }
  EXPECT_GT(covered[1], 0.9 * covered[0]);
  EXPECT_LT(covered[1], 1.5 * covered[0]);  // the rim of large strokes
}

}  // namespace
