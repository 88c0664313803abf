#include "input_options.h"

#include <cctype>

#include "core/counted.h"
#include "core/error.h"
#include "session/preset.h"

namespace sfumato::cli {
void declare_option(CommandLine& line, Request& request, const Option& option, const std::string& help) {
  const auto apply = [&request, &option, name = "--" + option.name()](const std::string& text) {
    option.set(request, name, text);
  };
  switch (option.kind) {
    case Option::Kind::flag: return line.flag(option.names, help, apply);
    case Option::Kind::text: return line.handler(option.names, option.metavar, help, false, apply);
    case Option::Kind::texts:
      return line.texts(
          option.names, option.metavar, help, [&request, &option] { option.reset(request); }, apply);
  }
}

void declare_group(CommandLine& line, Request& request, std::string_view group) {
  line.group(std::string(group));
  for (const Option& option : request_options())
    if (option.group == group) declare_option(line, request, option, option.help);
}

std::vector<scene::SceneFile> placed_files(const Words& files, const Words& transforms) {
  std::vector<scene::SceneFile> placed = scene::files_of(files);
  for (const std::string& text : transforms) {
    const std::size_t colon = text.find(':');
    const auto wrong = [&](const std::string& why) {
      throw Error(ErrorCode::usage,
                  "--transform: '" + text + "': " + why +
                      "; write \"N: 16 numbers\", such as \"2: 1,0,0,12.5,0,1,0,3,0,0,1,0,0,0,0,1\"");
    };
    if (colon == std::string::npos && files.size() > 1) wrong("there is no colon after the file's number");
    const long n = colon == std::string::npos ? 1 : parse_whole("--transform", text.substr(0, colon), 1);
    if (std::size_t(n) > files.size())
      wrong(files.size() == 1 ? "there is 1 file" : "there are " + counted(files.size(), "file"));
    // Commas, blanks and lines alike: matrices are copied from other programs.
    std::string commas;
    for (const char c : text.substr(colon + 1)) {  // npos + 1 is 0
      const bool parts = c == ',' || std::isspace(static_cast<unsigned char>(c));
      if (!parts)
        commas += c;
      else if (!commas.empty() && commas.back() != ',')
        commas += ',';
    }
    if (commas.ends_with(',')) commas.pop_back();
    const std::vector<double> numbers = parse_numbers("--transform", commas, 16);
    placed[std::size_t(n - 1)].transform = transform_of_rows(numbers);
    if (!placed[std::size_t(n - 1)].transform)
      wrong("the last row of a transform is 0 0 0 1, and it flattens nothing");
  }
  return placed;
}

std::string unused_columns(std::span<const io::ReadReport> files, const io::ReadOptions& options) {
  if (options.columns.empty()) return "";
  for (const io::ReadReport& report : files)
    if (report.format == "text" || report.format == "pts" || report.format == "npy" ||
        report.format == "kitti")
      return "";
  return "--columns has no effect: " + files.front().format + " files name their own columns";
}

std::string missing_points(std::uint64_t missing, std::uint64_t points) {
  return std::to_string(missing) + " of " + counted(points, "point") +
         (missing == 1 ? " is missing: it lies" : " are missing: they lie") +
         " in damaged parts (--strict refuses such files)";
}

}  // namespace sfumato::cli
