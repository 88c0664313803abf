#include "io/exr_read.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <iterator>
#include <map>
#include <span>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "io/file.h"
#include "io/format.h"

namespace sfumato::io {
namespace {

class ReadStream final : public Imf::IStream {
 public:
  explicit ReadStream(const File& file) : Imf::IStream(file.path().c_str()), file_(file) {}
  bool read(char out[], int count) override {
    if (count < 0 || std::uint64_t(count) > file_.size() - std::min(at_, file_.size()))
      throw std::runtime_error("the file ends too early");
    file_.read(at_, std::as_writable_bytes(std::span(out, std::size_t(count))));
    at_ += std::uint64_t(count);
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t byte) override { at_ = byte; }

 private:
  const File& file_;
  std::uint64_t at_ = 0;
};

// OpenEXR takes memory on the word of every attribute: their sizes are checked here before it sees them, and
// kinds whose contents have sizes of their own (previews, lists of strings, what it does not know) are
// refused.
class CheckedHeader {
 public:
  explicit CheckedHeader(const File& file) : file_(file), bytes_(file.read_text(0, largest_header)) {
    const auto flags = number<std::uint32_t>(4);
    if ((flags & 0xFF) != 2 || (flags & ~0x4FFu) != 0)
      fail("found tiles, several parts or a newer version, expected one picture of lines (save it so)");
    std::size_t at = 8;
    while (true) {
      const std::string name = word(at);
      if (name.empty()) break;
      const std::string type = word(at);
      const auto size = number<std::uint32_t>(at);
      at += 4;
      if (size > bytes_.size() - at)
        fail("found '" + name + "' of " + std::to_string(size) + " bytes, more than the header has");
      check(name, type, at, size);
      at += size;
    }
    if (width_ < 1 || height_ < 1 || width_ > 65536 || height_ > 65536 || pixel_size_ == 0)
      fail("found a picture of " + std::to_string(width_) + "x" + std::to_string(height_) + " pixels and " +
           std::to_string(pixel_size_) + " bytes each, expected some");
    constexpr std::uint64_t most_at_once = 64 << 20;
    const std::uint64_t lines = std::uint64_t(lines_at_once_),
                        chunks = (std::uint64_t(height_) + lines - 1) / lines;
    if (chunks * 8 > file.size() || pixel_size_ * std::uint64_t(width_) * lines > most_at_once)
      fail("found a picture of " + std::to_string(width_) + "x" + std::to_string(height_) +
           " pixels, more than its bytes can hold");
  }

 private:
  static constexpr std::size_t largest_header = 1 << 20, longest_name = 255;

  [[noreturn]] void fail(const std::string& what) const { bad_input(file_.path(), "header", what); }

  template <class T>
  T number(std::size_t at) const {
    T value{};
    if (at > bytes_.size() || bytes_.size() - at < sizeof value)
      fail("the file ends inside its header; it is cut short, fetch it again");
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }

  std::string word(std::size_t& at) const {
    const std::size_t end = bytes_.find('\0', at);
    if (end == std::string::npos || end - at > longest_name)
      fail("the file ends inside its header; it is cut short, fetch it again");
    std::string text = bytes_.substr(at, end - at);
    at = end + 1;
    return text;
  }

  void check(const std::string& name, const std::string& type, std::size_t at, std::uint32_t size) {
    static const std::map<std::string, std::uint32_t> sizes = {
        {"box2i", 16},      {"box2f", 16}, {"chromaticities", 32},
        {"compression", 1}, {"double", 8}, {"envmap", 1},
        {"float", 4},       {"int", 4},    {"keycode", 28},
        {"lineOrder", 1},   {"m33f", 36},  {"m33d", 72},
        {"m44f", 64},       {"m44d", 128}, {"rational", 8},
        {"timecode", 8},    {"v2i", 8},    {"v2f", 8},
        {"v2d", 16},        {"v3i", 12},   {"v3f", 12},
        {"v3d", 24}};
    const auto known = sizes.find(type);
    if (known == sizes.end() && type != "string" && type != "chlist")
      fail("found '" + name + "' of the kind '" + type + "', which is not read; save depth alone");
    if (known != sizes.end() && known->second != size)
      fail("found '" + name + "' of " + std::to_string(size) + " bytes; the file is damaged");
    if (name == "dataWindow" && type == "box2i") {
      width_ = std::int64_t(number<std::int32_t>(at + 8)) - number<std::int32_t>(at) + 1;
      height_ = std::int64_t(number<std::int32_t>(at + 12)) - number<std::int32_t>(at + 4) + 1;
    }
    if (name == "compression" && type == "compression") {
      constexpr int lines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
      const auto kind = number<std::uint8_t>(at);
      if (kind >= std::size(lines)) fail("found compression " + std::to_string(kind) + ", expected 0 to 9");
      lines_at_once_ = lines[kind];
    }
    if (type == "chlist") {
      const std::size_t last = at + size;
      std::uint64_t pixel = 0;
      // Name, then 16 bytes: kind of number, linear, sampling. An empty name ends the list, for OpenEXR
      // wherever it stands.
      bool is_ended = false;
      while (at < last && !(is_ended = word(at).empty())) at += 16, pixel += 4;
      if (!is_ended || at != last)
        fail("found channels that are not as long as their list; the file is damaged");
      if (name == "channels") pixel_size_ = pixel;
    }
  }

  const File& file_;
  std::string bytes_;
  std::int64_t width_ = 0, height_ = 0;
  std::uint64_t pixel_size_ = 0;  ///< bytes a pixel
  int lines_at_once_ = 256;
};

// No compression of OpenEXR makes more than this of a byte; smaller pictures cost little anyway.
constexpr std::uint64_t densest = 2048, small_picture_bytes = 16 << 20;

}  // namespace

ExrDepth read_exr_depth(const std::filesystem::path& path) {
  const File file(path);
  const auto fail = [&](const std::string& what) { bad_input(path, "header", what); };
  if (!file.read_text(0, 4).starts_with("\x76\x2f\x31\x01"))
    fail("found no OpenEXR picture, expected depth as one");
  const CheckedHeader checked(file);
  try {
    ReadStream stream(file);
    Imf::InputFile in(stream, 1);
    const Imath::Box2i box = in.header().dataWindow();
    const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1,
                       height = std::int64_t(box.max.y) - box.min.y + 1;
    if (width < 1 || height < 1 || width > 65536 || height > 65536 ||
        std::uint64_t(width * height) * sizeof(float) > std::max(small_picture_bytes, densest * file.size()))
      fail("found a picture of " + std::to_string(width) + "x" + std::to_string(height) +
           " pixels, more than its bytes can hold");
    const Imf::ChannelList& channels = in.header().channels();
    std::string name;
    for (const char* one : {"Z", "depth", "Depth", "D", "Y", "V"})
      if (name.empty() && channels.findChannel(one)) name = one;
    if (name.empty() && channels.begin() != channels.end() && ++channels.begin() == channels.end())
      name = channels.begin().name();
    if (name.empty()) fail("found no channel Z, expected depth in it");
    const Imf::Channel& channel = channels[name.c_str()];
    if (channel.xSampling != 1 || channel.ySampling != 1)
      fail("found a channel of fewer samples than pixels, expected depth for each");
    ExrDepth depth{std::uint32_t(width), std::uint32_t(height),
                   std::vector<float>(std::size_t(width * height))};
    Imf::FrameBuffer buffer;
    // OpenEXR addresses pixels by their place in the data window.
    char* base = reinterpret_cast<char*>(depth.values.data()) -
                 std::ptrdiff_t(sizeof(float)) * (std::ptrdiff_t(box.min.y) * width + box.min.x);
    buffer.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * std::size_t(width)));
    in.setFrameBuffer(buffer);
    in.readPixels(box.min.y, box.max.y);
    return depth;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    std::string what = error.what();
    std::replace_if(
        what.begin(), what.end(), [](unsigned char c) { return c < ' '; }, ' ');
    bad_input(path, "picture", what.substr(0, 200) + "; the file is truncated or damaged");
  }
}

}  // namespace sfumato::io
