#include "passes/pyramid.h"

#include <string>

namespace sfumato {

void NearestPyramid::build(const gl::Texture& depth, const gl::Texture& spacing, float same_spacing) {
  if (!unproject_) {
    unproject_ = ScreenPass("passes/pyramid_unproject.glsl", {GL_RGBA32F});
    reduce_ = ScreenPass("passes/pyramid_nearest.glsl", {GL_RGBA32F});
  }
  if (!storage_ || storage_.width() != depth.width() || storage_.height() != depth.height()) {
    storage_ = gl::Texture("nearest pyramid", GL_RGBA32F, depth.width(), depth.height(), levels);
    views_.clear();
    for (int l = 0; l < levels; ++l) views_.push_back(gl::Texture::view(storage_, l));
  }
  unproject_.set("same_spacing", same_spacing);
  unproject_.run({&depth, &spacing}, {&views_[0]});
  for (std::size_t l = 1; l < levels; ++l) reduce_.run({&views_[l - 1]}, {&views_[l]});
}

PullPush::Level& PullPush::seeds(int width, int height) {
  if (!pulled_.empty() && pulled_[0].a.width() == width && pulled_[0].a.height() == height) return pulled_[0];
  pulled_.clear();
  filled_.clear();
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    const std::string level = " level " + std::to_string(pulled_.size());
    pulled_.push_back({gl::Texture("pull a" + level, GL_RGBA32F, w, h), gl::Texture("pull b" + level, GL_RGBA32F, w, h)});
    filled_.push_back({gl::Texture("push a" + level, GL_RGBA32F, w, h), gl::Texture("push b" + level, GL_RGBA32F, w, h)});
    if (w == 1 && h == 1) break;
  }
  return pulled_[0];
}

void PullPush::run(float depth_edge) {
  if (!pull_) {
    pull_ = ScreenPass("passes/pull.glsl", {GL_RGBA32F, GL_RGBA32F}, {}, kind_);
    push_ = ScreenPass("passes/push.glsl", {GL_RGBA32F, GL_RGBA32F}, {}, kind_);
  }
  pull_.set("depth_edge", depth_edge);
  push_.set("depth_edge", depth_edge);
  for (std::size_t l = 1; l < pulled_.size(); ++l) {
    pull_.set("level", int(l) - 1);
    pull_.run({&pulled_[l - 1].a, &pulled_[l - 1].b}, {&pulled_[l].a, &pulled_[l].b});
  }
  for (std::size_t l = pulled_.size(); l-- > 0;) {
    // The top has nothing above it: its own texture stands in and is not read.
    const bool top = l + 1 == pulled_.size();
    const Level& coarse = top ? pulled_[l] : filled_[l + 1];
    push_.set("top", top).set("level", int(l));
    push_.run({&pulled_[l].a, &pulled_[l].b, &coarse.a, &coarse.b}, {&filled_[l].a, &filled_[l].b});
  }
}

}  // namespace sfumato
