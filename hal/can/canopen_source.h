// The encoders of one CAN bus as a source of samples: abbe is the master of the network.
//
// One Read() is one SYNC: it is sent, the PDOs that answer it are collected, and every sample is
// stamped with the time at which the SYNC passed the bus, when the encoders latch their counts. A
// PDO that answers no SYNC (late, doubled) is discarded and counted; after a missing one the next
// SYNC waits until twice the answer time has passed, so that a late one is not mistaken for its
// answer; so it does after a foreign SYNC, which is answered too. With `sync_ms = 0` abbe sends no
// SYNC and uses those of another device, or, where there are none, the PDOs as they arrive.
//
// A node that restarts has lost its reference: its samples are bad until ConfirmReference(). This
// is the one fault from which a source does not recover by itself.
// Units: rad, s of the clock.
// Failure: DeviceError from Require; else a bad sample with its cause.
// Source: CiA 301, CiA 406.
// Validity: encoders latch at the SYNC; the stamp is off by the length of the SYNC frame, 0.05
// ms at 1 Mbit/s.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "hal/can/can_bus.h"
#include "hal/can/canopen_node.h"
#include "hal/can/encoder_judge.h"
#include "hal/clock.h"
#include "hal/transport.h"

namespace abbe::hal {

struct CanopenCounts {
  std::uint64_t syncs = 0;    // received
  std::uint64_t missing = 0;  // answers that did not arrive in time
  std::uint64_t unasked = 0;  // PDOs that answered no SYNC
  std::uint64_t short_frames = 0;
  std::uint64_t restarts = 0;  // of nodes, by themselves
};

class CanopenSource : public DeviceSource {
 public:
  enum class Part {
    kMaster,    // identifies, starts and SYNCs the nodes
    kListener,  // sends nothing; for a bus that another commands, and for replays
  };

  // `bus` gives the stamps of `clock`, which must outlive the source; `stale_s` as in
  // DevicesSettings. Sends nothing yet.
  CanopenSource(const CanopenSettings& settings, double stale_s, std::unique_ptr<CanBus> bus,
                Clock& clock, Log log = {}, Part part = Part::kMaster);

  // DeviceError that names the node which does not answer as described.
  void Require() override;
  // For the header of a recording.
  std::string Description() const override { return "canopen"; }
  // Ends a loss of reference: the next counts are taken as the angles nearest to zero. To be called
  // when a person has brought the linkage to a pose where they are.
  void ConfirmReference();

  const std::vector<Channel>& channels() const override { return channels_; }
  // One SYNC and its answers.
  SampleSet Read() override;
  // At the end of a log.
  bool Ended() const override { return bus_->Ended() && !ahead_; }
  // With the name of the device.
  std::string Fault() const override;

  const CanopenCounts& counts() const { return counts_; }
  const CanBus& bus() const { return *bus_; }

 private:
  struct Encoder {
    EncoderSettings settings;
    CanopenNode node;
    EncoderJudge judge;
    std::optional<ReceivedFrame> answer;  // to the present SYNC
    bool silent = false;                  // has not answered the SYNC before
    bool owes = false;                    // that answer may still arrive
    bool too_short = false;
  };
  enum class Cycle { kThis, kNext };  // to which a frame belongs
  bool produces() const { return part_ == Part::kMaster && settings_.times.sync > 0.0; }
  double Span(double seconds) const { return seconds * clock_.speed(); }  // of real time
  Cycle Hear(const ReceivedFrame& received);
  Cycle HearSync(const ReceivedFrame& received);
  Cycle HearPdo(Encoder& encoder, const ReceivedFrame& received);
  void Listen(double until_s);  // handles all frames until then
  // Until no answer to the SYNC before is owed. After two SYNCs in one cycle (`doubled`) nobody knows
  // whose answer an answer is: then the whole time is waited.
  void AwaitLateAnswers(bool doubled);
  void Command();  // sends the requests that are due, then the SYNC
  void Collect();
  bool Complete(double now_s) const;
  Sample SampleOf(Encoder& encoder, bool torn, double now_s);
  std::string FaultNow(double now_s) const;
  DeviceError Error(const std::string& fault) const;
  void Note(const std::string& fault);

  CanopenSettings settings_;
  std::unique_ptr<CanBus> bus_;
  Clock& clock_;
  Log log_;
  Part part_;
  std::vector<Encoder> encoders_;
  std::vector<Channel> channels_;
  std::optional<double> sync_s_;        // of the present SYNC
  double sent_s_ = 0.0;                 // of the last one sent
  bool sync_heard_ = false;             // ever
  bool sync_due_ = false;               // sent and not yet received
  bool foreign_sync_ = false;           // received one that was not sent
  std::optional<ReceivedFrame> ahead_;  // the frame that began the next cycle (listener)
  std::uint64_t lost_before_ = 0, lost_now_ = 0;
  bool errors_ = false;  // the controller has counted many, and the bus still works
  std::uint64_t sequence_ = 0;
  std::string fault_;
  CanopenCounts counts_;
};

}  // namespace abbe::hal
