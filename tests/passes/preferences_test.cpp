#include "gl/preferences.h"

#include <cstdlib>

#include "core/error.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class PreferencesTest : public GlTest {
 protected:
  void TearDown() override {
    for (const char* name : {"SFUMATO_SPLAT_PATH", "SFUMATO_SCREEN_PASS", "SFUMATO_DEPTH_SORT"})
      unsetenv(name);
    GlTest::TearDown();
  }
};

TEST_F(PreferencesTest, ComeFromTheEnvironment) {
  setenv("SFUMATO_SPLAT_PATH", "quads", 1);
  setenv("SFUMATO_SCREEN_PASS", "compute", 1);
  setenv("SFUMATO_DEPTH_SORT", "", 1);
  const gl::Preferences found = gl::Preferences::from_environment();
  EXPECT_EQ(found.splat_path, gl::SplatPath::quads);
  EXPECT_EQ(found.screen_passes, gl::ScreenPassKind::compute);
  EXPECT_EQ(found.depth_sort, gl::Place::automatic);
}

TEST_F(PreferencesTest, RefuseWordsOfNoVariable) {
  setenv("SFUMATO_SPLAT_PATH", "quarks", 1);
  try {
    gl::Preferences::from_environment();
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    EXPECT_STREQ(e.what(), "SFUMATO_SPLAT_PATH is 'quarks', not automatic, points, quads or compute");
  }
}

// A variable that changes later changes nothing: a context keeps what it was made with, each its own.
TEST_F(PreferencesTest, BelongToTheirContext) {
  gl::Preferences wanted;
  wanted.splat_path = gl::SplatPath::quads;
  const gl::SplatPath before = [] {
    const gl::Context::Use use(context());
    return gl::preferences().splat_path;
  }();
  const std::unique_ptr<gl::Context> other = gl::Context::create_headless(wanted);
  setenv("SFUMATO_SPLAT_PATH", "points", 1);
  {
    const gl::Context::Use use(*other);
    EXPECT_EQ(gl::preferences().splat_path, gl::SplatPath::quads);
  }
  const gl::Context::Use use(context());
  EXPECT_EQ(gl::preferences().splat_path, before);
}

}  // namespace
