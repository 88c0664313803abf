// sfumato-decoder: runs LASzip's and Draco's decoders on bytes that nobody vouches for, away from whoever
// wants the points. It is started by io/decoder_pool.cpp, which also limits its memory and time; it gives up
// everything else itself.
#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "confine.h"
#include "io/decoder_messages.h"
#include "io/laz_raw.h"
#ifdef SFUMATO_DRACO
#include "core/point_cloud.h"
#include "draco_raw.h"
#endif

using namespace sfumato::io;

#ifdef SFUMATO_DECODER_THAT_DIES
void die_as_told(const std::uint8_t* input, std::size_t size);  // of the tests
#endif

namespace {

/// Packets of other sizes than the wanted are places given back behind the last block. False: nobody is there
/// any more.
template <class Message>
bool take(Message& message) {
  char bytes[sizeof(Message) + 1];
  while (true) {
    const ssize_t got = ::recv(decoder_socket, bytes, sizeof bytes, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    if (got != ssize_t(sizeof message)) continue;
    std::memcpy(&message, bytes, sizeof message);
    return true;
  }
}

void answer(const DecodeReply& reply) {
  if (::send(decoder_socket, &reply, sizeof reply, MSG_NOSIGNAL) != ssize_t(sizeof reply)) _exit(0);
}

void refuse(const char* what) {
  DecodeReply reply;
  reply.kind = DecodeReply::fault;
  std::snprintf(reply.text, sizeof reply.text, "%s", what);
  answer(reply);
}

/// The shared memory, mapped anew when it has grown.
class Memory {
 public:
  std::uint8_t* at(std::uint64_t size) {
    if (size == size_) return bytes_;
    if (bytes_) ::munmap(bytes_, size_);
    void* mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, decoder_memory, 0);
    bytes_ = mapped == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(mapped);
    size_ = bytes_ ? size : 0;
    if (!bytes_) throw std::bad_alloc();
    return bytes_;
  }

 private:
  std::uint8_t* bytes_ = nullptr;
  std::uint64_t size_ = 0;
};

/// Blocks in two places in turn.
class Blocks {
 public:
  Blocks(const DecodeJob& job, std::uint8_t* memory) : job_(job), memory_(memory) {}
  /// A place that is free. False: nobody wants more.
  bool place(std::uint8_t*& records) {
    char given_back = 0;
    if (count_ >= 2 && !take(given_back)) return false;
    records = memory_ + job_.output + (count_++ % 2) * job_.block_size;
    return true;
  }
  static void send(std::size_t points) {
    DecodeReply reply;
    reply.kind = DecodeReply::block;
    reply.points = std::uint32_t(points);
    answer(reply);
  }

 private:
  const DecodeJob& job_;
  std::uint8_t* memory_;
  std::uint64_t count_ = 0;
};

void decode_laszip(const DecodeJob& job, std::uint8_t* memory) {
  las::LazRawDecoder decoder({memory + job.input, job.input_size}, int(job.format), job.record_length);
  Blocks blocks(job, memory);
  for (std::uint64_t done = 0; done < job.points;) {
    std::uint8_t* records = nullptr;
    if (!blocks.place(records)) _exit(0);
    const auto count = std::size_t(std::min<std::uint64_t>(job.block_points, job.points - done));
    decoder.decode(records, count);
    Blocks::send(count);
    done += count;
  }
}

#ifdef SFUMATO_DRACO
/// What the fields of a record are, and all records: `pack(first, count, records)` writes some.
template <class Pack>
void give_records(const DecodeJob& job, std::uint8_t* memory, const std::string& fields, bool is_mesh,
                  std::uint64_t total, std::size_t record_length, const Pack& pack) {
  DecodeReply reply;
  reply.kind = DecodeReply::fields;
  reply.points = is_mesh;
  reply.total = total;
  std::snprintf(reply.text, sizeof reply.text, "%s", fields.c_str());
  answer(reply);
  Blocks blocks(job, memory);
  for (std::uint64_t done = 0; done < total;) {
    std::uint8_t* records = nullptr;
    if (!blocks.place(records)) _exit(0);
    const auto count = std::size_t(std::min<std::uint64_t>(job.block_size / record_length, total - done));
    pack(done, count, records);
    Blocks::send(count);
    done += count;
  }
}

void decode_draco(const DecodeJob& job, std::uint8_t* memory) {
  const sfumato::DracoCloud cloud({memory + job.input, job.input_size});
  give_records(job, memory, cloud.fields(), cloud.is_mesh(), cloud.points(), cloud.record_length(),
               [&](auto... range) { cloud.pack(range...); });
}

void decode_draco_faces(const DecodeJob& job, std::uint8_t* memory) {
  const sfumato::DracoFaces mesh({memory + job.input, job.input_size});
  const std::string type = std::to_string(int(sfumato::StoredType::uint32));
  give_records(job, memory, "a " + type + ";b " + type + ";c " + type + ";", true, mesh.faces(),
               3 * sizeof(std::uint32_t), [&](auto... range) { mesh.pack(range...); });
}
#endif

}  // namespace

int main() {
  struct rlimit none {};
  setrlimit(RLIMIT_CORE, &none);
  setrlimit(RLIMIT_FSIZE, &none);
  mallopt(M_ARENA_MAX, 1);  // or malloc, out of memory, opens a file to count processors, which it may not
  ::close_range(decoder_memory + 1, ~0u, 0);  // what whoever started us has open is no business of ours
  if (const char* what = sfumato::confine()) {
    refuse(what);
    return 1;
  }
  DecodeReply hello;
  hello.points = decoder_version;
  answer(hello);
  Memory memory;
  for (DecodeJob job; take(job);) {
    try {
      std::uint8_t* bytes = memory.at(job.memory_size);
#ifdef SFUMATO_DECODER_THAT_DIES
      die_as_told(bytes + job.input, job.input_size);
#endif
      if (job.what == Decode::laszip) decode_laszip(job, bytes);
#ifdef SFUMATO_DRACO
      else if (job.what == Decode::draco)
        decode_draco(job, bytes);
      else if (job.what == Decode::draco_faces)
        decode_draco_faces(job, bytes);
#endif
      else
        refuse("a job that this decoder does not know");
    } catch (const std::bad_alloc&) {
      refuse("bytes that want more memory than they may take");
    } catch (const std::exception& error) {
      refuse(error.what());
    }
  }
}
