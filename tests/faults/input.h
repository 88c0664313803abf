// Bytes as a file that a reader opens by name, without a disk.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace sfumato::test {

/// A folder with files whose contents lie in memory: their names are links into /proc.
class MemoryFolder {
 public:
  MemoryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "sfumato-memory-XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    path_ = name;
  }
  ~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  /// A name for a file of this process.
  class File {
   public:
    File(const MemoryFolder& folder, const std::string& name) : path_(folder.path_ / name) {
      handle_ = memfd_create(name.c_str(), MFD_CLOEXEC);
      const std::string target = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(handle_);
      if (handle_ < 0 || symlink(target.c_str(), path_.c_str()) != 0) std::abort();
    }
    ~File() {
      unlink(path_.c_str());
      close(handle_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    const std::filesystem::path& path() const { return path_; }
    void set(std::string_view bytes) const {
      if (ftruncate(handle_, 0) != 0 ||
          pwrite(handle_, bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
        std::abort();
    }

   private:
    std::filesystem::path path_;
    int handle_ = -1;
  };

 private:
  std::filesystem::path path_;
};

}  // namespace sfumato::test
