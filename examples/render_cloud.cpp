// A file to a picture: render_cloud SCAN OUT.png [TECHNIQUE]
#include <cstdio>
#include <sfumato/io.h>
#include <sfumato/renderer.h>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: render_cloud SCAN OUT.png [TECHNIQUE]\n");
    return 1;
  }
  try {
    sfumato::io::ReadResult scan = sfumato::io::read(argv[1]);
    std::printf("%s: %llu points, %s\n", argv[1], static_cast<unsigned long long>(scan.report.points),
                scan.report.format.c_str());
    sfumato::HeadlessRenderer renderer;
    renderer.set_cloud(std::move(scan.cloud));
    const sfumato::Pictures pictures =
        renderer.render(argc > 3 ? argv[3] : "surface", renderer.first_view(320, 240));
    sfumato::io::write_png(argv[2], pictures.color, false);
  } catch (const sfumato::Error& error) {
    std::fprintf(stderr, "render_cloud: %s\n", error.what());
    return int(error.code());
  }
}
