#include "session/notes.h"

#include <algorithm>
#include <cstdio>

#include "analysis/coincident.h"
#include "core/counted.h"
#include "core/option_text.h"

namespace sfumato {

std::string worded(const Note& note, FrontEnd front_end) {
  if (note.option.empty()) return note.text;
  std::string undone = note.control;
  if (front_end == FrontEnd::command)
    undone = "--" + note.option + (note.value.empty() ? "" : " " + note.value);
  if (front_end == FrontEnd::python)
    undone = note.option + (note.value.empty() ? "=True" : "=\"" + note.value + "\"");
  return note.text + "; " + undone + " " + note.does;
}

std::vector<std::string> notes_of_reading(const scene::Scene& scene) {
  std::vector<std::string> notes = scene.notes;
  notes.insert(notes.end(), scene.damage.begin(), scene.damage.end());
  return notes;
}

std::string note_on_hidden(const scene::Scene& scene, const std::vector<int>& hidden, FrontEnd front_end) {
  if (scene.selected.hidden == 0) return "";
  return are(scene.selected.hidden, "point") + " withheld or of a hidden class (" +
         (front_end == FrontEnd::python ? "hide_classes=() shows them)"
                                        : classes_text(hidden) + "); --hide-classes none shows them");
}

std::string note_on_levels(const scene::Scene& scene, FrontEnd front_end) {
  if (!scene.levels || scene.levels->is_complete()) return "";
  if (front_end == FrontEnd::viewer)
    return "too many points to hold: views are coarser than the screen shows (--memory)";
  char reason[100] = ": memory or max_points are used up";
  if (front_end == FrontEnd::command)
    std::snprintf(reason, sizeof reason,
                  ", in spacings of up to %.2g px: --memory, --gpu-memory or --max-points are used up",
                  scene.levels->widest_px);
  return std::to_string(scene.levels->points_needed - scene.levels->points) + " of " +
         std::to_string(scene.levels->points_needed) + " points that this view can show are left out" +
         reason;
}

std::string note_on_left_out(std::uint64_t points, FrontEnd front_end) {
  if (points == 0) return "";
  return are(points, "point") + " left out: " +
         (front_end == FrontEnd::command ? std::to_string(analysis::most_in_one_place) + " " : "") +
         "others share their place";
}

std::string note_on_legend(const Coloring& coloring, FrontEnd front_end) {
  if (coloring.kind == ColorKind::scalar || !coloring.swatches.empty()) return "";
  return (front_end == FrontEnd::command ? "--" : "") +
         ("legend has no effect: the points are coloured by " + coloring.source) + ", which explains itself";
}

Note note_on_cutaway(bool without_walls) {
  return {without_walls ? "a room, without the ceiling and walls before it" : "rooms without their ceilings",
          "whole", "", "draws them", "'whole room' under Scene"};
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
