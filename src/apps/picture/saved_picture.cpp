#include "saved_picture.h"

#include "core/option_text.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "labels/furniture.h"

namespace sfumato {

void draw_furniture(Image<Rgba8>& image, const view::Picture& picture, const Furniture& furniture, UpAxis up,
                    const std::string& crs) {
  labels::draw_furniture(image, labels::meaningful(furniture, picture.camera, up),
                         {picture.camera, up, crs, picture.coloring, picture.background});
}

std::string command_of(std::vector<std::string> words, const std::string& name) {
  words.insert(words.begin(), "sfumato");
  words.insert(words.end(), {"-o", name});
  return quote(words);
}

io::PngTexts texts_of(const std::string& command, const Camera& camera, const std::optional<Note>& cutaway) {
  io::PngTexts texts = {{"Software", std::string("sfumato ") + version()},
                        {"Command", command},
                        {"Camera", io::camera_to_json(camera)}};
  if (cutaway) texts.emplace_back("Description", worded(*cutaway, FrontEnd::command));
  return texts;
}

io::PngTexts finish(view::SavedPicture& saved, const std::string& name) {
  draw_furniture(saved.picture.image, saved.picture, saved.furniture, saved.up, saved.crs);
  return texts_of(command_of(saved.words, name), saved.picture.camera, saved.cutaway);
}

}  // namespace sfumato
