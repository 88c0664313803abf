#include "passes/compaction.h"

#include <algorithm>
#include <string>

#include "gl/commands.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

unsigned blocks(unsigned groups) { return (groups + 127) / 128; }

}  // namespace

void Compaction::bind_flags(unsigned groups_per_batch, unsigned batches, std::size_t most) {
  groups_per_batch_ = groups_per_batch;
  group_count_ = groups_per_batch * batches;
  gl::grow(flags_, "flags of points", GL_R8UI, std::size_t(group_count_) * group_size);
  gl::grow(list_, "flagged points", GL_R32UI, most * sizeof(std::uint32_t));
  gl::grow(offsets_, "offsets of groups", group_count_ * sizeof(std::uint32_t));
  gl::grow(sums_, "offsets of blocks", blocks(group_count_) * sizeof(std::uint32_t));
  gl::grow(command_, "draw command of flagged points", 4 * sizeof(std::uint32_t));
  gl::bind_image(0, flags_, GL_WRITE_ONLY, GL_R8UI);
}

void Compaction::run() {
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  flags_.bind(binding::input);
  offsets_.bind_storage(0);
  sums_.bind_storage(1);
  list_.buffer().bind_storage(2);
  command_.bind_storage(3);
  const unsigned threads[4] = {group_count_, blocks(group_count_), 1, group_count_};
  for (int stage = 0; stage < 4; ++stage) {
    gl::Program& program = stages_[stage];
    if (!program) program = gl::Program::compute("passes/compact.comp", {"STAGE " + std::to_string(stage)});
    program.set("group_count", group_count_).set("groups_per_batch", groups_per_batch_);
    program.dispatch((threads[stage] + 31) / 32);
    gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace sfumato
