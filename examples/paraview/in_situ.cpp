// A simulation that shows its particles through ParaView's Catalyst while it runs, on MPI ranks:
//   export SFUMATO_PLUGIN=Sfumato.so PICTURES=pictures
//   mpirun -np 4 -x SFUMATO_PLUGIN -x PICTURES in_situ in_situ.py 10
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <mpi.h>
#include <vtkCPDataDescription.h>
#include <vtkCPInputDataDescription.h>
#include <vtkCPProcessor.h>
#include <vtkCPPythonPipeline.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace {

/// A wavy disc of particles that circle its axis, faster near it.
class Disc {
 public:
  Disc(std::size_t count, unsigned seed) : places_(count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> area(0.04, 4), turn(0, 2 * M_PI);
    for (Particle& each : places_) {
      const double angle = turn(random);
      each = {std::sqrt(area(random)), angle, 0.15 * std::sin(3 * angle)};
    }
  }
  void step(double seconds) {
    for (Particle& each : places_) each.angle += seconds * speed(each) / each.radius;
  }
  vtkSmartPointer<vtkPolyData> data() const {
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> speeds;
    speeds->SetName("speed");
    for (const Particle& each : places_) {
      points->InsertNextPoint(each.radius * std::cos(each.angle), each.radius * std::sin(each.angle), each.z);
      speeds->InsertNextValue(float(speed(each)));
    }
    auto out = vtkSmartPointer<vtkPolyData>::New();
    out->SetPoints(points);
    out->GetPointData()->AddArray(speeds);
    return out;
  }

 private:
  struct Particle {
    double radius, angle, z;
  };
  static double speed(const Particle& particle) { return 1 / std::sqrt(particle.radius); }
  std::vector<Particle> places_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return EXIT_FAILURE;
  MPI_Init(&argc, &argv);
  int rank = 0, drawn = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  {
    vtkNew<vtkCPProcessor> processor;
    processor->Initialize();
    processor->AddPipeline(vtkCPPythonPipeline::CreateAndInitializePipeline(argv[1]));
    Disc disc(20000, unsigned(rank));
    for (int step = 0; step < std::atoi(argv[2]); ++step) {
      vtkNew<vtkCPDataDescription> description;
      description->AddInput("particles");
      description->SetTimeData(0.1 * step, step);
      if (processor->RequestDataDescription(description)) {
        description->GetInputDescriptionByName("particles")->SetGrid(disc.data());
        drawn += processor->CoProcess(description);
      }
      disc.step(0.1);
    }
    processor->Finalize();
  }
  MPI_Finalize();
  return drawn == std::atoi(argv[2]) ? EXIT_SUCCESS : EXIT_FAILURE;
}
