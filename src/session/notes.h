// What is said about a picture that nobody asked for: each guess with the option that undoes it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/coloring.h"
#include "session/pose.h"

namespace sfumato {

/// Where options are written, or controls.
enum class FrontEnd { command, python, viewer };

/// One clause, the same for every front end but for the words of what undoes it.
struct Note {
  std::string text;                                ///< "up: -Y (stands on a base)"
  std::string option = {}, value = {}, does = {};  ///< "up", "+Z", "turns it back": or nothing undoes it
  std::string control = {};                        ///< what undoes it in the viewer
};

/// "up: -Y (stands on a base); --up +Z turns it back", or `up="+Z"`, or the control.
std::string worded(const Note& note, FrontEnd front_end);

/// Of readers, of putting files together, of selecting, and of damage.
std::vector<std::string> notes_of_reading(const scene::Scene& scene);
// Nothing where there is nothing to say:
/// Points that are withheld or of `hidden` classes.
std::string note_on_hidden(const scene::Scene& scene, const std::vector<int>& hidden, FrontEnd front_end);
/// What a budget left out of a view of files with levels.
std::string note_on_levels(const scene::Scene& scene, FrontEnd front_end);
/// Points of which too many are in one place.
std::string note_on_left_out(std::uint64_t points, FrontEnd front_end);
/// A legend of colours that need none.
std::string note_on_legend(const Coloring& coloring, FrontEnd front_end);

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
