// The rig's encoders on a bus in memory, its registers on a socket, and the client that records
// both: the sibling of tests/apps/encoders_test.py, which does the same on SocketCAN in a guest.
#include "rig/encoder_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "hal/can/can_in_process.h"
#include "hal/can/canopen_device.h"
#include "hal/can/canopen_source.h"
#include "hal/combined_source.h"
#include "hal/modbus/modbus_device.h"
#include "hal/recorder.h"
#include "machine/machine.h"
#include "paths/circle_run.h"
#include "recording/recording_file.h"
#include "relm/linkage_model.h"
#include "relm/tip_path.h"
#include "rig/register_server.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace encoder_server_test {

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

// A clock that several threads look at and one moves: time passes only where the client waits.
class SharedHandClock : public hal::Clock {
 public:
  double Now() override { return now_s_; }
  void SleepUntil(double time_s) override { now_s_ = std::max(time_s, now_s_.load()); }
  void WaitUntil(double time_s, std::unique_lock<std::mutex>&, std::condition_variable&) override {
    SleepUntil(time_s);
  }

 private:
  std::atomic<double> now_s_{0.0};
};

hal::DevicesSettings Devices() { return hal::ReadDevices(DemoMill().Root().Child("devices")); }
hal::CanopenSettings EncodersOnCan() {
  return hal::SettingsOf<hal::CanopenDevice>(Devices()).at(0);
}

paths::CircleRun OneRun(const paths::MeasuredPath& path) {
  const auto runs = paths::CircleRuns({path});
  EXPECT_EQ(runs.size(), 1u);
  return runs.front();
}

// Nothing of it depends on how quick the computer is.
TEST(LinkageEncoders, ACircleIsRecordedAndEvaluatedAsTheRigRanIt) {
  const World world(Mill(), 7);
  const LinkageRig linkage(world, Linkage(PerfectLinkage(), 7));
  const Course course = CircleCourse(kCircle);
  SharedHandClock clock;
  LiveMachine machine(
      world, [&clock] { return clock.Now(); }, &linkage, course);
  const RegisterServer registers(machine, Devices(), {});
  hal::CanInProcess wire(clock);
  std::unique_ptr<hal::CanBus> bus;
  LinkageEncoders encoders(machine, EncodersOnCan(),
                           [&bus](const hal::CanFrame& frame) { bus->Send(frame); });
  bus = wire.Join([&encoders](const hal::ReceivedFrame& heard) { encoders.Hear(heard.frame); });
  encoders.Boot();

  hal::ModbusSettings positions = hal::SettingsOf<hal::ModbusDevice>(Devices()).at(1);
  ASSERT_EQ(positions.name, "machine");
  positions.port = registers.port();
  positions.times.response = 5.0;
  positions.times.deadline = 10.0;
  hal::CanopenSettings pivots = EncodersOnCan();
  pivots.times.heartbeat = 0.0;  // nobody beats while time stands
  hal::DevicesSettings both = Devices();
  both.devices = {std::make_shared<hal::ModbusDevice>(positions),
                  std::make_shared<hal::CanopenDevice>(
                      pivots, [&wire](const std::string&, hal::Clock&) { return wire.Join(); })};
  const hal::OpenedDevices devices = hal::OpenDevices(both, clock, hal::Presence::kRequired);
  const auto& channels = devices.source->channels();
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "linkage_encoders_circle.csv";
  std::filesystem::remove(file);
  const auto writer = recording::Writer::Create(
      file,
      hal::RecordHeader(
          {"demo-mill", "2026-11-21T09:00:00Z", {{"machine", "modbus"}, {"linkage", "canopen"}}},
          channels),
      hal::RecordColumns(channels));
  devices.start_cycle(kCourseProgram + 1);
  hal::RecordOptions options{.rate = 100.0, .seconds = 60.0, .passes_only = true};
  options.stopped = [&machine] { return machine.Now().state == ProgramState::kDone; };
  const hal::RecordOutcome outcome = hal::Record(*devices.source, clock, *writer, options);
  EXPECT_EQ(outcome.flagged, 0u) << outcome.worst_channel << outcome.fault;
  EXPECT_GT(encoders.syncs(), outcome.rows);

  // The linkage as its nominal parameters have it: in this world they are the true ones.
  const settings::Document mill = DemoMill();
  const relm::LinkageSettings settings = relm::ReadLinkageSettings(mill.Root());
  const machine::Machine described = machine::ReadMachine(mill.Root());
  const relm::LinkageModel model = relm::MakeLinkageModel(settings, relm::ErrorModel::kComplete);
  const recording::Recording recorded = recording::Read(file);
  const relm::TipPath tips = relm::EvaluateTipPath(recorded, settings, model, model.Values());
  const paths::CircleRun measured = OneRun(paths::LinkagePath(
      recorded, described.chain, tips.rows, relm::InFrame(settings.X_MB, tips.tips)));

  // What the rig knows of the same course.
  const paths::CircleRun truth =
      OneRun(paths::ReferencePath(linkage.Record(course, {.kind = "reference", .rate = 1000.0})));
  const auto of_linkage = paths::EvaluateCircle(measured).iso;
  const auto of_truth = paths::EvaluateCircle(truth).iso;
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

// The server's thread, on the computer's clock.
class EncoderServerTest : public testing::Test {
 protected:
  explicit EncoderServerTest(const LinkageSettings& settings = PerfectLinkage())
      : linkage_(world_, Linkage(settings, 7)) {
    // A computer that is busy is no fault of the bus.
    device_.times.answer = device_.times.heartbeat = 10.0;
  }
  std::unique_ptr<hal::CanopenSource> Client() {
    return std::make_unique<hal::CanopenSource>(device_, 100.0, wire_.Join(), clock_);
  }

  const World world_{Mill(), 7};
  const LinkageRig linkage_;
  const Course course_ = CircleCourse(kCircle);
  hal::SteadyClock clock_;
  hal::CanInProcess wire_{clock_};
  LiveMachine machine_{world_, [this] { return clock_.Now(); }, &linkage_, course_};
  hal::CanopenSettings device_ = EncodersOnCan();
};

TEST_F(EncoderServerTest, AnswersEverySyncThreeTimes) {
  const EncoderServer encoders(machine_, device_, wire_.Join(), clock_);
  const auto client = Client();
  client->Require();
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(client->Read().AllGood());
  EXPECT_EQ(client->counts().missing, 0u);
  EXPECT_EQ(client->counts().unasked, 0u);
  EXPECT_EQ(client->counts().syncs, encoders.syncs());
}

TEST_F(EncoderServerTest, WhatItCannotServeIsRefused) {
  hal::CanopenSettings device = device_;
  device.encoders[1].name = "pivot_4_rad";
  EXPECT_THROW(EncoderServer(machine_, device, wire_.Join(), clock_), InputError);
  LiveMachine bare(world_, [] { return 0.0; });
  EXPECT_THROW(EncoderServer(bare, device_, wire_.Join(), clock_), InputError);
  wire_.SetState(hal::CanState::kDown);
  EXPECT_THROW(EncoderServer(machine_, device_, wire_.Join(), clock_), DeviceError);
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
  const EncoderServer encoders(machine_, device_, wire_.Join(), clock_);
  const auto client = Client();
  const auto becomes = [&](auto wanted) {
    const double until = clock_.Now() + 30.0;
    while (clock_.Now() < until) {
      if (wanted(client->Read())) return true;
    }
    return false;
  };
  EXPECT_TRUE(becomes(
      [](const hal::SampleSet& set) { return set.samples[0].cause == hal::Cause::kSensorFault; }));
  EXPECT_NE(client->Fault().find("emergency 5000h (hardware)"), std::string::npos)
      << client->Fault();
  EXPECT_EQ(machine_.Start(kCourseProgram), StartOutcome::kStarted);
  EXPECT_TRUE(becomes([](const hal::SampleSet& set) { return set.AllGood(); })) << client->Fault();
}

}  // namespace encoder_server_test
}  // namespace abbe::rig
