// A question that is asked of many worlds, each drawn by a seed: the interface of a study.
//
// A study is one folder that derives from Study and one line in kinds.h. World(seed) depends on the
// seed and the question only, never on who works it out or when: a store is the same for any number
// of threads, ranks and shards.
// Units: those of the row's keys, as everywhere in JSON of abbe (SI where a key has none).
// Failure: what World throws is kept as the row {"failed": message}: a world on which the program
// fails is one of the worlds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "study/rate.h"

namespace abbe::study {

using Row = nlohmann::ordered_json;

struct Question {
  std::filesystem::path machine;  // file
  std::string variant;            // one of StudyKind::variants; "" where there are none
};

// What all rows say together.
struct Summary {
  std::string text;           // Markdown
  std::vector<Bound> bounds;  // what is asked of such a study
};

class Study {
 public:
  virtual ~Study() = default;
  // Called from several threads at once.
  virtual Row World(std::uint64_t seed) const = 0;
};

// What a store's row says, which a damaged store may say otherwise: InputError where `key` is not
// `count` numbers, or no rate of `met` among `worlds`.
std::vector<double> NumbersOf(const Row& row, const char* key, std::size_t count);
Rate RateOf(const Row& row, const char* worlds, const char* met);

struct StudyKind {
  std::string_view name, what;  // "head", one line of help
  std::vector<std::string_view> variants;
  std::unique_ptr<const Study> (*make)(const Question& question);
  // Rows without those that failed, in the order of their seeds.
  Summary (*sum)(const std::string& variant, const std::vector<Row>& rows);
};

}  // namespace abbe::study
