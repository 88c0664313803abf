#include "passes/fragment_list.h"

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "passes/bindings.h"

namespace sfumato {

std::uint64_t FragmentList::most_records() { return std::uint64_t(gl::limits().max_texture_buffer_size); }

void FragmentList::begin(int width, int height) {
  gl::ensure(counts_, "fragments of pixels", GL_R32F, width, height);
  gl::ensure(stored_, "stored fragments", GL_R32UI, width, height);
  const std::size_t bytes = std::size_t(width) * std::size_t(height) * 4;
  if (!offsets_ || offsets_.buffer().bytes() != bytes)
    offsets_ = gl::TextureBuffer("places of fragments", GL_R32UI, bytes);
  counts_.clear(vec4(0));
  stored_.clear_uint(0);
}

std::uint64_t FragmentList::allocate(const std::string& who) {
  if (!to_words_) to_words_ = gl::Program::compute("passes/fragment_counts.comp");
  const int width = counts_.width(), height = counts_.height();
  counts_.bind(binding::input);
  offsets_.buffer().bind_storage(0);
  to_words_.set("size", ivec2(width, height)).dispatch(unsigned(width + 127) / 128, unsigned(height));
  gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT);
  prefix_sum_.run(offsets_.buffer(), std::uint32_t(width) * std::uint32_t(height));
  const std::uint64_t total = prefix_sum_.total();
  if (total > most_records())
    throw Error(ErrorCode::out_of_memory, who + " needs " + std::to_string(total) +
                                              " fragments in this view, " + std::to_string(most_records()) +
                                              " fit into a buffer of this driver; "
                                              "lower --resolution or let fewer points take part");
  // Room for a third more, so that a moving camera does not allocate anew in every frame.
  if (!records_ || records_.buffer().bytes() < total * 8)
    records_ = gl::TextureBuffer("fragments", GL_RG32UI,
                                 std::size_t(std::min(total + total / 3 + 1024, most_records())) * 8);
  return total;
}

void FragmentList::bind_store() const {
  offsets_.bind(binding::fragment_offsets);
  stored_.bind_image(binding::fragment_cursor_image, GL_READ_WRITE);
  gl::bind_image(binding::fragment_image, records_, GL_READ_WRITE, GL_RG32UI);
}

void FragmentList::finish_store() const {
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

void FragmentList::bind_read() const {
  bind_store();
  records_.bind(binding::fragments);
}

}  // namespace sfumato
