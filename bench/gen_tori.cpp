// Writes a tori cloud for the peers.   usage: gen_tori COUNT OUT.ply [random|morton] [SEED]
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tori.h"

int main(int argc, char** argv) {
  using namespace sfumato::bench;
  if (argc < 3) {
    std::fprintf(stderr, "usage: gen_tori COUNT OUT.ply [random|morton] [SEED]\n");
    return 1;
  }
  const Order order = argc > 3 && std::string(argv[3]) == "morton" ? Order::morton : Order::random;
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 12345;
  write_tori(argv[2], tori(std::strtoull(argv[1], nullptr, 10), order, seed));
}
