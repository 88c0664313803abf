// Which files one command reads and writes: an output must be neither an input nor another output.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace sfumato::io {

class FileNames {
 public:
  /// `role` is how the user knows it: "the input", "--camera".
  void input(const std::string& role, const std::filesystem::path& file);
  /// Throws Error(usage) when the file is an input, named before, or there and not a regular file, and
  /// Error(io) when it cannot be written: before hours of work, not after. Links are followed.
  void output(const std::string& role, const std::filesystem::path& file);

 private:
  struct Use {
    std::string role;
    bool is_output = false;
  };
  std::map<std::string, Use> uses_;          ///< by what tells files apart, whatever they are called
  std::set<std::filesystem::path> folders_;  ///< that can be written to
};

}  // namespace sfumato::io
