// sfumato build, as a user runs it.
#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

class Build : public CommandTest {};

TEST_F(Build, WritesAFileThatInfoConvertAndRenderingRead) {
  write_cube("cube.ply", 60);
  const Outcome built = run({"build", "cube.ply", "-o", "cube.copc.laz"});
  ASSERT_EQ(built.code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("wrote cube.copc.laz (21600 points, 1 nodes in 1 levels"));
  // Header and hierarchy answer; with --stats the points do.
  const nlohmann::json info = run_json({"info", "cube.copc.laz", "--json"});
  EXPECT_EQ(info["points"], 21600);
  EXPECT_TRUE(info["median_spacing"].is_null() && info["attributes"]["red"].is_null());
  ASSERT_EQ(info["levels"].size(), 1u);
  EXPECT_EQ(info["levels"][0]["points"], 21600);
  const nlohmann::json stats = run_json({"info", "cube.copc.laz", "--json", "--stats"});
  EXPECT_EQ(stats["bounds_max"], info["bounds_max"]);
  EXPECT_EQ(stats["attributes"]["red"]["max"], 65535);
  EXPECT_GT(stats["median_spacing"], 0);
  EXPECT_THAT(run({"info", "cube.copc.laz"}).out, HasSubstr("(--stats reads their"));
  ASSERT_EQ(run({"convert", "cube.copc.laz", "-o", "back.ply"}).code, 0);
  ASSERT_EQ(run({"cube.copc.laz", "-t", "points", "--resolution", "64x48", "-o", "cube.png"}).code, 0);
  // Built again of itself, and of two files.
  ASSERT_EQ(run({"build", "cube.copc.laz", "back.ply", "-o", "two.copc.laz", "--quiet"}).code, 0);
  EXPECT_EQ(run_json({"info", "two.copc.laz", "--json"})["points"], 43200);
}

TEST_F(Build, SaysWhatIsWrongInOneLine) {
  write_cube("cube.ply");
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "build");
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(refused({"cube.ply"}), HasSubstr("no output given"));
  EXPECT_THAT(refused({"-o", "a.copc.laz"}), HasSubstr("no input given"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.laz"}), HasSubstr("ends in .copc.laz"));
  EXPECT_THAT(refused({"cube.ply", "-o", "-"}), HasSubstr("ends in .copc.laz"));
  EXPECT_THAT(refused({"-", "-o", "a.copc.laz"}), HasSubstr("name a file"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.copc.laz", "--memory", "1M"}), HasSubstr("--memory"));
  EXPECT_THAT(refused({"cube.ply", "-o", "a.copc.laz", "--box", "0,0,0,1,1,-1"}), HasSubstr("empty along z"));
  ASSERT_EQ(run({"build", "cube.ply", "-o", "a.copc.laz"}).code, 0);
  EXPECT_THAT(refused({"a.copc.laz", "-o", "a.copc.laz"}), HasSubstr("would replace the input"));
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(Build, LeavesNothingBehindWhenItIsInterrupted) {
  ASSERT_EQ(run({"synth", "courtyard", "--points", "1000000", "-o", "scan.las", "--quiet"}).code, 0);
  const Outcome interrupted = run({"build", "scan.las", "-o", "scan.copc.laz"}, 150);
  EXPECT_EQ(interrupted.code, 130) << interrupted.err;
  EXPECT_EQ(files(), std::vector<std::string>{"scan.las"});
}

}  // namespace
