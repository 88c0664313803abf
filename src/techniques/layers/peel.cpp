#include "techniques/layers/peel.h"

#include "gl/context.h"

namespace sfumato::layers {

bool Peel::can_cascade(const View& view) {
  return view.height() <= gl::limits().max_texture_size / PointsToPixels::list_length;
}

void Peel::begin(const View& view, const Footprint& footprint, bool cascade, float bin) {
  bin_ = bin;
  footprint_ = footprint;
  cascade_ = cascade;
  visits_ = 0;
  if (!cascade_) return;
  const int height = view.height() * PointsToPixels::list_length;
  gl::ensure(depth_lists_, "depth lists", GL_R32UI, view.width(), height);
  gl::ensure(index_lists_, "index lists", GL_R32UI, view.width(), height);
  gl::ensure(revisit_, "limits of another visit", GL_R32F, view.width(), view.height());
}

const gl::Texture& Peel::next(GpuCloud& cloud, const View& view, const gl::Texture& limit, gl::Texture& depth,
                              gl::Texture& index, bool may_be_bits, gl::Timers& timers) {
  const bool is_first = visits_ == 0;
  if (!cascade_) {
    ++visits_;
    std::swap(layer_.index, index);
    to_pixels_.draw(cloud, view, footprint_, layer_, timers, is_first ? nullptr : &limit);
    std::swap(layer_.index, index);
    if (may_be_bits) return layer_.depth_bits;
    auto timing = timers.scope("select");
    if (!decode_) decode_ = ScreenPass("passes/depth_from_bits.glsl", {GL_R32F});
    decode_.run({&layer_.depth_bits}, {&depth});
    return depth;
  }
  if (is_first) {
    ++visits_;
    depth_lists_.clear_uint(0xffffffffu);
    index_lists_.clear_uint(0xffffffffu);
    to_pixels_.draw_lists(cloud, view, footprint_, bin_, depth_lists_, index_lists_, timers);
  }
  {
    auto timing = timers.scope("select");
    select(view, limit, depth, index);
    if (!too_short_.is_set()) return depth;
    if (!empty_) empty_ = ScreenPass("techniques/layers/empty_lists.glsl", {GL_R32UI, GL_R32UI});
    empty_.run({&revisit_}, {&depth_lists_, &index_lists_});
  }
  ++visits_;
  to_pixels_.draw_lists(cloud, view, footprint_, bin_, depth_lists_, index_lists_, timers, &revisit_);
  auto timing = timers.scope("select");
  select(view, limit, depth, index);
  return depth;
}

void Peel::select(const View& view, const gl::Texture& limit, const gl::Texture& depth,
                  const gl::Texture& index) {
  if (!select_)
    select_ = ScreenPass("techniques/layers/select.glsl", {GL_R32F, GL_R32UI, GL_R32F},
                         {"LIST_LENGTH " + std::to_string(PointsToPixels::list_length)});
  too_short_.arm();
  view.bind();
  select_.run({&depth_lists_, &index_lists_, &limit}, {&depth, &index, &revisit_});
}

}  // namespace sfumato::layers
