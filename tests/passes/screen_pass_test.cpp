#include "passes/screen_pass.h"

#include <algorithm>
#include <bit>

#include "passes/finish.h"
#include "passes/points_to_pixels.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class Passes : public GlTest {};

// One body, two wrappers: the pictures must be the same bit for bit.
TEST_F(Passes, FragmentAndComputeWrappersAgree) {
  Image<vec4> image(37, 23);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (vec4& c : image) {
    const float a = uniform(random);
    c = vec4(uniform(random) * a, uniform(random) * a, uniform(random) * a, a);
  }
  gl::Texture in("in", GL_RGBA32F, 37, 23);
  in.upload(image);
  Image<Rgba8> results[2];
  int k = 0;
  for (ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    gl::Texture out("out", GL_RGBA8, 37, 23);
    ScreenPass pass("passes/finish.glsl", {GL_RGBA8}, {"ENCODE_SRGB"}, kind);
    pass.set("background_srgb", vec3(1)).set("is_transparent", false);
    pass.run({&in}, {&out});
    results[k++] = out.download<Rgba8>();
  }
  for (std::size_t i = 0; i < results[0].size(); ++i) EXPECT_EQ(results[0].data()[i], results[1].data()[i]);
  // and the value is that of the formula, within one rounding
  const vec4 c = image.at(5, 7);
  const double linear = c.r + (1 - c.a);
  const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  EXPECT_NEAR(results[0].at(5, 7).r, 255 * srgb, 0.6);
}

// What loops of the processor hand on is what passes read, and the other way round.
TEST_F(Passes, TexturesHoldWhatWasLastGivenToThem) {
  const auto filled = [](float value) { return Image<vec4>(5, 3, vec4(value, value, value, 1)); };
  const RenderSettings settings;
  Finish finish;
  gl::Texture color("color", GL_RGBA32F, 5, 3), linear("linear", GL_RGBA32F, 5, 3);
  const auto by_shader = [&] {
    finish.run_linear(settings, color, linear);
    return linear.download<vec4>().at(4, 2).r;
  };
  color.upload(filled(0.125f));
  EXPECT_EQ(color.peek<vec4>().at(4, 2).r, 0.125f);
  color.give(filled(0.25f));
  EXPECT_EQ(color.download<vec4>().at(4, 2).r, 0.25f);
  EXPECT_EQ(color.download<vec3>().at(4, 2).r, 0.25f);
  EXPECT_EQ(by_shader(), 0.25f);
  EXPECT_EQ(color.peek<vec4>().at(4, 2).r, 0.25f);
  Image<vec4> image = color.take<vec4>();
  image.at(4, 2).r = 0.5f;
  color.give(std::move(image));
  EXPECT_EQ(by_shader(), 0.5f);
  // Rows beside what was given.
  color.give(filled(0.75f));
  color.upload_rows(filled(0), 0, 1);
  EXPECT_EQ(color.peek<vec4>().at(4, 0).r, 0);
  EXPECT_EQ(by_shader(), 0.75f);
  // A pass writes over what is known here.
  linear.give(filled(0));
  EXPECT_EQ(by_shader(), 0.75f);
  EXPECT_EQ(linear.peek<vec4>().at(4, 2).r, 0.75f);
  color.give(filled(1)), color.clear(vec4(0, 0, 0, 1));
  EXPECT_EQ(by_shader(), 0);
  gl::Texture other = std::move(color);
  other.give(filled(0.5f));
  color = std::move(other);
  EXPECT_EQ(by_shader(), 0.5f);
}

// A filter that writes floats beside integers, as those of depth and index do.
TEST_F(Passes, BothWrappersWriteFloatsAndIntegers) {
  Image<float> depths(37, 23);
  Image<std::uint32_t> indices(37, 23);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    depths.data()[i] = random() % 4 ? 1 + float(random() % 1000) / 1000 : INFINITY;
    indices.data()[i] = std::uint32_t(i);
  }
  gl::Texture depth("depth", GL_R32F, 37, 23), index("index", GL_R32UI, 37, 23);
  depth.upload(depths);
  index.upload(indices);
  Image<float> filled[2];
  Image<std::uint32_t> sources[2];
  int k = 0;
  for (ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    gl::Texture depth_out("filled depth", GL_R32F, 37, 23), index_out("filled index", GL_R32UI, 37, 23);
    ScreenPass pass("passes/fill.glsl", {GL_R32F, GL_R32UI}, {"EXTRAS 0", "INDEX"}, kind);
    pass.run({&depth, &index}, {&depth_out, &index_out});
    filled[k] = depth_out.download<float>();
    sources[k++] = index_out.download<std::uint32_t>();
  }
  std::size_t taken_over = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    ASSERT_EQ(filled[0].data()[i], filled[1].data()[i]);
    ASSERT_EQ(sources[0].data()[i], sources[1].data()[i]);
    taken_over += sources[0].data()[i] != i;
  }
  EXPECT_GT(taken_over, 20u);
}

// A pass that marks pixels, and one that runs at those: everything else stays, also where a mask is used
// again.
TEST_F(Passes, APassWithAMaskLeavesTheRestAlone) {
  const int width = 37, height = 23;
  Image<vec4> picture(width, height);
  Image<float> depths(width, height);
  for (std::size_t i = 0; i < picture.size(); ++i) picture.data()[i] = vec4(float(i % 7), 0, 0, 1);
  const View view(frame({dvec3(-1), dvec3(1)}, UpAxis::pos_z, width, height, 0, 0), dvec3(0));
  view.bind();
  gl::Texture color("color", GL_RGBA32F, width, height), depth("depth", GL_R32F, width, height);
  color.upload(picture);
  Image<vec4> results[2];
  int k = 0;
  for (ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    ScreenPass find("passes/depth_edges.glsl", {GL_R32UI}, {}, kind),
        smooth("passes/smooth_outlines.glsl", {GL_RGBA32F}, {}, kind);
    gl::Texture edges("edges", GL_R32UI, width, height), out("out", GL_RGBA32F, width, height);
    PixelMask mask;
    for (int border : {30, 11}) {
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) depths.at(x, y) = x + y / 4 < border ? 1 : INFINITY;
      depth.upload(depths);
      edges.clear_uint(0), out.clear(vec4(-1));
      find.mark(mask, {&depth}, {&edges});
      smooth.run(mask, {&color, &edges, &depth}, {&out});
    }
    results[k] = out.download<vec4>();
    const Image<std::uint32_t> marked = edges.download<std::uint32_t>();
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(results[k].at(x, y).a == -1, marked.at(x, y) == 0) << x << ' ' << y << ' ' << k;
    EXPECT_EQ(std::count(marked.begin(), marked.end(), 0u) + 2 * height, std::ptrdiff_t(marked.size()));
    ++k;
  }
  for (std::size_t i = 0; i < picture.size(); ++i) ASSERT_EQ(results[0].data()[i], results[1].data()[i]);
}

// Tiles that are on get what the whole pass writes, everything else the value for elsewhere; the tiled area
// may reach beyond the image on all sides.
TEST_F(Passes, APassOnTilesLeavesTheRestAlone) {
  Image<vec4> image(37, 23);
  for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = vec4(float(i) / float(image.size()));
  gl::Texture in("in", GL_RGBA32F, 37, 23), on("tiles", GL_R32F, 7, 5);
  in.upload(image);
  Image<float> switches(7, 5);
  std::mt19937 random(9);
  for (float& s : switches) s = float(random() & 1);
  on.upload(switches);
  const ivec2 offset(5, 11);
  for (ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    gl::Texture out("out", GL_RGBA32F, 37, 23);
    ScreenPass copy("passes/finish.glsl", {GL_RGBA32F}, {}, kind);
    copy.set("background_srgb", vec3(1)).set("is_transparent", true);
    glFinish();  // llvmpipe's vertex shaders do not wait for textures
    copy.run({on, 8, offset}, {&in}, {&out}, {vec4(-3)});
    const Image<vec4> result = out.download<vec4>();
    for (int y = 0; y < 23; ++y)
      for (int x = 0; x < 37; ++x) {
        const bool runs = switches.at((x + offset.x) / 8, (y + offset.y) / 8) > 0;
        ASSERT_EQ(result.at(x, y), runs ? image.at(x, y) : vec4(-3)) << x << " " << y;
      }
  }
}

// Brute force: the nearest point of every pixel, ties to the lowest source index.
TEST_F(Passes, PointsToPixelsKeepsTheNearestPoint) {
  PointCloud cloud = sphere_cloud(5000);
  for (std::size_t i = 0; i < 300; ++i) cloud.positions[i] = cloud.positions[i + 300];
  const PointCloud file = cloud;
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, colors_of(prepared.cloud), 2000);
  Camera camera = front_camera(61, 47);
  camera.fit_depth_range(gpu.bounds());
  const View view(camera, prepared.cloud.origin);
  PointsToPixels to_pixels;
  PixelLayer layer;
  gl::Timers timers(false);
  to_pixels.draw(gpu, view, {SizeMode::pixels, 1}, layer, timers);
  to_pixels.resolve(gpu, view, layer, timers);
  const auto index = layer.index.download<std::uint32_t>();
  const auto depth = layer.depth.download<float>();

  Image<std::uint32_t> expected(61, 47, 0xffffffffu);
  Image<double> nearest(61, 47, INFINITY);
  const Intrinsics k = camera.intrinsics();
  const dmat4 v = camera.view(file.origin);
  for (std::size_t i = 0; i < file.size(); ++i) {
    const dvec3 eye(v * glm::dvec4(dvec3(file.positions[i]), 1));
    const double z = -eye.z, x = k.fx * eye.x / z + k.cx, y = -k.fy * eye.y / z + k.cy;
    if (x < 0 || y < 0 || x >= 61 || y >= 47) continue;
    if (z < nearest.at(int(x), int(y))) {
      nearest.at(int(x), int(y)) = z;
      expected.at(int(x), int(y)) = std::uint32_t(i);
    }
  }
  std::size_t different = 0, covered = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    covered += expected.data()[i] != 0xffffffffu;
    different += index.data()[i] != expected.data()[i];
    if (index.data()[i] == expected.data()[i] && covered) {
      if (index.data()[i] == 0xffffffffu)
        EXPECT_TRUE(std::isinf(depth.data()[i]));
      else
        EXPECT_NEAR(depth.data()[i], nearest.data()[i], 1e-5);  // float depth near 4
    }
  }
  EXPECT_GT(covered, 400u);
  // Points on a pixel border may round to the other side in float: a few of thousands.
  EXPECT_LE(different, covered / 200);

  // The same points as eye positions with colour and spacing.
  gl::Texture eye("eye", GL_RGBA32F, 61, 47);
  for (float same_spacing : {0.0f, 0.3f}) {
    to_pixels.resolve_eye(gpu, view, layer, eye, same_spacing, timers);
    const auto positions = eye.download<vec4>();
    const auto colors = layer.shadowed.download<vec4>();
    for (int y = 0; y < 47; ++y)
      for (int x = 0; x < 61; ++x) {
        const std::uint32_t source = index.at(x, y);
        if (source == 0xffffffffu) {
          ASSERT_EQ(positions.at(x, y), vec4(0, 0, -3e38f, 0));
          ASSERT_EQ(colors.at(x, y), vec4(0, 0, 0, 1));
          continue;
        }
        // The point itself, not the middle of its pixel.
        const dvec3 at(v * glm::dvec4(dvec3(file.positions[source]), 1));
        for (int axis = 0; axis < 3; ++axis)
          ASSERT_NEAR(positions.at(x, y)[axis], at[axis], 3e-6);  // roundings near 4
        const auto& order = prepared.cloud.source_index;
        const auto place = std::size_t(std::find(order.begin(), order.end(), source) - order.begin());
        const auto batch =
            std::find_if(prepared.batches.begin(), prepared.batches.end(),
                         [&](const Batch& b) { return place >= b.first && place < b.first + b.count; });
        const float spacing = batch->spacing_at(prepared.cloud.positions[place]);
        ASSERT_NEAR(positions.at(x, y).w, same_spacing > 0 ? same_spacing : spacing,
                    1e-5 * spacing);  // exp2 of two
        const Rgba8 color = prepared.cloud.colors[place];
        for (int c = 0; c < 3; ++c) {
          const double code = (&color.r)[c] / 255.0;
          const double linear = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
          ASSERT_NEAR(colors.at(x, y)[c], linear, 1e-3 * linear + 1e-6);  // 11 bits, the rest cut off
        }
        ASSERT_EQ(colors.at(x, y).a, 1);
      }
  }
}

// Ties too: a third of the points lie where others do.
TEST_F(Passes, OneVisitFindsWhatTwoFind) {
  if (!gl::limits().int64_atomics)
    GTEST_SKIP() << gl::limits().renderer << " has no 64-bit atomics (GL_NV_shader_atomic_int64)";
  PointCloud cloud = sphere_cloud(9000);
  for (std::size_t i = 0; i < 3000; ++i) {
    cloud.positions[i] = cloud.positions[i + 3000];
    cloud.normals[i] = cloud.normals[i + 3000];
  }
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, colors_of(prepared.cloud), 2000);  // several chunks
  gl::Timers timers(false);
  PointsToPixels one(PointsToPixels::Visits::one), two(PointsToPixels::Visits::two);
  Footprint facing{SizeMode::pixels, 5}, oriented{SizeMode::adaptive, 2};
  oriented.oriented = true;
  for (const auto& [width, height] : {std::pair(61, 47), std::pair(130, 90), std::pair(33, 20)}) {
    Camera camera = front_camera(width, height);
    camera.fit_depth_range(gpu.bounds());
    const View view(camera, prepared.cloud.origin);
    gl::Texture reference("reference", GL_R32F, width, height);
    reference.clear(vec4(4));  // through the middle of the sphere
    for (const Footprint& footprint : {Footprint{SizeMode::pixels, 1}, facing, oriented})
      for (const gl::Texture* behind : {(const gl::Texture*)nullptr, (const gl::Texture*)&reference}) {
        PixelLayer of_one, of_two;
        EXPECT_EQ(one.draw(gpu, view, footprint, of_one, timers, behind),
                  two.draw(gpu, view, footprint, of_two, timers, behind));
        const auto index = of_one.index.download<std::uint32_t>();
        EXPECT_TRUE(std::ranges::equal(index, of_two.index.download<std::uint32_t>()));
        EXPECT_TRUE(std::ranges::equal(of_one.depth_bits.download<std::uint32_t>(),
                                       of_two.depth_bits.download<std::uint32_t>()));
        EXPECT_LT(std::ranges::count(index, 0xffffffffu), width * height);
      }
  }
}

TEST_F(Passes, DiscsAreRoundAndOfTheAskedSize) {
  PointCloud cloud;
  cloud.positions = {vec3(0)};
  cloud.colors = {{255, 0, 0, 255}};
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, prepared.cloud.colors);
  Camera camera = front_camera(64, 64, 2);
  camera.position = {0, -2, 0};
  camera.fit_depth_range({{-1, -1, -1}, {1, 1, 1}});
  const View view(camera, prepared.cloud.origin);
  PointsToPixels to_pixels;
  PixelLayer layer;
  gl::Timers timers(false);
  for (float diameter : {1.0f, 2.0f, 7.0f, 20.0f, 300.0f}) {
    to_pixels.draw(gpu, view, {SizeMode::pixels, diameter}, layer, timers);
    const auto index = layer.index.download<std::uint32_t>();
    std::size_t count = 0, expected = 0;
    const float radius = std::min(diameter, 64.0f) / 2;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        count += index.at(x, y) == 0;
        expected +=
            diameter <= 1 ? (x == 32 && y == 32) : glm::length(vec2(x + 0.5f, y + 0.5f) - vec2(32)) <= radius;
      }
    EXPECT_EQ(count, expected) << diameter;
  }
}

TEST_F(Passes, PeelingSkipsPointsInFrontOfTheReference) {
  PointCloud cloud;
  for (float y : {0.0f, 0.5f, 1.0f}) cloud.positions.push_back(vec3(0, y, 0));
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, colors_of(prepared.cloud));
  Camera camera = front_camera(9, 9, 2);
  camera.position = {0, -2, 0};
  camera.fit_depth_range(gpu.bounds());
  const View view(camera, prepared.cloud.origin);
  PointsToPixels to_pixels;
  gl::Texture bits, reference("reference", GL_R32F, 9, 9);
  auto nearest = [&](float ref, float gap) {
    reference.clear(vec4(ref));
    to_pixels.draw_depth(gpu, view, {SizeMode::pixels, 1}, bits, &reference, gap);
    const std::uint32_t word = bits.download<std::uint32_t>().at(4, 4);
    return word == 0xffffffffu ? -1.0f : std::bit_cast<float>(word);
  };
  EXPECT_NEAR(nearest(-INFINITY, 0.1f), 2.0f, 1e-6);
  EXPECT_NEAR(nearest(2.0f, 0.1f), 2.5f, 1e-6);
  EXPECT_NEAR(nearest(2.0f, 0.7f), 3.0f, 1e-6);
  EXPECT_EQ(nearest(3.0f, 0.1f), -1.0f);
  EXPECT_EQ(nearest(INFINITY, 0.1f), -1.0f);
}

TEST_F(Passes, NormalsSurviveTheirEncoding) {
  PointCloud cloud = sphere_cloud(2000);
  cloud.normals.push_back(vec3(0, 0, -1));
  cloud.normals.push_back(vec3(0));
  for (const vec3& n : cloud.normals) {
    const std::uint32_t code = encode_normal(n);
    EXPECT_EQ(code == 0, n == vec3(0));
    vec2 e = vec2(float(code & 0xffff), float(code >> 16)) / 65535.0f * 2.0f - 1.0f;
    vec3 d(e, 1 - std::abs(e.x) - std::abs(e.y));
    if (d.z < 0)
      d = vec3((1 - std::abs(e.y)) * (e.x >= 0 ? 1 : -1), (1 - std::abs(e.x)) * (e.y >= 0 ? 1 : -1), d.z);
    if (n != vec3(0))
      EXPECT_GT(glm::dot(glm::dvec3(glm::normalize(d)), glm::dvec3(n)), 1 - 1e-6);  // float rounding of both
  }
}

// Unlit points take a short way to the finished picture; it must be the picture of the long way, which is
// taken when somebody reads the float target.
TEST_F(Passes, TheShortWayOfUnlitPointsGivesTheSamePicture) {
  Renderer renderer(context());
  PointCloud cloud = sphere_cloud(8000);
  cloud.normals.clear();
  show(renderer, std::move(cloud), {}, 3000);
  auto points = find_technique("points").create();
  RenderSettings settings;
  settings.edl.user = false;
  for (bool transparent : {false, true}) {
    settings.transparent = transparent;
    settings.background = vec3(0.2f, 0.4f, 0.9f);
    const Image<Rgba8> quick = renderer.render(*points, front_camera(60, 44), settings).rgba8;
    const Image<Rgba8> full = renderer.render(*points, front_camera(60, 44), settings, all_outputs()).rgba8;
    for (std::size_t i = 0; i < full.size(); ++i) {
      const Rgba8 a = quick.data()[i], b = full.data()[i];
      // sRGB to linear and back in float rounds to the same byte but for the last bit.
      ASSERT_LE(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 3);
      ASSERT_EQ(a.a, b.a);
    }
  }
}

}  // namespace
