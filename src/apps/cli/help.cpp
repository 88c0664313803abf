// sfumato help [COMMAND|TOPIC], and what a bare --help says.
#include "help.h"

#include "commands.h"
#include "console.h"
#include "core/param.h"
#include "help_text.h"
#include "techniques/technique.h"

namespace sfumato::cli {
namespace {

/// The ten options most used, in the order of use.
const Words& most_used() {
  static const Words names = {"technique", "output", "resolution", "view", "zoom",
                              "color-by",  "legend", "crop",       "each", "preset"};
  return names;
}

const Words& examples() {
  static const Words lines = {
      "sfumato scan.laz -o scan.png",
      "sfumato scan.laz -t points --view top -o plan.png",
      "sfumato a.laz b.laz --color-by file --legend -o both.png",
      "sfumato scan.laz -t all -o techniques.png",
      "sfumato scans/ --each -o '{stem}.png'",
  };
  return lines;
}

struct Topic {
  std::string name, summary, text;
};

/// Paragraphs are wrapped, lines that begin with blanks are kept.
const std::vector<Topic>& topics() {
  static const std::vector<Topic> all = {
      {"views", "where the camera stands",
       "Without options the view frames the points. --view front|back|left|right|top|bottom|iso chooses the "
       "side, "
       "--camera-azimuth-angle and --camera-elevation-angle any other; --zoom 2 shows things twice as large, "
       "--roll turns "
       "the picture, --look-at X,Y,Z looks at a place from the same side and --distance says from how far "
       "away.\n"
       "--camera-position with --camera-focal-point or --camera-direction places the camera. A --camera "
       "FILE.json, as "
       "written by --output-camera, sets all of these; single options override the file.\n"
       "  sfumato scan.laz --view left --camera-orthographic -o left.png\n"
       "  sfumato scan.laz --look-at 1,2,3 --distance 8 -o detail.png\n"
       "  sfumato scan.laz --panorama --camera-position 1,2,3 -o around.png"},
      {"selections", "which points are shown or converted",
       "--crop X0,Y0,Z0,X1,Y1,Z1 keeps a box in the file's coordinates, --crop-relative the same in shares "
       "of the whole "
       "box (0,0,0,1,1,0.5 is the lower half). --show-classes 2,6 keeps classes, --hide-classes leaves some "
       "out, "
       "--filter \"SCALAR A..B\" keeps a range of any number of the points and may be given several times. "
       "--max-points "
       "keeps a subsample. All of them go with convert as well.\n"
       "  sfumato scan.laz --show-classes 6 --filter \"z 5..\" -o roofs.png\n"
       "  sfumato convert a.laz b.laz --crop-relative 0,0,0,0.5,1,1 -o west.ply"},
      {"colours", "what colours mean",
       "--color-by takes rgb, intensity, classification, elevation, normal, file or any scalar (sfumato info "
       "lists them); "
       "--colormap and --color-range set the map and its range, --legend explains it in the picture. --color "
       "paints every point alike.\n"
       "A colour is a name (steelblue), #hex (#468, #4682b4) or R,G,B from 0 to 1.\n"
       "  sfumato scan.laz --color-by intensity --colormap inferno --legend -o intensity.png\n"
       "  sfumato before.laz after.laz --color-by file --legend -o change.png"},
      {"batches", "many files, many pictures",
       "Several files are one scene. --each makes one picture a file instead, and names it by -o: {stem} is "
       "the file's "
       "name without folder and extension, {n:04} its number, {technique} the technique. Folders and "
       "patterns name their "
       "files. A file that cannot be read is reported and skipped; the exit code is then 3.\n"
       "  sfumato scans/ --each -o 'pictures/{stem}.png'\n"
       "  sfumato 'scans/*.laz' --each -t points -o '{stem}_{technique}.png'\n"
       "- is standard input or output: cat scan.laz | sfumato - -o - > scan.png"},
      {"draw", "several techniques in one picture",
       "--draw \"SELECTION: TECHNIQUE [name=value ...]\" draws some points otherwise than -t says; it may be "
       "given several "
       "times, and the first that selects a point draws it. A selection is *, ranges of any number of the "
       "points, classes "
       "by name, file N (of several files), box x0,y0,z0,x1,y1,z1, or several of them with and / not; the "
       "technique none leaves "
       "points out. What soft and layers "
       "let through is seen behind them; shadows fall from all points on all points.\n"
       "  sfumato city.laz --draw \"classification 3-5: soft opacity=0.2\" -o trees.png\n"
       "  sfumato a.laz b.laz --draw \"file 2 and not class ground: points point_size=2\" -o both.png\n"
       "--save-scene scene.json keeps files, rules, look and camera; --scene scene.json brings them back. A "
       "file in it may "
       "be {\"file\": name, \"transform\": [16 numbers, row by row]}."},
      {"presets", "keeping a look",
       "--save-preset look.json keeps the technique, every parameter and the options that decide the look; "
       "--preset "
       "look.json brings them back. A preset keeps parameters by technique: with another -t those of the "
       "other technique "
       "wait. What the command line says wins.\n"
       "Defaults of your own have the same form and are read from $SFUMATO_CONFIG, else "
       "~/.config/sfumato/config.json.\n"
       "  {\"technique\": \"points\", \"options\": {\"background-color\": \"#202830\"}}"},
      {"exit-codes", "what they mean",
       "  0    done\n  1    usage: something does not exist, or options contradict each other\n"
       "  2    bad input: a file is damaged, empty or not what it claims to be\n"
       "  3    partial: some files of a batch failed, or parts of a file are damaged\n  4    no usable "
       "OpenGL\n  5    out of memory\n"
       "  6    reading or writing failed\n  70   a fault of sfumato\n  130  interrupted"},
  };
  return all;
}

std::string topic_text(const Topic& topic, int width) {
  std::string text = topic.name + ": " + topic.summary + "\n\n";
  for (const std::string& paragraph : split(topic.text, '\n')) {
    if (paragraph.starts_with("  sfumato"))
      text += wrap_example(paragraph.substr(2), width, 2);
    else
      text += (paragraph.starts_with(" ") ? paragraph : wrap(paragraph, width)) + "\n";
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> command_rows() {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const Command& command : all_commands())
    if (!command.hidden) entries.emplace_back(command.name, command.summary);
  return entries;
}

}  // namespace

Words topic_names() {
  Words names;
  for (const Topic& topic : topics()) names.push_back(topic.name);
  return names;
}

std::string short_help(const CommandHelp& help) {
  const int width = terminal_width();
  std::string text =
      "usage: " + wrap(help.usage, width - 7, 7) + "\n       sfumato COMMAND ...\n\nExamples\n";
  for (const std::string& example : examples()) text += wrap_example(example, width, 2);
  std::vector<OptionInfo> options;
  for (const std::string& name : most_used())
    for (const OptionInfo& option : help.options)
      if (option.long_name == name) options.push_back(option);
  text += "\nOptions most used\n";
  std::vector<std::pair<std::string, std::string>> entries;
  for (const OptionInfo& option : options) entries.emplace_back(spelling(option), option.help);
  text += rows(entries, width, 30);
  text += "\nCommands\n" + rows(command_rows(), width, 14);
  std::string names;
  for (const std::string& name : topic_names()) names += " " + name;
  text +=
      "\n" +
      wrap(
          "All options: sfumato --help all. Parameters of a technique: sfumato techniques NAME. Topics of "
          "sfumato help:" +
              names,
          width) +
      "\n";
  return text;
}

int help_command(const Words& words) {
  std::string name, rest;
  CommandLine line("sfumato help",
                   "Explains a command, a technique or a topic; without one, where to begin.");
  line.positional("[COMMAND|TOPIC]", name, "");
  if (!line.parse(words)) return 0;
  const int width = terminal_width();
  if (name.empty() || name == "render") return print(short_help(help_of(""))), 0;
  if (name == "all") return print(full_help(help_of(""), width)), 0;
  if (find_command(name)) return print(full_help(help_of(name), width)), 0;
  for (const Topic& topic : topics())
    if (topic.name == name || topic.name == name + "s" ||
        (topic.name == "colours" && name.starts_with("color")))
      return print(topic_text(topic, width)), 0;
  Words names = topic_names();
  for (const TechniqueInfo& info : all_techniques()) {
    if (info.name == name) return techniques_command({name});
    names.push_back(info.name);
  }
  for (const Command& command : all_commands())
    if (!command.hidden) names.push_back(command.name);
  const std::string near = nearest_word(name, names);
  throw Error(ErrorCode::usage, "there is no help on '" + name + "'" +
                                    (near.empty() ? "" : "; did you mean " + near + "?") + " There is on " +
                                    join(names, ", "));
}

}  // namespace sfumato::cli
