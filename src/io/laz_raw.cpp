#include "io/laz_raw.h"

#include <algorithm>
#include <istream>
#include <new>
#include <streambuf>
#include <string>

#include "io/laz_point.h"

namespace sfumato::io::las {
namespace {

// A read-only stream over bytes which never ends: LASzip does not survive an end of file where a chunk
// begins, so zeros follow, and `is_overrun` tells that they were asked for.
class ChunkBuffer : public std::streambuf {
 public:
  explicit ChunkBuffer(std::span<const std::uint8_t> bytes) {
    begin_ = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));  // never written to
    end_ = begin_ + bytes.size();
    setg(begin_, begin_, end_);
  }
  bool is_overrun() const { return is_overrun_; }

 protected:
  int_type underflow() override {
    is_overrun_ = true;
    setg(zeros_, zeros_, zeros_ + sizeof zeros_);
    return 0;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type here = is_overrun_ ? end_ - begin_ : gptr() - begin_;
    const off_type base = from == std::ios_base::beg ? 0 : from == std::ios_base::end ? end_ - begin_ : here;
    return seekpos(pos_type(base + offset), std::ios_base::in);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode) override {
    const off_type at = std::clamp<off_type>(off_type(position), 0, end_ - begin_);
    setg(begin_, begin_ + at, end_);
    return pos_type(at);
  }

 private:
  char* begin_ = nullptr;
  char* end_ = nullptr;
  char zeros_[4096] = {};
  bool is_overrun_ = false;
};

}  // namespace

struct LazRawDecoder::State {
  ChunkBuffer buffer;
  std::istream stream;
  int format;
  std::size_t record_length;
  laszip_POINTER laszip = nullptr;
  laszip_point_struct* point = nullptr;

  State(std::span<const std::uint8_t> file, int f, std::size_t length)
      : buffer(file), stream(&buffer), format(f), record_length(length) {}
  ~State() {
    if (!laszip) return;
    laszip_close_reader(laszip);
    laszip_destroy(laszip);
  }
  void check(laszip_I32 result) const {
    if (result == 0) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(laszip, &message);
    std::string text = message ? message : "an error";
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw LazFault("\"" + text + "\"");
  }
};

LazRawDecoder::LazRawDecoder(std::span<const std::uint8_t> file, int format, std::size_t record_length)
    : state_(new State(file, format, record_length)) {
  State& s = *state_;
  if (laszip_create(&s.laszip) != 0) throw std::bad_alloc();
  laszip_BOOL is_compressed = 0;
  s.check(laszip_open_reader_stream(s.laszip, s.stream, &is_compressed));
  s.check(laszip_get_point_pointer(s.laszip, &s.point));
}

LazRawDecoder::~LazRawDecoder() = default;

void LazRawDecoder::decode(std::uint8_t* records, std::size_t count) {
  State& s = *state_;
  for (std::size_t i = 0; i < count; ++i) {
    s.check(laszip_read_point(s.laszip));
    if (s.buffer.is_overrun()) throw LazFault("the end");
    pack_point(*s.point, s.format, s.record_length, records + i * s.record_length);
  }
}

}  // namespace sfumato::io::las
