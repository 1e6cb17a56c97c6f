component abbe_map "The error map of a machine, applied by the external offsets of LinuxCNC";
description """
Reads at load the grid that abbe export --format linuxcnc-hal wrote, and offsets X, Y and Z in each period so that the
tool stands where the program wants it: trilinear in the position of the axes, with the tool of the moment. The HAL file
beside the grid connects every pin.

The grid is that of the parameter of loadrt,
.B grid=FILE
(abbe_map.grid), seen from the folder of the INI file.

Each offset changes by at most rate * period. It starts at zero with the machine, returns to zero when enable falls, and
is held while the axes are where the map does not reach.
""";
license "Apache-2.0";
author "abbe";
see_also "https://linuxcnc.org/docs/html/motion/external-offsets.html";
option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
modparam dummy grid """The grid file""";
pin in float x "Position of the axis without external offset, in machine units; from axis.x.pos-cmd";
pin in float y "The same of Y";
pin in float z "The same of Z";
pin in float tool_x "Tool offset in effect, in machine units; from motion.tooloffset.x";
pin in float tool_y "The same of Y";
pin in float tool_z "The same of Z";
pin in float x_eoffset "Offset that LinuxCNC applies, in machine units; from axis.x.eoffset";
pin in float y_eoffset "The same of Y";
pin in float z_eoffset "The same of Z";
pin in bit machine_on "From motion.motion-enabled: the offsets are zero while it is not";
pin in bit homed "From motion.is-all-homed: nothing changes while it is not";
pin in bit enable "Apply the map; the offsets ramp to the map's and back to zero";
pin out s32 x_counts "To axis.x.eoffset-counts";
pin out s32 y_counts "To axis.y.eoffset-counts";
pin out s32 z_counts "To axis.z.eoffset-counts";
pin out float scale "To axis.[xyz].eoffset-scale: a count is 1e-6 mm";
pin out bit eoffset_enable "To axis.[xyz].eoffset-enable";
pin out float x_offset "Offset asked for, in mm";
pin out float y_offset "The same of Y";
pin out float z_offset "The same of Z";
pin out bit outside "The axes are where the map does not reach, and the last offsets are held";
pin out bit limited "The rate holds an offset back: while the map is being applied or taken away, or rate is too small";
pin out bit missed "LinuxCNC has not applied the offsets for 100 periods: OFFSET_AV_RATIO is 0, or a soft limit is near";
pin out bit applied "The map is applied: enabled, in the map, not limited and not missed";
pin out bit not_applied "Enabled and not applied; may be connected to motion.feed-inhibit";
param rw float rate = 0.5 "Most speed of an offset, mm/s";
param rw float unit_mm = 1.0 "Millimetres in a machine unit: 25.4 where LINEAR_UNITS = inch";
include "abbe_grid.h";
function _ fp "Computes the offsets; in the servo thread, after motion-controller";
;;

static char *grid = "abbe_map.grid";
RTAPI_MP_STRING(grid, "The grid file");

#define ABBE_COUNT_MM 1e-6

static abbe_grid map;
static abbe_offsets now;

EXTRA_SETUP() {
  char reason[ABBE_GRID_REASON];
  (void)__comp_inst, (void)prefix, (void)extra_arg;
  if (abbe_grid_read(grid, &map, reason)) return 0;
  rtapi_print_msg(RTAPI_MSG_ERR, "abbe_map: %s\n", reason);
  return -EINVAL;
}

EXTRA_CLEANUP() { abbe_grid_free(&map); }

static int counts_of(double mm) {
  const double counts = mm / ABBE_COUNT_MM;
  return (int)(counts < 0.0 ? counts - 0.5 : counts + 0.5);
}

FUNCTION(_) {
  const double mm = unit_mm;
  abbe_period given = {{x * mm, y * mm, z * mm},
                       {tool_x * mm, tool_y * mm, tool_z * mm},
                       {x_eoffset * mm, y_eoffset * mm, z_eoffset * mm},
                       rate * fperiod, machine_on, homed, enable};
  if (!(given.step >= 0.0)) given.step = 0.0;
  abbe_offsets_step(&map, &given, &now);
  x_counts = counts_of(now.offset[0]);
  y_counts = counts_of(now.offset[1]);
  z_counts = counts_of(now.offset[2]);
  x_offset = now.offset[0];
  y_offset = now.offset[1];
  z_offset = now.offset[2];
  scale = ABBE_COUNT_MM / mm;
  eoffset_enable = machine_on;
  outside = now.is_outside;
  limited = now.is_limited;
  missed = now.is_missed;
  applied = machine_on && homed && enable && !now.is_outside && !now.is_limited && !now.is_missed;
  not_applied = enable && !applied;
}
