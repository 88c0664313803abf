// What the command says about a picture that nobody asked for.
#include <algorithm>

#include "cli/command.h"

namespace sfumato::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class NotesCommand : public CommandTest {
 protected:
  Outcome ok(const std::vector<std::string>& words) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }
};

// One line on the scan, one on the picture: each clause with the option that undoes it.
TEST_F(NotesCommand, APictureHasAtMostTwoLines) {
  std::vector<std::vector<std::string>> scenes;
  for (const char* name : {"room", "courtyard", "forest", "spheres", "tori"})
    scenes.push_back({"synth", name, "--points", "30000", "-o", std::string(name) + ".ply", "--quiet"});
  write_cube("cube.ply");
  std::vector<std::string> files = {"cube.ply"};
  for (const auto& words : scenes) ok(words), files.push_back(words[5]);
  // Columns that are guessed, an axis that is, degrees, points that are hidden and colours of 8 bits.
  for (const char* name : {"dots.txt", "lying.obj", "degrees.las"}) files.push_back(name);
  std::string dots, lying;
  for (int i = 0; i < 600; ++i) {
    const double x = 52 + 1e-4 * (i % 25), y = 13 + 1e-4 * (i / 25);
    dots += std::to_string(x) + " " + std::to_string(y) + " 7.5 200 100 50\n";
    lying +=
        "v " + std::to_string(i % 25) + " " + std::to_string(i / 25) + " " + std::to_string(i % 3) + "\n";
  }
  write("dots.txt", dots), write("lying.obj", lying);
  ok({"convert", "dots.txt", "-o", "degrees.las", "--quiet"});
  for (const std::string& file : files) {
    const std::string said = ok({file, "-o", "a.png", "--resolution", "32x24"}).err;
    EXPECT_LE(std::count(said.begin(), said.end(), '\n'), 2) << said;
    EXPECT_THAT(said, HasSubstr("wrote a.png ("));
    EXPECT_THAT(said, HasSubstr("technique: "));
    EXPECT_THAT(said, HasSubstr("--technique NAME chooses another"));
  }
  EXPECT_THAT(ok({"room.ply", "-o", "a.png", "--resolution", "32x24"}).err, HasSubstr("--whole draws them"));
  EXPECT_THAT(ok({"room.ply", "--panorama", "-o", "a.png", "--resolution", "32x16"}).err,
              Not(HasSubstr("--whole")))
      << "which shows the ceiling";
}

// Flat along z, by which it lies; no camera.
TEST_F(NotesCommand, AReasonIsOneThatSpeaksForTheAxis) {
  std::string text;
  for (int i = 0; i < 600; ++i)
    text += "v " + std::to_string(i % 25) + " " + std::to_string(i / 25) + " " + std::to_string(i % 3) + "\n";
  write("lying.obj", text);
  EXPECT_THAT(ok({"lying.obj", "-o", "a.png", "--resolution", "32x24"}).err,
              ::testing::AllOf(HasSubstr("; --up +Y turns it"), Not(HasSubstr("camera"))));
}

}  // namespace
}  // namespace sfumato::testing
