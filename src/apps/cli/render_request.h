// The words of a rendering, parsed: for the command, its window and the browser alike.
#pragma once

#include <memory>

#include "render_options.h"
#include "session/preset.h"
#include "view/view_model.h"

namespace sfumato::cli {

struct RenderRequest {
  Preset preset;
  Choice choice;
  RenderOptions options;
  CommandLine line;

  /// Declares the options of rendering with the techniques that `words` or presets name. More may be declared
  /// before `parse`.
  explicit RenderRequest(const Words& words, const std::string& command = "sfumato",
                         const std::string& description = "Renders point clouds to pictures.");
  /// The configuration, a preset and the words, one over the other. False when help was asked for, or listed.
  bool parse(const Words& words);
  /// Options, by their long names, that the command does not have: not in its --help, of no effect in a
  /// preset, and refused by `check` with the reason, which ends the sentence "--NAME does not go with ...".
  /// Comes before `parse`.
  void exclude(std::vector<const char*> names, std::string reason);
  /// Everything that can be wrong before a file is opened. Throws Error(usage).
  void check();

 private:
  RenderRequest(const Words& words, const std::string& command, const std::string& description,
                std::pair<Preset, Preset> presets);
  Preset defaults_;
  std::vector<const char*> excluded_;
  std::string why_excluded_;
};

/// Reads, draws and writes what a parsed and checked request asks for; `command` is kept in the pictures.
/// Returns the exit code.
int draw_pictures(RenderRequest& request, const std::string& command);

/// What a viewer begins with.
view::Start view_start(const RenderOptions& options, const Choice& choice);

}  // namespace sfumato::cli
