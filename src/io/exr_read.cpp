#include "io/exr_read.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <exception>
#include <span>
#include <stdexcept>

#include "core/error.h"
#include "io/file.h"
#include "io/format.h"

namespace sfumato::io {
namespace {

class Stream final : public Imf::IStream {
 public:
  explicit Stream(const File& file) : Imf::IStream(file.path().c_str()), file_(file) {}
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

// No compression of OpenEXR makes more than this of a byte; smaller pictures cost little anyway.
constexpr std::uint64_t densest = 2048, trusted_bytes = 16 << 20;

}  // namespace

ExrDepth read_exr_depth(const std::filesystem::path& path) {
  const File file(path);
  const auto fail = [&](const std::string& what) { bad_input(path, "header", what); };
  if (!file.read_text(0, 4).starts_with("\x76\x2f\x31\x01")) fail("found no OpenEXR picture, expected depth as one");
  try {
    Stream stream(file);
    Imf::InputFile in(stream, 1);
    const Imath::Box2i box = in.header().dataWindow();
    const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1, height = std::int64_t(box.max.y) - box.min.y + 1;
    if (width < 1 || height < 1 || width > 65536 || height > 65536 ||
        std::uint64_t(width * height) * sizeof(float) > std::max(trusted_bytes, densest * file.size()))
      fail("found a picture of " + std::to_string(width) + "x" + std::to_string(height) + " pixels, more than its bytes can hold");
    const Imf::ChannelList& channels = in.header().channels();
    std::string name;
    for (const char* one : {"Z", "depth", "Depth", "D", "Y", "V"})
      if (name.empty() && channels.findChannel(one)) name = one;
    if (name.empty() && channels.begin() != channels.end() && ++channels.begin() == channels.end()) name = channels.begin().name();
    if (name.empty()) fail("found no channel Z, expected depth in it");
    const Imf::Channel& channel = channels[name.c_str()];
    if (channel.xSampling != 1 || channel.ySampling != 1) fail("found a channel of fewer samples than pixels, expected depth for each");
    ExrDepth depth{std::uint32_t(width), std::uint32_t(height), std::vector<float>(std::size_t(width * height))};
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
    std::replace_if(what.begin(), what.end(), [](unsigned char c) { return c < ' '; }, ' ');
    bad_input(path, "picture", what.substr(0, 200) + "; the file is truncated or damaged");
  }
}

}  // namespace sfumato::io
