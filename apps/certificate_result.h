// The certificate of a map or of a calibration of the linkage, from the files of the commands that
// made it.
//
//   const CertificateSources sources{"out/map.toml", "out/fuse.json", {}, "mill.toml", {}};
//   const certificate::Certificate made = MakeCertificate(sources, certificate::Sense::kTool, 13);
//
// Units: SI. Failure: InputError where the JSON is not of that map or calibration, or of another
// machine. Source: own. Validity: no conformity is stated where the results carry a doubt
// (certificate/doubts_of_result.h).
#pragma once

#include <filesystem>

#include "certificate/certificate_of_map.h"

namespace abbe::apps {

struct CertificateSources {
  std::filesystem::path of;         // a map or a calibration
  std::filesystem::path result;     // the JSON of the command that wrote it
  std::filesystem::path diagnosis;  // of the same recordings, or empty
  std::filesystem::path machine;
  std::filesystem::path data;  // with the table [certificate]; empty: the machine file
};

// All of it, with the statements of conformity.
certificate::Certificate MakeCertificate(const CertificateSources& sources,
                                         certificate::Sense sense, int points);

}  // namespace abbe::apps
