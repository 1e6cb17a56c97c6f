#include "recording/hdf5_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "failure/failure.h"
#include "failure/sanitized.h"

namespace abbe::recording {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20;
constexpr std::size_t kMostBytes = kMebi;  // of one message
constexpr char kBegun = 'b', kFailed = 'e', kDone = 'd';
constexpr int kFirstPatience = 200, kLastPatience = 30'000;  // ms, for a child to begin
constexpr rlim_t kChildSeconds = 3;
constexpr int kSecondsOfClock = 20;  // per second of CPU, for a busy computer
constexpr std::uint64_t kBytesPerSecond = 2'000'000;
constexpr std::uint64_t kLibrary = 256 * kMebi;  // memory of libhdf5 itself

std::uintmax_t SizeOf(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

void WriteAll(int pipe, const void* from, std::size_t size) {
  const char* at = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t count = write(pipe, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) _exit(1);  // the reader has closed the pipe
    at += count;
    size -= count;
  }
}

// False at the end of the pipe, and when the child has sent nothing for `patience` ms.
bool ReadAll(int pipe, void* to, std::size_t size, int patience) {
  char* at = static_cast<char*>(to);
  while (size > 0) {
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = poll(&waiting, 1, patience);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    const ssize_t count = read(pipe, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    size -= count;
  }
  return true;
}

void Limit(int resource, rlim_t most) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_max = std::min(limit.rlim_max, most + 1);
  limit.rlim_cur = std::min(limit.rlim_max, most);
  setrlimit(resource, &limit);
}

// Size of the address space of this process, in bytes.
std::uint64_t Mapped() {
  std::uint64_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * sysconf(_SC_PAGESIZE);
}

struct Child {
  const std::function<void(const Hdf5Sender&)>& read;
  std::uint64_t memory;
  rlim_t seconds;
  int pipe[2];
  pid_t id = -1;
};

[[noreturn]] void RunChild(const Child& child) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGPIPE, SIG_IGN);
  // Default signal handlers: a crash ends the child at once.
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGBUS, SIGILL, SIGFPE}) {
    std::signal(signal, SIG_DFL);
  }
  close(child.pipe[0]);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDERR_FILENO);  // messages of the C library about a corrupt heap
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_CPU, child.seconds);
  if (!ABBE_ADDRESS_SANITIZER) Limit(RLIMIT_AS, child.memory);
  const Hdf5Sender sender(child.pipe[1]);
  try {
    H5open();  // where a lock was copied while another thread held it, the child waits here for ever
    WriteAll(child.pipe[1], &kBegun, 1);
    child.read(sender);
    sender.Send(kDone, std::string_view{});
  } catch (const std::bad_alloc&) {
    _exit(1);
  } catch (const std::exception& failure) {
    sender.Send(kFailed, std::string_view(failure.what()).substr(0, kMostBytes));
  }
  _exit(0);
}

// Forks while this thread holds the lock of libhdf5. Otherwise another thread could hold it, and
// the child would wait for that thread for ever. H5Ewalk2 calls back with the lock held. A thread
// that asks for that lock just then holds a lock within the lock for a moment: see Begin.
void Fork(Child& child) {
  const auto fork_once = [](unsigned number, const H5E_error2_t*, void* to) -> herr_t {
    auto& forked = *static_cast<Child*>(to);
    if (number != 0) return 0;
    forked.id = fork();
    if (forked.id == 0) RunChild(forked);
    return 0;
  };
  H5Eclear2(H5E_DEFAULT);
  H5Epush2(H5E_DEFAULT, __FILE__, "Fork", __LINE__, H5E_ERR_CLS, H5E_ARGS, H5E_BADVALUE, "none");
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, fork_once, &child);
  H5Eclear2(H5E_DEFAULT);
}

// Ends the child on every way out of the reading.
class ChildGuard {
 public:
  ChildGuard(pid_t child, int pipe) : child_(child), pipe_(pipe) {}
  ~ChildGuard() { End(); }
  ChildGuard(const ChildGuard&) = delete;
  ChildGuard& operator=(const ChildGuard&) = delete;

  // Kills it unless it has ended; returns its exit status.
  int End() {
    if (child_ < 0) return 0;
    close(pipe_);
    kill(child_, SIGKILL);
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return status;
  }

 private:
  pid_t child_;
  int pipe_;
};

// A child that has begun to read. One that does not begin hangs in a lock that it copied, whatever
// the file; it is ended and made again, with twice the patience for a busy computer.
std::unique_ptr<ChildGuard> Begin(Child& child, const std::string& name) {
  for (int patience = kFirstPatience; patience < kLastPatience; patience *= 2) {
    if (pipe2(child.pipe, O_CLOEXEC) != 0) throw InputError(name + ": too many open files");
    Fork(child);
    close(child.pipe[1]);
    auto ending = std::make_unique<ChildGuard>(child.id, child.pipe[0]);
    if (child.id < 0) throw InputError(name + ": no process to read it in; close other programs");
    char kind = 0;
    if (ReadAll(child.pipe[0], &kind, 1, patience) && kind == kBegun) return ending;
  }
  throw InputError(name + ": its reading does not begin; close other programs and try again");
}

[[noreturn]] void ThrowEnded(const std::string& name, int status) {
  const bool slow =
      WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
  throw InputError(fmt::format("{}: this HDF5 file is damaged: {}; use an intact copy", name,
                               slow ? "reading it does not end"
                               : WIFSIGNALED(status)
                                   ? "the HDF5 library crashes on it"
                                   : "it asks for more memory than such a file can hold"));
}

[[noreturn]] void RefuseNumbers(const std::string& file, const std::string& name,
                                std::string_view why) {
  throw InputError(fmt::format("{}: {}: {}", file, name, why));
}

void RefuseForeignStorage(hid_t set, const std::string& name, const std::string& file) {
  const Handle layout(H5Dget_create_plist(set), H5Pclose);
  if (H5Pget_external_count(layout.id()) != 0 || H5Pget_layout(layout.id()) == H5D_VIRTUAL) {
    RefuseNumbers(
        file, name,
        "its numbers are in other files, which abbe does not read; copy them into this one "
        "(h5repack)");
  }
  const int filters = H5Pget_nfilters(layout.id());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(layout.id(), i, &flags, &values, nullptr, 0, nullptr, &config);
    if (filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE ||
        filter == H5Z_FILTER_FLETCHER32) {
      continue;
    }
    RefuseNumbers(file, name,
                  "is packed in a way that abbe does not read; write it with gzip or unpacked");
  }
}

}  // namespace

std::uint64_t MostHdf5Numbers(const std::filesystem::path& path) {
  return 16 * kMebi + 256 * SizeOf(path);
}

void Hdf5Sender::Send(char kind, std::string_view bytes) const {
  const std::uint64_t size = bytes.size();
  WriteAll(pipe_, &kind, 1);
  WriteAll(pipe_, &size, sizeof(size));
  WriteAll(pipe_, bytes.data(), bytes.size());
}

void Hdf5Sender::Send(char kind, std::span<const double> values) const {
  constexpr std::size_t kMost = kMostBytes / sizeof(double);
  for (; !values.empty(); values = values.subspan(std::min(kMost, values.size()))) {
    const auto some = values.first(std::min(kMost, values.size()));
    Send(kind, {reinterpret_cast<const char*>(some.data()), some.size_bytes()});
  }
}

void ReadInChild(const std::filesystem::path& path,
                 const std::function<void(const Hdf5Sender& sender)>& read,
                 const std::function<bool(char kind, std::string_view bytes)>& take) {
  const QuietHdf5 quiet;
  const std::string name = path.string();
  const std::uint64_t size = SizeOf(path), most = MostHdf5Numbers(path);
  Child child{
      read, Mapped() + kLibrary + 2 * most, kChildSeconds + size / kBytesPerSecond, {-1, -1}};
  const std::unique_ptr<ChildGuard> ending = Begin(child, name);
  const auto receive = [&, patience = 1000 * kSecondsOfClock * static_cast<int>(child.seconds)](
                           void* to, std::size_t count) {
    if (!ReadAll(child.pipe[0], to, count, patience)) ThrowEnded(name, ending->End());
  };
  std::string bytes;
  std::uint64_t received = 0;
  for (bool more = true; more;) {
    char kind = 0;
    std::uint64_t length = 0;
    receive(&kind, 1);
    receive(&length, sizeof(length));
    if (length > kMostBytes || (received += length) > 2 * most) ThrowEnded(name, ending->End());
    bytes.resize(length);
    receive(bytes.data(), length);
    if (kind == kFailed) throw InputError(bytes);
    more = kind != kDone && take(kind, bytes);
  }
}

std::string TextAttribute(hid_t object, const char* attribute_name, const std::string& file) {
  const Handle attribute(H5Aopen(object, attribute_name, H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.good() ? H5Aget_type(attribute.id()) : H5I_INVALID_HID, H5Tclose);
  const Handle space(attribute.good() ? H5Aget_space(attribute.id()) : H5I_INVALID_HID, H5Sclose);
  if (!type.good() || !space.good() || H5Tget_class(type.id()) != H5T_STRING ||
      H5Sget_simple_extent_npoints(space.id()) != 1) {
    throw InputError(fmt::format("{}: was not written by abbe: it has no text `{}`; check the path",
                                 file, attribute_name));
  }
  const auto refuse_long = [&](std::size_t size) {
    if (size <= kMostHdf5Text) return;
    throw InputError(
        fmt::format("{}: its text `{}` is longer than 1 MiB; shorten it", file, attribute_name));
  };
  char* variable = nullptr;
  const bool is_variable = H5Tis_variable_str(type.id()) > 0;
  if (!is_variable) refuse_long(H5Tget_size(type.id()));
  std::string fixed(is_variable ? 0 : H5Tget_size(type.id()), '\0');
  void* const to = is_variable ? static_cast<void*>(&variable) : fixed.data();
  if (H5Aread(attribute.id(), type.id(), to) < 0) {
    throw InputError(fmt::format("{}: the text `{}` cannot be read: {}; use an intact copy", file,
                                 attribute_name, Hdf5Reason()));
  }
  if (!is_variable) return fixed.substr(0, fixed.find('\0'));
  const std::string text = variable == nullptr ? "" : variable;
  H5free_memory(variable);
  refuse_long(text.size());
  return text;
}

Hdf5Numbers::Hdf5Numbers(hid_t file, const std::string& name, int rank,
                         const std::string& file_name)
    : name_(name) {
  H5L_info_t link{};
  if (H5Lget_info(file, name.c_str(), &link, H5P_DEFAULT) < 0) {
    RefuseNumbers(file_name, name, "is missing; check the path");
  }
  if (link.type != H5L_TYPE_HARD) {
    RefuseNumbers(file_name, name,
                  "is a link to another place, which is not followed; copy the numbers here");
  }
  set_ = Handle(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(set_.good() ? H5Dget_space(set_.id()) : H5I_INVALID_HID, H5Sclose);
  const Handle type(set_.good() ? H5Dget_type(set_.id()) : H5I_INVALID_HID, H5Tclose);
  const bool number =
      type.good() && H5Tget_size(type.id()) <= 16 &&
      (H5Tget_class(type.id()) == H5T_FLOAT || H5Tget_class(type.id()) == H5T_INTEGER);
  if (!space.good() || !number || H5Sget_simple_extent_ndims(space.id()) != rank) {
    RefuseNumbers(file_name, name,
                  rank == 1 ? std::string("is not a column (one row of numbers); remove it from "
                                          "the file")
                            : fmt::format("is not an array of numbers of {} dimensions", rank));
  }
  RefuseForeignStorage(set_.id(), name, file_name);
  std::vector<hsize_t> shape(rank);
  H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
  count_ = 1;
  const hsize_t most = MostHdf5Numbers(file_name) / sizeof(double);
  for (const hsize_t size : shape) {
    if (size != 0 && count_ > most / size) {
      RefuseNumbers(file_name, name,
                    fmt::format("states {} x {} numbers, more than a file of this size can hold; "
                                "use an intact copy",
                                count_, size));
    }
    count_ *= size;
  }
}

void Hdf5Numbers::RequireStorage(const std::string& file_name) const {
  const Handle layout(H5Dget_create_plist(set_.id()), H5Pclose);
  const Handle type(H5Dget_type(set_.id()), H5Tclose);
  const Handle space(H5Dget_space(set_.id()), H5Sclose);
  bool all = false;
  hsize_t chunk = 0;
  if (H5Pget_layout(layout.id()) != H5D_CHUNKED) {
    all = H5Dget_storage_size(set_.id()) >= count_ * H5Tget_size(type.id());
  } else if (H5Pget_chunk(layout.id(), 1, &chunk) == 1 && chunk > 0) {
    hsize_t pieces = 0;
    all = H5Dget_num_chunks(set_.id(), space.id(), &pieces) >= 0 &&
          pieces >= (count_ + chunk - 1) / chunk;
  } else {
    all = H5Dget_storage_size(set_.id()) > 0;
  }
  if (all || count_ == 0) return;
  RefuseNumbers(file_name, name_,
                fmt::format("states {} numbers, but the file does not hold them all; use an "
                            "intact copy",
                            count_));
}

}  // namespace abbe::recording
