#include "session/notes.h"

#include <algorithm>

#include "core/counted.h"

namespace sfumato {

std::string for_command(const Note& note) {
  if (note.option.empty()) return note.text;
  return note.text + "; --" + note.option + (note.value.empty() ? "" : " " + note.value) + " " + note.does;
}

std::string for_python(const Note& note) {
  if (note.option.empty()) return note.text;
  return note.text + "; " + note.option + (note.value.empty() ? "=True" : "=\"" + note.value + "\"") + " " +
         note.does;
}

Note note_on_cutaway(bool without_walls) {
  return {without_walls ? "a room, without the ceiling and walls before it" : "rooms without their ceilings",
          "whole", "", "draws them"};
}

std::optional<Note> note_on_cutaway(const Pose& pose, std::span<const Camera> cameras) {
  if (!pose.subject.room) return std::nullopt;
  bool any = false, walls = false;
  for (const Camera& camera : cameras) {
    const Cut cut = cut_before(*pose.subject.room, camera);
    any = any || !cut.empty(), walls = walls || !cut.walls.empty();
  }
  return any ? std::optional(note_on_cutaway(walls)) : std::nullopt;
}

std::vector<Note> notes_on(const Pose& pose, std::span<const Camera> cameras) {
  std::vector<Note> notes;
  const analysis::Upright& upright = pose.upright;
  if (upright.other)
    notes.push_back({"up: " + to_string(upright.up) + " (" + upright.reason + ")", "up",
                     to_string(*upright.other), "turns it"});
  if (const auto cutaway = note_on_cutaway(pose, cameras)) notes.push_back(*cutaway);
  return notes;
}

Note note_on_technique(const std::string& technique, const std::string& reason) {
  return {"technique: " + technique + " (" + reason + ")", "technique", "NAME", "chooses another"};
}

std::string joined_notes(const std::vector<std::string>& clauses, const std::vector<std::string>& files) {
  struct Clause {
    std::string text;
    std::vector<std::string> files;
  };
  std::vector<Clause> all;
  for (const std::string& text : clauses) {
    const auto file = std::find_if(files.begin(), files.end(),
                                   [&](const std::string& name) { return text.rfind(name + ": ", 0) == 0; });
    const std::string rest = file == files.end() ? text : text.substr(file->size() + 2);
    const auto known = std::find_if(all.begin(), all.end(), [&](const Clause& c) {
      return c.text == rest && c.files.empty() == (file == files.end());
    });
    Clause& clause = known == all.end() ? all.emplace_back(Clause{rest, {}}) : *known;
    if (file != files.end() &&
        std::find(clause.files.begin(), clause.files.end(), *file) == clause.files.end())
      clause.files.push_back(*file);
  }
  std::string line;
  for (const Clause& clause : all) {
    line += line.empty() ? "" : "; ";
    if (files.size() > 1 && clause.files.size() > 2)
      line += counted(clause.files.size(), "file") + ": ";
    else if (files.size() > 1)
      for (std::size_t i = 0; i < clause.files.size(); ++i)
        line += clause.files[i] + (i + 1 < clause.files.size() ? ", " : ": ");
    line += clause.text;
  }
  return line.empty() || files.size() != 1 ? line : files[0] + ": " + line;
}

}  // namespace sfumato
