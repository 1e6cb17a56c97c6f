// The set-up of head and target that an alignment leaves for the sweeps that follow: the file
// mounting.toml in their folder.
//
//   id = "first"
//   [aligned.X]
//   at = "2026-11-21T09:00:00Z"
//   top_tilt_urad = 12.5
//   side_tilt_urad = -3.0
//
// A sweep into the folder states the id in its header, and the entry of its axis as
// [mounting.aligned]. Failure: InputError with file, line and key.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace abbe::apps {

struct AlignedAxis {
  std::string at;          // "2026-11-21T09:00:00Z"
  double top_tilt = 0.0;   // rad
  double side_tilt = 0.0;  // rad
};

struct MountingFile {
  std::string id;
  std::map<char, AlignedAxis> aligned;
};

// The set-up that `folder` states; none without the file.
std::optional<MountingFile> ReadMounting(const std::filesystem::path& folder);
void WriteMounting(const MountingFile& mounting, const std::filesystem::path& folder);

// The table [mounting.aligned] of the header of a sweep; empty for an axis that is not aligned.
std::string AlignedText(const MountingFile& mounting, char axis);

}  // namespace abbe::apps
