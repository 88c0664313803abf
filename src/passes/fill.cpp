#include "passes/fill.h"

#include <vector>

#include "passes/bindings.h"

namespace sfumato {

void Fill::run(FillKind kind, float d_min, const gl::Texture& depth_in, const gl::Texture& depth_out,
               std::initializer_list<const gl::Texture*> extra_in,
               std::initializer_list<const gl::Texture*> extra_out) {
  const std::size_t extras = extra_in.size();
  const bool bits = depth_in.format() == GL_R32UI;
  ScreenPass& pass = passes_[int(kind) + 3 * bits][extras];
  if (!pass) {
    gl::Defines defines{"EXTRAS " + std::to_string(extras)};
    if (bits) defines.push_back("BITS");
    if (kind == FillKind::occluded) defines.push_back("OCCLUDED");
    if (kind == FillKind::gaps) defines.push_back("GAPS");
    std::vector<GLenum> formats(1 + extras, GL_RGBA32F);
    formats[0] = GL_R32F;
    pass = ScreenPass("passes/fill.glsl", formats, defines);
  }
  if (kind != FillKind::background) pass.set("d_min", d_min);
  int unit = binding::input + 1;
  for (const gl::Texture* extra : extra_in) extra->bind(unit++);
  switch (extras) {
    case 0: pass.run({&depth_in}, {&depth_out}); break;
    case 1: pass.run({&depth_in}, {&depth_out, extra_out.begin()[0]}); break;
    default: pass.run({&depth_in}, {&depth_out, extra_out.begin()[0], extra_out.begin()[1]});
  }
}

void Fill::run_index(FillKind kind, float d_min, const gl::Texture& depth_in, const gl::Texture& depth_out,
                     const gl::Texture& index_in, const gl::Texture& index_out) {
  const bool bits = depth_in.format() == GL_R32UI;
  ScreenPass& pass = index_passes_[int(kind) + 3 * bits];
  if (!pass) {
    gl::Defines defines{"EXTRAS 0", "INDEX"};
    if (bits) defines.push_back("BITS");
    if (kind == FillKind::occluded) defines.push_back("OCCLUDED");
    if (kind == FillKind::gaps) defines.push_back("GAPS");
    pass = ScreenPass("passes/fill.glsl", {GL_R32F, GL_R32UI}, defines);
  }
  if (kind != FillKind::background) pass.set("d_min", d_min);
  pass.run({&depth_in, &index_in}, {&depth_out, &index_out});
}

}  // namespace sfumato
