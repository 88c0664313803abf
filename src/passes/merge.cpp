#include "passes/merge.h"

namespace sfumato {

void Merge::run(const Target& other, Target& target, bool with_normals) {
  const int width = target.color.width(), height = target.color.height();
  gl::ensure(scratch_.color, "merged colour", GL_RGBA32F, width, height);
  gl::ensure(scratch_.depth, "merged depth", GL_R32F, width, height);
  if (with_normals) gl::ensure(scratch_.normal, "merged normal", GL_RGBA32F, width, height);
  ScreenPass& pass = nearer_[with_normals];
  if (!pass) {
    std::vector<GLenum> formats{GL_RGBA32F, GL_R32F};
    gl::Defines defines;
    if (with_normals) {
      formats.push_back(GL_RGBA32F);
      defines.push_back("WITH_NORMALS");
    }
    pass = ScreenPass("passes/merge_nearer.glsl", formats, defines);
  }
  if (with_normals)
    pass.run({&target.color, &target.depth, &other.color, &other.depth, &target.normal, &other.normal},
             {&scratch_.color, &scratch_.depth, &scratch_.normal});
  else
    pass.run({&target.color, &target.depth, &other.color, &other.depth}, {&scratch_.color, &scratch_.depth});
  std::swap(scratch_.color, target.color);
  std::swap(scratch_.depth, target.depth);
  if (with_normals) std::swap(scratch_.normal, target.normal);
}

void Merge::limit(const View& view, const gl::Texture& depth, gl::Texture& ray_distance) {
  gl::ensure(distance_, "merged ray distance", GL_R32F, depth.width(), depth.height());
  if (!limit_) limit_ = ScreenPass("passes/limit_distance.glsl", {GL_R32F});
  view.bind();
  limit_.run({&ray_distance, &depth}, {&distance_});
  std::swap(distance_, ray_distance);
}

}  // namespace sfumato
