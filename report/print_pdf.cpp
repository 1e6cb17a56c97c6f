#include "report/print_pdf.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <vector>

extern char** environ;

namespace abbe::report {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 4> kBrowsers{"chromium", "chromium-browser", "google-chrome",
                                               "google-chrome-stable"};
constexpr std::chrono::minutes kPatience{3};

fs::path Browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : kBrowsers) {
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      const fs::path program = fs::path(folder) / name;
      if (access(program.c_str(), X_OK) == 0 && fs::is_regular_file(program)) return program;
    }
  }
  throw InputError(
      "a PDF is printed by Chromium, which was not found: apt-get install chromium, or print "
      "the page in a browser");
}

// A folder that goes with its content.
class OwnFolder {
 public:
  OwnFolder() {
    std::string pattern = (fs::temp_directory_path() / "abbe-print-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
      throw DeviceError(fmt::format("{}: cannot be created: {}", pattern, std::strerror(errno)));
    }
    path_ = pattern;
  }
  ~OwnFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Runs a program with its output in `log`. Returns whether it ended with 0 in time.
bool Run(std::vector<std::string> words, const fs::path& log) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  // A group of its own, so that the processes of the browser end with it.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw InputError(fmt::format("{}: cannot be started: {}", words[0], std::strerror(error)));
  }
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      kill(-process, SIGKILL);
      waitpid(process, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// The line of the browser that says why, if one does.
std::string WhyNot(const std::string& log) {
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("ERROR") != std::string::npos || line.find("rror:") != std::string::npos) {
      return line;
    }
  }
  return fmt::format("it did not end well within {} minutes", kPatience.count());
}

// A path in the form of a URL: every byte but those of plain names by its number.
std::string UrlOf(const fs::path& path) {
  std::string url = "file://";
  for (const char each : fs::absolute(path).string()) {
    const bool plain = (each >= 'a' && each <= 'z') || (each >= 'A' && each <= 'Z') ||
                       (each >= '0' && each <= '9') ||
                       std::string_view("/-_.").find(each) != std::string_view::npos;
    url += plain ? std::string(1, each) : fmt::format("%{:02X}", static_cast<unsigned char>(each));
  }
  return url;
}

}  // namespace

std::string PrintPdf(const fs::path& page) {
  const fs::path browser = Browser();
  const OwnFolder folder;
  const fs::path pdf = folder / "page.pdf", log = folder / "log";
  std::vector<std::string> words{browser.string(), "--headless", "--disable-gpu", "--no-first-run",
                                 "--disable-background-networking", "--disable-component-update",
                                 "--disable-sync", "--disable-dev-shm-usage",
                                 "--user-data-dir=" + (folder / "profile").string(),
                                 "--no-pdf-header-footer",
                                 // Pages draw their figures after they are loaded.
                                 "--virtual-time-budget=20000", "--print-to-pdf=" + pdf.string()};
  if (geteuid() == 0) words.emplace_back("--no-sandbox");  // Chromium has none for root
  words.push_back(UrlOf(page));
  const bool done = Run(words, log);
  std::string bytes = BytesOf(pdf);
  if (!done || !bytes.starts_with("%PDF-")) {
    throw InputError(fmt::format("{}: {} did not print it: {}", page.string(), browser.string(),
                                 WhyNot(BytesOf(log))));
  }
  return bytes;
}

}  // namespace abbe::report
