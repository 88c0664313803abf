// Runs the built command in a folder of its own and looks at what it leaves behind.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/image.h"

namespace sfumato::testing {

struct Outcome {
  int code = -1;  ///< exit code, or 128 + signal
  std::string out, err;
  double seconds = 0;       ///< of the processor
  double seconds_late = 0;  ///< of them, after the interrupt
};

struct Array {
  std::string type;
  std::vector<int> shape;
  std::vector<float> values;
  std::vector<std::int64_t> indices;  ///< of int64
};

class CommandTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Runs `sfumato words...` inside `folder`. `interrupt_after_ms` sends Ctrl-C once.
  Outcome run(const std::vector<std::string>& words, int interrupt_after_ms = 0);
  /// Sends Ctrl-C when `is_time`, which is asked again and again, says so of the seconds of the processor
  /// that the command has taken. `input`: what it has as standard input.
  Outcome run_interrupted(const std::vector<std::string>& words,
                          const std::function<bool(double seconds)>& is_time, int input = -1);
  /// Runs it, expects exit code 0 and parses what it printed.
  nlohmann::json run_json(const std::vector<std::string>& words);

  /// Stand before the words of every run.
  std::vector<std::string> first_words_;

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }
  std::string write(const std::string& name, const std::string& text);
  std::string text(const std::string& name) const;
  /// Every file in the folder, also those with temporary names.
  std::vector<std::string> files() const;

  /// An ascii PLY of a unit cube's surface, z up, red below and green above its middle, `per_edge`^2 points a
  /// face.
  std::string write_cube(const std::string& name, int per_edge = 30);

  Image<Rgba8> read_png(const std::string& name) const;
  /// Keyword -> text of the picture's tEXt and iTXt chunks, plus the name of every chunk with an empty text.
  std::map<std::string, std::string> png_texts(const std::string& name) const;
  Array read_npy(const std::string& name) const;

 private:
  Outcome run(const std::vector<std::string>& words,
              const std::function<void(int child, Outcome&)>& meanwhile, int input);
  std::filesystem::path folder_;
};

}  // namespace sfumato::testing
