// Options of the evaluations on their command lines: `--name VALUE` and `--name`.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace sfumato::bench {

class Options {
 public:
  Options& flag(const std::string& name, bool& value) {
    flags_["--" + name] = &value;
    return *this;
  }
  Options& value(const std::string& name, std::function<void(const std::string&)> take) {
    values_["--" + name] = std::move(take);
    return *this;
  }
  Options& value(const std::string& name, std::string& text) {
    return value(name, [&text](const std::string& word) { text = word; });
  }
  /// `--name KEY=VALUE`, any number of times.
  Options& pairs(const std::string& name, std::vector<std::pair<std::string, std::string>>& list) {
    return value(name, [&list](const std::string& word) {
      const std::size_t at = word.find('=');
      if (at == std::string::npos) throw Error(ErrorCode::usage, "no = in '" + word + "'");
      list.emplace_back(word.substr(0, at), word.substr(at + 1));
    });
  }

  /// The words that are no options. Throws `Error` (usage) for an option that is none of these.
  std::vector<std::string> parse(int count, char** words) const {
    std::vector<std::string> rest;
    for (int i = 1; i < count; ++i) {
      const std::string word = words[i];
      if (const auto flag = flags_.find(word); flag != flags_.end()) {
        *flag->second = true;
      } else if (const auto value = values_.find(word); value != values_.end()) {
        if (++i == count) throw Error(ErrorCode::usage, word + " needs a value");
        value->second(words[i]);
      } else if (word.starts_with("--")) {
        throw Error(ErrorCode::usage, "unknown option " + word);
      } else {
        rest.push_back(word);
      }
    }
    return rest;
  }

 private:
  std::map<std::string, bool*> flags_;
  std::map<std::string, std::function<void(const std::string&)>> values_;
};

}  // namespace sfumato::bench
