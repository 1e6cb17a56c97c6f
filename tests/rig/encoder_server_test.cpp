// The rig's encoders on a bus in memory, its registers on a socket, and the client that records
// both: the sibling of tests/apps/encoders_test.py, which does the same on SocketCAN in a guest.
#include "rig/encoder_server.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "hal/can_in_process.h"
#include "hal/canopen_source.h"
#include "hal/combined_source.h"
#include "hal/recorder.h"
#include "machine/machine.h"
#include "recording/recording_file.h"
#include "relm/circle_run.h"
#include "relm/linkage_model.h"
#include "relm/tip_path.h"
#include "rig/register_server.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace {

constexpr double kSpeed = 10.0;  // seconds of the machine in one of the computer

// The demonstration machine with the errors of its axes, and a linkage without any.
LinkageSettings PerfectLinkage() {
  LinkageSettings linkage = ReadLinkage(DemoMill().Root());
  linkage.link = linkage.pivot_angle = linkage.pivot_offset = linkage.encoder_offset = 0.0;
  linkage.eccentricity = linkage.graduation = linkage.bearing = linkage.base_place = 0.0;
  linkage.base_angle = linkage.ball = linkage.compliance = linkage.thermal = 0.0;
  linkage.encoder_noise = linkage.reference_noise = 0.0;
  return linkage;
}

RigSettings Mill() {
  RigSettings settings = DemoRig();
  settings.temperature_drift = 0.0;
  settings.cap = 0.0;
  settings.population.squareness = 300e-6;  // something to show
  return settings;
}

const CircleProgram kCircle{
    .centre = Eigen::Vector3d::Constant(0.03), .radius = 0.01, .feed = 0.01, .run_in = 0.25};

class EncoderServerTest : public testing::Test {
 protected:
  explicit EncoderServerTest(const LinkageSettings& settings = PerfectLinkage())
      : linkage_(world_, Linkage(settings, 7)) {
    devices_ = hal::ReadDevices(DemoMill().Root().Child("devices"));
    std::erase_if(devices_.devices, [](const auto& device) { return device.name == "head"; });
    devices_.devices[0].port = registers_.port();
    // A computer that is busy is no fault of the bus.
    devices_.max_skew = 10.0;
    devices_.canopen[0].times.answer = 0.5;
    devices_.canopen[0].times.heartbeat = 5.0;
  }
  EncoderServer Encoders() {
    return {machine_, hal::ReadDevices(DemoMill().Root().Child("devices")).canopen[0], wire_.Join(),
            clock_};
  }
  hal::OpenedDevices Open() {
    return hal::OpenDevices(devices_, clock_, hal::Presence::kRequired, {},
                            [this](const std::string&, hal::Clock&) { return wire_.Join(); });
  }

  const World world_{Mill(), 7};
  const LinkageRig linkage_;
  const Course course_ = CircleCourse(kCircle);
  hal::SteadyClock clock_{kSpeed};
  hal::CanInProcess wire_{clock_};
  LiveMachine machine_{world_, [this] { return clock_.Now(); }, &linkage_, course_};
  RegisterServer registers_{machine_, hal::ReadDevices(DemoMill().Root().Child("devices")), {}};
  hal::DevicesSettings devices_;
};

relm::CircleRun OneRun(const relm::MeasuredPath& path) {
  const auto runs = relm::CircleRuns({path});
  EXPECT_EQ(runs.size(), 1u);
  return runs.front();
}

TEST_F(EncoderServerTest, ACircleIsRecordedAndEvaluatedAsTheRigRanIt) {
  const EncoderServer encoders = Encoders();
  const hal::OpenedDevices devices = Open();
  const auto& channels = devices.source->channels();
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "encoder_server_circle.csv";
  std::filesystem::remove(file);
  const auto writer = recording::Writer::Create(
      file,
      hal::RecordHeader(
          {"demo-mill", "2026-11-21T09:00:00Z", {{"machine", "modbus"}, {"linkage", "canopen"}}},
          channels),
      hal::RecordColumns(channels));
  devices.start_cycle(kCourseProgram + 1);
  hal::RecordOptions options{.rate = 100.0, .seconds = 60.0, .passes_only = true};
  options.stopped = [this] { return machine_.Now().state == ProgramState::kDone; };
  const hal::RecordOutcome outcome = hal::Record(*devices.source, clock_, *writer, options);
  EXPECT_EQ(outcome.flagged, 0u) << outcome.worst_channel << outcome.fault;
  EXPECT_GT(encoders.syncs(), outcome.rows);

  // The linkage as its nominal parameters have it: in this world they are the true ones.
  const settings::Document mill = DemoMill();
  const relm::LinkageSettings settings = relm::ReadLinkageSettings(mill.Root());
  const machine::Machine machine = machine::ReadMachine(mill.Root());
  const relm::LinkageModel model = relm::MakeLinkageModel(settings, relm::ErrorModel::kComplete);
  const recording::Recording recorded = recording::Read(file);
  const relm::TipPath tips = relm::EvaluateTipPath(recorded, settings, model, model.Values());
  const relm::CircleRun measured = OneRun(relm::LinkagePath(
      recorded, machine.chain, tips.rows, relm::InFrame(settings.X_MB, tips.tips)));

  // What the rig knows of the same course.
  const relm::CircleRun truth =
      OneRun(relm::ReferencePath(linkage_.Record(course_, {.kind = "reference", .rate = 1000.0})));
  const auto of_linkage = relm::EvaluateCircle(measured).iso;
  const auto of_truth = relm::EvaluateCircle(truth).iso;
  ASSERT_TRUE(of_linkage.ccw && of_linkage.cw && of_linkage.both);
  EXPECT_GT(of_truth.both->G, 2e-6);
  // A count is 0.4 urad, 45 nm at the end of a link, two links and both edges of the ring.
  constexpr double kCounts = 0.2e-6;
  EXPECT_NEAR(of_linkage.ccw->G, of_truth.ccw->G, kCounts);
  EXPECT_NEAR(of_linkage.cw->G, of_truth.cw->G, kCounts);
  EXPECT_NEAR(of_linkage.both->G, of_truth.both->G, kCounts);
  EXPECT_NEAR(of_linkage.ccw->least_squares.radius, of_truth.ccw->least_squares.radius, 0.05e-6);
  EXPECT_NEAR(of_linkage.cw->least_squares.radius, of_truth.cw->least_squares.radius, 0.05e-6);
  EXPECT_NEAR(measured.feed, kCircle.feed, 1e-9);
}

TEST_F(EncoderServerTest, AnswersEverySyncThreeTimes) {
  const EncoderServer encoders = Encoders();
  hal::CanopenSource source(devices_.canopen[0], 1.0, wire_.Join(), clock_);
  source.Require();
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(source.Read().AllGood());
  EXPECT_EQ(source.counts().missing, 0u);
  EXPECT_EQ(source.counts().unasked, 0u);
  EXPECT_EQ(source.counts().syncs, encoders.syncs());
}

TEST_F(EncoderServerTest, ANodeOfAnotherNameIsRefused) {
  hal::CanopenSettings device = devices_.canopen[0];
  device.encoders[1].name = "pivot_4_rad";
  EXPECT_THROW(EncoderServer(machine_, device, wire_.Join(), clock_), InputError);
  LiveMachine bare(world_, [] { return 0.0; });
  EXPECT_THROW(EncoderServer(bare, devices_.canopen[0], wire_.Join(), clock_), InputError);
  wire_.SetState(hal::CanState::kDown);
  EXPECT_THROW(EncoderServer(machine_, devices_.canopen[0], wire_.Join(), clock_), DeviceError);
}

// The base so far away that rest is out of reach and the circle is not.
class BeyondReach : public EncoderServerTest {
 protected:
  BeyondReach() : EncoderServerTest(Far()) {}
  static LinkageSettings Far() {
    LinkageSettings linkage = PerfectLinkage();
    linkage.base_position.x() -= 58e-3;
    return linkage;
  }
};

TEST_F(BeyondReach, OutOfReachIsAnEmergencyUntilTheMachineComesIntoReach) {
  const EncoderServer encoders = Encoders();
  hal::CanopenSource source(devices_.canopen[0], 1.0, wire_.Join(), clock_);
  const auto becomes = [&](auto wanted) {
    const double until = clock_.Now() + 100.0;
    while (clock_.Now() < until) {
      if (wanted(source.Read())) return true;
    }
    return false;
  };
  EXPECT_TRUE(becomes(
      [](const hal::SampleSet& set) { return set.samples[0].cause == hal::Cause::kSensorFault; }));
  EXPECT_NE(source.Fault().find("emergency 5000h (hardware)"), std::string::npos) << source.Fault();
  EXPECT_EQ(machine_.Start(kCourseProgram), StartOutcome::kStarted);
  EXPECT_TRUE(becomes([](const hal::SampleSet& set) { return set.AllGood(); })) << source.Fault();
}

}  // namespace
}  // namespace abbe::rig
