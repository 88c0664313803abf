// What is said about a picture that nobody asked for.
#include "session/notes.h"

#include <gtest/gtest.h>

using namespace sfumato;

namespace {

TEST(Notes, EveryFrontEndWordsTheOptionAsItIsWrittenThere) {
  const Note up{"up: -Y (flat)", "up", "+Z", "turns it"}, room = note_on_cutaway(false), fact{"2 scans"};
  EXPECT_EQ(worded(up, FrontEnd::command), "up: -Y (flat); --up +Z turns it");
  EXPECT_EQ(worded(up, FrontEnd::python), "up: -Y (flat); up=\"+Z\" turns it");
  EXPECT_EQ(worded(room, FrontEnd::command), room.text + "; --whole draws them");
  EXPECT_EQ(worded(room, FrontEnd::python), room.text + "; whole=True draws them");
  EXPECT_EQ(worded(room, FrontEnd::viewer), room.text + "; 'whole room' under Scene draws them");
  EXPECT_EQ(worded(fact, FrontEnd::command), "2 scans");
}

TEST(Notes, OnPointsThatAreNotShown) {
  scene::Scene scene;
  for (const FrontEnd front_end : {FrontEnd::command, FrontEnd::python, FrontEnd::viewer}) {
    EXPECT_EQ(note_on_hidden(scene, {7}, front_end), "");
    EXPECT_EQ(note_on_levels(scene, front_end), "");
    EXPECT_EQ(note_on_left_out(0, front_end), "");
  }
  scene.selected.hidden = 1;
  scene.levels = scene::LevelsReport{30, 100, 200, 1, 2, 3, 1.3};
  EXPECT_EQ(note_on_hidden(scene, {7, 18}, FrontEnd::command),
            "1 point is withheld or of a hidden class (7,18); --hide-classes none shows them");
  EXPECT_EQ(note_on_hidden(scene, {}, FrontEnd::python),
            "1 point is withheld or of a hidden class (hide_classes=() shows them)");
  EXPECT_EQ(note_on_levels(scene, FrontEnd::command),
            "70 of 100 points that this view can show are left out, in spacings of up to 1.3 px: "
            "--memory, --gpu-memory or --max-points are used up");
  EXPECT_EQ(note_on_levels(scene, FrontEnd::python),
            "70 of 100 points that this view can show are left out: memory or max_points are used up");
  EXPECT_EQ(note_on_levels(scene, FrontEnd::viewer),
            "too many points to hold: views are coarser than the screen shows (--memory)");
  EXPECT_EQ(note_on_left_out(2, FrontEnd::command), "2 points are left out: 256 others share their place");
  EXPECT_EQ(note_on_left_out(2, FrontEnd::python), "2 points are left out: others share their place");
}

TEST(Notes, OnARoomOnlyWhereOneLooksIntoIt) {
  Pose pose;
  pose.subject.box = {{0, 0, 0}, {4, 4, 3}};
  pose.subject.room = Room{{{0, 0, 1, -2.9}}};
  Camera above = first_view(pose, 16, 9), within = above;
  above.position = {2, 2, 9}, above.target = {2, 2, 0}, above.up = {0, 1, 0};
  within.position = {2, 2, 1}, within.target = {3, 2, 1};
  EXPECT_EQ(notes_on(pose, std::vector{above}).size(), 1u);
  EXPECT_EQ(notes_on(pose, std::vector{within, above}).size(), 1u);
  EXPECT_TRUE(notes_on(pose, std::vector{within}).empty());
  EXPECT_TRUE(notes_on(pose, {}).empty());
}

TEST(Notes, AreOneLineThatSaysEachFactOnce) {
  EXPECT_EQ(joined_notes({}, {"a.las"}), "");
  EXPECT_EQ(joined_notes({"a.las: 8 bits", "a.las: rounded", "up: +Y"}, {"a.las"}),
            "a.las: 8 bits; rounded; up: +Y");
  EXPECT_EQ(joined_notes({"wrote a.las", "wrote a.las"}, {}), "wrote a.las");
  EXPECT_EQ(joined_notes({"a: x", "b: x", "a: y", "b: z", "c: x", "up: +Y"}, {"a", "b", "c"}),
            "3 files: x; a: y; b: z; up: +Y");
  EXPECT_EQ(joined_notes({"a: x", "b: x"}, {"a", "b", "c"}), "a, b: x");
}

}  // namespace
