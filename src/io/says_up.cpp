#include "io/says_up.h"

#include <fstream>
#include <string>

namespace sfumato::io {

bool says_up(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line(4, ' ');
  if (!in.read(line.data(), 4) || line.substr(0, 3) != "ply") return false;
  // Headers are short; what is no header is not read to its end.
  for (int lines = 0; lines < 1000 && std::getline(in, line) && line.size() < 4096; ++lines) {
    if (line.starts_with("end_header")) return false;
    if (line.starts_with("comment up ")) return true;
  }
  return false;
}

}  // namespace sfumato::io
