// gen_isosurface FOLDER neghip|hydrogen OUT.ply: the volumes of Dobrev 2010 as point clouds, for its figures.
#include <cstdio>
#include <exception>

#include "io/io.h"
#include "isosurface.h"

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: gen_isosurface FOLDER neghip|hydrogen OUT.ply\n");
    return 1;
  }
  sfumato::io::write(argv[3], sfumato::bench::isosurfaces(argv[1], argv[2]));
} catch (const std::exception& e) {
  std::fprintf(stderr, "gen_isosurface: %s\n", e.what());
  return 1;
}
