// What a task of a study costs beside its own work: the constants of the model of cost in
// docs/study.md.
//
//   bench/study_costs STORE                 // bytes, parsing, appending, reading of its rows
//   mpirun -n 3 bench/study_costs STORE     // question and answer of two processes as well
//
// STORE is one that `abbe study` or `abbe fleet fit` wrote: its rows are appended again to a store in
// the folder for temporary files, or in $ABBE_SCRATCH, each on the disk before the next, as number 0
// does it. The processes have no work but to send such rows.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clock.h"
#include "study/ranks.h"
#include "study/store.h"

namespace {

namespace fs = std::filesystem;
using namespace abbe::study;
using abbe::bench::Seconds;

double Megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// Milliseconds of each call, in ascending order.
template <typename Call>
std::vector<double> Times(std::size_t count, const Call& call) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) {
    const double start = Seconds();
    call(i);
    times.push_back(1e3 * (Seconds() - start));
  }
  std::ranges::sort(times);
  return times;
}

void Print(const char* what, const std::vector<double>& ms) {
  double sum = 0.0;
  for (const double each : ms) sum += each;
  fmt::print("{:<34}{:>10.4f} ms in the median, {:.4f} in the mean, {:.3f} at most\n", what,
             ms[ms.size() / 2], sum / static_cast<double>(ms.size()), ms.back());
}

void PrintStore(const fs::path& path) {
  const double before = Megabytes(), start = Seconds();
  const Stored stored = ReadStores({path});
  const double count = static_cast<double>(stored.rows.size()), read = Seconds() - start;
  fmt::print("{} rows of {:.0f} bytes; to read all: {:.4f} ms and {:.3f} MB a row\n",
             stored.rows.size(), static_cast<double>(fs::file_size(path)) / count,
             1e3 * read / count, (Megabytes() - before) / count);
  std::vector<Row> rows;
  std::vector<std::string> texts;
  for (const auto& [seed, row] : stored.rows) {
    rows.push_back(row);
    texts.push_back(row.dump());
  }
  const std::size_t calls = std::clamp<std::size_t>(rows.size(), 20, 400);
  Print("a row made text by its process", Times(calls, [&](std::size_t i) {
          texts[i % rows.size()] = rows[i % rows.size()].dump();
        }));
  Print("text made a row by number 0", Times(calls, [&](std::size_t i) {
          rows[i % rows.size()] = Row::parse(texts[i % rows.size()]);
        }));
  const char* const scratch = std::getenv("ABBE_SCRATCH");
  const fs::path copy = (scratch == nullptr ? fs::temp_directory_path() : fs::path(scratch)) /
                        fmt::format("abbe_study_costs_{}.jsonl", getpid());
  {
    Store store = Store::Open(copy, stored.question, Store::kNew);
    Print("a row appended, on the disk",
          Times(calls, [&](std::size_t i) { store.Add(i, rows[i % rows.size()]); }));
  }
  fs::remove(copy);
}

// Questions of the other processes, answered as fast as they come.
void PrintMessages(Ranks& ranks) {
  constexpr std::uint64_t kTasks = 4000;
  std::uint64_t at = 0, came = 0;
  const double start = Seconds();
  ranks.Serve(
      [&]() -> std::optional<std::uint64_t> {
        if (at == kTasks) return std::nullopt;
        return at++;
      },
      [&](std::uint64_t, const std::string&) { ++came; });
  fmt::print("{} processes: {} tasks without work, {:.4f} ms each\n", ranks.count() - 1, came,
             1e3 * (Seconds() - start) / static_cast<double>(came));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: study_costs STORE\n");
    return EXIT_FAILURE;
  }
  Ranks ranks;
  const Stored stored = ReadStores({argv[1]});
  const std::string row = stored.rows.begin()->second.dump();
  if (ranks.number() > 0) {
    ranks.Ask([&](std::uint64_t) { return row; });
    return EXIT_SUCCESS;
  }
  if (ranks.count() > 1) {
    PrintMessages(ranks);
  } else {
    PrintStore(argv[1]);
  }
  return EXIT_SUCCESS;
}
