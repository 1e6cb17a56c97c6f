#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "failure/failure.h"
#include "study/ranks.h"

namespace abbe::study {
namespace {

// A question and its answer. A seed and the row it gave: "7 {...}"; nothing at first.
constexpr int kAsk = 1, kSeed = 2, kNoSeed = 3, kLeave = 4;
constexpr std::chrono::milliseconds kPause{1};  // between looks for a question

std::string Receive(const MPI_Status& status) {
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  std::string text(size, '\0');
  MPI_Recv(text.data(), size, MPI_CHAR, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return text;
}

bool StartedByMpirun() {
  for (const char* name :
       {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK", "SLURM_STEP_NUM_TASKS"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace

Ranks::Ranks() {
  if (!StartedByMpirun()) return;
  int threads = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads) != MPI_SUCCESS ||
      threads < MPI_THREAD_FUNNELED) {
    throw DeviceError("MPI cannot be started; start abbe study without mpirun");
  }
  started_ = true;
  MPI_Comm_rank(MPI_COMM_WORLD, &number_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
}

Ranks::~Ranks() {
  if (!started_) return;
  // After a failure before the work began nobody waits for this one.
  if (!worked_ && number_ == 0) Serve([] { return std::nullopt; }, [](auto, const auto&) {});
  if (!worked_ && number_ > 0) MPI_Send(nullptr, 0, MPI_CHAR, 0, kLeave, MPI_COMM_WORLD);
  MPI_Finalize();
}

void Ranks::Serve(const std::function<std::optional<std::uint64_t>()>& next,
                  const std::function<void(std::uint64_t, const std::string&)>& keep) {
  worked_ = true;
  for (int working = count_ - 1; working > 0;) {
    int is_asked = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_asked, &status);
    if (is_asked == 0) {
      std::this_thread::sleep_for(kPause);
      continue;
    }
    const std::string text = Receive(status);
    if (status.MPI_TAG == kLeave) {
      --working;
      continue;
    }
    if (!text.empty()) {
      std::size_t end = 0;
      const std::uint64_t seed = std::stoull(text, &end);
      keep(seed, text.substr(end + 1));
    }
    std::uint64_t seed = 0;
    const std::optional<std::uint64_t> given = next();
    if (given) seed = *given;
    MPI_Send(&seed, 1, MPI_UINT64_T, status.MPI_SOURCE, given ? kSeed : kNoSeed, MPI_COMM_WORLD);
    if (!given) --working;
  }
}

void Ranks::Ask(const std::function<std::string(std::uint64_t)>& work) {
  worked_ = true;
  std::string text;
  while (true) {
    MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, kAsk, MPI_COMM_WORLD);
    std::uint64_t seed = 0;
    MPI_Status status;
    MPI_Recv(&seed, 1, MPI_UINT64_T, 0, MPI_ANY_TAG, MPI_COMM_WORLD, &status);
    if (status.MPI_TAG == kNoSeed) return;
    text = fmt::format("{} {}", seed, work(seed));
  }
}

}  // namespace abbe::study
