#include "core/progress.h"

namespace sfumato {
namespace {

class NoProgress final : public Progress {
 public:
  void update(double, std::string_view) override {}
  bool cancelled() const override { return false; }
};

}  // namespace

Progress& no_progress() {
  static NoProgress progress;
  return progress;
}

}  // namespace sfumato
