#include "io/file_names.h"

#include <sys/stat.h>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

/// Device and inode of a file that is there, so that no other spelling or link hides it; else its folder's,
/// and name.
std::string identity(const std::filesystem::path& file) {
  if (is_standard_output(file)) return "-";
  const auto number = [](const std::filesystem::path& path) -> std::string {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0) return {};
    return std::to_string(info.st_dev) + ":" + std::to_string(info.st_ino);
  };
  if (const std::string here = number(file); !here.empty()) return here;
  const std::filesystem::path target = follow_links(file);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  return number(folder) + "/" + target.filename().string();
}

}  // namespace

void FileNames::input(const std::string& role, const std::filesystem::path& file) {
  if (file != "-") uses_.emplace(identity(file), Use{role, false});
}

void FileNames::output(const std::string& role, const std::filesystem::path& file) {
  if (!is_standard_output(file)) refuse_special_file(follow_links(file));
  const auto [use, is_new] = uses_.emplace(identity(file), Use{role, true});
  if (!is_new)
    throw Error(ErrorCode::usage, role + " " + file.string() + ": " +
                                      (use->second.is_output ? "is also written by " : "would replace ") +
                                      use->second.role + "; name another file");
  // Permissions do not tell what a file system refuses: a writer that is not committed leaves nothing.
  const std::filesystem::path target = is_standard_output(file) ? file : follow_links(file);
  std::error_code error;
  if (folders_.insert(target.parent_path()).second || std::filesystem::exists(target, error))
    const AtomicWriter writer(file);
}

}  // namespace sfumato::io
