// How long calls report what they do and learn that they should stop. Libraries never print.
#pragma once

#include <string_view>

#include "core/error.h"

namespace sfumato {

/// Handed to every long call. Implementations must be callable from several threads.
class Progress {
 public:
  virtual ~Progress() = default;
  /// `fraction` in [0,1] of the step named by `text`.
  virtual void update(double fraction, std::string_view text) = 0;
  /// True once the user wants to stop (Ctrl-C).
  virtual bool cancelled() const = 0;
  /// Throws `Cancelled` when the user wants to stop; call it every 64k points or so.
  void check() const {
    if (cancelled()) throw Cancelled();
  }
};

/// A progress that says nothing and never stops.
Progress& no_progress();

}  // namespace sfumato
