#include "study/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "failure/failure.h"
#include "recording/whole_file.h"

namespace abbe::study {
namespace {

namespace fs = std::filesystem;

std::string ReadAll(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  if (!in) throw InputError(fmt::format("{}: cannot be read; check its name", path.string()));
  return all.str();
}

Row ParseLine(const std::string& line, const fs::path& path, std::size_t number) {
  Row row = Row::parse(line, nullptr, false);
  const char* key = number == 1 ? "abbe_study" : "seed";
  // A byte order mark is taken by the parser, and not by who reads on.
  if (!line.starts_with('{') || !row.is_object() || !row.contains(key)) {
    throw InputError(
        fmt::format("{}:{}: no line of a study (its key \"{}\" is missing); give a "
                    "file that abbe study wrote",
                    path.string(), number, key));
  }
  return row;
}

struct Contents {
  Row question;
  Rows rows;
  std::size_t bytes = 0;  // of its whole lines
};

void AddOnce(std::uint64_t seed, Row row, Rows& rows, const fs::path& path) {
  const auto [at, is_new] = rows.try_emplace(seed, row);
  if (!is_new && at->second != row) {
    throw InputError(
        fmt::format("{}: seed {} was worked out with another result elsewhere; do not "
                    "merge stores of different programs",
                    path.string(), seed));
  }
}

Contents Read(const fs::path& path) {
  const std::string text = ReadAll(path);
  Contents contents;
  std::size_t number = 0;
  for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos;
       begin = end + 1) {
    Row row = ParseLine(text.substr(begin, end - begin), path, ++number);
    contents.bytes = end + 1;
    if (number == 1) {
      contents.question = std::move(row);
      continue;
    }
    if (!row["seed"].is_number_unsigned()) {
      throw InputError(fmt::format("{}:{}: the seed is no whole number", path.string(), number));
    }
    const auto seed = row["seed"].get<std::uint64_t>();
    AddOnce(seed, std::move(row), contents.rows, path);
  }
  if (number == 0) {
    throw InputError(fmt::format("{}: no study: its first line is missing", path.string()));
  }
  return contents;
}

void RequireSameQuestion(const Row& one, const Row& other, const fs::path& path) {
  if (one == other) return;
  throw InputError(fmt::format("{}: this store asks {}, not {}; give another name", path.string(),
                               one.dump(), other.dump()));
}

}  // namespace

Store::Store(fs::path path, Row question)
    : path_(std::move(path)), question_(std::move(question)) {}

Store::Store(Store&& other) noexcept
    : path_(std::move(other.path_)),
      question_(std::move(other.question_)),
      rows_(std::move(other.rows_)),
      lock_(std::exchange(other.lock_, -1)),
      file_(std::move(other.file_)) {}

Store::~Store() {
  if (lock_ >= 0) close(lock_);
}

// Until this process ends or closes it.
void Store::Lock() {
  lock_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (lock_ >= 0 && flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  throw InputError(fmt::format(
      "{}: {}", path_.string(),
      errno == EWOULDBLOCK ? "another abbe study writes it; wait for it, or give another name"
                           : std::strerror(errno)));
}

Store Store::Open(const fs::path& path, const Row& question, Opening opening) {
  Store store(path, question);
  if (opening == kNew) {
    if (fs::exists(path)) {
      throw InputError(fmt::format(
          "{}: exists already; --resume goes on with it, or give another name", path.string()));
    }
    std::error_code ignored;  // said by what creates the file
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), ignored);
    store.file_ = std::make_unique<recording::OutputFile>(path);
    store.Lock();
    store.file_->Append(question.dump() + "\n");
    store.file_->Sync();
    return store;
  }
  store.Lock();
  Contents contents = Read(path);
  RequireSameQuestion(contents.question, question, path);
  store.rows_ = std::move(contents.rows);
  store.file_ = std::make_unique<recording::OutputFile>(path, contents.bytes);
  return store;
}

void Store::Add(std::uint64_t seed, const Row& row) {
  Row line{{"seed", seed}};
  line.update(row);
  file_->Append(line.dump() + "\n");
  file_->Sync();
  rows_[seed] = std::move(line);
}

void Store::Finish() { recording::WriteWhole(TextOf(question_, rows_), path_); }

std::string TextOf(const Row& question, const Rows& rows) {
  std::string text = question.dump() + "\n";
  for (const auto& [seed, row] : rows) text += row.dump() + "\n";
  return text;
}

std::vector<Row> Stored::Good() const {
  std::vector<Row> good;
  for (const auto& [seed, row] : rows) {
    if (!row.contains("failed")) good.push_back(row);
  }
  return good;
}

Stored ReadStores(const std::vector<fs::path>& paths) {
  Stored stored;
  for (const fs::path& path : paths) {
    Contents contents = Read(path);
    if (stored.question.is_null()) stored.question = contents.question;
    RequireSameQuestion(contents.question, stored.question, path);
    for (auto& [seed, row] : contents.rows) AddOnce(seed, std::move(row), stored.rows, path);
  }
  return stored;
}

}  // namespace abbe::study
