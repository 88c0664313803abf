#include "gl/shader_source.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>

#include "core/error.h"
#include "gl/preferences.h"

namespace sfumato::gl {
namespace {

std::optional<std::string> file_text(const std::string& name) {
  if (const std::string& folder = preferences().shader_folder; !folder.empty())
    for (const char* room : {"/src/", "/shaders/"}) {
      std::ifstream file(folder + room + name);
      if (file) return (std::ostringstream() << file.rdbuf()).str();
    }
  for (const ShaderFile& file : shader_files)
    if (name == file.name) return file.text;
  return std::nullopt;
}

void flatten(const std::string& name, ShaderSource& out, std::vector<std::string>& open) {
  if (std::find(open.begin(), open.end(), name) != open.end())
    throw Error(ErrorCode::no_gl, "shader " + name + " includes itself through " + open.back());
  const auto text = file_text(name);
  if (!text)
    throw Error(ErrorCode::no_gl,
                "no shader file " + name + (open.empty() ? "" : ", included by " + open.back()));
  if (std::find(out.files.begin(), out.files.end(), name) != out.files.end()) return;  // once is enough
  open.push_back(name);
  const std::size_t number = out.files.size();
  out.files.push_back(name);
  out.text += "#line 1 " + std::to_string(number) + "\n";

  static const std::regex include(R"re(^\s*#include\s+"([^"]+)"\s*(//.*)?$)re");
  std::istringstream lines(*text);
  std::string line;
  for (int at = 1; std::getline(lines, line); ++at) {
    std::smatch match;
    if (line.find("#include") != std::string::npos && std::regex_match(line, match, include)) {
      flatten(match[1], out, open);
      out.text += "#line " + std::to_string(at + 1) + " " + std::to_string(number) + "\n";
    } else {
      out.text += line + "\n";
    }
  }
  open.pop_back();
}

}  // namespace

std::string ShaderSource::map_log(const std::string& log) const {
  static const std::regex place(R"((\d+)[:(](\d+)\)?)");
  std::string out;
  std::sregex_iterator at(log.begin(), log.end(), place), end;
  std::size_t done = 0;
  for (; at != end; ++at) {
    const std::size_t number = std::stoul((*at)[1]);
    if (number >= files.size()) continue;
    out += log.substr(done, std::size_t(at->position()) - done) + files[number] + ":" + (*at)[2].str();
    done = std::size_t(at->position() + at->length());
  }
  return out + log.substr(done);
}

ShaderSource load_shader(std::string_view name, const Defines& defines, const std::string& extra_head) {
  ShaderSource source;
  source.text = "#version 450 core\n";
  for (const std::string& define : defines) source.text += "#define " + define + "\n";
  source.text += extra_head;
  std::vector<std::string> open;
  flatten(std::string(name), source, open);
  return source;
}

}  // namespace sfumato::gl
