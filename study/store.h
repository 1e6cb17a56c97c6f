// The rows of a study on the disk: JSON, one line a row, the first line the question.
//
//   Store store = Store::Open("rates.jsonl", question, Store::kNew);
//   store.Add(7, row);  // on the disk when it returns
//   store.Finish();     // in the order of the seeds: bytes do not depend on threads and ranks
//
//   {"abbe_study":"hidden","variant":"one-effect","machine_sha256":"...","version":"0.1.0"}
//   {"seed":7,...}
//
// While a study runs the rows stand in the order in which they came. A last line that a crash cut
// off is dropped at the next Open. Two programs that write one store: the second is refused.
// Failure: InputError for a store of another question, one that exists already, one in use, a line
// that is no row; DeviceError when the disk is full.
// Units: those of the rows. Validity: a few million rows, all kept in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recording/output_file.h"
#include "study/study.h"

namespace abbe::study {

using Rows = std::map<std::uint64_t, Row>;  // by seed

class Store {
 public:
  enum Opening { kNew, kGoOn };

  static Store Open(const std::filesystem::path& path, const Row& question, Opening opening);
  Store(Store&& other) noexcept;
  ~Store();

  const Rows& rows() const { return rows_; }
  void Add(std::uint64_t seed, const Row& row);
  void Finish();

 private:
  Store(std::filesystem::path path, Row question);
  void Lock();

  std::filesystem::path path_;
  Row question_;
  Rows rows_;
  int lock_ = -1;
  std::unique_ptr<recording::OutputFile> file_;
};

// A store, or the stores of several shards, that are read.
struct Stored {
  Row question;
  Rows rows;
  std::vector<Row> Good() const;  // without those that failed
};

// InputError where the stores ask different questions, or two rows of one seed differ.
Stored ReadStores(const std::vector<std::filesystem::path>& paths);

// What a store of these has in it.
std::string TextOf(const Row& question, const Rows& rows);

}  // namespace abbe::study
