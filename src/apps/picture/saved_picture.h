// A picture of a view model that is kept: what is drawn into it, and what it says of how it was made.
#pragma once

#include <optional>
#include <string>

#include "io/image_png.h"
#include "session/notes.h"
#include "view/view_model.h"

namespace sfumato {

/// What of the furniture has a meaning in this view.
void draw_furniture(Image<Rgba8>& image, const view::Picture& picture, const Furniture& furniture, UpAxis up,
                    const std::string& crs);
/// The line of a shell that writes a picture so named; `words`: ViewRequest::words.
std::string command_of(std::vector<std::string> words, const std::string& name);
/// What a PNG says of how it was made, for who gets it without what was said when it was drawn.
io::PngTexts texts_of(const std::string& command, const Camera& camera, const std::optional<Note>& cutaway);
/// Draws its furniture; returns the texts of its PNG.
io::PngTexts finish(view::SavedPicture& saved, const std::string& name);

}  // namespace sfumato
