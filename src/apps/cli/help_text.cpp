#include "help_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace sfumato::cli {

int terminal_width() {
  int width = 0;
  if (const char* columns = std::getenv("COLUMNS")) width = std::atoi(columns);
  if (winsize size{}; width <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  return width <= 0 ? 80 : std::clamp(width, 40, 120);
}

std::string wrap(const std::string& text, int width, int indent) {
  std::string out;
  std::istringstream words(text);
  int at = 0;
  for (std::string word; words >> word;) {
    while (indent + int(word.size()) > width) {  // lists of choices break behind a bar
      const std::size_t bar = word.rfind('|', std::size_t(std::max(1, width - indent - 1)));
      if (bar == std::string::npos || bar + 1 >= word.size()) break;
      out += (at > 0 ? "\n" + std::string(std::size_t(indent), ' ') : "") + word.substr(0, bar + 1);
      at = width;
      word.erase(0, bar + 1);
    }
    if (at > 0 && at + 1 + int(word.size()) > width) {
      out += "\n" + std::string(std::size_t(indent), ' ');
      at = indent;
      out += word;
    } else {
      out += (at > 0 ? " " : "") + word;
      at += at > 0 ? 1 : 0;
    }
    at += int(word.size());
  }
  return out;
}

std::string wrap_example(const std::string& line, int width, int indent) {
  const std::string blanks(std::size_t(indent), ' ');
  if (int(line.size()) + indent <= width) return blanks + line + "\n";
  const std::string wrapped = wrap(line, width - indent - 2, 2);
  std::string out;
  std::istringstream lines(wrapped);
  std::string previous;
  bool first = true;
  for (std::string each; std::getline(lines, each); first = false) {
    if (!first) out += blanks + previous + " \\\n";
    previous = each;
  }
  return out + blanks + previous + "\n";
}

std::string value_names(const std::string& metavar) { return metavar.substr(0, metavar.find(' ')); }

std::string spelling(const OptionInfo& option) {
  std::string text = option.short_name ? std::string{'-', option.short_name} + ", " : "";
  text += "--" + option.long_name;
  if (option.kind == OptionInfo::Kind::value && !option.metavar.empty()) text += " " + option.metavar;
  if (option.kind == OptionInfo::Kind::boolean) text += " " + option.metavar;
  return text;
}

std::string option_rows(const std::vector<OptionInfo>& options, int width) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const OptionInfo& option : options)
    if (!option.hidden) entries.emplace_back(spelling(option), option.help);
  return rows(entries, width, 38);
}

std::string rows(const std::vector<std::pair<std::string, std::string>>& entries, int width, int column) {
  std::string text;
  const bool narrow = width < column + 30;
  const int indent = narrow ? 6 : column;
  for (const auto& [name, what] : entries) {
    std::string left = "  " + wrap(name, width - 2, 6);
    if (what.empty()) {
      text += left + "\n";
      continue;
    }
    const bool below = narrow || int(left.size()) + 1 > column;
    text += left + (below ? "\n" + std::string(std::size_t(indent), ' ')
                          : std::string(std::size_t(column) - left.size(), ' '));
    const std::string body = wrap(what, width - indent, 0);
    for (char c : body) text += c == '\n' ? "\n" + std::string(std::size_t(indent), ' ') : std::string(1, c);
    text += "\n";
  }
  return text;
}

std::string full_help(const CommandHelp& help, int width) {
  std::string text = wrap(help.description, width) + "\n\nusage: " + wrap(help.usage, width - 7, 7) + "\n";
  std::vector<std::string> groups;
  for (const OptionInfo& option : help.options)
    if (!option.hidden && std::find(groups.begin(), groups.end(), option.group) == groups.end())
      groups.push_back(option.group);
  for (const std::string& group : groups) {
    std::vector<OptionInfo> members;
    for (const OptionInfo& option : help.options)
      if (option.group == group) members.push_back(option);
    text += "\n" + wrap(group, width) + "\n" + option_rows(members, width);
  }
  if (!help.footer.empty()) text += "\n" + wrap(help.footer, width) + "\n";
  return text;
}

}  // namespace sfumato::cli
