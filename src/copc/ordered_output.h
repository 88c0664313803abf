// Work in parallel within a budget of memory, and its results in order.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "copc/file_writer.h"
#include "copc/octree.h"

namespace sfumato::copc {

/// Lets in as much work as memory holds; the first always.
class Gate {
 public:
  explicit Gate(std::uint64_t size) : size_(size) {}
  class Pass {
   public:
    Pass(Gate& gate, std::uint64_t size) : gate_(gate), taken_(size) {
      std::unique_lock lock(gate_.mutex_);
      gate_.free_.wait(lock, [&] { return gate_.used_ == 0 || gate_.used_ + taken_ <= gate_.size_; });
      gate_.used_ += taken_;
    }
    ~Pass() {
      {
        const std::lock_guard lock(gate_.mutex_);
        gate_.used_ -= taken_;
      }
      gate_.free_.notify_all();
    }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    Gate& gate_;
    std::uint64_t taken_;
  };

 private:
  std::uint64_t size_, used_ = 0;
  std::mutex mutex_;
  std::condition_variable free_;
};

/// Nodes reach the file in the order of the tasks that make them, whoever is done first.
class OrderedOutput {
 public:
  OrderedOutput(FileWriter& file, Summary& summary) : file_(file), summary_(summary) {}
  void deliver(std::size_t task, NodeMaker& maker) {
    const std::lock_guard lock(mutex_);
    summary_.add(maker.summary);
    waiting_[task] = std::move(maker.nodes);
    for (auto at = waiting_.begin(); at != waiting_.end() && at->first == next_;
         at = waiting_.erase(at), ++next_)
      for (const EncodedNode& node : at->second) file_.append(node);
  }

 private:
  std::mutex mutex_;
  FileWriter& file_;
  Summary& summary_;
  std::size_t next_ = 0;
  std::map<std::size_t, std::vector<EncodedNode>> waiting_;
};

}  // namespace sfumato::copc
