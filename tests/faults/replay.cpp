// Feeds every file of a folder to a target once: what fuzzing found stays found. usage: replay TARGET FOLDER
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "faults/fuzz_targets.h"

int main(int argc, char** argv) {
  const auto& all = sfumato::test::fuzz_targets();
  if (argc != 3 || !all.contains(argv[1])) return std::fprintf(stderr, "usage: replay TARGET FOLDER\n"), 1;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
#ifndef __SANITIZE_ADDRESS__
  struct rlimit limit {};  // no input of a few bytes is worth a gigabyte
  limit.rlim_cur = limit.rlim_max = rlim_t(1) << 30;
  setrlimit(RLIMIT_AS, &limit);
#endif
  for (const auto& file : files) {
    std::fprintf(stderr, "%s\n", file.c_str());  // the last line before a crash
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    all.at(argv[1])(bytes);
  }
  std::printf("%zu files\n", files.size());
}
