// The one place that hands bytes to LASzip's decoder, which does not survive every damage (docs/adr/0130): it
// runs in a decoder process, or here where none can be started.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>

namespace sfumato::io::las {

/// What LASzip found: one line.
class LazFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Decodes the points of a LAS file in memory that holds compressed points. Zeros follow its end.
class LazRawDecoder {
 public:
  /// `file` lives as long as this. `format` and `record_length` are those of its points.
  LazRawDecoder(std::span<const std::uint8_t> file, int format, std::size_t record_length);
  ~LazRawDecoder();
  /// The next `count` points as packed records. Throws LazFault.
  void decode(std::uint8_t* records, std::size_t count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato::io::las
