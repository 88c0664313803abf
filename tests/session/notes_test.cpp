// What is said about a picture that nobody asked for.
#include "session/notes.h"

#include <gtest/gtest.h>

using namespace sfumato;

namespace {

TEST(Notes, EveryFrontEndWordsTheOptionAsItIsWrittenThere) {
  const Note up{"up: -Y (flat)", "up", "+Z", "turns it"}, room{"a room", "whole", "", "draws them"},
      fact{"2 scans", "", "", ""};
  EXPECT_EQ(for_command(up), "up: -Y (flat); --up +Z turns it");
  EXPECT_EQ(for_python(up), "up: -Y (flat); up=\"+Z\" turns it");
  EXPECT_EQ(for_command(room), "a room; --whole draws them");
  EXPECT_EQ(for_python(room), "a room; whole=True draws them");
  EXPECT_EQ(for_command(fact), for_python(fact));
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
