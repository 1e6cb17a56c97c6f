// `investigate/journal.h`: of a journal that is taken, all can be asked.
#include "investigate/journal.h"

#include <stdlib.h>

#include <cmath>
#include <filesystem>

#include "fuzz/target.h"

namespace abbe::fuzz::journal {

namespace fs = std::filesystem;

// Gone with the program.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "journal-XXXXXX").string();
    Require(mkdtemp(name.data()) != nullptr, "a folder can be made");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void Read(Bytes bytes) {
  static const Folder folder;
  const InputFile file(bytes);
  const fs::path link = folder.path() / "investigation.json";
  fs::remove(link);
  fs::create_symlink(file.path(), link);
  const auto journal = investigate::Journal::In(folder.path(), {"demo-mill", "devices", 0.0});
  Require(std::isfinite(journal.started()) && std::isfinite(journal.spent()), "times are numbers");
  Require(journal.recordings().size() == journal.texts().size(), "a recording has its step");
  Require(journal.outcomes().size() <= journal.steps(), "an outcome has its step");
  Require(journal.stalled() <= std::ssize(journal.outcomes()),
          "a step that stalled has an outcome");
  if (journal.IsWaiting()) {
    Require(journal.number() == journal.steps(), "the last step is waiting");
    Require(!(journal.WaitingText() + journal.WaitingPath().string()).empty(), "it can be done");
  }
  Require(journal.Text().starts_with("Investigation of demo-mill"), "it can be read");
}

}  // namespace abbe::fuzz::journal
