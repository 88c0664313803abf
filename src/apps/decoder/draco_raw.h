// A Draco point cloud, or the vertices and the faces of a Draco mesh, as packed records.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace sfumato {

class DracoCloud {
 public:
  /// Decodes all of it. Throws std::runtime_error with what Draco found.
  explicit DracoCloud(std::span<const std::uint8_t> bytes);
  ~DracoCloud();
  std::uint64_t points() const;
  bool is_mesh() const;
  /// "NAME TYPE;" for each number of a record, in order; types as io::StoredType counts them.
  const std::string& fields() const;
  std::size_t record_length() const;
  void pack(std::uint64_t first, std::size_t count, std::uint8_t* records) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Three uint32 a face, places among the points of `DracoCloud`; of a point cloud there are none.
class DracoFaces {
 public:
  explicit DracoFaces(std::span<const std::uint8_t> bytes);
  ~DracoFaces();
  std::uint64_t faces() const;
  void pack(std::uint64_t first, std::size_t count, std::uint8_t* records) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato
