// What a publication says of its scan.
#pragma once

#include "../publish/publication.h"
#include "io/io.h"
#include "render_options.h"
#include "report.h"
#include "session/pose.h"

namespace sfumato::cli {

/// Of the scene that was drawn.
struct Drawn {
  const Pose& pose;
  const Bounds& box;  ///< world
  const std::string& crs;
  const std::vector<io::ReadReport>& files;
};

publish::Facts facts_to_publish(const RenderOptions& options, const Choice& choice,
                                const RenderReport& report, const std::string& command, const Drawn& drawn);

}  // namespace sfumato::cli
