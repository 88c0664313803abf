// Decoders in processes of their own: what LASzip and Draco do to themselves on damaged bytes, they do there.
// A process has limits on memory, processor time and files, and may make no system calls but those of
// computing (docs/adr/0130).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "core/progress.h"
#include "io/decoder_messages.h"

namespace sfumato::io {

/// The decoder found damage or died of it: one line, as "the end" or "bytes that ended LASzip (SIGSEGV)".
class DecodeFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Why this process has no decoders and decodes by itself: one line; empty when it has some. SFUMATO_DECODER
/// names the program, or is `none`; otherwise it is sought beside the program or module that this code is in,
/// in ../libexec/sfumato of there, and where it was configured to be installed. Throws Error(usage) when
/// SFUMATO_DECODER names what is none.
std::string why_no_decoders();

/// One job of one process. Processes are kept for the next job, and end with this one.
class DecoderJob {
 public:
  /// Takes a process, or starts one. Throws Error(out_of_memory) when none can be started any more.
  DecoderJob();
  /// Ends the process when the job is not done.
  ~DecoderJob();
  DecoderJob(const DecoderJob&) = delete;

  /// Room for the bytes to decode and for blocks of records, in memory that the process sees. They are
  /// nobody's to trust once the job has begun: whoever reads them twice may read two things.
  std::span<std::uint8_t> make_room(std::size_t input_size, std::size_t block_size);
  /// Decodes what was put there. `memory`: bytes that the process may take beyond that.
  void begin(DecodeJob job, std::uint64_t memory);
  /// What `fields` says (Draco). Throws DecodeFault.
  DecodeReply fields(Progress& progress);
  /// The records of the next block, valid until the next call, at most `most`. Throws DecodeFault; Cancelled.
  std::span<std::uint8_t> next(std::uint64_t most, std::size_t record_length, Progress& progress);
  /// To be called behind the last block: the process can take another job.
  void done();

 private:
  class Process;
  DecodeReply receive(Progress& progress);
  std::unique_ptr<Process> process_;
  std::uint64_t output_ = 0, block_size_ = 0, blocks_ = 0;
  bool is_at_work_ = false;
  friend class DecoderPool;
};

}  // namespace sfumato::io
