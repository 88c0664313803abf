// A random sample of the points of a COPC file, stored beside them: what follows from all points, as the ends
// of a colour map, is measured on it, the same for every view and budget.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/cloud_facts.h"

namespace sfumato::copc {

/// The records with the smallest hashes of all that they hold, as the sample of analysis::CloudFacts, and off
/// by as little. The same whatever part a record lies in, in any order and grouping of the parts.
class RecordSample {
 public:
  static constexpr std::size_t most = analysis::CloudFacts::most_sampled;
  /// Of so many points: a sixteenth of small files, as they are read whole mostly; 0 where that is too few to
  /// tell anything that the levels do not.
  static std::size_t size_for(std::uint64_t points);

  /// All records have the same length.
  void add(std::span<const std::uint8_t> record);
  void add(const RecordSample& other);
  /// Those with the smallest hashes, `count` or as many as there are, one behind the other.
  std::vector<std::uint8_t> first(std::size_t count);

 private:
  void add(std::uint64_t hash, std::span<const std::uint8_t> record);
  void trim();

  std::size_t length_ = 0;
  std::vector<std::uint64_t> hashes_;  ///< of up to twice as many as are wanted
  std::vector<std::uint8_t> records_;
  std::uint64_t limit_ = ~std::uint64_t{0};  ///< no larger hash is wanted
};

/// The record sample_user_id, sample_record_id (io/las_header.h): this number and that of its points, in 32
/// bits each; the number of points of the file, in 64 bits: who changes these and copies the record has a
/// sample of others; its points, as a LASzip chunk like those of the nodes. Other records are ignored.
inline constexpr std::uint32_t sample_version = 2;
inline constexpr std::uint64_t sample_head = 16;

}  // namespace sfumato::copc
