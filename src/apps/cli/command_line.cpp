#include "command_line.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "console.h"
#include "core/error.h"
#include "core/param.h"

namespace sfumato::cli {

struct CommandLine::State {
  CLI::App app;
  std::string group = "Options";
  std::vector<std::pair<CLI::Option*, std::function<void(const std::string&)>>> handlers;
  std::vector<CLI::Option*> options;
  std::function<void(const std::string&)> explain;

  State(const std::string& name, const std::string& description) : app(description, name) {}

  CLI::Option* keep(CLI::Option* option, const std::string& metavar) {
    option->group(group)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    if (!metavar.empty()) option->type_name(metavar);
    options.push_back(option);
    return option;
  }

  [[noreturn]] void refuse_unknown(const std::string& word) const {
    if (explain) explain(word);
    std::vector<std::string> names;
    for (const CLI::Option* option : options)
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    const std::string near = nearest_word(word, names);
    throw Error(ErrorCode::usage, "unknown option " + word +
                                      (near.empty() ? "" : "; did you mean " + near + "?") + " (" +
                                      app.get_name() + " --help lists all)");
  }
};

CommandLine::CommandLine(const std::string& name, const std::string& description)
    : state_(std::make_unique<State>(name, description)) {
  state_->app.allow_extras();
  state_->app.get_formatter()->column_width(38);
}

CommandLine::~CommandLine() = default;

void CommandLine::group(const std::string& title) {
  state_->group = title;
}

void CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  state_->keep(state_->app.add_flag(names, value, help), "");
}

void CommandLine::text(const std::string& names, std::string& value, const std::string& metavar,
                       const std::string& help) {
  state_->keep(state_->app.add_option(names, value, help), metavar);
}

void CommandLine::text(const std::string& names, std::optional<std::string>& value,
                       const std::string& metavar, const std::string& help) {
  handler(names, metavar, help, false, [&value](const std::string& text) { value = text; });
}

void CommandLine::positional(const std::string& metavar, std::string& value, const std::string& help) {
  state_->app.add_option(metavar, value, help)->type_name("");
}

void CommandLine::positionals(const std::string& metavar, Words& values, const std::string& help) {
  state_->app.add_option(metavar, values, help)->type_name("");
}

void CommandLine::handler(const std::string& names, const std::string& metavar, const std::string& help,
                          bool hidden, std::function<void(const std::string&)> apply) {
  CLI::Option* option = state_->keep(state_->app.add_option(names, help), metavar);
  option->expected(1);
  if (hidden) option->group("");
  state_->handlers.emplace_back(option, std::move(apply));
}

void CommandLine::explain_unknown(std::function<void(const std::string&)> explain) {
  state_->explain = std::move(explain);
}

void CommandLine::footer(const std::string& text) {
  state_->app.footer(text);
}

bool CommandLine::parse(const Words& words) {
  Words reversed(words.rbegin(), words.rend());  // CLI11 takes words from the back
  try {
    state_->app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    print(state_->app.help());
    return false;
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorCode::usage,
                std::string(error.what()) + " (" + state_->app.get_name() + " --help lists all)");
  }
  for (const std::string& word : state_->app.remaining()) {
    if (word == "--") continue;  // ends the options
    if (word.size() > 1 && word[0] == '-') state_->refuse_unknown(word.substr(0, word.find('=')));
    throw Error(ErrorCode::usage,
                "unexpected argument '" + word + "' (" + state_->app.get_name() + " --help)");
  }
  for (const auto& [option, apply] : state_->handlers)
    if (option->count() > 0) apply(option->results().back());
  return true;
}

std::vector<std::pair<std::string, std::string>> CommandLine::given() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const CLI::Option* option : state_->options)
    if (option->count() > 0) all.emplace_back(option->get_lnames().front(), option->results().back());
  return all;
}

double parse_number(const std::string& option, std::string_view text) {
  double value = 0;
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw Error(ErrorCode::usage, option + ": '" + std::string(text) + "' is not a number");
  return value;
}

long parse_whole(const std::string& option, std::string_view text, long least) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least)
    throw Error(ErrorCode::usage, option + ": '" + std::string(text) +
                                      "' is not a whole number of at least " + std::to_string(least));
  return value;
}

std::vector<double> parse_numbers(const std::string& option, std::string_view text, std::size_t count) {
  std::vector<double> values;
  for (const std::string& word : split(text, ',')) values.push_back(parse_number(option, word));
  if (values.size() != count)
    throw Error(ErrorCode::usage, option + ": '" + std::string(text) + "' is not " + std::to_string(count) +
                                      " numbers separated by commas");
  return values;
}

std::pair<int, int> parse_resolution(const std::string& option, std::string_view text) {
  const std::size_t cut = text.find_first_of("xX,");
  const std::string shape = option + ": '" + std::string(text) + "' is not WIDTHxHEIGHT";
  if (cut == std::string_view::npos) throw Error(ErrorCode::usage, shape);
  const long width = parse_whole(option, text.substr(0, cut), 1);
  const long height = parse_whole(option, text.substr(cut + 1), 1);
  if (width > 65536 || height > 65536) throw Error(ErrorCode::usage, shape + " of at most 65536 each");
  return {int(width), int(height)};
}

Words split(std::string_view text, char separator) {
  Words words;
  while (true) {
    const std::size_t cut = text.find(separator);
    words.emplace_back(text.substr(0, cut));
    if (cut == std::string_view::npos) return words;
    text.remove_prefix(cut + 1);
  }
}

std::string quote(const Words& words) {
  static const std::string plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%^";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace sfumato::cli
