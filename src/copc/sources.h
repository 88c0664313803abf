// The files of a build as streams of point records: LAS, LAZ and COPC as they are; others are read whole, one
// after the other, and wait as records on the disk.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "io/las_records.h"

namespace sfumato::copc {

class Source {
 public:
  using Sink = std::function<void(std::uint64_t first, const std::uint8_t* records, std::size_t count)>;

  virtual ~Source() = default;
  /// Points, format, scaling, extra bytes and coordinate system.
  virtual const io::las::Header& header() const = 0;
  /// What the file claims, if anything.
  virtual std::optional<Bounds> bounds() const = 0;
  virtual const std::vector<io::las::RecordFile::Part>& parts() const = 0;
  /// From any thread.
  virtual void read(std::size_t part, const Sink& sink) const = 0;

  std::string name;
  std::vector<std::string> notes;
};

/// `output` is where temporaries go beside. `memory`: what a file that is read whole may take. Throws
/// Error(bad_input, io), and Error(out_of_memory) when it would take more.
std::unique_ptr<Source> open_source(const std::filesystem::path& file, const std::filesystem::path& output,
                                    std::uint64_t memory, Progress& progress);

/// The bits of the colours in its records, from some of them: 8, 12 or 16; 0 when there are none, or all are
/// 0.
int color_bits_of(const Source& source, Progress& progress);

}  // namespace sfumato::copc
