// Ctrl-C ends the command, wherever it is. How soon is measured by bench/stretches.
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/command.h"

using namespace sfumato::testing;

namespace {

class Interrupt : public CommandTest {
 protected:
  /// Stops the command after shares of the processor time that it takes to its end. Runs differ in length,
  /// the first compiles shaders: the last moments may lie behind the end.
  void expect_stops(const std::vector<std::string>& words, std::initializer_list<double> shares) {
    const Outcome whole = run(words);
    ASSERT_EQ(whole.code, 0) << whole.err;
    for (const std::string& name : files())
      if (name.ends_with(".png")) std::filesystem::remove(path(name));
    const std::vector<std::string> inputs = files();
    int stopped = 0;
    for (const double share : shares) {
      const Outcome outcome =
          run_interrupted(words, [&](double seconds) { return seconds >= share * whole.seconds; });
      if (outcome.code == 0) {
        std::filesystem::remove(path("a.png"));
        continue;
      }
      ++stopped;
      EXPECT_EQ(outcome.code, 130) << outcome.err;
      EXPECT_THAT(outcome.err, ::testing::EndsWith("sfumato: interrupted\n"));
      EXPECT_EQ(files(), inputs) << "nothing is left behind";
      std::printf("%s: %.2f s, stopped at %.0f %%: %.0f ms late\n", words[0].c_str(), whole.seconds,
                  100 * share, 1e3 * outcome.seconds_late);
    }
    EXPECT_GE(stopped, 1);
  }
};

TEST_F(Interrupt, WhileALargeFileIsRead) {
  ASSERT_EQ(run({"synth", "courtyard", "--points", "1000000", "-o", "large.xyz", "--quiet"}).code, 0);
  expect_stops({"large.xyz", "-t", "points", "-o", "a.png", "--resolution", "64x48"}, {0.1, 0.2, 0.3});
}

TEST_F(Interrupt, WhilePointsAreMeasured) {
  ASSERT_EQ(run({"synth", "courtyard", "--points", "600000", "-o", "large.ply", "--quiet"}).code, 0);
  ASSERT_EQ(run({"convert", "large.ply", "-o", "bare.las", "--quiet"}).code, 0);  // to be measured anew
  expect_stops({"bare.las", "-t", "splats", "-o", "a.png", "--resolution", "64x48"}, {0.2, 0.35, 0.5, 0.65});
}

/// Who writes into the pipe may take for ever.
TEST_F(Interrupt, WhileStandardInputIsSilent) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "1 2 3\n", 6), 6);
  const auto is_read = [&](double) {
    int left = 0;
    return ioctl(ends[0], FIONREAD, &left) == 0 && left == 0;
  };
  const Outcome outcome = run_interrupted({"info", "-"}, is_read, ends[0]);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(outcome.err, "sfumato: interrupted\n");
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
