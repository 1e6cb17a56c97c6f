// Seconds and memory of `abbe fuse` for three sweeps of 1e5 rows together and a recording of the
// linkage on a moving path of 1e5, 1e6, ... rows.
//
//   bench/fuse_rows ABBE ROWS...
//
// The recordings are those of the virtual rig: the errors of seed 1 in 1e5 places along a curve
// that fills the volume; a longer path goes through them again with noise of its own. Time and
// largest memory are those of the whole program, reading included, on one core.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/device_settings.h"
#include "random/counter_random.h"
#include "recording/recording_file.h"
#include "rig/record_course.h"
#include "rig/record_sweep.h"

namespace {

using namespace abbe;
using Eigen::Vector3d;
namespace fs = std::filesystem;

constexpr std::size_t kPlaces = 100'000;
constexpr double kSweepRate = 45.0;  // Hz: 1e5 rows in three sweeps

class Campaign {
 public:
  explicit Campaign(const fs::path& machine)
      : document_(settings::Document::Read(machine)),
        rig_(rig::World(rig::ReadRigSettings(document_.Root()), 1),
             rig::Linkage(rig::ReadLinkage(document_.Root()), 1)) {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double turn = 2.0 * M_PI * static_cast<double>(i) / kPlaces;
      Vector3d at(std::sin(211.0 * turn), std::sin(37.0 * turn + 0.3), std::sin(5.0 * turn + 0.7));
      at = Vector3d::Constant(0.03) + 0.029 * at;
      places_.push_back(at);
      Vector3d angles = rig_.linkage().EncodersFor(rig_.ToolAt(at), 20.0);
      for (Eigen::Index k = 0; k < 3 && i > 0; ++k) {  // a counter does not jump by a turn
        const double before = angles_.back()[k];
        angles[k] = before + std::remainder(angles[k] - before, 2.0 * M_PI);
      }
      angles_.push_back(angles);
    }
  }

  std::vector<std::string> WriteSweeps(const fs::path& folder) const {
    std::vector<std::string> files;
    const auto channels = rig::ChannelsOf(hal::ReadDevices(document_.Root().Child("devices")));
    for (const char axis : {'X', 'Y', 'Z'}) {
      files.push_back(folder / fmt::format("sweep_{}.h5", axis));
      const auto sweep =
          rig::RecordSweep(rig_.world(), axis, channels, {.rate = kSweepRate, .mounting = "A"});
      sweep_rows_ += sweep.rows();
      recording::Write(sweep, files.back());
    }
    return files;
  }
  std::size_t sweep_rows() const { return sweep_rows_; }

  void WritePath(std::size_t rows, const fs::path& file) const {
    recording::Recording path;
    path.header = "kind = \"linkage\"\nmachine = \"demo-mill\"\n";
    for (const char* name : {"time_s", "x_mm", "y_mm", "z_mm", "pivot_1_rad", "pivot_2_rad",
                             "pivot_3_rad", "temp_table_c", "flags"}) {
      path.columns.push_back({name, std::vector<double>(rows, 0.0)});
    }
    const random::CounterRandom random(1, 0x3AB);
    for (std::size_t row = 0; row < rows; ++row) {
      path.columns[0].values[row] = 0.001 * static_cast<double>(row);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        path.columns[1 + k].values[row] = 1e3 * places_[row % kPlaces][i];
        path.columns[4 + k].values[row] =
            angles_[row % kPlaces][i] +
            rig_.linkage().settings().encoder_noise * random.Normal(3 * row + k);
      }
      path.columns[7].values[row] = 20.0;
    }
    recording::Write(path, file);
  }

 private:
  settings::Document document_;
  rig::LinkageRig rig_;
  std::vector<Vector3d> places_, angles_;
  mutable std::size_t sweep_rows_ = 0;
};

struct Cost {
  double seconds, processor, megabytes;
};

Cost Run(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || status != 0) {
    throw std::runtime_error(fmt::format("{} ended with {}", words[0], status));
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {passed.count(), seconds(used.ru_utime) + seconds(used.ru_stime),
          static_cast<double>(used.ru_maxrss) / 1024.0};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: fuse_rows ABBE ROWS...\n");
    return EXIT_FAILURE;
  }
  const fs::path folder = fs::temp_directory_path() / fmt::format("abbe_fuse_rows_{}", getpid());
  fs::create_directory(folder);
  const fs::path machine = fs::path(ABBE_SOURCE_DIR) / "machines/demo_mill.toml";
  const Campaign campaign(machine);
  const std::vector<std::string> sweeps = campaign.WriteSweeps(folder);
  fmt::print("{} sweep rows beside\n{:>12}{:>10}{:>14}{:>10}\n", campaign.sweep_rows(), "RELM rows",
             "s", "processor s", "MB");
  for (int i = 2; i < argc; ++i) {
    const std::size_t rows = std::strtoull(argv[i], nullptr, 10);
    const fs::path path = folder / "path.h5";
    campaign.WritePath(rows, path);
    std::vector<std::string> words{argv[1], "fuse"};
    words.insert(words.end(), sweeps.begin(), sweeps.end());
    words.insert(words.end(), {path, "--machine", machine, "-o", folder / "map.toml", "--quiet"});
    const Cost cost = Run(words);
    fmt::print("{:>12}{:>10.2f}{:>14.2f}{:>10.0f}\n", rows, cost.seconds, cost.processor,
               cost.megabytes);
    fs::remove(path);
  }
  fs::remove_all(folder);
  return EXIT_SUCCESS;
}
