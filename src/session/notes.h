// What is said about a picture that nobody asked for: each guess with the option that undoes it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "session/pose.h"

namespace sfumato {

/// One clause, the same for every front end, which words the option as it is written there.
struct Note {
  std::string text;                 ///< "up: -Y (stands on a base)"
  std::string option, value, does;  ///< "up", "+Z", "turns it back": nothing where nothing undoes it
};

/// "up: -Y (stands on a base); --up +Z turns it back".
std::string for_command(const Note& note);
/// The same with `up="+Z"`.
std::string for_python(const Note& note);

Note note_on_cutaway(bool without_walls);
/// Where one of the cameras looks into the room.
std::optional<Note> note_on_cutaway(const Pose& pose, std::span<const Camera> cameras);
/// On the axis that is up where it is a guess or not the convention of the format, and on a cutaway.
std::vector<Note> notes_on(const Pose& pose, std::span<const Camera> cameras);
Note note_on_technique(const std::string& technique, const std::string& reason);

/// One line of clauses about files, each of which may begin with a name of `files` and a colon: that of a
/// single file stands before all of them, and what is said of several files alike is said once. Nothing for
/// nothing.
std::string joined_notes(const std::vector<std::string>& clauses, const std::vector<std::string>& files);

}  // namespace sfumato
