#include "passes/shadows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>

#include "core/error.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

/// Discs so many spacings wide leave exp(-pi 1.3^2) = 0.5 % of a surface of random points open, and the lit
/// test takes the points within two texels of what is left for lit as well.
constexpr float disc_spacings = 2.6f;
/// Points up to so many spacings of the map apart take one texel each, which then is empty in
/// exp(-(1.5 / 1.2)^2) = 21 % of the cases, and 0.6 % after the filter.
constexpr float single_spacings = 1.2f;
/// Of d_min, and how many medians apart points may be to count as that sparse.
constexpr float d_min_spacings = 3, most_medians = 12;

/// Two unit vectors perpendicular to `n` and to each other.
std::pair<dvec3, dvec3> perpendicular(const dvec3& n) {
  const dvec3 other = std::abs(n.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0);
  const dvec3 u = glm::normalize(glm::cross(other, n));
  return {u, glm::cross(n, u)};
}

int largest_side() { return std::min(gl::limits().max_texture_size, 4096); }  // 64 MiB of depth and copies

int map_side(double texels) { return std::clamp(int(std::ceil(texels)), 16, largest_side()); }

double radius_of(const Bounds& box) { return std::max(0.5 * box.diagonal(), 1e-9); }

/// From outside one camera sees the bounding sphere; beyond 120 degrees its texels get too uneven.
bool is_inside(const Light& light, const Bounds& box) {
  return light.kind != Light::Kind::directional &&
         glm::length(box.center() - light.vector) <= radius_of(box) * 1.155;
}

/// Angle under which a light outside sees the bounding sphere.
double fov_of(const Light& light, const Bounds& box) {
  return 2 * std::asin(radius_of(box) / glm::length(box.center() - light.vector)) * 1.01;
}

/// What a map is wide: in the middle of the box, or where the faces of a light inside reach its sphere.
double map_width(const Light& light, const Bounds& box) {
  if (light.kind == Light::Kind::directional) return 2.02 * radius_of(box);
  if (is_inside(light, box)) return 2 * radius_of(box);
  return 2 * std::tan(0.5 * fov_of(light, box)) * glm::length(box.center() - light.vector);
}

/// How many of `total` light maps one visit of the points tests: what may be kept, in visits of one size.
std::size_t maps_at_a_time(std::size_t bytes_each, std::size_t total) {
  const std::size_t most =
      std::clamp<std::size_t>(ShadowMaps::most_map_bytes / bytes_each, 1, ShadowMaps::most_maps);
  const std::size_t visits = (total + most - 1) / most;
  return (total + visits - 1) / visits;
}

std::size_t bytes_of_map(const Camera& camera) {
  return std::size_t(camera.width) * std::size_t(camera.height) * sizeof(float);
}

}  // namespace

double ShadowMaps::fitting_texel(const Light& light, const Bounds& box, double wanted) {
  return std::max(wanted, map_width(light, box) / largest_side());
}

std::vector<Camera> ShadowMaps::light_cameras(const Light& light, const Bounds& box, double texel) {
  const dvec3 center = box.center();
  Camera camera;
  camera.width = camera.height = map_side(map_width(light, box) / texel);
  if (light.kind == Light::Kind::directional) {
    const double radius = radius_of(box);
    camera.projection = Projection::orthographic;
    camera.position = center + light.vector * (2 * radius);
    camera.target = center;
    camera.up = perpendicular(light.vector).first;
    camera.height_world = 2.02 * radius;
    camera.fit_depth_range(box);
    return {camera};
  }
  camera.position = light.vector;
  if (!is_inside(light, box)) {
    camera.target = center;
    camera.up = perpendicular(glm::normalize(center - light.vector)).first;
    camera.fov_y = fov_of(light, box);
    camera.fit_depth_range(box);
    return {camera};
  }
  std::vector<Camera> faces;
  camera.fov_y = glm::radians(90.0);
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {1.0, -1.0}) {
      dvec3 direction(0), up(0);
      direction[axis] = sign;
      // A map holds its left and its upper border: so every edge of the cube belongs to one face.
      up[(axis + (sign > 0 ? 1 : 2)) % 3] = 1;
      camera.target = camera.position + direction;
      camera.up = up;
      camera.fit_depth_range(box);
      faces.push_back(camera);
    }
  return faces;
}

std::vector<Light> ShadowMaps::light_samples(const Light& light, const Bounds& box, double size, int count) {
  std::vector<Light> samples{light};
  // A directional light stands at one diagonal from the cloud: its disc turns it by size / diagonal. In the
  // middle of the cloud one way is as good as another.
  const bool is_directional = light.kind == Light::Kind::directional;
  const dvec3 away = is_directional ? light.vector : light.vector - box.center();
  const dvec3 towards = glm::length(away) > 0 ? glm::normalize(away) : dvec3(0, 0, 1);
  const auto [u, v] = perpendicular(towards);
  std::mt19937 random(20100501);
  std::uniform_real_distribution<double> uniform(0, 1);
  // Stratified along the radius and turned by the golden angle: even cover of the disc for any count.
  const double turn = uniform(random) * 6.283185307179586;
  for (int i = 1; i < count; ++i) {
    const double r = 0.5 * size * std::sqrt((i + uniform(random) - 0.5) / count);
    const double angle = turn + 2.399963229728653 * i;
    const dvec3 offset = u * (r * std::cos(angle)) + v * (r * std::sin(angle));
    Light sample = light;
    if (is_directional)
      sample.vector = glm::normalize(light.vector + offset / std::max(box.diagonal(), 1e-9));
    else
      sample.vector = light.vector + offset;
    samples.push_back(sample);
  }
  return samples;
}

Bounds bounds_without_strays(std::span<const PointCloud* const> clouds) {
  std::size_t points = 0;
  for (const PointCloud* cloud : clouds) points += cloud->size();
  const std::size_t stride = std::max<std::size_t>(1, points / 1'000'000);
  PointCloud sample;
  for (const PointCloud* cloud : clouds) {
    sample.origin = cloud->origin;
    for (std::size_t i = 0; i < cloud->size(); i += stride) sample.positions.push_back(cloud->positions[i]);
  }
  const Bounds most = robust_bounds(sample);
  // Most points in one place have no size to measure by.
  const double reach = most.diagonal() > 0 ? most.diagonal() : std::numeric_limits<double>::infinity();
  const vec3 from(most.min - sample.origin - reach), to(most.max - sample.origin + reach);
  vec3 lo(std::numeric_limits<float>::infinity()), hi = -lo;
  for (const PointCloud* cloud : clouds)
    for (const vec3& p : cloud->positions) {
      if (glm::any(glm::lessThan(p, from)) || glm::any(glm::greaterThan(p, to))) continue;
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
  if (!(lo.x <= hi.x)) return most;
  return {sample.origin + dvec3(lo), sample.origin + dvec3(hi)};
}

void resolve_shadow_sizes(RenderSettings& settings, const Bounds& box, float median_spacing) {
  settings.light_size.resolve(float(0.1 * box.diagonal()));
  settings.shadow_distance.resolve(d_min_spacings * median_spacing);
}

float ShadowMaps::d_min_of(const RenderSettings& settings, float median, float spacing, float map_spacing) {
  // Across the texels of a map that had to be coarser a surface recedes as much more.
  if (settings.shadow_distance.is_auto()) return d_min_spacings * std::max(spacing, map_spacing);
  return *settings.shadow_distance.user * spacing / std::max(median, 1e-12f);
}

void ShadowMaps::measure(Clouds clouds) {
  std::vector<std::uint64_t> serials;
  for (const GpuCloud* cloud : clouds) serials.push_back(cloud->serial());
  if (serials == measured_) return;
  std::vector<const PointCloud*> points;
  for (const GpuCloud* cloud : clouds) points.push_back(&cloud->prepared().cloud);
  without_strays_ = bounds_without_strays(points);
  measured_ = std::move(serials);
}

void ShadowMaps::use_stored(Clouds clouds) {
  const auto is_loaded = [](const GpuCloud* cloud) {
    return cloud->size() == 0 || cloud->has_stored_shadow();
  };
  if (std::all_of(clouds.begin(), clouds.end(), is_loaded)) return;
  if (std::none_of(clouds.begin(), clouds.end(),
                   [](const GpuCloud* cloud) { return cloud->prepared().cloud.scalar("shadow"); }))
    throw Error(
        ErrorCode::usage,
        "--shadows stored: no point has the scalar `shadow`; sfumato convert IN --shadows soft -o OUT "
        "writes it");
  clear(clouds);
  for (GpuCloud* cloud : clouds)
    if (cloud->size() > 0) cloud->set_stored_shadow();
}

void ShadowMaps::clear(Clouds clouds) {
  for (GpuCloud* cloud : clouds)
    if (cloud->has_shadow()) cloud->set_shadow({});
  key_.reset();
  // Up to a gigabyte of light maps and layers would wait for the next time that somebody wants shadows.
  for (gl::Texture* each :
       {&bits_, &closed_, &other_depth_, &other_index_, &state_, &other_state_, &ground_passed_})
    *each = {};
  for (auto* each : {&maps_, &farthest_, &layer_depth_, &opacity_}) each->clear();
  layer_ = {};
  to_pixels_.forget();
  passed_.clear();
}

void ShadowMaps::update(Clouds all, const RenderSettings& asked, const Light& light, gl::Timers& timers,
                        Progress& progress, const View* ground_view, const Ground& ground,
                        gl::Texture* ground_factor) {
  std::vector<GpuCloud*> clouds;
  for (GpuCloud* cloud : all)
    if (cloud->size() > 0) clouds.push_back(cloud);
  if (clouds.empty()) return clear(all);
  Bounds whole = clouds.front()->bounds();
  float spacing = clouds.front()->median_spacing();
  for (const GpuCloud* cloud : clouds) {
    whole = {glm::min(whole.min, cloud->bounds().min), glm::max(whole.max, cloud->bounds().max)};
    spacing = std::min(spacing, cloud->median_spacing());
  }
  measure(clouds);
  RenderSettings settings = asked;
  resolve_shadow_sizes(settings, without_strays_, spacing);
  const int count = settings.shadows == Shadows::soft ? settings.light_samples : 1;
  const double size = settings.light_size.value();
  const double wanted = texel_ * std::max(double(spacing), 1e-12);  // of the densest cloud
  // Strays count as long as a map of the texels wanted holds them as well.
  const bool holds_strays = !(fitting_texel(light, whole, wanted) > wanted);
  const Bounds& box = holds_strays ? whole : without_strays_;
  Key key{{}, light.kind, light.vector, std::size_t(count), size, asked.shadow_distance};
  bool have_all = true, see_through = false;
  for (const GpuCloud* cloud : clouds) {
    key.clouds.push_back({cloud->serial(), cloud->casters(), cloud->has_normals(), cloud->cut()});
    have_all = have_all && cloud->has_shadow();
    see_through = see_through || cloud->see_through_spacing() > 0;
  }
  // The ground depends on the camera as well, so it is always drawn anew.
  if (key_ == key && have_all && !ground_view) return;
  key_.reset();  // who cancels leaves the factors half done

  std::erase_if(passed_, [&](const auto& each) {
    return std::find(clouds.begin(), clouds.end(), each.first) == clouds.end();
  });
  const dvec3 origin = clouds.front()->prepared().cloud.origin;
  for (GpuCloud* cloud : clouds) {
    cloud->begin_shadow();
    if (!see_through) continue;
    std::vector<gl::TextureBuffer>& passed = passed_[cloud];
    passed.resize(cloud->chunks().size());
    for (std::size_t c = 0; c < passed.size(); ++c)
      gl::grow(passed[c], "light passed", GL_R32F, cloud->chunks()[c].count * sizeof(float));
  }
  std::optional<Catcher> catcher;
  if (ground_view && ground_factor) {
    ground_factor->clear(vec4(0));
    catcher.emplace(Catcher{*ground_view, ground, origin, *ground_factor});
  }
  const Catcher* caught = catcher ? &*catcher : nullptr;
  const std::vector<Light> samples = light_samples(light, without_strays_, size, count);
  double texel = wanted;
  for (const Light& sample : samples) texel = std::max(texel, fitting_texel(sample, box, wanted));
  const float map_spacing = float(texel / texel_);
  const float d_min = d_min_of(asked, spacing, spacing, map_spacing);  // of the densest cloud
  const float share = 1.0f / float(samples.size());
  const LitTest kind = see_through ? LitTest::behind_see_through : LitTest::solid;
  std::vector<View> views;       // of the light maps that wait for their test
  std::vector<float> elsewhere;  // light that falls on what each of them does not hold
  bool is_first = true;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    progress.update(double(i) / double(samples.size()), "shadows");
    progress.check();
    const std::vector<Camera> cameras = light_cameras(samples[i], box, texel);
    for (std::size_t face = 0; face < cameras.size(); ++face) {
      bool is_first_peel = true;
      for (GpuCloud* cloud : clouds) {
        // See-through casters are sparser than their cloud: their map is as much coarser, and so is d_min.
        const float sparse = cloud->see_through_spacing();
        if (!(sparse > 0)) continue;
        const double own_texel = fitting_texel(samples[i], box, texel_ * std::max(double(sparse), 1e-12));
        peel(*cloud, clouds, light_cameras(samples[i], box, own_texel)[face],
             d_min_of(asked, cloud->median_spacing(), sparse, float(own_texel / texel_)), is_first_peel,
             timers, caught);
        is_first_peel = false;
      }
      // What see-through casters let pass is kept for one map only.
      const std::size_t most =
          see_through ? 1 : maps_at_a_time(bytes_of_map(cameras[face]), samples.size() * cameras.size());
      maps_.resize(std::max(maps_.size(), most));
      const gl::Texture& map = maps_[views.size()];
      const View& view = views.emplace_back(cameras[face], origin);
      elsewhere.push_back(cameras.size() > 1 ? 0.0f : 1.0f);  // another face sees it, or nothing casts there
      draw_map(clouds, view, d_min, views.size() - 1, timers);
      auto timing = timers.scope("lit test");
      if (caught) test_ground(*caught, see_through, elsewhere.back(), view, map, d_min, share);
      const bool is_last = i + 1 == samples.size() && face + 1 == cameras.size();
      if (views.size() < most && !is_last) continue;
      for (GpuCloud* cloud : clouds)
        test_points(*cloud, kind, views, std::span(maps_).first(views.size()),
                    d_min_of(asked, cloud->median_spacing(), cloud->median_spacing(), map_spacing),
                    asked.shadow_distance.is_auto() ? d_min_spacings : 0.0f, is_first, elsewhere, share);
      views.clear(), elsewhere.clear();
      is_first = false;
    }
  }
  key_ = std::move(key);
}

void ShadowMaps::peel(GpuCloud& cloud, Clouds receivers, const Camera& light_camera, float d_min,
                      bool is_first, gl::Timers& timers, const Catcher* catcher) {
  const dvec3 origin = cloud.prepared().cloud.origin;
  const View view(light_camera, origin);
  const int w = view.width(), h = view.height();
  const CasterRange see_through{least_opacity, solid_opacity};
  // Of each layer its depth and its opacity are kept until the points are tested.
  const std::size_t most = maps_at_a_time(2 * bytes_of_map(light_camera), most_layers_a_visit);
  layer_depth_.resize(std::max(layer_depth_.size(), most));
  opacity_.resize(layer_depth_.size());
  gl::ensure(other_depth_, "light layer", GL_R32F, w, h);
  for (gl::Texture* t : {&state_, &other_state_}) gl::ensure(*t, "light layer limit", GL_RG32F, w, h);
  gl::ensure(other_index_, "light layer index", GL_R32UI, w, h);
  state_.clear(vec4(0, 1, 0, 0));
  if (catcher && is_first) {
    gl::ensure(ground_passed_, "light passed to the ground", GL_R32F, catcher->view.width(),
               catcher->view.height());
    ground_passed_.clear(vec4(1));
  }
  if (!layer_pass_) layer_pass_ = ScreenPass("passes/light_layer.glsl", {GL_RG32F, GL_R32F});

  std::size_t kept = 0;
  for (int layer = 0; layer < most_layers; ++layer) {
    {
      auto timing = timers.scope("light map");
      const gl::Texture* limit = layer == 0 ? nullptr : &state_;
      gl::Timers untimed(false);  // its own scopes are those of the picture
      to_pixels_.draw(cloud, view, {SizeMode::pixels, 1}, layer_, untimed, limit, 0, &see_through);
    }
    gl::Texture &depth = layer_depth_[kept], &opacity = opacity_[kept];
    bool is_open = false;
    {
      auto timing = timers.scope("light map fill");
      for (gl::Texture* t : {&depth, &opacity}) gl::ensure(*t, "light layer", GL_R32F, w, h);
      fill_.run_index(FillKind::background, d_min, layer_.depth_bits, other_depth_, layer_.index,
                      other_index_);
      fill_.run_index(FillKind::occluded, d_min, other_depth_, depth, other_index_, layer_.index);
      view.bind();
      open_.arm();
      layer_pass_.set("has_normals", cloud.has_normals()).set("d_min", d_min);
      cloud.for_each_place(layer_pass_, [&](GpuCloud::Chunk& chunk) {
        cloud.bind_normals(chunk);
        cloud.bind_casters(chunk);
        layer_pass_.run({&depth, &layer_.index, &state_}, {&other_state_, &opacity});
      });
      std::swap(state_, other_state_);
      find_farthest(depth, kept);
      is_open = open_.is_set();
    }
    auto timing = timers.scope("lit test");
    if (catcher) test_ground_layer(*catcher, view, depth, opacity, d_min);
    const bool is_last = !is_open || layer + 1 == most_layers;
    if (++kept == most || is_last) {
      for (std::size_t k = 0; k < kept; ++k) opacity_[k].bind(binding::input + int(kept + k));
      for (GpuCloud* receiver : receivers)
        test_points(*receiver, LitTest::see_through, std::span(&view, 1), std::span(layer_depth_).first(kept),
                    d_min, 0, is_first);
      kept = 0;
      is_first = false;
    }
    if (is_last) break;
  }
}

void ShadowMaps::draw_map(Clouds clouds, const View& view, float d_min, std::size_t k, gl::Timers& timers) {
  gl::Texture& map = maps_[k];
  const CasterRange solid{solid_opacity};
  {
    auto timing = timers.scope("light map");
    gl::ensure(bits_, "nearest depth bits", GL_R32UI, view.width(), view.height());
    bits_.clear_uint(0xffffffffu);
    for (GpuCloud* cloud : clouds) {
      Footprint footprint;
      footprint.mode = SizeMode::adaptive;
      footprint.size = disc_spacings;
      footprint.oriented = true;
      footprint.largest_medians = most_medians;
      footprint.single_px = single_spacings * disc_spacings / float(texel_);
      footprint.most_px = 1024;
      to_pixels_.add_depth(*cloud, view, footprint, bits_, nullptr, 0, cloud->casters() ? &solid : nullptr);
    }
  }
  auto timing = timers.scope("light map fill");
  for (gl::Texture* t : {&map, &closed_}) gl::ensure(*t, "light map", GL_R32F, view.width(), view.height());
  const gl::Texture* last = &bits_;
  auto fill = [&](FillKind kind) {
    fill_.run(kind, d_min, *last, closed_);
    std::swap(map, closed_);
    last = &map;
  };
  for (int i = 0; i < fills_; ++i) fill(FillKind::gaps);
  if (last == &bits_) {
    if (!decode_) decode_ = ScreenPass("passes/depth_from_bits.glsl", {GL_R32F});
    decode_.run({&bits_}, {&map});
  }
  find_farthest(map, k);
}

void ShadowMaps::find_farthest(const gl::Texture& map, std::size_t k) {
  constexpr int side = 4;
  if (!farthest_pass_) farthest_pass_ = ScreenPass("passes/light_farthest.glsl", {GL_R32F});
  farthest_.resize(std::max(farthest_.size(), k + 1));
  gl::ensure(farthest_[k], "light map, farthest", GL_R32F, (map.width() + side - 1) / side,
             (map.height() + side - 1) / side);
  farthest_pass_.run({&map}, {&farthest_[k]});
}

void ShadowMaps::test_points(GpuCloud& cloud, LitTest kind, std::span<const View> views,
                             std::span<const gl::Texture> maps, float d_min, float spacings, bool is_first,
                             std::span<const float> elsewhere, float share) {
  const bool parallel = views.front().camera().orthographic();
  gl::Program& program = lit_tests_[{kind, parallel, maps.size()}];
  if (!program) {
    gl::Defines defines{"MAPS " + std::to_string(maps.size())};
    if (parallel) defines.push_back("ORTHOGRAPHIC");
    if (kind == LitTest::see_through) defines.push_back("LAYER");
    if (kind == LitTest::behind_see_through) defines.push_back("PASSED");
    program = gl::Program::compute("passes/lit_test.comp", defines);
  }
  for (std::size_t k = 0; k < maps.size(); ++k) {
    maps[k].bind(binding::input + int(k));
    farthest_[k].bind(binding::farthest + int(k));
  }
  for (std::size_t k = 0; k < views.size(); ++k) {
    const std::string name = "views[" + std::to_string(k) + "].";
    const Intrinsics lens = views[k].camera().intrinsics();
    program.set(name + "eye_from_cloud", mat4(views[k].eye_from_cloud()))
        .set(name + "intrinsics", vec4(lens.fx, lens.fy, lens.cx, lens.cy))
        .set(name + "near_plane", float(views[k].camera().near_plane));
    if (!elsewhere.empty()) program.set(name + "elsewhere", elsewhere[k]);
  }
  program.set("d_min", d_min).set("d_min_spacings", spacings).set("share", share);
  program.set("largest_spacing", most_medians * cloud.median_spacing());
  program.set("has_normals", cloud.has_normals()).set("is_first", is_first);
  // Every batch: what no map holds is lit.
  const Bounds all = cloud.bounds();
  cloud.cull(
      View(light_cameras(Light{Light::Kind::directional, {0, 0, 1}}, all, std::max(all.diagonal(), 1e-9))[0],
           cloud.prepared().cloud.origin));
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c) {
    GpuCloud::Chunk& chunk = cloud.chunks()[c];
    cloud.bind_geometry(chunk);
    cloud.bind_normals(chunk);
    gl::bind_image(0, chunk.shadow, GL_READ_WRITE, GL_R32F);
    if (kind != LitTest::solid) gl::bind_image(1, passed_.at(&cloud)[c], GL_READ_WRITE, GL_R32F);
    program.dispatch(chunk.groups_per_batch, chunk.visible_batches);
  }
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void ShadowMaps::test_ground(const Catcher& catcher, bool has_passed, float elsewhere, const View& light_view,
                             const gl::Texture& map, float d_min, float share) {
  ScreenPass& pass = ground_pass_[has_passed];
  if (!pass) {
    gl::Defines defines;
    if (has_passed) defines.push_back("PASSED");
    pass = ScreenPass("passes/ground_shadow.glsl", {GL_R32F}, defines);
  }
  pass.set("share", share).set("elsewhere", elsewhere);
  if (has_passed) ground_passed_.bind(binding::input + 2);
  run_ground(catcher, pass, light_view, d_min, {&map, &catcher.factor}, catcher.factor);
}

void ShadowMaps::test_ground_layer(const Catcher& catcher, const View& light_view, const gl::Texture& depth,
                                   const gl::Texture& opacity, float d_min) {
  if (!ground_layer_) ground_layer_ = ScreenPass("passes/ground_shadow.glsl", {GL_R32F}, {"LAYER"});
  run_ground(catcher, ground_layer_, light_view, d_min, {&depth, &opacity, &ground_passed_}, ground_passed_);
}

void ShadowMaps::run_ground(const Catcher& catcher, ScreenPass& pass, const View& light_view, float d_min,
                            std::initializer_list<const gl::Texture*> inputs, gl::Texture& target) {
  const dmat4 eye_from_cloud = catcher.view.eye_from_cloud();
  const dvec3 point(eye_from_cloud * glm::dvec4(catcher.ground.point - catcher.cloud_origin, 1));
  const dvec3 normal(eye_from_cloud * glm::dvec4(catcher.ground.normal, 0));
  const Intrinsics k = light_view.camera().intrinsics();
  pass.set("plane_eye", vec4(vec3(normal), float(-glm::dot(normal, point))))
      .set("light_from_eye", mat4(light_view.eye_from_cloud() * glm::inverse(eye_from_cloud)))
      .set("light_intrinsics", vec4(k.fx, k.fy, k.cx, k.cy))
      .set("light_orthographic", light_view.camera().orthographic())
      .set("d_min", d_min);
  gl::Texture next("ground shadow", GL_R32F, catcher.view.width(), catcher.view.height());
  catcher.view.bind();
  pass.run(inputs, {&next});
  std::swap(next, target);
}

}  // namespace sfumato
