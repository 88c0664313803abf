// nanoflann peer: kd-tree, k nearest neighbours and a PCA normal for every point, on several threads.
// usage: peer_nanoflann FILE.ply [K] [THREADS]   prints one JSON line
#include <sys/resource.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <nanoflann.hpp>
#include <thread>
#include <vector>

namespace {

struct Cloud {
  std::vector<float> xyz;
  std::size_t kdtree_get_point_count() const { return xyz.size() / 3; }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return xyz[i * 3 + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, unsigned>;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Reads the 28-byte records that gen_tori writes.
bool load(const char* path, Cloud& cloud) {
  std::FILE* file = std::fopen(path, "rb");
  if (!file) return false;
  char line[256];
  std::size_t count = 0;
  while (std::fgets(line, sizeof line, file) && std::strncmp(line, "end_header", 10) != 0) {
    std::sscanf(line, "element vertex %zu", &count);
  }
  std::vector<char> records(count * 28);
  const bool complete = std::fread(records.data(), 28, count, file) == count;
  std::fclose(file);
  cloud.xyz.resize(count * 3);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&cloud.xyz[i * 3], &records[i * 28], 12);
  return complete;
}

void fit_normals(const Cloud& cloud, const Tree& tree, std::size_t k, std::size_t first, std::size_t last,
                 float* normals) {
  std::vector<unsigned> ids(k);
  std::vector<float> distances(k);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t found = tree.knnSearch(&cloud.xyz[i * 3], k, ids.data(), distances.data());
    Eigen::Vector3f mean(0, 0, 0);
    for (std::size_t j = 0; j < found; ++j) mean += Eigen::Map<const Eigen::Vector3f>(&cloud.xyz[ids[j] * 3]);
    mean /= float(found);
    Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
    for (std::size_t j = 0; j < found; ++j) {
      const Eigen::Vector3f d = Eigen::Map<const Eigen::Vector3f>(&cloud.xyz[ids[j] * 3]) - mean;
      covariance += d * d.transpose();
    }
    solver.computeDirect(covariance);
    const Eigen::Vector3f normal = solver.eigenvectors().col(0);
    std::memcpy(normals + i * 3, normal.data(), 12);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 1;
  const std::size_t k = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 24;
  const std::size_t thread_count = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 2;
  Cloud cloud;
  double start = now_ms();
  if (!load(argv[1], cloud)) return 2;
  const double load_ms = now_ms() - start;

  start = now_ms();
  Tree tree(3, cloud, {16});
  tree.buildIndex();
  const double tree_ms = now_ms() - start;

  const std::size_t count = cloud.xyz.size() / 3;
  std::vector<float> normals(cloud.xyz.size());
  start = now_ms();
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < thread_count; ++t) {
    threads.emplace_back(fit_normals, std::cref(cloud), std::cref(tree), k, count * t / thread_count,
                         count * (t + 1) / thread_count, normals.data());
  }
  for (std::thread& thread : threads) thread.join();
  const double normals_ms = now_ms() - start;

  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "{\"peer\": \"nanoflann %d.%d.%d\", \"n\": %zu, \"load_ms\": %.1f, \"normals_ms\": %.1f, \"peak_mb\": "
      "%ld}\n",
      NANOFLANN_VERSION >> 8, NANOFLANN_VERSION >> 4 & 15, NANOFLANN_VERSION & 15, count, load_ms,
      tree_ms + normals_ms, usage.ru_maxrss / 1024);
}
