#include "passes/pyramid.h"

#include <string>

namespace sfumato {

gl::Texture& NearestPyramid::points(int width, int height) {
  if (!storage_ || storage_.width() != width || storage_.height() != height) {
    storage_ = gl::Texture("nearest pyramid", GL_RGBA32F, width, height, levels);
    views_.clear();
    for (int l = 0; l < levels; ++l) views_.push_back(gl::Texture::view(storage_, l));
    squares_ = gl::Texture::view(storage_, 1, levels - 1);
  }
  return views_[0];
}

void NearestPyramid::build() {
  if (!reduce_) reduce_ = ScreenPass("passes/pyramid_nearest.glsl", {GL_RGBA32F});
  for (std::size_t l = 1; l < levels; ++l) reduce_.run({&views_[l - 1]}, {&views_[l]});
}

void PullPush::allocate(int width, int height) {
  if (!filled_.empty() && filled_[0].a.width() == width && filled_[0].a.height() == height) return;
  pulled_.clear();
  filled_.clear();
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    const std::string level = " level " + std::to_string(filled_.size());
    pulled_.emplace_back();
    if (filled_.size() > 0)
      pulled_.back() = {gl::Texture("pull a" + level, GL_RGBA32F, w, h),
                        gl::Texture("pull b" + level, GL_RGBA32F, w, h)};
    filled_.push_back(
        {gl::Texture("push a" + level, GL_RGBA32F, w, h), gl::Texture("push b" + level, GL_RGBA32F, w, h)});
    if (w == 1 && h == 1) break;
  }
}

void PullPush::run(const gl::Texture& a, const gl::Texture& b, float depth_edge, int first,
                   const Tiles* tiles) {
  if (!pull_) {
    pull_ = ScreenPass("passes/pull.glsl", {GL_RGBA32F, GL_RGBA32F}, {}, kind_);
    push_ = ScreenPass("passes/push.glsl", {GL_RGBA32F, GL_RGBA32F}, {}, kind_);
  }
  allocate(a.width(), a.height());
  pull_.set("depth_edge", depth_edge);
  push_.set("depth_edge", depth_edge);
  // The kernel reaches 3 px per px of level 2, less than a tile: there, off is still empty. Coarser levels
  // are small.
  const auto on_level = [&](int level, int last) { return level <= last ? tiles : nullptr; };
  const int top = int(filled_.size()) - 1;
  for (int l = 1; l <= top; ++l) {
    const Level& fine = pulled_[std::size_t(l - 1)];
    pull(l == 1 ? a : fine.a, l == 1 ? b : fine.b, l, on_level(l, 2));
  }
  for (int l = top; l >= first; --l) {
    const Level& own = pulled_[std::size_t(l)];
    push(l == 0 ? a : own.a, l == 0 ? b : own.b, l, on_level(l, 1));
  }
}

void PullPush::pull(const gl::Texture& fine_a, const gl::Texture& fine_b, int level, const Tiles* tiles) {
  const Level& to = pulled_[std::size_t(level)];
  pull_.set("level", level - 1);
  if (tiles)
    pull_.run({tiles->on, tiles->size >> level}, {&fine_a, &fine_b}, {&to.a, &to.b}, {vec4(0), vec4(0)});
  else
    pull_.run({&fine_a, &fine_b}, {&to.a, &to.b});
}

void PullPush::push(const gl::Texture& pulled_a, const gl::Texture& pulled_b, int level, const Tiles* tiles) {
  // The top has nothing above it: its own texture stands in and is not read.
  const std::size_t l = std::size_t(level);
  const bool top = l + 1 == filled_.size();
  const Level& to = filled_[l];
  const gl::Texture &coarse_a = top ? pulled_a : filled_[l + 1].a,
                    &coarse_b = top ? pulled_b : filled_[l + 1].b;
  push_.set("top", top).set("level", level);
  const auto inputs = {&pulled_a, &pulled_b, &coarse_a, &coarse_b};
  if (tiles)
    push_.run({tiles->on, tiles->size >> level}, inputs, {&to.a, &to.b}, {vec4(0), vec4(0)});
  else
    push_.run(inputs, {&to.a, &to.b});
}

}  // namespace sfumato
