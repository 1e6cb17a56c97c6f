#include "recording/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <utility>

#include "failure/failure.h"
#include "recording/output_file.h"

namespace abbe::recording {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;           // limit of Linux
constexpr std::size_t kBegin = 1 << 14;  // bytes that determine the kind of a file
constexpr std::string_view kNothingChanged = "nothing is saved";

Overwriting& Policy() {
  static Overwriting policy;
  return policy;
}

std::optional<struct stat> StatOf(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

// The target of the symbolic links of `path`, which need not exist.
fs::path Followed(fs::path path) {
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path to = fs::read_symlink(path, error);
    path = to.is_absolute() ? to : path.parent_path() / to;
  }
  return path;
}

// First words of the TOML files that abbe writes.
constexpr std::array<std::string_view, 4> kOwn{"# An error map", "# A calibration of the linkage",
                                               "# What the simulation of this machine lacked",
                                               "# The set-up of head and target"};

// The kind of a file in words, by how it begins; a command always writes the same beginning.
std::string KindOf(std::string_view begin) {
  if (begin.find("abbe-recording") != std::string_view::npos) return "a recording";
  if (begin.starts_with("\x89HDF\r\n\x1a\n")) return "an HDF5 file";
  if (begin.find('\0') != std::string_view::npos) return "a binary file";
  if (begin.starts_with("<!doctype html")) return "a page";
  for (const std::string_view own : kOwn) {
    if (begin.starts_with(own)) return fmt::format("\"{}\"", own.substr(2));
  }
  const auto first = begin.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && begin[first] == '{' ? "JSON" : "other text";
}

std::string BeginOf(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return {};
  std::string begin(kBegin, '\0');
  const ssize_t count = read(file, begin.data(), begin.size());
  close(file);
  begin.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return begin;
}

void RefuseInput(const struct stat& status, const std::string& name) {
  for (const fs::path& input : Policy().inputs) {
    const auto read = StatOf(input);
    if (!read || read->st_dev != status.st_dev || read->st_ino != status.st_ino) continue;
    throw InputError(fmt::format(
        "{}: exists already, and this command reads it; choose another name, or add --force",
        name));
  }
}

void RefuseRecording(const std::string& kind, const std::string& name) {
  if (kind != "a recording") return;
  throw InputError(fmt::format(
      "{}: exists already, and nothing recorded is overwritten; choose another name, or "
      "add --force",
      name));
}

[[noreturn]] void RefusePlace(const std::string& name, int error) {
  throw InputError(fmt::format("{}: cannot be created: {}; choose a folder that can be written",
                               name, std::strerror(error)));
}

// A pipe closed by its reader is a failure to write, not the end of this program.
class NoPipeSignal {
 public:
  NoPipeSignal() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
  ~NoPipeSignal() { std::signal(SIGPIPE, before_); }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;

 private:
  void (*before_)(int);
};

}  // namespace

void SetOverwriting(Overwriting overwriting) { Policy() = std::move(overwriting); }

bool OverwritingIsForced() { return Policy().force; }

void RefuseToOverwrite(const fs::path& path) {
  const auto status = StatOf(path);
  if (Policy().force || !status || !S_ISREG(status->st_mode)) return;
  RefuseInput(*status, path.string());
  RefuseRecording(KindOf(BeginOf(path)), path.string());
}

WholeFile::WholeFile(const fs::path& path) : name_(path.string()), target_(Followed(path)) {
  const auto status = StatOf(target_);
  if (!status) return;
  if (S_ISDIR(status->st_mode)) {
    throw InputError(fmt::format("{}: is a folder, not a file; name a file", name_));
  }
  special_ = !S_ISREG(status->st_mode);
  if (special_) return;
  RefuseToOverwrite(target_);
  if (access(target_.c_str(), W_OK) != 0) RefusePlace(name_, errno);
}

WholeFile::~WholeFile() { Remove(); }

void WholeFile::Remove() {
  if (file_ >= 0) close(std::exchange(file_, -1));
  if (!part_.empty()) unlink(part_.c_str());
  part_.clear();
}

// `begin`: the beginning of the content, compared with the kind of an existing file.
void WholeFile::Open(std::string_view begin) {
  begun_ = true;
  if (special_) {
    file_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (file_ < 0) RefusePlace(name_, errno);
    return;
  }
  const auto status = StatOf(target_);
  if (status && status->st_size > 0 && !Policy().force) {
    const std::string is = KindOf(BeginOf(target_)), becomes = KindOf(begin.substr(0, kBegin));
    const bool written_by_hand = is == "other text" && target_.extension() == ".toml";
    if (is != becomes || written_by_hand) {
      throw InputError(fmt::format(
          "{}: exists already and holds {}, but {} would be written; choose another name, or add "
          "--force",
          name_, written_by_hand ? "your settings" : is, becomes));
    }
  }
  part_ = fmt::format("{}.{}.part", target_.string(), getpid());
  const mode_t mode = status ? status->st_mode & 0777 : 0666;
  file_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
  if (file_ >= 0) return;
  const int error = errno;
  const fs::path part = std::exchange(part_, {});
  if (error == EEXIST) {
    throw InputError(fmt::format("{}: is in the way; remove it", part.string()));
  }
  RefusePlace(name_, error);
}

void WholeFile::Append(std::string_view bytes) {
  if (!begun_) Open(bytes);
  const NoPipeSignal no_signal;
  while (!bytes.empty()) {
    const ssize_t count = write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowWriteFailure(name_, kNothingChanged);
    bytes.remove_prefix(count);
  }
}

fs::path WholeFile::PartToFill(std::string_view kind_of) {
  if (special_) {
    throw InputError(fmt::format(
        "{}: is a device or a pipe, which HDF5 cannot be written to; name a file", name_));
  }
  if (!begun_) Open(kind_of);
  return part_;
}

void WholeFile::Finish() {
  if (!begun_) Open({});
  // EINVAL: a device without synchronisation, which has the bytes already.
  if (fsync(file_) != 0 && errno != EINVAL && errno != EROFS) {
    ThrowWriteFailure(name_, kNothingChanged);
  }
  if (close(std::exchange(file_, -1)) != 0) ThrowWriteFailure(name_, kNothingChanged);
  if (special_) return;
  if (rename(part_.c_str(), target_.c_str()) != 0) ThrowWriteFailure(name_, kNothingChanged);
  part_.clear();
}

void WriteWhole(std::string_view text, const fs::path& path) {
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  WholeFile file(path);
  file.Append(text);
  file.Finish();
}

}  // namespace abbe::recording
