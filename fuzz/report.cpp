// `report/report_page.h`: a folder whose only result is the input.
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "fuzz/target.h"
#include "report/report_page.h"

namespace abbe::fuzz::report {

// A folder in memory, gone with the program.
class Folder {
 public:
  Folder() {
    const char* const memory = "/dev/shm";
    path_ = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    path_ /= "abbe-fuzz-" + std::to_string(getpid());
    std::filesystem::create_directory(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void Read(Bytes bytes) {
  static const Folder folder;
  {
    std::ofstream file(folder.path() / "result.json", std::ios::binary | std::ios::trunc);
    file << TextOf(bytes);
  }
  const auto composed = abbe::report::ComposeReport(folder.path());
  Require(composed.results == 1 && composed.page.ends_with("</html>\n"),
          "a page has the one result and is whole");
}

}  // namespace abbe::fuzz::report
