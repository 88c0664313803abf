#include "command_line.h"

#include <algorithm>
#include <set>

#include "console.h"
#include "core/error.h"
#include "core/option_text.h"
#include "help_text.h"
#include "suggestions.h"

namespace sfumato::cli {

std::function<void(const CommandHelp&)> CommandLine::listener;

namespace {

bool is_boolean_word(const std::string& word) {
  static const std::set<std::string> words = {"true", "false", "on", "off", "yes", "no", "1", "0", "auto"};
  return words.contains(word);
}

/// "-3", "-1,2,3" and "-.5" are values, not options.
bool looks_like_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !(word[1] >= '0' && word[1] <= '9') && word[1] != '.';
}

}  // namespace

struct CommandLine::State {
  struct Entry {
    OptionInfo info;
    std::function<void(const std::string&)> apply;
    std::function<void()> clear;  // of options that collect values: a later line starts anew
    Words values;                 // of the last line that gave any
    bool fresh = false;           // given on the line being parsed
  };

  CommandHelp help;
  std::string group = "Options";
  std::vector<Entry> entries;
  std::vector<std::pair<std::string, std::string*>> single;  // positionals of one word
  Words* many = nullptr;
  std::function<void(const std::string&)> explain;
  Words other_names;
  std::string other_place;
  std::function<std::string(const CommandHelp&)> make_short_help;

  Entry& add(const std::string& names, OptionInfo::Kind kind, const std::string& metavar,
             const std::string& text) {
    Entry entry;
    for (const std::string& name : split(names, ',')) {
      if (name.starts_with("--"))
        entry.info.long_name = name.substr(2);
      else
        entry.info.short_name = name[1];
    }
    entry.info.kind = kind;
    entry.info.metavar = metavar;
    entry.info.help = text;
    entry.info.group = group;
    return entries.emplace_back(std::move(entry));
  }

  Entry* find_long(const std::string& name) {
    for (Entry& entry : entries)
      if (entry.info.long_name == name) return &entry;
    return nullptr;
  }

  /// "--no-legend" is legend, and "--background" the opposite of "--no-background".
  Entry* find_opposite(const std::string& name) {
    Entry* entry = nullptr;
    if (name.starts_with("no-"))
      entry = find_long(name.substr(3));
    else
      entry = find_long("no-" + name);
    // "--no-points.edl" and "--points.no-edl" are both tried by people.
    if (const std::size_t dot = name.find(".no-"); !entry && dot != std::string::npos)
      entry = find_long(name.substr(0, dot + 1) + name.substr(dot + 4));
    return entry && entry->info.kind != OptionInfo::Kind::value ? entry : nullptr;
  }

  /// Whether the word that stands where a value is due is rather the next option. "-Y" is not: no option has
  /// that letter, but the axes of --up have.
  bool begins_option(const std::string& word) const {
    if (!looks_like_option(word)) return false;
    return word[1] == '-' || word[1] == 'h' ||
           std::any_of(entries.begin(), entries.end(),
                       [&](const Entry& entry) { return entry.info.short_name == word[1]; });
  }

  [[noreturn]] void refuse_unknown(const std::string& word) const {
    if (explain) explain(word);
    Words names;
    for (const Entry& entry : entries)
      if (!entry.info.hidden) names.push_back("--" + entry.info.long_name);
    std::string near = suggest_option(word, names);
    if (near.empty() && !(near = suggest_option(word, other_names)).empty())
      near.insert(near.size() - 1, other_place);
    throw Error(ErrorCode::usage,
                "unknown option " + word + near + " (" + help.name + " --help all lists all)");
  }

  void describe() {
    help.options.clear();
    for (const Entry& entry : entries) help.options.push_back(entry.info);
  }

  /// Takes words[i], an option, and its value; returns the place of the next word.
  std::size_t take_option(const Words& words, std::size_t i) {
    const std::string& word = words[i];
    Entry* entry = nullptr;
    std::optional<std::string> value;
    bool negated = false;
    std::string shown = word;
    if (word.starts_with("--")) {
      const std::size_t equals = word.find('=');
      const std::string name = word.substr(2, equals == std::string::npos ? equals : equals - 2);
      if (equals != std::string::npos) value = word.substr(equals + 1);
      shown = "--" + name;
      entry = find_long(name);
      if (!entry && (entry = find_opposite(name))) negated = true;
    } else {
      for (Entry& one : entries)
        if (one.info.short_name == word[1]) entry = &one;
      shown = word.substr(0, 2);
      if (word.size() > 2) value = word.substr(2);
    }
    if (!entry) refuse_unknown(word.starts_with("--") ? shown : word);
    if (entry->info.kind == OptionInfo::Kind::value) {
      if (!value) {
        if (i + 1 == words.size() || begins_option(words[i + 1]))
          throw Error(ErrorCode::usage,
                      shown + " needs a value: " + shown + " " + value_names(entry->info.metavar));
        value = words[++i];
      }
    } else {
      if (!value && entry->info.kind == OptionInfo::Kind::boolean && !negated && i + 1 < words.size() &&
          is_boolean_word(words[i + 1]))
        value = words[++i];
      if (!value) value = "true";
      if (entry->info.kind == OptionInfo::Kind::flag || negated)
        value = parse_flag(shown, *value) != negated ? "true" : "false";
    }
    if (!entry->fresh) entry->values.clear();
    entry->fresh = true;
    entry->values.push_back(*value);
    return i + 1;
  }
};

CommandLine::CommandLine(const std::string& name, const std::string& description)
    : state_(std::make_unique<State>()) {
  state_->help.name = name;
  state_->help.description = description;
  state_->help.usage = name;
}

CommandLine::~CommandLine() = default;

void CommandLine::group(const std::string& title) { state_->group = title; }

void CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  flag(names, help, [&value](const std::string& text) { value = text == "true"; });
}

void CommandLine::flag(const std::string& names, const std::string& help,
                       std::function<void(const std::string&)> apply) {
  state_->add(names, OptionInfo::Kind::flag, "", help).apply = std::move(apply);
}

void CommandLine::text(const std::string& names, std::string& value, const std::string& metavar,
                       const std::string& help) {
  handler(names, metavar, help, false, [&value](const std::string& text) { value = text; });
}

void CommandLine::text(const std::string& names, std::optional<std::string>& value,
                       const std::string& metavar, const std::string& help) {
  handler(names, metavar, help, false, [&value](const std::string& text) { value = text; });
}

void CommandLine::texts(const std::string& names, Words& values, const std::string& metavar,
                        const std::string& help) {
  texts(
      names, metavar, help, [&values] { values.clear(); },
      [&values](const std::string& text) { values.push_back(text); });
}

void CommandLine::texts(const std::string& names, const std::string& metavar, const std::string& help,
                        std::function<void()> clear, std::function<void(const std::string&)> apply) {
  State::Entry& entry = state_->add(names, OptionInfo::Kind::value, metavar, help);
  entry.apply = std::move(apply);
  entry.clear = std::move(clear);
}

void CommandLine::positional(const std::string& metavar, std::string& value, const std::string& help) {
  state_->single.emplace_back(metavar, &value);
  state_->help.usage += " " + metavar;
  if (!help.empty() && state_->help.description.empty()) state_->help.description = help;
}

void CommandLine::positionals(const std::string& metavar, Words& values, const std::string&) {
  state_->many = &values;
  state_->help.usage += " " + metavar + "...";
}

void CommandLine::handler(const std::string& names, const std::string& metavar, const std::string& help,
                          bool hidden, std::function<void(const std::string&)> apply) {
  State::Entry& entry = state_->add(names, OptionInfo::Kind::value, metavar, help);
  entry.info.hidden = hidden;
  entry.apply = std::move(apply);
}

void CommandLine::boolean(const std::string& names, const std::string& metavar, const std::string& help,
                          bool hidden, std::function<void(const std::string&)> apply) {
  handler(names, metavar, help, hidden, std::move(apply));
  state_->entries.back().info.kind = OptionInfo::Kind::boolean;
}

void CommandLine::restate(const std::string& long_name, const std::string& metavar, const std::string& help) {
  OptionInfo& info = state_->find_long(long_name)->info;
  info.metavar = metavar, info.help = help;
}

void CommandLine::hide(const std::vector<const char*>& names) {
  for (const char* name : names) state_->find_long(name)->info.hidden = true;
}

void CommandLine::explain_unknown(std::function<void(const std::string&)> explain) {
  state_->explain = std::move(explain);
}

void CommandLine::elsewhere(Words names, const std::string& where) {
  state_->other_names = std::move(names);
  state_->other_place = where;
}

void CommandLine::usage(const std::string& text) { state_->help.usage = text; }

void CommandLine::footer(const std::string& text) { state_->help.footer = text; }

void CommandLine::short_help(std::function<std::string(const CommandHelp&)> make) {
  state_->make_short_help = std::move(make);
}

bool CommandLine::parse(const Words& words) {
  State& s = *state_;
  s.describe();
  if (listener) {
    listener(s.help);
    return false;
  }
  for (State::Entry& entry : s.entries) entry.fresh = false;
  const Words loose_before = s.many ? *s.many : Words{};
  Words loose;
  bool options_ended = false;
  for (std::size_t i = 0; i < words.size();) {
    const std::string& word = words[i];
    if (options_ended || !looks_like_option(word)) {
      loose.push_back(word);
      ++i;
    } else if (word == "--") {
      options_ended = true;
      ++i;
    } else if (word == "--help" || word == "-h") {
      const bool all = i + 1 < words.size() && words[i + 1] == "all";
      print(s.make_short_help && !all ? s.make_short_help(s.help) : full_help(s.help, terminal_width()));
      return false;
    } else {
      i = s.take_option(words, i);
    }
  }
  std::size_t taken = 0;
  for (auto& [metavar, value] : s.single)
    if (taken < loose.size()) *value = loose[taken++];
  if (s.many) {
    s.many->insert(s.many->end(), loose.begin() + std::ptrdiff_t(taken), loose.end());
  } else if (taken < loose.size()) {
    throw Error(ErrorCode::usage, "unexpected argument '" + loose[taken] + "' (" + s.help.name + " --help)");
  }
  for (State::Entry& entry : s.entries) {
    if (!entry.fresh) continue;
    if (entry.clear) {
      entry.clear();
      for (const std::string& value : entry.values) entry.apply(value);
    } else {
      entry.apply(entry.values.back());
    }
  }
  return true;
}

std::vector<std::pair<std::string, std::string>> CommandLine::given() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const State::Entry& entry : state_->entries)
    for (const std::string& value : entry.values) {
      if (entry.clear || &value == &entry.values.back()) all.emplace_back(entry.info.long_name, value);
    }
  return all;
}

const CommandHelp& CommandLine::described() const {
  state_->describe();
  return state_->help;
}

std::string join(const Words& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

}  // namespace sfumato::cli
