// The random streams of a rig: everything that is drawn has its own, so that one more effect
// changes no number of another.
#pragma once

#include <cstdint>

namespace abbe::rig {

enum Stream : std::uint64_t {
  kErrorStream = 0x100,           // + 6 * axis + component
  kScaleStream = 0x120,           // index: axis
  kSquarenessStream = 0x121,      // index: A0Z, B0Z, C0Y
  kProbeStream = 0x200,           // index: 4 * probe + along, across, depth, gain
  kLinearityStream = 0x202,       // index: 8 * probe + three pairs of period and phase
  kInstallationStream = 0x201,    // index: 8 * axis + three angles, three offsets, two gap settings
  kTargetStream = 0x300,          // index: three angles, three squarenesses
  kFaceStream = 0x310,            // + face: -x +x -y +y -z +z
  kRoomStream = 0x130,            // index: hour
  kResponseStream = 0x131,        // index: 12 * axis + 2 * motion, and 36 + squareness
  kLinkageStream = 0x400,         // + pivot, and one for the links, the ball and the base
  kHiddenStream = 0x500,          // the beginning of the streams of hidden effects
  kHiddenFormStream = 0x510,      // + face, as kFaceStream
  kPlateStream = 0x480,           // index: scale, then two for each hole
  kPlateRunStream = 0x100b0,      // + kRunStreams * run; index: pose of a set-up, then its holes
  kBallbarStream = 0x100a8,       // + kRunStreams * run; index: direction; of run 0: the bar
  kLengthStream = 0x100a0,        // + kRunStreams * run; index: common scale, then each length
  kNoiseStream = 0x10000,         // + kRunStreams * run + probe
  kDriftStream = 0x10008,         // + kRunStreams * run + probe
  kTemperatureStream = 0x10010,   // + kRunStreams * run + sensor, up to 16
  kEncoderNoiseStream = 0x10080,  // + kRunStreams * run + pivot
  kBallStream = 0x10088,          // + kRunStreams * run + direction
  kSeatStream = 0x1008c,          // + kRunStreams * run + direction
  kReferenceNoiseStream = 0x10090,  // + kRunStreams * run + axis
};

inline constexpr std::uint64_t kRunStreams = 0x100;
}  // namespace abbe::rig
