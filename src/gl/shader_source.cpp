#include "gl/shader_source.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
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

/// The NAME of a line `#include "NAME"`, which a comment may follow.
std::optional<std::string> included_by(std::string_view line) {
  const auto skip = [&](std::string_view word) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    const bool is_there = line.starts_with(word);
    if (is_there) line.remove_prefix(word.size());
    return is_there;
  };
  if (!skip("#include") || !skip("\"")) return std::nullopt;
  const std::size_t end = line.find('"');
  if (end == 0 || end == std::string_view::npos) return std::nullopt;
  const std::string name(line.substr(0, end));
  line.remove_prefix(end + 1);
  if (!skip("//") && !line.empty()) return std::nullopt;
  return name;
}

std::size_t digits_at(const std::string& text, std::size_t at) {
  return std::min(text.find_first_not_of("0123456789", at), text.size()) - at;
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

  std::istringstream lines(*text);
  std::string line;
  for (int at = 1; std::getline(lines, line); ++at) {
    if (const auto included = included_by(line)) {
      flatten(*included, out, open);
      out.text += "#line " + std::to_string(at + 1) + " " + std::to_string(number) + "\n";
    } else {
      out.text += line + "\n";
    }
  }
  open.pop_back();
}

}  // namespace

std::string ShaderSource::map_log(const std::string& log) const {
  std::string out;
  for (std::size_t at = 0; at < log.size();) {
    // NUMBER:LINE or NUMBER(LINE)
    const std::size_t number = digits_at(log, at), behind = at + number;
    const std::size_t line = number > 0 && behind < log.size() && (log[behind] == ':' || log[behind] == '(')
                                 ? digits_at(log, behind + 1)
                                 : 0;
    std::size_t end = line > 0 ? behind + 1 + line : std::max(behind, at + 1), file = files.size();
    if (line > 0) {
      if (end < log.size() && log[end] == ')') ++end;
      std::from_chars(log.data() + at, log.data() + behind, file);
    }
    out += file < files.size() ? files[file] + ":" + log.substr(behind + 1, line) : log.substr(at, end - at);
    at = end;
  }
  return out;
}

ShaderSource load_shader(std::string_view name, const Defines& defines, const std::string& extra_head) {
  ShaderSource source;
  source.text = "#version 450 core\n";
  for (const std::string& define : defines) source.text += "#define " + define + "\n";
  std::vector<std::string> open;
  std::istringstream head(extra_head);
  for (std::string line; std::getline(head, line);)
    if (const auto included = included_by(line))
      flatten(*included, source, open);
    else
      source.text += line + "\n";
  flatten(std::string(name), source, open);
  return source;
}

}  // namespace sfumato::gl
