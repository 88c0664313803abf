#include "gl/shader_source.h"

#include <gtest/gtest.h>

namespace sfumato {
namespace {

TEST(ShaderSource, NamesTheFilesOfALog) {
  gl::ShaderSource source;
  source.files = {"splat.vert", "frame.glsl"};
  EXPECT_EQ(source.map_log("0:12(5): error: no\n1(34) : warning 7\n"),
            "splat.vert:12(5): error: no\nframe.glsl:34 : warning 7\n");
  // No file of ours, no place at all.
  EXPECT_EQ(source.map_log("2:1:3 5: 1( 1:"), "2:1:3 5: 1( 1:");
  EXPECT_EQ(source.map_log("99999999999999999999999:1"), "99999999999999999999999:1");
  EXPECT_EQ(source.map_log(""), "");
}

TEST(ShaderSource, ResolvesIncludes) {
  const gl::ShaderSource source = gl::load_shader("passes/shade.glsl", {"SOME 1"});
  EXPECT_TRUE(source.text.starts_with("#version 450 core\n#define SOME 1\n#line 1 0\n"));
  ASSERT_GT(source.files.size(), 1u);
  EXPECT_EQ(source.text.find("#include"), std::string::npos);
  EXPECT_NE(source.text.find("#line 1 1\n"), std::string::npos);
}

}  // namespace
}  // namespace sfumato
