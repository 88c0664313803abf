// PCL peer: load a PLY; normals from the K nearest neighbours (NormalEstimationOMP) unless K is 0.
// usage: peer_pcl FILE.ply [K] [THREADS]   prints one JSON line
#include <pcl/features/normal_3d_omp.h>
#include <pcl/io/ply_io.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace {

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 1;
  const int k = argc > 2 ? std::atoi(argv[2]) : 24;
  const int threads = argc > 3 ? std::atoi(argv[3]) : 2;
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  double start = now_ms();
  if (pcl::io::loadPLYFile(argv[1], *cloud) < 0) return 2;
  const double load_ms = now_ms() - start;

  double normals_ms = 0;  // tree and query
  pcl::PointCloud<pcl::Normal> normals;
  if (k > 0) {
    start = now_ms();
    auto tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
    tree->setInputCloud(cloud);
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(threads);
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(tree);
    estimation.setKSearch(k);
    estimation.compute(normals);
    normals_ms = now_ms() - start;
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "{\"peer\": \"pcl %s\", \"n\": %zu, \"load_ms\": %.1f, \"normals_ms\": %.1f, \"peak_mb\": %ld}\n",
      PCL_VERSION_PRETTY, cloud->size(), load_ms, normals_ms, usage.ru_maxrss / 1024);
  std::fflush(stdout);
  _exit(0);  // the destructors of a large tree take seconds and are not what is measured
}
