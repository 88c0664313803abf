#include "io/image_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

/// OpenEXR writes the table of its lines in a destructor, where no exception gets out: the first one is kept.
class WriteStream final : public Imf::OStream {
 public:
  WriteStream(const std::string& name, AtomicWriter& writer) : Imf::OStream(name.c_str()), writer_(writer) {}
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

constexpr const char *rgba[] = {"R", "G", "B", "A"}, *xyz[] = {"N.X", "N.Y", "N.Z"};

}  // namespace

struct ExrRows::State {
  std::string file;
  int width, height, done = 0;
  AtomicWriter writer;
  WriteStream stream;
  std::optional<Imf::OutputFile> out;  // gone before its stream

  State(const std::filesystem::path& path, int width_px, int height_px)
      : file(path.string()), width(width_px), height(height_px), writer(path), stream(file, writer) {}
  /// OpenEXR's own errors become ours.
  template <class Work>
  void guarded(Work&& work) {
    try {
      work();
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw Error(ErrorCode::io, "cannot write " + file + ": " + error.what());
    }
  }
};

ExrRows::ExrRows(const std::filesystem::path& file, int width, int height, bool with_color, bool with_depth,
                 bool with_normal, const std::string& command)
    : state_(std::make_unique<State>(file, width, height)) {
  state_->guarded([&] {
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (!command.empty()) Imf::addComments(header, command);
    const auto add = [&](const char* name) { header.channels().insert(name, Imf::Channel(Imf::FLOAT)); };
    if (with_color) std::for_each(std::begin(rgba), std::end(rgba), add);
    if (with_depth) add("Z");
    if (with_normal) std::for_each(std::begin(xyz), std::end(xyz), add);
    state_->out.emplace(state_->stream, header);
  });
}
ExrRows::~ExrRows() = default;

void ExrRows::write(const Image<vec4>& color, const Image<float>& depth, const Image<vec3>& normal) {
  State& s = *state_;
  const int rows = std::max({color.height(), depth.height(), normal.height()});
  s.guarded([&] {
    Imf::FrameBuffer buffer;
    // One float of every pixel; OpenEXR counts rows from the top of the picture.
    const auto add = [&](const char* name, const float* first, int stride) {
      const std::size_t step = sizeof(float) * std::size_t(stride), row = step * std::size_t(s.width);
      char* base = reinterpret_cast<char*>(const_cast<float*>(first)) - row * std::size_t(s.done);
      buffer.insert(name, Imf::Slice(Imf::FLOAT, base, step, row));
    };
    for (int k = 0; k < 4 && !color.empty(); ++k) add(rgba[k], &color.data()->x + k, 4);
    if (!depth.empty()) add("Z", depth.data(), 1);
    for (int k = 0; k < 3 && !normal.empty(); ++k) add(xyz[k], &normal.data()->x + k, 3);
    s.out->setFrameBuffer(buffer);
    s.out->writePixels(rows);
    s.done += rows;
  });
}

void ExrRows::finish() {
  State& s = *state_;
  s.guarded([&] { s.out.reset(); });
  s.stream.rethrow();
  s.writer.commit();
}

void write_exr(const std::filesystem::path& file, const Image<vec4>& color, const Image<float>& depth,
               const Image<vec3>& normal, const std::string& command) {
  const int width = std::max({color.width(), depth.width(), normal.width()});
  const int height = std::max({color.height(), depth.height(), normal.height()});
  ExrRows rows(file, width, height, !color.empty(), !depth.empty(), !normal.empty(), command);
  rows.write(color, depth, normal);
  rows.finish();
}

}  // namespace sfumato::io
