#include "io/image_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>

#include <algorithm>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

/// One float of every pixel of `image`, which holds `stride` floats a pixel.
void add_channel(Imf::Header& header, Imf::FrameBuffer& buffer, const char* name, const float* first,
                 int stride, int width) {
  header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  const std::size_t step = sizeof(float) * std::size_t(stride);
  char* base = reinterpret_cast<char*>(const_cast<float*>(first));
  buffer.insert(name, Imf::Slice(Imf::FLOAT, base, step, step * std::size_t(width)));
}

/// OpenEXR writes the table of its lines in a destructor, where no exception gets out: the first one is kept.
class Stream final : public Imf::OStream {
 public:
  Stream(const std::string& name, AtomicWriter& writer) : Imf::OStream(name.c_str()), writer_(writer) {}
  void write(const char bytes[], int count) override {
    guarded([&] { writer_.write(std::string_view(bytes, std::size_t(count))); });
  }
  std::uint64_t tellp() override { return writer_.tell(); }
  void seekp(std::uint64_t byte) override {
    guarded([&] { writer_.seek(byte); });
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  template <class Work>
  void guarded(Work&& work) {
    try {
      work();
    } catch (...) {
      if (!error_) error_ = std::current_exception();
      throw;
    }
  }
  AtomicWriter& writer_;
  std::exception_ptr error_;
};

}  // namespace

void write_exr(const std::filesystem::path& file, const Image<vec4>& color, const Image<float>& depth,
               const Image<vec3>& normal, const std::string& command) {
  AtomicWriter writer(file);
  Stream stream(file.string(), writer);
  const int width = std::max(color.width(), depth.width()), height = std::max(color.height(), depth.height());
  try {
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (!command.empty()) Imf::addComments(header, command);
    Imf::FrameBuffer buffer;
    const char* rgba[] = {"R", "G", "B", "A"};
    for (int k = 0; k < 4 && !color.empty(); ++k)
      add_channel(header, buffer, rgba[k], &color.data()->x + k, 4, width);
    if (!depth.empty()) add_channel(header, buffer, "Z", depth.data(), 1, width);
    const char* xyz[] = {"N.X", "N.Y", "N.Z"};
    for (int k = 0; k < 3 && !normal.empty(); ++k)
      add_channel(header, buffer, xyz[k], &normal.data()->x + k, 3, width);
    Imf::OutputFile out(stream, header);
    out.setFrameBuffer(buffer);
    out.writePixels(height);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::io, "cannot write " + file.string() + ": " + error.what());
  }
  stream.rethrow();
  writer.commit();
}

}  // namespace sfumato::io
