// The processes that mpirun started, by MPI: number 0 deals, the others ask it.
//
//   Ranks ranks;
//   if (ranks.number() > 0) ranks.Ask(work);
//
// Without mpirun, and in a build without MPI, this process is the only one.
// Failure: DeviceError when MPI cannot be started.
// Validity: one object in a process, on its main thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace abbe::study {

class Ranks {
 public:
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int number() const { return number_; }
  int count() const { return count_; }

  // Number 0: answers all that the others ask, until each knows that no seed is left.
  // Other work of this process may go on in threads meanwhile.
  void Serve(const std::function<std::optional<std::uint64_t>()>& next,
             const std::function<void(std::uint64_t seed, const std::string& row)>& keep);
  // The others: works out seed after seed.
  void Ask(const std::function<std::string(std::uint64_t seed)>& work);

 private:
  int number_ = 0, count_ = 1;
  [[maybe_unused]] bool started_ = false, worked_ = false;  // by MPI
};

}  // namespace abbe::study
