/* The error map on a grid as a control applies it: its file, the error at a place for any tool, and
 * the offsets of X, Y and Z that a period may apply. Plain C: abbe_map.comp includes it in
 * LinuxCNC, map/export_linuxcnc_hal.cpp reads back with it what it wrote.
 *
 * abbe_grid_read() opens the file and allocates; everything else does neither and suits a realtime
 * thread.
 *
 * Frames: positions are those of the axes as the control shows them; errors are those of the tool
 * in the workpiece, actual minus nominal, along its axes; with s the sense of an axis (+1 if the
 * tool goes towards + against the workpiece as the number rises, else -1) the control adds -s times
 * the error. The tool vector is the tool point Q seen from the reference point, that of the file
 * for a tool whose length offset is zero; an offset t of the control moves it by -s t.
 * Units: mm; in the file um for errors and urad for turns.
 * Shapes: a point has 6 values, error d for Q = 0 and turn r; error = d + r x Q. x runs fastest.
 * Failure: abbe_grid_read() gives 0 and a reason with the line; a place outside the limits, or one
 * that is not finite, gives 0.
 * Source: docs/linuxcnc.md; trilinear interpolation; first order of machine/volumetric_error.h.
 * Validity: turns below 1 mrad: r x Q leaves out r^2 Q / 2, 50 nm for 1 mrad and 100 mm. Between
 * the end of the grid and a limit the error is that of the end. */
#ifndef ABBE_GRID_H
#define ABBE_GRID_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  ABBE_GRID_VALUES = 6,     /* of a point */
  ABBE_GRID_REASON = 200,   /* bytes of a reason */
  ABBE_MISSED_PERIODS = 100 /* in a row until the control counts as one that applies nothing */
};
static const double abbe_grid_most = 1e6;     /* points of a file: 48 MB */
static const double abbe_grid_largest = 10.0; /* mm: of a wrong tool or map, and refused */

typedef struct {
  double first[3], last[3];     /* of the grid, mm */
  double lowest[3], highest[3]; /* limits of use, mm */
  double sense[3];              /* +1 or -1 */
  double tool[3];               /* Q of a tool of length offset zero, mm */
  int count[3];
  double* values; /* mm and rad */
} abbe_grid;

/* What a period applies. All zero to begin with. */
typedef struct {
  double offset[3]; /* mm */
  double target[3]; /* that of the last place in the map, mm */
  int is_outside;   /* the place is not in the map: the target is held */
  int is_limited;   /* the rate held an offset back */
  int is_missed;    /* the control does not apply what was asked for */
  int missed;       /* periods since it does not */
} abbe_offsets;

/* What a period applies depends on it. */
typedef struct {
  double position[3];    /* of the axes without offsets, mm */
  double tool_offset[3]; /* of the control, mm */
  double applied[3];     /* by the control, mm */
  double step;           /* most that an offset changes, mm */
  int machine_on;        /* else all offsets are zero at once, as in the control */
  int homed;             /* else nothing changes: the control ignores it */
  int enable;            /* else the offsets return to zero */
} abbe_period;

static inline void abbe_grid_free(abbe_grid* grid) {
  free(grid->values);
  grid->values = NULL;
}

/* The next line that is no comment; 0 at the end of the file. */
static inline int abbe_grid_line(FILE* file, char* line, int size, int* number) {
  while (fgets(line, size, file) != NULL) {
    ++*number;
    if (line[0] != '#') return 1;
  }
  return 0;
}

/* `count` finite numbers and nothing else. */
static inline int abbe_grid_numbers(const char* text, double* numbers, int count) {
  for (int i = 0; i < count; ++i) {
    char* end = NULL;
    numbers[i] = strtod(text, &end);
    if (end == text || !(numbers[i] > -1e12 && numbers[i] < 1e12)) return 0;
    text = end;
  }
  return text[strspn(text, " \t\r\n")] == '\0';
}

/* A line "key n n ..." */
static inline int abbe_grid_entry(const char* line, const char* key, double* numbers, int count) {
  const size_t length = strlen(key);
  return strncmp(line, key, length) == 0 && line[length] == ' ' &&
         abbe_grid_numbers(line + length, numbers, count);
}

/* "x_mm first last count lowest highest" */
static inline int abbe_grid_take_axis(const char* line, int axis, abbe_grid* grid) {
  static const char* const keys[3] = {"x_mm", "y_mm", "z_mm"};
  double n[5];
  if (!abbe_grid_entry(line, keys[axis], n, 5)) return 0;
  grid->first[axis] = n[0];
  grid->last[axis] = n[1];
  if (!(n[2] >= 2 && n[2] <= abbe_grid_most)) return 0;
  grid->count[axis] = (int)n[2];
  grid->lowest[axis] = n[3];
  grid->highest[axis] = n[4];
  return grid->count[axis] == n[2] && n[0] < n[1] && n[3] <= n[0] && n[4] >= n[1];
}

static inline int abbe_grid_take_sense(const char* line, abbe_grid* grid) {
  if (!abbe_grid_entry(line, "sense", grid->sense, 3)) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (grid->sense[axis] != 1.0 && grid->sense[axis] != -1.0) return 0;
  }
  return 1;
}

/* Line `index` of the head; 0 where it is not what belongs there. */
static inline int abbe_grid_take_head(const char* line, int index, abbe_grid* grid) {
  double version = 0.0;
  if (index == 0) return abbe_grid_entry(line, "abbe-map-grid", &version, 1) && version == 1.0;
  if (index == 1) return abbe_grid_take_sense(line, grid);
  if (index == 2) return abbe_grid_entry(line, "tool_mm", grid->tool, 3);
  return abbe_grid_take_axis(line, index - 3, grid);
}

static inline long abbe_grid_points(const abbe_grid* grid) {
  const double points = (double)grid->count[0] * grid->count[1] * grid->count[2];
  return points <= abbe_grid_most ? (long)points : 0;
}

/* The values of the points and the last line; 0 with the reason. */
static inline int abbe_grid_take_points(FILE* file, char* line, int size, int* number,
                                        abbe_grid* grid, const char** what) {
  const long points = abbe_grid_points(grid);
  *what = "too many points; export fewer with --points";
  if (points == 0) return 0;
  grid->values = (double*)malloc((size_t)points * ABBE_GRID_VALUES * sizeof(double));
  *what = "no memory for the points";
  if (grid->values == NULL) return 0;
  *what = "not the 6 numbers of a point; the file may be cut off: export it again";
  for (long i = 0; i < points; ++i) {
    double* point = grid->values + i * ABBE_GRID_VALUES;
    if (!abbe_grid_line(file, line, size, number)) return 0;
    if (!abbe_grid_numbers(line, point, ABBE_GRID_VALUES)) return 0;
    for (int k = 0; k < 3; ++k) point[k] *= 1e-3;
    for (int k = 3; k < ABBE_GRID_VALUES; ++k) point[k] *= 1e-6;
  }
  *what = "no \"end\" behind the points; the file may be cut off: export it again";
  return abbe_grid_line(file, line, size, number) && strncmp(line, "end", 3) == 0;
}

static inline int abbe_grid_take(FILE* file, abbe_grid* grid, int* number, const char** what) {
  char line[256];
  *what =
      "not a grid for the HAL component abbe_map; write it with abbe export --format linuxcnc-hal";
  for (int i = 0; i < 6; ++i) {
    if (!abbe_grid_line(file, line, (int)sizeof(line), number)) return 0;
    if (!abbe_grid_take_head(line, i, grid)) return 0;
  }
  return abbe_grid_take_points(file, line, (int)sizeof(line), number, grid, what);
}

/* Reads a file; 1 if done. Else 0, nothing is allocated, and `reason` says why. */
static inline int abbe_grid_read(const char* path, abbe_grid* grid, char reason[ABBE_GRID_REASON]) {
  const char* what = NULL;
  int number = 0;
  memset(grid, 0, sizeof(*grid));
  FILE* file = fopen(path, "r");
  if (file == NULL) {
    snprintf(reason, ABBE_GRID_REASON, "%.80s: cannot be read", path);
    return 0;
  }
  const int is_done = abbe_grid_take(file, grid, &number, &what);
  fclose(file);
  if (is_done) return 1;
  snprintf(reason, ABBE_GRID_REASON, "%.80s:%d: %s", path, number, what);
  abbe_grid_free(grid);
  return 0;
}

/* The cell and the part of it along an axis; 0 outside the limits. */
static inline int abbe_grid_cell(const abbe_grid* grid, int axis, double q, int* cell,
                                 double* part) {
  if (!(q >= grid->lowest[axis] && q <= grid->highest[axis])) return 0;
  const int cells = grid->count[axis] - 1;
  double at = (q - grid->first[axis]) / (grid->last[axis] - grid->first[axis]) * cells;
  if (at < 0.0) at = 0.0;
  if (at > cells) at = cells;
  *cell = (int)at;
  if (*cell == cells) --*cell;
  *part = at - *cell;
  return 1;
}

/* d and r at a position of the axes; 0 outside the limits. */
static inline int abbe_grid_values(const abbe_grid* grid, const double position[3],
                                   double values[ABBE_GRID_VALUES]) {
  int cell[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    if (!abbe_grid_cell(grid, axis, position[axis], &cell[axis], &part[axis])) return 0;
  }
  for (int k = 0; k < ABBE_GRID_VALUES; ++k) values[k] = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int upper = (corner >> axis) & 1;
      at[axis] = cell[axis] + upper;
      weight *= upper ? part[axis] : 1.0 - part[axis];
    }
    const long point = at[0] + (long)grid->count[0] * (at[1] + (long)grid->count[1] * at[2]);
    const double* value = grid->values + point * ABBE_GRID_VALUES;
    for (int k = 0; k < ABBE_GRID_VALUES; ++k) values[k] += weight * value[k];
  }
  return 1;
}

/* The error of the tool point Q in the workpiece; 0 outside the limits. */
static inline int abbe_grid_error(const abbe_grid* grid, const double position[3],
                                  const double Q[3], double error[3]) {
  double v[ABBE_GRID_VALUES];
  if (!abbe_grid_values(grid, position, v)) return 0;
  error[0] = v[0] + v[4] * Q[2] - v[5] * Q[1];
  error[1] = v[1] + v[5] * Q[0] - v[3] * Q[2];
  error[2] = v[2] + v[3] * Q[1] - v[4] * Q[0];
  return 1;
}

/* The offset that puts the tool in its place at `period->position`, as abbe correct does: c = p +
 * offset with offset = -s E(c). One step from the offset of the last period: E changes by less than
 * a thousandth of what is left. 0 outside. */
static inline int abbe_grid_target(const abbe_grid* grid, const abbe_period* period,
                                   double target[3]) {
  double at[3], Q[3], error[3];
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = period->position[axis] + target[axis];
    Q[axis] = grid->tool[axis] - grid->sense[axis] * period->tool_offset[axis];
  }
  if (!abbe_grid_error(grid, at, Q, error)) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(error[axis] > -abbe_grid_largest && error[axis] < abbe_grid_largest)) return 0;
  }
  for (int axis = 0; axis < 3; ++axis) target[axis] = -grid->sense[axis] * error[axis];
  return 1;
}

/* `value` moved towards `target` by at most `step`; 1 if it is not there yet. */
static inline int abbe_approach(double* value, double target, double step) {
  const double left = target - *value;
  if (left > step) {
    *value += step;
    return 1;
  }
  if (left < -step) {
    *value -= step;
    return 1;
  }
  *value = target;
  return 0;
}

/* Whether the control has applied what the last period asked for: it follows within three periods. */
static inline void abbe_offsets_check(const abbe_period* period, abbe_offsets* now) {
  const double most = 1e-3 + 4.0 * period->step;
  int is_there = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double left = now->offset[axis] - period->applied[axis];
    is_there &= left >= -most && left <= most;
  }
  if (is_there) {
    now->missed = 0;
  } else if (now->missed < ABBE_MISSED_PERIODS) {
    ++now->missed;
  }
  now->is_missed = now->missed == ABBE_MISSED_PERIODS;
}

/* One period. */
static inline void abbe_offsets_step(const abbe_grid* grid, const abbe_period* period,
                                     abbe_offsets* now) {
  if (!period->machine_on) {
    memset(now, 0, sizeof(*now));
    return;
  }
  abbe_offsets_check(period, now);
  now->is_outside = !abbe_grid_target(grid, period, now->target);
  if (!period->homed) return;
  now->is_limited = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double target = period->enable ? now->target[axis] : 0.0;
    now->is_limited |= abbe_approach(&now->offset[axis], target, period->step);
  }
}

#ifdef __cplusplus
}
#endif

#endif
