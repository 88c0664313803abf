// What the ranks that have parts of a cloud tell each other: values that merge, in a tree to the first rank.
#pragma once

#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "analysis/regions.h"
#include "analysis/whole.h"
#include "passes/visible_points.h"
#include "vtkMultiProcessController.h"

/// Values as bytes, and back in the same order. All ranks are of one build on one kind of machine, as VTK asks.
class Bytes {
 public:
  std::vector<char> all;

  template <class T>
  void Put(const T* values, std::size_t count) {
    const std::size_t at = all.size();
    all.resize(at + count * sizeof(T));
    if (count > 0) std::memcpy(all.data() + at, values, count * sizeof(T));
  }
  template <class T>
  void Put(const T& value) { Put(&value, 1); }
  template <class T>
  void PutAll(const std::vector<T>& values) { Put(values.size()), Put(values.data(), values.size()); }
  template <class T>
  void Take(T* values, std::size_t count) {
    if (count > 0) std::memcpy(static_cast<void*>(values), all.data() + taken_, count * sizeof(T));
    taken_ += count * sizeof(T);
  }
  template <class T>
  void Take(T& value) { Take(&value, 1); }
  template <class T>
  void TakeAll(std::vector<T>& values) {
    std::size_t count = 0;
    Take(count);
    values.resize(count);
    Take(values.data(), count);
  }

 private:
  std::size_t taken_ = 0;
};

Bytes BytesOf(const sfumato::analysis::CloudFacts& facts);
Bytes BytesOf(const sfumato::analysis::NeighborhoodFacts& around);
Bytes BytesOf(const sfumato::VisiblePoints& visible);
Bytes BytesOf(const sfumato::PointCloud& points);
void Take(Bytes& bytes, sfumato::analysis::CloudFacts& facts);
void Take(Bytes& bytes, sfumato::analysis::NeighborhoodFacts& around);
void Take(Bytes& bytes, sfumato::VisiblePoints& visible);
void Take(Bytes& bytes, sfumato::PointCloud& points);

/// The ranks of ParaView's process module. Every one has to call each of these, in the same order.
class Ranks {
 public:
  static int Own() { return Controller() ? Controller()->GetLocalProcessId() : 0; }
  static int Count() { return Controller() ? Controller()->GetNumberOfProcesses() : 1; }
  /// Whether it holds for one of them.
  static bool Any(bool holds);
  /// Throws what `work` throws on this rank, and Error where it throws on another: nobody waits for who is gone.
  static void Together(const std::function<void()>& work);
  static void Broadcast(Bytes& bytes, int from = 0);
  /// The largest of all.
  static int Most(int own);
  /// On the first rank the merge of the values of all; on the others something. In pairs, then in pairs of pairs:
  /// each rank sends once. Returns the bytes that this one sent.
  template <class T>
  static std::size_t Merge(T& value) {
    for (int step = 1; step < Count(); step *= 2) {
      if (Own() % (2 * step) == step) {
        const Bytes bytes = BytesOf(value);
        Send(bytes, Own() - step);
        return bytes.all.size();
      }
      if (Own() + step >= Count()) continue;
      Bytes bytes = Receive(Own() + step);
      T other;
      Take(bytes, other);
      merge(value, other);
    }
    return 0;
  }
  /// The same on all ranks.
  template <class T>
  static std::size_t MergeForAll(T& value) {
    const std::size_t sent = Merge(value);
    Bytes bytes;
    if (Own() == 0) bytes = BytesOf(value);
    Broadcast(bytes);
    value = T();
    Take(bytes, value);
    return sent;
  }
  /// Of the points that all have, numbered, those of the region of this rank, and those around it.
  static sfumato::analysis::Share DealOut(const sfumato::PointCloud& part, const sfumato::WholeCloud& whole);

 private:
  static vtkMultiProcessController* Controller() { return vtkMultiProcessController::GetGlobalController(); }
  static void Send(const Bytes& bytes, int to);
  static Bytes Receive(int from);
};
