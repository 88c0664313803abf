#include "techniques/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "gl/commands.h"
#include "gl/pace.h"
#include "passes/finish.h"
#include "passes/ground.h"
#include "passes/merge.h"
#include "passes/relief.h"
#include "passes/screen_pass.h"
#include "passes/shadows.h"
#include "techniques/tiles.h"

namespace sfumato {
namespace {

/// In the space of a cloud with this origin.
GpuCloud::Cut local(const Cut& cut, const dvec3& origin) {
  GpuCloud::Cut near;
  const auto moved = [&](const glm::dvec4& plane) {
    return vec4(dvec3(plane), plane.w + glm::dot(dvec3(plane), origin));
  };
  for (const glm::dvec4& wall : cut.walls) near.planes.push_back(moved(wall));
  if (!cut.ceiling) return near;
  const Ceiling& ceiling = *cut.ceiling;
  near.up = vec3(ceiling.up), near.across = ceiling.across;
  near.u = moved(ceiling.u), near.v = moved(ceiling.v);
  for (const double height : ceiling.heights)
    near.heights.push_back(float(std::min(height - glm::dot(ceiling.up, origin), 1e30)));
  return near;
}

/// What is drawn, and how, for each of the samples of a picture.
struct SamplePass {
  std::vector<Item> items;         ///< in the order of drawing
  const RenderSettings& settings;  ///< of the scene
  gl::Timers& timers;
  Progress& progress;
  Relief::Options relief;
  bool with_smooth_outlines;
  bool wants_normal = false;
  VisiblePoints* visible = nullptr;       ///< Frame::visible
  const VisiblePoints* merged = nullptr;  ///< Frame::merged
};

/// The base-2 radical inverse.
double van_der_corput(unsigned i) {
  double value = 0;
  for (double digit = 0.5; i > 0; i >>= 1, digit *= 0.5) value += digit * (i & 1);
  return value;
}

/// The camera seen through another place of its pixels: one in each row and column of a grid over the pixel
/// (for four samples the rotated grid), their mean the centre where `samples` is a power of two.
Camera jittered(const Camera& camera, int sample, int samples) {
  const double x = (sample + 0.5) / samples - 0.5;
  const double inverse = van_der_corput(unsigned(sample));
  const double y =
      (inverse < 0.5 ? inverse : inverse - 1) + 0.5 / samples;  // half a turn: no two on a diagonal
  Camera out = camera;
  Intrinsics inside = camera.whole_intrinsics();
  inside.cx += x;
  inside.cy += y;
  out.custom_intrinsics = inside;
  return out;
}

/// Whether what is shown is a picture that light and outlines belong to.
bool is_shaded(const RenderSettings& settings) {
  return settings.shading == Shading::lit || settings.shading == Shading::albedo;
}

/// What depth is resolved for: everything within a hundred diagonals of most points, so that one stray point
/// a billion times farther out costs nobody else.
Bounds depth_bounds(const PreparedCloud& prepared) {
  const WholeCloud* whole = prepared.whole.get();
  const Bounds all = whole ? whole->box : bounds(prepared.cloud),
               most = whole ? whole->usual_box : robust_bounds(prepared.cloud);
  const double reach = 100 * most.diagonal();
  if (reach == 0) return all;  // most points in one place have no size to measure by
  return {glm::max(all.min, most.min - reach), glm::min(all.max, most.max + reach)};
}

Relief::Options relief_options(std::span<const Item> items, const RenderSettings& settings) {
  Relief::Options options;
  if (!is_shaded(settings)) return options;
  Auto<bool> edl = settings.edl;
  if (edl.resolve(edl_strength(items, settings.photographed) > 0))
    options.edl_strength = settings.edl_strength.value();
  options.edl_radius = settings.edl_radius;
  options.occlusion = settings.ambient_occlusion.value();
  options.coarse = settings.photographed;
  options.scaling = settings.radiance_scaling.value();
  return options;
}

/// Rows [0, height) of `part` to those of `picture` from (x, y) on, `width` px of each from `from_x` on.
template <class T>
void paste(const Image<T>& part, int from_x, int from_y, int width, int height, Image<T>& picture, int x,
           int y) {
  if (part.empty()) return;
  for (int row = 0; row < height; ++row)
    std::copy_n(&part.at(from_x, from_y + row), width, &picture.at(x, y + row));
}

RenderOutput empty_images(int width, int height, const RenderWants& wants) {
  RenderOutput out;
  if (wants.color) out.rgba8 = Image<Rgba8>(width, height);
  if (wants.color_linear) out.color_linear = Image<vec4>(width, height);
  if (wants.depth) out.depth = Image<float>(width, height);
  if (wants.normal) out.normal = Image<vec3>(width, height);
  return out;
}

void paste(const RenderOutput& part, int from_x, int from_y, int width, int height, RenderOutput& picture,
           int x, int y) {
  paste(part.rgba8, from_x, from_y, width, height, picture.rgba8, x, y);
  paste(part.color_linear, from_x, from_y, width, height, picture.color_linear, x, y);
  paste(part.depth, from_x, from_y, width, height, picture.depth, x, y);
  paste(part.normal, from_x, from_y, width, height, picture.normal, x, y);
}

void require_merging(bool merges) {
  if (!merges)
    throw Error(ErrorCode::usage,
                "this picture of a part cannot be merged with those of others (shadows, samples, tiles, or a "
                "technique that cannot): draw the whole cloud, or another technique");
}

/// Whether the technique cannot draw it in one go.
bool exceeds(const Camera& camera, const Technique& technique) {
  return std::int64_t(camera.width) * camera.height > technique.most_pixels();
}

/// Side of what all of them can draw in one go, px.
int largest_canvas(std::span<const Item> items) {
  std::int64_t pixels = Renderer::most_pixels;
  for (const Item& item : items) pixels = std::min(pixels, item.technique->most_pixels());
  return int(std::sqrt(double(pixels)));
}

}  // namespace

float edl_strength(std::span<const Item> items, bool photographed) {
  float strength = 0;
  for (const Item& item : items) strength = std::max(strength, item.technique->edl_strength(photographed));
  return strength;
}

struct Renderer::State {
  struct Cloud {
    std::shared_ptr<SharedCloud> shared;
    Bounds depth_bounds;
    std::unique_ptr<GpuCloud> gpu;
    const PreparedCloud& prepared() const { return gpu->prepared(); }
  };

  gl::Context& context;
  std::vector<std::unique_ptr<Cloud>> clouds;
  std::optional<Room> room;
  std::vector<Camera> together;  ///< while pictures are drawn that are put together; else empty
  Target target, item_target;
  gl::Texture finish_scratch, ground_factor, rgba8, linear;
  ShadowMaps shadows;
  GroundPlane ground;
  Merge merge;
  PostProcessing post_processing;
  Finish finish;
  ScreenPass add_sample;
  gl::Texture sum, averaged;
  explicit State(gl::Context& c) : context(c) {}

  Cloud& cloud_of(const Item& item) { return *clouds.at(item.cloud); }
  /// The largest spacing of points between which a surface was closed, scene units; 0 where one item closes
  /// none.
  float closed_spacing(std::span<const Item> items) {
    float spacing = 0;
    for (const Item& item : items) {
      if (!item.technique->closes_depth()) return 0;
      spacing = std::max(spacing, cloud_of(item).gpu->median_spacing());
    }
    return spacing;
  }
  /// Where not, radiance scaling has nothing to read. A closed surface has normals.
  bool has_normals(const SamplePass& pass) {
    return std::ranges::any_of(pass.items, [&](const Item& item) {
      return item.technique->closes_depth() ||
             (pass.merged ? !pass.merged->normals.empty() : cloud_of(item).gpu->has_normals());
    });
  }
  /// Of the cloud with the most points: a few of another do not decide for all.
  float median_spacing(std::span<const Item> items) {
    const auto points = [&](const Item& item) { return cloud_of(item).gpu->size(); };
    return cloud_of(*std::ranges::max_element(items, {}, points)).gpu->median_spacing();
  }
  /// The largest of the clouds; of one that is a depth picture that of its sensor.
  void find_noise(SamplePass& pass, const Camera& camera) {
    pass.relief.noise = pass.relief.sensor_noise = 0;
    for (const Item& item : pass.items)
      pass.relief.noise = std::max(pass.relief.noise, cloud_of(item).prepared().noise);
    const PreparedCloud& only = cloud_of(pass.items.front()).prepared();
    if (pass.items.size() > 1 || !only.pictures) return;
    pass.relief.sensor =
        vec3(camera.view() * glm::dvec4(only.cloud.origin + dvec3(only.pictures->sensor), 1));
    pass.relief.sensor_noise = only.pictures->noise;
  }
  /// Makes ready what the items draw from, and a camera that sees the depths of all of them.
  Camera fit_camera(std::span<const Item> items, const Camera& asked);
  Ground ground_below_all() const;
  void make_target(const Camera& camera) {
    if (!target.color || target.color.width() != camera.width || target.color.height() != camera.height)
      target = Target(camera.width, camera.height);
  }
  /// One picture through pixel centres (of a camera that may be jittered) into `target`.
  void draw(SamplePass& pass, const Camera& camera);
  /// One item into `into`; `behind`: what it lets through.
  void draw_item(SamplePass& pass, const Item& item, const Camera& camera, const Light& light, Target& into,
                 const Target* behind);
  /// Adds the target's colour, a share of the whole.
  void average(int sample, int samples, gl::Timers& timers);
  /// How far a pixel of the finished picture sees. `camera`: as `fit_camera` gives it.
  int reach_px(std::span<const Item> items, const Camera& camera, const RenderSettings& settings);
  std::uint64_t points_seen(std::span<const Item> items, const Camera& camera);
  /// Of tiles that all of them can draw with their overlap, px.
  static int tile_side(std::span<const Item> items, int overlap);
  /// Of tiles of which at least a quarter of the side is kept, px.
  static int most_overlap(std::span<const Item> items);
};

void Renderer::State::average(int sample, int samples, gl::Timers& timers) {
  auto timing = timers.scope("average");
  for (gl::Texture* each : {&sum, &averaged})
    gl::ensure(*each, "samples", GL_RGBA32F, target.color.width(), target.color.height());
  if (!add_sample) add_sample = ScreenPass("techniques/add_sample.glsl", {GL_RGBA32F});
  add_sample.set("share", 1.0f / float(samples)).set("is_first", sample == 0);
  add_sample.run({&sum, &target.color}, {&averaged});
  if (sample + 1 < samples) std::swap(sum, averaged);
}

Camera Renderer::State::fit_camera(std::span<const Item> items, const Camera& asked) {
  Bounds near, all;
  bool is_first = true;
  for (const Item& item : items) {
    Cloud& cloud = cloud_of(item);
    cloud.gpu->show(cloud.shared->newest(), item.technique->needs());
    if (!is_first && cloud.gpu->size() == 0) continue;
    const Bounds box = cloud.gpu->bounds(), &depths = cloud.depth_bounds;
    all = is_first ? box : Bounds{glm::min(all.min, box.min), glm::max(all.max, box.max)};
    near = is_first ? depths : Bounds{glm::min(near.min, depths.min), glm::max(near.max, depths.max)};
    is_first = cloud.gpu->size() == 0;
  }
  Camera camera = asked;
  const GpuCloud::Cut cut =
      room ? local(cut_before(*room, camera), clouds.front()->prepared().cloud.origin) : GpuCloud::Cut{};
  for (const Item& item : items) cloud_of(item).gpu->set_cut(cut);
  // Who looks at a stray point gets its depth as well.
  const dvec3 looked_at = glm::clamp(camera.target, all.min, all.max);
  const Bounds shown{glm::min(near.min, looked_at), glm::max(near.max, looked_at)};
  camera.fit_depth_range(shown);
  for (Camera& each : together) {
    each.fit_depth_range(shown);
    camera.near_plane = std::min(camera.near_plane, each.near_plane);
    camera.far_plane = std::max(camera.far_plane, each.far_plane);
  }
  for (Camera& each : together) each.near_plane = camera.near_plane, each.far_plane = camera.far_plane;
  return camera;
}

int Renderer::State::reach_px(std::span<const Item> items, const Camera& camera,
                              const RenderSettings& settings) {
  int reach = 0;
  for (const Item& item : items)
    reach = std::max(reach, item.technique->reach_px(*cloud_of(item).gpu, camera));
  // See-through items look at what opaque ones left.
  if (items.size() > 1) reach *= 2;
  if (const Relief::Options options = relief_options(items, settings); options.any())
    reach += Relief::reach_px(options, camera.whole_height());
  if (settings.smooth_outlines.value() && is_shaded(settings)) reach += 16;  // smooth_outlines.glsl
  return reach;
}

std::uint64_t Renderer::State::points_seen(std::span<const Item> items, const Camera& camera) {
  std::uint64_t count = 0;
  for (const Item& item : items) {
    const Cloud& cloud = cloud_of(item);
    count += cloud.gpu->points_in(View(camera, cloud.prepared().cloud.origin));
  }
  return count;
}

int Renderer::State::tile_side(std::span<const Item> items, int overlap) {
  // The overlap is rounded up to the grid on either side.
  const int side = std::min(2048, largest_canvas(items) - 2 * (overlap + tile_grid));
  return std::max(side / tile_grid, 1) * tile_grid;
}

int Renderer::State::most_overlap(std::span<const Item> items) {
  const int canvas = largest_canvas(items);
  return std::max(0, (canvas - canvas / 4) / 2 - tile_grid);
}

Ground Renderer::State::ground_below_all() const {
  if (clouds.size() == 1) return ground_below(clouds.front()->prepared().cloud);
  // The lowest points of the scene, not of an item that may be nothing but a few outliers.
  std::size_t points = 0;
  for (const auto& cloud : clouds) points += cloud->prepared().cloud.size();
  const std::size_t stride = std::max<std::size_t>(1, points / 1'000'000);
  PointCloud sample;
  for (const auto& cloud : clouds) {
    const PointCloud& of = cloud->prepared().cloud;
    sample.origin = of.origin, sample.up = of.up;
    for (std::size_t i = 0; i < of.size(); i += stride) sample.positions.push_back(of.positions[i]);
  }
  return ground_below(sample);
}

void Renderer::State::draw_item(SamplePass& pass, const Item& item, const Camera& camera, const Light& light,
                                Target& into, const Target* behind) {
  RenderSettings settings = *item.settings;
  settings.background = pass.settings.background;
  settings.transparent = pass.settings.transparent;
  Frame frame{*cloud_of(item).gpu, camera,      settings,     light, into,
              pass.wants_normal,   pass.timers, pass.progress};
  frame.behind = behind;
  const Camera whole = camera.whole_picture();
  frame.views = together.empty() ? std::span(&whole, 1) : std::span<const Camera>(together);
  frame.visible = pass.visible, frame.merged = pass.merged;
  while (!item.technique->render(frame)) pass.progress.check();
}

void Renderer::State::draw(SamplePass& pass, const Camera& camera) {
  const RenderSettings& settings = pass.settings;
  const PointCloud& first = clouds.front()->prepared().cloud;
  const View view(camera, first.origin);
  std::vector<GpuCloud*> all;
  bool is_empty = true;
  for (const Item& item : pass.items) {
    all.push_back(cloud_of(item).gpu.get());
    is_empty = is_empty && all.back()->size() == 0;
  }
  const bool has_shadows = settings.shadows != Shadows::off && !is_empty;
  const bool has_ground = settings.ground && has_shadows && casts_shadows(settings.shadows);
  Light light = Light::parse(settings.light_text);
  Ground ground_plane;
  // The shadows of a light at the eye are hidden behind what casts them.
  if (has_shadows && light.is_of_camera()) light = key_light(camera, first.up);
  if (has_shadows && settings.shadows == Shadows::stored) {
    shadows.use_stored(all);
  } else if (has_shadows) {
    for (const Item& item : pass.items) {
      GpuCloud& cloud = *cloud_of(item).gpu;
      cloud.set_casters(item.technique->casters(cloud, pass.progress));
    }
    if (has_ground) {
      ground_plane = ground_below_all();
      gl::ensure(ground_factor, "ground shadow", GL_R32F, camera.width, camera.height);
    }
    shadows.update(all, settings, light, pass.timers, pass.progress, has_ground ? &view : nullptr,
                   ground_plane, has_ground ? &ground_factor : nullptr);
  } else {
    shadows.clear(all);
  }

  draw_item(pass, pass.items.front(), camera, light, target, nullptr);
  if (pass.visible) return;
  for (const Item& item : std::span(pass.items).subspan(1)) {
    if (cloud_of(item).gpu->size() == 0) continue;
    gl::ensure(item_target.color, "item color", GL_RGBA32F, camera.width, camera.height);
    gl::ensure(item_target.depth, "item depth", GL_R32F, camera.width, camera.height);
    gl::ensure(item_target.normal, "item normal", GL_RGBA32F, camera.width, camera.height);
    const bool is_seen_through = item.technique->transparency() != Transparency::none;
    draw_item(pass, item, camera, light, item_target, is_seen_through ? &target : nullptr);
    if (is_seen_through) {
      std::swap(target, item_target);
    } else {
      auto timing = pass.timers.scope("merge");
      merge.run(item_target, target, pass.wants_normal);
    }
  }

  if (has_ground) {
    auto timing = pass.timers.scope("ground");
    gl::ensure(finish_scratch, "finish scratch", GL_RGBA32F, camera.width, camera.height);
    ground.run(view, ground_plane, first.origin, target.color, target.depth, ground_factor, finish_scratch);
    std::swap(finish_scratch, target.color);
  }
  pass.relief.spacing = closed_spacing(pass.items);
  pass.relief.median_spacing = median_spacing(pass.items);
  find_noise(pass, camera);
  post_processing.run(view, pass.relief, pass.with_smooth_outlines, target.color, target.depth, target.normal,
                      pass.timers);
}

Renderer::Renderer(gl::Context& context) : state_(std::make_unique<State>(context)) {}
Renderer::~Renderer() {
  if (!state_) return;
  const gl::Context::Use use(state_->context);
  state_.reset();
}

void Renderer::set_cloud(PreparedCloud cloud, std::vector<Rgba8> colors, std::uint32_t max_chunk_points) {
  std::vector<ColoredCloud> one;
  one.push_back({std::move(cloud), std::move(colors)});
  set_clouds(std::move(one), max_chunk_points);
}

void Renderer::set_clouds(std::vector<ColoredCloud> clouds, std::uint32_t max_chunk_points) {
  for (const ColoredCloud& each : clouds)
    if (each.cloud.cloud.origin != clouds.front().cloud.cloud.origin)
      throw Error(ErrorCode::usage,
                  "the clouds of a scene have one origin: move them to that of the first (append does)");
  const gl::Context::Use use(state_->context);
  state_->clouds.clear();
  state_->room.reset();
  for (ColoredCloud& each : clouds) {
    auto& cloud = state_->clouds.emplace_back(std::make_unique<State::Cloud>());
    cloud->depth_bounds = depth_bounds(each.cloud);
    cloud->shared = std::make_shared<SharedCloud>(std::move(each.cloud), max_chunk_points);
    cloud->gpu = std::make_unique<GpuCloud>(cloud->shared->newest(),
                                            std::make_shared<const GpuCloud::Colors>(std::move(each.colors)));
  }
}

void Renderer::share_clouds(const Renderer& other) {
  const gl::Context::Use use(state_->context);
  state_->clouds.clear();
  state_->room = other.state_->room;
  for (const auto& each : other.state_->clouds) {
    auto& cloud = state_->clouds.emplace_back(std::make_unique<State::Cloud>());
    cloud->shared = each->shared;
    cloud->depth_bounds = each->depth_bounds;
    cloud->gpu = std::make_unique<GpuCloud>(cloud->shared->newest(), each->gpu->shared_colors());
  }
}

void Renderer::complete(std::size_t cloud, const std::function<bool(const PreparedCloud&)>& lacks,
                        const std::function<void(PreparedCloud&)>& add) {
  State::Cloud& own = *state_->clouds.at(cloud);
  if (!lacks(own.prepared())) return;
  const gl::Context::Use use(state_->context);
  own.gpu->complete(*own.shared, own.shared.use_count() == 1, lacks, add);
}

void Renderer::forget_programs() {
  const gl::Context::Use use(state_->context);
  auto fresh = std::make_unique<State>(state_->context);
  fresh->clouds = std::move(state_->clouds);
  fresh->room = std::move(state_->room);
  state_ = std::move(fresh);
}

void Renderer::set_room(std::optional<Room> room) { state_->room = std::move(room); }

void Renderer::set_colors(std::vector<Rgba8> colors, std::size_t cloud) {
  const gl::Context::Use use(state_->context);
  state_->clouds.at(cloud)->gpu->set_colors(std::make_shared<const GpuCloud::Colors>(std::move(colors)));
}

const std::vector<Rgba8>& Renderer::colors(std::size_t cloud) const {
  return state_->clouds.at(cloud)->gpu->colors();
}
const PreparedCloud& Renderer::prepared(std::size_t cloud) const {
  return state_->clouds.at(cloud)->prepared();
}

RenderOutput Renderer::render(Technique& technique, const Camera& camera, const RenderSettings& settings,
                              const RenderWants& wants, Progress& progress) {
  const Item item{0, &technique, &settings};
  return render({&item, 1}, camera, settings, wants, progress);
}

bool Renderer::is_tiled(const Camera& camera) const {
  const int side = std::max(camera.width, camera.height);
  if (const int wanted = gl::preferences().tile_side; wanted > 0) return side > wanted;
  return side > state_->context.limits().max_texture_size / 2 ||
         std::int64_t(camera.width) * camera.height > most_pixels;
}

bool Renderer::is_tiled(std::span<const Item> items, const Camera& camera) const {
  return is_tiled(camera) || std::any_of(items.begin(), items.end(),
                                         [&](const Item& item) { return exceeds(camera, *item.technique); });
}

RenderOutput Renderer::render(std::span<const Item> items, const Camera& camera,
                              const RenderSettings& settings, const RenderWants& wants, Progress& progress) {
  if (!is_tiled(items, camera)) return render_at_once(items, camera, settings, wants, progress);
  RenderOutput picture = empty_images(camera.width, camera.height, wants);
  RenderOutput out = render_rows(
      items, camera, settings, wants,
      [&](RenderOutput& rows, int first_row) {
        const int height = std::max(
            {rows.rgba8.height(), rows.color_linear.height(), rows.depth.height(), rows.normal.height()});
        paste(rows, 0, 0, camera.width, height, picture, 0, first_row);
      },
      progress);
  out.rgba8 = std::move(picture.rgba8);
  out.color_linear = std::move(picture.color_linear);
  out.depth = std::move(picture.depth);
  out.normal = std::move(picture.normal);
  return out;
}

std::vector<RenderOutput> Renderer::render_together(std::span<const Item> items,
                                                    std::span<const Camera> cameras,
                                                    const RenderSettings& settings, const RenderWants& wants,
                                                    Progress& progress) {
  struct Together {  // also where a picture is cancelled
    std::vector<Camera>& views;
    ~Together() { views.clear(); }
  } together{state_->together};
  together.views.assign(cameras.begin(), cameras.end());
  std::vector<RenderOutput> out;
  for (const Camera& camera : cameras) {
    progress.check();
    progress.update(double(out.size()) / double(cameras.size()), "rendering the panorama");
    out.push_back(render(items, camera, settings, wants, progress));
  }
  return out;
}

RenderOutput Renderer::render_rows(std::span<const Item> items, const Camera& asked,
                                   const RenderSettings& settings, const RenderWants& wants,
                                   const RowSink& sink, Progress& progress) {
  RenderOutput out;
  if (!is_tiled(items, asked)) {
    RenderOutput picture = render_at_once(items, asked, settings, wants, progress);
    sink(picture, 0);
    out.timings = std::move(picture.timings);
    out.total_ms = picture.total_ms;
    out.points_drawn = picture.points_drawn;
    out.outliers = picture.outliers;
    out.notes = std::move(picture.notes);
    return out;
  }
  if (std::max(asked.width, asked.height) > largest_side)
    throw Error(ErrorCode::usage, std::to_string(asked.width) + "x" + std::to_string(asked.height) +
                                      " is beyond the largest picture (" + std::to_string(largest_side) +
                                      " px a side): ask for a smaller one");
  State& s = *state_;
  const gl::Context::Use use(s.context);
  const Camera camera = s.fit_camera(items, asked);
  const int reach = s.reach_px(items, camera, settings),
            overlap = std::min(reach, State::most_overlap(items));
  if (overlap < reach)
    out.notes.push_back("pixels see farther than tiles of this picture overlap: their borders may show");
  const int wanted = gl::preferences().tile_side, side = wanted > 0 ? wanted : s.tile_side(items, overlap);
  const std::vector<TileSpan> columns = tile_spans(camera.width, side, overlap),
                              rows = tile_spans(camera.height, side, overlap);
  std::size_t done = 0;
  for (const TileSpan& row : rows) {
    RenderOutput strip = empty_images(camera.width, row.last - row.first, wants);
    for (const TileSpan& column : columns) {
      progress.check();
      progress.update(double(done++) / double(columns.size() * rows.size()), "rendering tiles");
      const Camera tile =
          asked.tile(column.drawn_first, row.drawn_first, column.drawn_last - column.drawn_first,
                     row.drawn_last - row.drawn_first);
      const RenderOutput part = render_at_once(items, tile, settings, wants, progress);
      paste(part, column.first - column.drawn_first, row.first - row.drawn_first, column.last - column.first,
            row.last - row.first, strip, column.first, 0);
      out.total_ms += part.total_ms;
      for (const PassTiming& pass : part.timings) {
        const auto same = std::find_if(out.timings.begin(), out.timings.end(),
                                       [&](const PassTiming& each) { return each.name == pass.name; });
        if (same == out.timings.end())
          out.timings.push_back(pass);
        else
          same->ms += pass.ms;
      }
      add_tile_notes(out.notes, part.notes);
      out.outliers = part.outliers;
    }
    sink(strip, row.first);
  }
  out.points_drawn = s.points_seen(items, camera);
  return out;
}

bool Renderer::merges(const Technique& technique, const Camera& camera,
                      const RenderSettings& settings) const {
  return technique.merges() && state_->clouds.size() == 1 && settings.samples <= 1 &&
         settings.shadows == Shadows::off && !is_tiled(camera) && !exceeds(camera, technique);
}

bool Renderer::has_needs(const Technique& technique) const {
  const PreparedCloud& prepared = state_->clouds.front()->prepared();
  return prepared.cloud.empty() || prepared.lacking(technique.needs()).empty();
}

VisiblePoints Renderer::visible(Technique& technique, const Camera& asked, const RenderSettings& settings,
                                const VisiblePoints* merged, Progress& progress) {
  require_merging(merges(technique, asked, settings) && has_needs(technique));
  State& s = *state_;
  const gl::Context::Use use(s.context);
  const gl::Pace pace(progress);
  const Item item{0, &technique, &settings};
  const Camera camera = s.fit_camera({&item, 1}, asked);
  s.make_target(camera);
  gl::Timers timers(false);
  SamplePass pass{{item}, settings, timers, progress, {}, false};
  VisiblePoints visible;
  pass.visible = &visible, pass.merged = merged;
  s.draw(pass, camera);
  return visible;
}

RenderOutput Renderer::render_merged(const VisiblePoints& merged, Technique& technique, const Camera& camera,
                                     const RenderSettings& settings, const RenderWants& wants,
                                     Progress& progress) {
  require_merging(merges(technique, camera, settings) && has_needs(technique));
  const Item item{0, &technique, &settings};
  return render_at_once({&item, 1}, camera, settings, wants, progress, &merged);
}

RenderOutput Renderer::render_at_once(std::span<const Item> items, const Camera& asked,
                                      const RenderSettings& settings, const RenderWants& wants,
                                      Progress& progress, const VisiblePoints* merged) {
  State& s = *state_;
  const gl::Context::Use use(s.context);
  const gl::Pace pace(progress);
  for (const Item& item : items)
    if (!item.technique->shows(item.settings->shading))
      throw Error(ErrorCode::usage,
                  "this technique cannot show that shading: occlusion and hidden belong to surface, weight "
                  "to denoise; use that technique, or another shading");
  const Camera camera = s.fit_camera(items, asked);
  s.make_target(camera);

  RenderOutput out;
  gl::Timers timers(wants.timings);
  gl::finish();
  const auto start = std::chrono::steady_clock::now();
  const int samples = std::max(1, settings.samples);
  if (wants.color) gl::ensure(s.rgba8, "finished picture", GL_RGBA8, camera.width, camera.height);

  // `auto` was resolved by Session, and is off where it was not.
  SamplePass pass{{items.begin(), items.end()},
                  settings,
                  timers,
                  progress,
                  relief_options(items, settings),
                  settings.smooth_outlines.value() && is_shaded(settings)};
  pass.merged = merged;
  if (!s.has_normals(pass)) pass.relief.scaling = 0;
  pass.wants_normal = wants.normal || pass.relief.scaling > 0;
  std::stable_sort(pass.items.begin(), pass.items.end(), [](const Item& a, const Item& b) {
    return a.technique->transparency() < b.technique->transparency();
  });
  if (samples == 1) {
    s.draw(pass, camera);
  } else {
    for (int i = 0; i < samples; ++i) {
      s.draw(pass, jittered(camera, i, samples));
      s.average(i, samples, timers);
    }
    // Depths and normals are those of pixel centres.
    if (wants.depth || wants.normal) s.draw(pass, camera);
  }
  const gl::Texture& color = samples == 1 ? s.target.color : s.averaged;
  if (wants.color) {
    auto timing = timers.scope("finish");
    s.finish.run(settings, color, s.rgba8);
  }
  gl::finish();
  out.total_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  for (auto& [name, ms] : timers.results()) out.timings.push_back({name, ms});

  if (wants.color) out.rgba8 = s.rgba8.take<Rgba8>();
  if (wants.color_linear) {
    gl::ensure(s.linear, "linear picture", GL_RGBA32F, camera.width, camera.height);
    s.finish.run_linear(settings, color, s.linear);
    out.color_linear = s.linear.download<vec4>();
  }
  if (wants.depth) out.depth = s.target.depth.download<float>();
  if (wants.normal) out.normal = s.target.normal.download<vec3>();
  out.points_drawn = s.points_seen(items, camera);
  for (const Item& item : items) {
    for (const std::string& note : item.technique->notes()) out.notes.push_back(note);
    out.outliers += item.technique->outliers();
  }
  return out;
}

}  // namespace sfumato
