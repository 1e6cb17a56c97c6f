// The journal of an investigation: every decision with what was expected, what came and what it
// cost, as data (investigation.json) and as text (investigation.txt) in the folder.
//
//   Journal journal = Journal::In(folder, {"demo-mill", "devices", started});
//   journal.Decide(choice);                 // on the disk before anything is recorded
//   journal.Recorded("01_sweep.h5");
//   journal.Diagnosed(outcome, &choice);
//
// Each change replaces the file as a whole (recording/whole_file.h), so after a crash the journal
// is what it was before or after a step, and the next call goes on from there.
// Units: minutes, bits, s since 1970. Shapes: one entry a step.
// Failure: InputError for a journal of another machine or of another kind of recording, or one that
// is no journal; DeviceError when the disk is full.
// Source: own format, docs/investigate.md.
// Validity: one program writes a folder at a time.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "investigate/choice.h"

namespace abbe::investigate {

// What a diagnosis said after a step.
struct Outcome {
  std::string verdict;
  std::vector<Probable> findings = {};
  std::vector<std::string> left = {};  // "X over feed"
  bool is_certain = false;
};
// Not certain yet.
Outcome OutcomeOf(const diagnosis::Diagnosis& diagnosis);

// What an investigation is of; another one must not go on in its folder.
struct About {
  std::string machine, recorder;  // "devices", or the rig by the hash of its description
  double started = 0.0;           // s since 1970, the first time
};

class Journal {
 public:
  // That of the folder, or a new one.
  static Journal In(const std::filesystem::path& folder, const About& about);

  // The first time.
  double started() const;
  // Minutes of the steps that were recorded.
  double spent() const;
  // Waiting one included.
  std::size_t steps() const;
  // Recordings, in the order of the steps.
  std::vector<std::filesystem::path> recordings() const;
  // The last step was decided and not recorded.
  bool IsWaiting() const;
  // What is to be done in it.
  std::string WaitingText() const;
  std::filesystem::path WaitingPath() const;  // of the planned path
  // For a reason that the last entry states.
  bool IsEnded() const;
  // One for each step that was diagnosed.
  std::vector<Outcome> outcomes() const;
  // How many of the last steps left as much open as before.
  int stalled() const;
  // What was done in the steps that were recorded.
  std::vector<std::string> texts() const;
  // The number of the next or of the waiting step, from 1.
  std::size_t number() const;
  // Where all its files are.
  const std::filesystem::path& folder() const { return folder_; }

  // The first of the weighed runs. Writes its path too.
  void Decide(const Choice& choice);
  // The file name of the waiting step, in the folder.
  void Recorded(const std::filesystem::path& recording);
  // What came of the last step, and what is open then.
  void Diagnosed(const Outcome& outcome, const Choice* then);
  // Why it ends: the last entry.
  void End(const std::string& why, const Choice* last);
  // More budget or another run: an ended one goes on.
  void Reopen();

  // As in investigation.json.
  const nlohmann::ordered_json& data() const { return data_; }
  // As in investigation.txt.
  std::string Text() const;

 private:
  Journal(std::filesystem::path folder, nlohmann::ordered_json data);
  bool IsWhole() const;
  void Write() const;
  const nlohmann::ordered_json& last() const;

  std::filesystem::path folder_;
  nlohmann::ordered_json data_;
};

}  // namespace abbe::investigate
