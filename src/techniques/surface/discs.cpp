#include "techniques/surface/discs.h"

#include <limits>

#include "gl/commands.h"
#include "gl/context.h"
#include "gl/draw.h"
#include "gl/state.h"
#include "passes/bindings.h"

namespace sfumato::surface {
namespace {

/// How far behind the nearest point of a square, and the nearest disc of a pixel, shadow factors count: point
/// spacings, and a share of what still counts as the surface. Points farther behind are in the shadow of
/// those in front.
constexpr float lit_depth = 1, shadow_depth = 0.5f;

}  // namespace

void Discs::allocate(int width, int height) {
  if (all_clusters_ && clusters_[0].width() == width && clusters_[0].height() == height) return;
  clusters_.clear();
  about_.clear();
  for (int l = 0; l < levels; ++l) {
    clusters_.emplace_back("clusters", GL_RGBA32F, width >> l, height >> l);
    about_.emplace_back("spacing", GL_RG32F, width >> l, height >> l);
  }
  colors_ = gl::Texture("colours of discs", GL_RGBA16F, width, height);
  orientations_ = gl::Texture("orientations of discs", GL_RGBA32F, width, height);
  ends_ = gl::Texture("ends of discs", GL_RGBA32F, width, height);
  all_clusters_ = gl::Texture("clusters of all levels", GL_RGBA32F, width + width / 2, height);
}

float Discs::widest_ball(float normal_scale, float spacing, float noise) {
  const float ball = normal_scale * spacing;
  if (!(noise > little_noise * spacing)) return 2 * ball;
  return grown * std::clamp(deviations * noise, ball, most_of_noise * ball);
}

void Discs::find(const NearestPyramid& pyramid, const HiddenPoints& squares, const gl::Texture& shadowed,
                 const Options& options) {
  const int width = squares.visible().width(), height = squares.visible().height();
  allocate(width, height);
  if (!first_) {
    first_ = ScreenPass("techniques/surface/squares.glsl", {GL_RGBA32F, GL_RG32F, GL_RGBA16F});
    coarser_ = ScreenPass("techniques/surface/clusters.glsl", {GL_RGBA32F, GL_RG32F});
    planes_ = ScreenPass("techniques/surface/planes.glsl", {GL_RGBA32F, GL_RGBA32F});
  }
  first_.set("lit_depth", lit_depth);
  first_.run(squares.tiles(), {&pyramid.level(0), &squares.visible(), &shadowed},
             {&clusters_[0], &about_[0], &colors_}, {vec4(0), vec4(0), vec4(0)});
  for (std::size_t l = 1; l < std::size_t(levels); ++l) {
    coarser_.set("width_px", float(2 << l));
    coarser_.run({&clusters_[l - 1], &about_[l - 1]}, {&clusters_[l], &about_[l]});
  }
  gl::barrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  for (int l = 0, y = 0; l<levels; y += l> 0 ? height >> l : 0, ++l)
    gl::copy(clusters_[std::size_t(l)], ivec2(0), all_clusters_, ivec2(l > 0 ? width : 0, y),
             ivec2(width >> l, height >> l));
  planes_.set("normal_scale", options.normal_scale)
      .set("noise", options.noise)
      .set("balls_of_noise", vec4(little_noise, deviations, most_of_noise, grown))
      .set("disc_scale", options.disc_scale)
      .set("levels", levels);
  planes_.set("gap_scale", options.gap_scale).set("widest_px", options.widest_px);
  planes_.run(squares.tiles(), {&all_clusters_, &about_[0]}, {&orientations_, &ends_}, {vec4(0), vec4(0)});
}

void Discs::draw(const View& view, const Options& options) {
  const int width = view.width(), height = view.height(), columns = clusters_[0].width(),
            rows = clusters_[0].height();
  gl::ensure(nearest_t_, "nearest ray distance", GL_R32F, width, height);
  gl::ensure(color_sum_, "sum of colours", GL_RGBA32F, width, height);
  gl::ensure(normal_sum_, "sum of normals", GL_RGBA32F, width, height);
  nearest_t_.clear(vec4(std::numeric_limits<float>::infinity()));
  color_sum_.clear(vec4(0));
  normal_sum_.clear(vec4(0));
  if (gl::limits().software) gl::finish();  // compute does not wait for fragment passes there

  const gl::Defines defines{"SPLAT_PREFILTER", "SPLAT_PREFILTER_OWN"};
  if (!draw_nearest_) draw_nearest_ = gl::Program::compute("techniques/surface/disc_nearest.comp", defines);
  const auto bind = [&] {
    view.bind();
    clusters_[0].bind(binding::input);
    orientations_.bind(binding::input + 1);
    colors_.bind(binding::input + 2);
    ends_.bind(binding::input + 4);
  };
  bind();
  gl::bind_image(0, nearest_t_, GL_READ_WRITE, GL_R32UI);
  draw_nearest_.dispatch(unsigned(columns + 15) / 16, unsigned(rows + 7) / 8);
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);

  gl::Program& program = accumulate_[options.with_shadow ? 1 : 0];
  if (!program) {
    gl::Defines with = defines;
    if (options.with_shadow) with.push_back("WITH_SHADOW");
    program = gl::Program::raster("techniques/surface/disc.vert", "techniques/surface/disc.frag", with);
  }
  program.set("columns", columns);
  if (options.with_shadow) program.set("shadow_depth", shadow_depth);
  nearest_t_.bind(binding::input + 3);
  const auto run = [&](const gl::Framebuffer& framebuffer) {
    framebuffer.bind();
    gl::State{.blend = gl::State::Blend::add}.apply();
    program.use();
    gl::draw_items(program, GL_POINTS, 0, std::uint64_t(columns) * std::uint64_t(rows), 1);
  };
  if (options.with_shadow) {
    gl::ensure(shadow_sum_, "sum of shadow factors", GL_RG32F, width, height);
    shadow_sum_.clear(vec4(0));
    run(gl::Framebuffer({&color_sum_, &normal_sum_, &shadow_sum_}));
  } else {
    run(gl::Framebuffer({&color_sum_, &normal_sum_}));
  }
}

}  // namespace sfumato::surface
