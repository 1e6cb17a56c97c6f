// Results as a sweep of three axes and a positioning test would leave them, from closed curves:
// node sample_results.mjs FOLDER. Nothing here comes from the reduction; docs/report.md has the
// keys.
import {mkdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const PROBES = ['probe_a', 'probe_b', 'probe_c', 'probe_d', 'probe_e'];
const stations = Array.from({length: 61}, (unused, index) => index * 1e-3);

// A sum of three waves over the travel with a pseudo-random phase: smooth, repeatable.
function curve(seed, amplitude) {
  const phase = (wave) => ((seed * 7919 + wave * 104729) % 6283) / 1000;
  return stations.map(
      (at) => amplitude *
          [1, 2, 3].reduce(
              (sum, wave) =>
                  sum + Math.cos(2 * Math.PI * wave * at / 0.08 + phase(wave)) / wave ** 1.6,
              0));
}

// A linear congruential generator, for clouds of residuals.
function noiseSource(seed) {
  let state = seed >>> 0;
  const uniform = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
  return () => Math.sqrt(-2 * Math.log(uniform() + 1e-12)) * Math.cos(2 * Math.PI * uniform());
}

const range = (list) => Math.max(...list) - Math.min(...list);
const mean = (list) => list.reduce((sum, value) => sum + value, 0) / list.length;

// A bow h (x/L)^2 about the middle of the travel: all three lines are as wide as the bow is high.
function bowOf(height) {
  const half = stations.at(-1) / 2;
  return stations.map((at) => height * ((at - half) / half) ** 2);
}

// As it was measured, on a target that is not aligned.
const sloped = (values) => values.map((value, index) => value + OFFSET + SLOPE * stations[index]);

const widthAbout = (values, slope) =>
    range(values.map((value, index) => value - slope * stations[index]));

// The three lines of a curve by their definitions: through the ends, by the normal equations, and
// the slope that makes the zone narrowest (a golden-section search: the width is convex in the
// slope).
function linesOf(values) {
  const ends = (values.at(-1) - values[0]) / (stations.at(-1) - stations[0]);
  const centre = mean(stations);
  const fit = mean(stations.map((at, index) => (at - centre) * values[index])) /
      mean(stations.map((at) => (at - centre) ** 2));
  let [low, high] = [fit - 1e-3, fit + 1e-3];
  for (let step = 0; step < 100; ++step) {
    const [one, other] = [high - 0.618034 * (high - low), low + 0.618034 * (high - low)];
    [low, high] = widthAbout(values, one) < widthAbout(values, other) ? [low, other] : [one, high];
  }
  const rest = values.map((value, index) => value - low * stations[index]);
  return {
    end_points: {slope: ends, offset: values[0] - ends * stations[0]},
    least_squares: {slope: fit, offset: mean(values) - fit * centre},
    minimum_zone: {slope: low, offset: (Math.max(...rest) + Math.min(...rest)) / 2},
  };
}

// Less its least-squares line.
const level = (values) => {
  const {slope, offset} = linesOf(values).least_squares;
  return values.map((value, index) => value - offset - slope * stations[index]);
};

const straightnessOf = (values, lines, u) => ({
  u,
  ...Object.fromEntries(
      Object.entries(lines).map(([line, {slope}]) => [line, widthAbout(values, slope)]))
});

function component(unit, kind, values, u, backlash) {
  return {
    unit,
    kind,
    value: values,
    u: values.map(() => u),
    forward: values.map((value, index) => value + backlash / 2 + 0.4 * u * Math.sin(index / 3)),
    backward: values.map((value, index) => value - backlash / 2 + 0.4 * u * Math.cos(index / 2))
  };
}

const reversalOf = ({forward, backward, u}) => {
  const value = forward.map((one, index) => one - backward[index]);
  const each = Math.SQRT2 * u[0];
  return {
    value,
    u: value.map(() => each),
    mean: {value: mean(value), u: each},
    max: {value: Math.max(...value.map(Math.abs)), u: each}
  };
};

export const BOW = 1.5e-6;
const SLOPE = 4e-4;
const OFFSET = 2e-5;

export function sweepResult(axis, moves, seed) {
  const [straight_1, straight_2] = {X: ['EYX', 'EZX'], Y: ['EXY', 'EZY'], Z: ['EXZ', 'EYZ']}[axis];
  const turns = {X: ['EAX', 'EBX', 'ECX'], Y: ['EBY', 'EAY', 'ECY'], Z: [
                   'ECZ', 'EBZ', 'EAZ'
                 ]}[axis];
  const errors = {
    [turns[0]]: component('rad', 'roll', curve(seed, 12e-6), 0.31e-6, 0.2e-6),
    [turns[1]]: component('rad', 'pitch', curve(seed + 1, 18e-6), 0.28e-6, 1.9e-6),
    [turns[2]]: component('rad', 'yaw', curve(seed + 2, 9e-6), 0.44e-6, 0.1e-6),
    [straight_1]: component('m', 'straightness', level(curve(seed + 3, 0.6e-6)), 0.042e-6, 0.03e-6),
    [straight_2]: component('m', 'straightness', level(bowOf(BOW)), 0.031e-6, 0.25e-6),
  };
  const names = Object.keys(errors);
  const dwell_count = 61 * 10;
  const normal = noiseSource(seed);
  const straights = [straight_1, straight_2];
  const lines =
      Object.fromEntries(straights.map((name) => [name, linesOf(sloped(errors[name].value))]));
  return {
    abbe: '0.1.0',
    command: 'reduce',
    kind: 'sweep',
    recording: `sweep_${axis}.csv`,
    machine: 'demo-mill',
    chain: '[w X Y b Z t]',
    axis,
    moves,
    started: '2026-11-21T09:00:00Z',
    protocol: {operator: 'A. Smith', serial: 'mill 4711, head P-12'},
    conditions: {
      temp_column_c: {min: 20.08, max: 20.41, mean: 20.22},
      temp_table_c: {min: 20.31, max: 20.35, mean: 20.33},
      duration_s: 1284,
      feed_mm_min: 600
    },
    stations,
    passes: 5,
    samples: {rows: 256800, used: 61000, flagged: 12, moving: 195640, outliers: 148},
    errors,
    errors_at_target: {
      [straight_1]: {
        value: errors[straight_1].value.map(
            (value, index) => value + 0.02 * errors[turns[2]].value[index])
      }
    },
    straightness: Object.fromEntries(straights.map(
        (name) => [name, straightnessOf(sloped(errors[name].value), lines[name], 0.035e-6)])),
    straightness_lines: lines,
    angular_ranges: Object.fromEntries(turns.map(
        (name) => [name, {value: range(errors[name].value), u: 1.3 * errors[name].u[0]}])),
    reversal: Object.fromEntries(names.map((name) => [name, reversalOf(errors[name])])),
    residuals: Object.fromEntries(PROBES.map(
        (probe, which) =>
            [probe,
             Array.from(
                 {length: dwell_count},
                 (unused, index) =>
                     9e-9 * normal() + (which === 3 ? 12e-9 * Math.sin(index / 60) : 0))])),
    dwells: {
      time_s: Array.from({length: dwell_count}, (unused, index) => 2 + index * 2.1),
      station: Array.from(
          {length: dwell_count},
          (unused, index) => index % 122 < 61 ? index % 61 : 60 - index % 61),
      direction: Array.from({length: dwell_count}, (unused, index) => index % 122 < 61 ? 1 : -1),
      pass: Array.from({length: dwell_count}, (unused, index) => 1 + Math.floor(index / 122))
    },
    noise: {
      ...Object.fromEntries(PROBES.map((probe, which) => [probe, {
                                         white_m: (18 + which) * 1e-9,
                                         lag1: 0.04 * which,
                                         drift_m: (22 + 5 * which) * 1e-9
                                       }])),
      chi2: 2461.2,
      dof: 2440
    },
    budget: Object.fromEntries(names.map((name, index) => {
      const shares = {
        noise: 0.5,
        gain: 0.2 + 0.1 * index,
        position: 0.35,
        installation: 0.3,
        form: straights.includes(name) ? 0.8 : 0.4
      };
      const scale = errors[name].u[0] / Math.hypot(...Object.values(shares));
      return [
        name,
        Object.fromEntries(Object.entries(shares).map(([cause, share]) => [cause, share * scale]))
      ];
    })),
  };
}

export function referenceResult(axis) {
  const targets = Array.from({length: 11}, (unused, index) => {
    const target_mm = 30 * index + index % 3;
    const mean_up_um = 110 * (target_mm / 300) ** 1.3 + 6 * Math.sin(target_mm / 25);
    return {
      target_mm,
      mean_up_um,
      mean_down_um: mean_up_um + 25.2,
      mean_um: mean_up_um + 12.6,
      reversal_um: -25.2,
      std_up_um: 1.2 + 0.2 * (index % 4),
      std_down_um: 1.5 + 0.1 * (index % 5)
    };
  });
  return {
    abbe: '0.1.0',
    command: 'reduce',
    kind: 'reference',
    recording: `positioning_${axis}.csv`,
    machine: 'demo-mill',
    axis,
    started: '2026-11-20T14:30:00Z',
    conditions: {temp_column_c: {min: 19.9, max: 20.2, mean: 20.05}},
    iso230_2: {
      A_um: 142.3,
      A_up_um: 117.4,
      A_down_um: 118.1,
      R_um: 31.7,
      R_up_um: 7.2,
      R_down_um: 7.6,
      E_um: 138.1,
      E_up_um: 112.9,
      E_down_um: 112.9,
      M_um: 112.9,
      B_um: 27.4,
      mean_reversal_um: -25.2,
      cycles: 5,
      left_out_rows: 0,
      targets
    },
  };
}

// X moves by half the backlash against its motion, the squareness shears the circle, and the plane
// is warped twice a turn: the radial deviation in closed form.
export const BACKLASH = 4e-6;
const SHEAR = 2e-6;
const WARP = 1.5e-6;

export function circleResult() {
  const angle = Array.from({length: 360}, (unused, index) => (index + 0.5) * Math.PI / 180);
  const profile = (sense) => {
    const radial = angle.map(
        (t) => sense * BACKLASH / 2 * Math.cos(t) * Math.sign(Math.sin(t)) -
            SHEAR / 2 * Math.sin(2 * t));
    return {angle, radial, explained: radial, axial: angle.map((t) => WARP * Math.cos(2 * t))};
  };
  const harmonics = Array.from(
      {length: 10},
      (unused, index) =>
          ({order: index + 1, amplitude_um: 2 / (index + 1) ** 2, phase_deg: 10 * index}));
  const run = {
    feed_mm_min: 100,
    points: 1440,
    left_out_rows: 12,
    recordings: ['circle.csv'],
    G_ccw_um: 4.41,
    G_cw_um: 5.62,
    G_b_um: 5.62,
    F_max_um: 2.9,
    F_min_um: -2.9,
    D_um: 0.02,
    u: {G_ccw_um: 0.1, G_cw_um: 0.1, G_b_um: 0.1, F_max_um: 0.05, F_min_um: 0.05, D_um: 0.01},
    partial: false,
    start_deg: {ccw: 0.5, cw: 179.5},
    harmonics: {cw: harmonics, ccw: harmonics},
    profile: {ccw: profile(1), cw: profile(-1)},
  };
  const causes = [
    {cause: 'backlash', object: 'X', value: BACKLASH, unit: 'm', u: 3e-8, effect_um: 2, seen: true},
    {
      cause: 'squareness',
      object: 'XY',
      value: 2e-4,
      unit: 'rad',
      u: 2e-6,
      effect_um: 1,
      seen: true
    },
    {
      cause: 'servo_lag_squared',
      object: 'XY',
      value: 0,
      unit: 's2',
      u: 1,
      effect_um: 0,
      seen: false
    },
  ];
  const circle = {plane: 'XY', radius_mm: 10, filter_undulations: 0, runs: [run], causes};
  return {
    abbe: '0.1.0',
    command: 'circle',
    machine: 'demo-mill',
    started: '2026-11-21T09:00:00Z',
    plane: 'XY',
    radius_mm: 10,
    radius_is: 'programmed',
    linkage: {
      parameters: 'calibrated',
      file: 'linkage.toml',
      model: 'complete',
      mapped: false,
      held_out_rms_um: 0.2
    },
    G_b_um: 5.62,
    causes,
    circles: [{instrument: 'linkage', ...circle}, {instrument: 'reference', ...circle}],
  };
}

// A square of 50 mm that sags by 2 um in its middle.
export function squareResult() {
  const ends = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]].map((at) => at.map((one) => one * 0.05));
  const place = (index, axis) => {
    const [side, part] = [Math.floor(index / 50), index % 50 / 50];
    return ends[side][axis] * (1 - part) + ends[side + 1][axis] * part;
  };
  const list = (value) => Array.from({length: 200}, (unused, index) => value(index));
  const dz = list((index) => -2e-6 * Math.sin(Math.PI * place(index, 0) / 0.05));
  return {
    command: 'path',
    kind: 'square',
    machine: 'demo-mill',
    tests: [{
      recording: 'square.csv',
      instrument: 'linkage',
      largest_um: 2,
      rms_um: 1.4,
      sides: [{axis: 'X', nominal_mm: 50, length_error_um: 0.5, along: [], across: []}],
      path: {
        x: list((index) => place(index, 0)),
        y: list((index) => place(index, 1)),
        z: dz,
        dx: list(() => 0),
        dy: list(() => 0),
        dz
      }
    }],
  };
}

// A linkage that was off by 100 um along X and is off by 0.3 um, in a wave from pose to pose; two
// of its five parameters are told, and the cells of a mapping lift the ball by 2 um where x is
// large.
export function calibrationResult() {
  const place = (index) => [index % 4, Math.floor(index / 4) % 4, Math.floor(index / 16)];
  const residuals = Array.from({length: 64}, (unused, index) => ({
                                               recording: 'cube.csv',
                                               row: index + 1,
                                               position_mm: place(index).map((at) => 10 * at),
                                               before_um: [100, 0, 0],
                                               gap_um: [0, 0.3 * Math.sin(index), 0],
                                               held_out_um: [0, 0.4 * Math.sin(index), 0],
                                               normalised: 1
                                             }));
  const parameter = (name, unit, value, uncertainty, seen_by) =>
      ({name, unit, value, uncertainty, nominal: 0, prior: 100, seen_by});
  const centres = [0.01, 0.02];
  return {
    abbe: '0.1.0',
    simulated: true,
    command: 'calibrate',
    kind: 'calibration',
    recordings: ['cube.csv'],
    machine: 'demo-mill',
    model: 'complete',
    displacement: false,
    poses: 64,
    before: {rms_um: 100, max_um: 100},
    after: {rms_um: 0.21, max_um: 0.3},
    held_out: {rms_um: 0.28, max_um: 0.4},
    residuals_over_noise: 1,
    combinations: 5,
    combinations_seen: 2,
    scaled_condition: null,
    noise_amplification_index: 0.1,
    parameters: [
      parameter('link.link_1', 'um', 312.4, 4.1, 'data'),
      parameter('tilt.pivot_1_u', 'urad', -40, 2, 'data'),
      ...['a', 'b', 'c'].map((name) => parameter(`run_out.${name}`, 'um', 0, 99, 'prior')),
    ],
    unseen: ['a', 'b', 'c'].map(
        (name) => ({words: `1.00 run_out.${name} and 1 smaller`, share_of_prior: 0.99})),
    residuals,
    outliers: [],
    mapped: {
      cells: 8,
      centres_m: [centres, centres, centres],
      shifts_um: Array.from({length: 8}, (unused, cell) => [0, 0, cell < 4 ? 0 : 2])
    },
  };
}

// A map whose table goes 100 ppm too little along X, so that the tool comes too far in the workpiece,
// and that lifts Z by 5 um over Y; known to 0.2 um a component. A sweep contradicts, and no length
// was given.
export const STRETCH = 1e-4;
export const LIFT = 5e-6;

export function fuseResult() {
  const travel = Array.from({length: 11}, (unused, index) => 0.006 * index);
  const places = travel.flatMap((z) => travel.flatMap((y) => travel.map((x) => [x, y, z])));
  const axes = ['X', 'Y', 'Z'];
  const functions = axes.flatMap((axis) => ['X', 'Y', 'Z', 'A', 'B', 'C'].map((motion) => [
    `E${motion}${axis}`, {
      unit: 'XYZ'.includes(motion) ? 'm' : 'rad',
      from: motion === 'C' ? 'prior' : 'sweep',
      positions: travel,
      value: travel.map((at) => motion === axis ? STRETCH * at : 0),
      u: travel.map((at) => 1e-5 * at),
    }
  ]));
  const squareness = ['A0Z', 'B0Z', 'C0Y'].map(
      (name, index) => [name, {unit: 'rad', value: (index + 1) * 1e-5, u: 2e-6, from: 'linkage'}]);
  const run = (name, kind, probability) => ({
    run: name,
    kind,
    rows: 5000,
    chi2: 4988.2,
    redundancy: 4900,
    outliers: 3,
    agreement: {statistic: 40.2, directions: 12, p: probability}
  });
  return {
    abbe: '0.1.0',
    command: 'fuse',
    machine: 'demo-mill',
    chain: '[w X Y b Z t]',
    scale: {value_ppm: 3.1, u_ppm: 18, prior_ppm: 20, statement: 'prior only'},
    smoothness_mm: 15,
    observability: Object.fromEntries([...functions, ...squareness].map(([name, {from}]) => [
      name, {prior: 2e-5, u: 1e-6, determined_by: from === 'prior' ? [] : [from]}
    ])),
    chi2: [run('a/sweep_X.csv', 'sweep', 1e-5), run('volume.csv', 'linkage', 0.4)],
    contradictions: ['a/sweep_X.csv'],
    widened: 1.83,
    misfits: ['volume.csv'],
    scatter: [{run: 'a/volume.csv', axis: 'Z', sd_um: 2.93}],
    reversals: [{error: 'EBX', value: -13.21, u: 0.06, unit: 'urad'}],
    parameters: [
      {
        name: 'EXX.c0', unit: 'um', value: 1, uncertainty: 0.1, nominal: 0, prior: 2,
        seen_by: 'data'
      },
      {
        name: 'base.x', unit: 'um', value: 12, uncertainty: 2, nominal: 0, prior: 100,
        seen_by: 'data'
      }
    ],
    map: {
      tool: [0, 0, -0.08],
      signs: [-1, -1, 1],
      temperature_c: 20,
      grid: {
        x: travel,
        y: travel,
        z: travel,
        error: [
          places.map(([x]) => STRETCH * x), places.map(() => 0),
          places.map(([, y]) => LIFT * y / 0.06)
        ],
        u: [0, 1, 2].map(() => places.map(() => 2e-7)),
      },
      errors: Object.fromEntries([...functions, ...squareness]),
    },
  };
}

export function simulateResult() {
  return {
    abbe: '0.1.0',
    command: 'simulate',
    machine: 'demo-mill',
    map: 'map.toml',
    scale: 'calibrated',
    test: 'circle',
    as_is: {'G XY um': 12.4, 'F_min XY um': -6.1},
    corrected_95: {'G XY um': 0.8, 'F_min XY um': 0.5},
  };
}

export function correctResult() {
  return {
    abbe: '0.1.0',
    command: 'correct',
    kind: 'program',
    machine: 'demo-mill',
    map: 'map.toml',
    from: 'part.ngc',
    out: 'part_corrected.ngc',
    lines: 20,
    moves: 15,
    corrected: 480,
    largest_um: 13.2,
    line_mm: 0.9,
    chord_um: 1
  };
}

export function exportResult() {
  return {
    abbe: '0.1.0',
    command: 'export',
    machine: 'demo-mill',
    map: 'map.toml',
    format: 'isg',
    files: ['out/map.csv'],
    drops: 'uncertainty',
    largest_difference_um: 0.52,
    rms_difference_um: 0.14,
    largest_error_um: 27
  };
}

// A machine with 6 um of backlash in X that is certain, and a gain that could be crosstalk too.
export function diagnosisResult() {
  const steps = Array.from({length: 60}, (unused, index) => index);
  return {
    abbe: '0.1.0',
    command: 'diagnose',
    machine: 'demo-mill',
    recordings: ['01_sweep_X.h5', '04_circle_XY.h5'],
    verdict: 'ambiguous',
    cannot_show: ['probe-position:probe_a', 'squareness:XZ'],
    findings: [
      {
        cause: 'backlash',
        object: 'X',
        probability: 1,
        log_evidence: 812.4,
        words: {
          what: 'the axis loses a fixed distance whenever it turns round',
          shows: 'forward and backward runs differ by a constant',
          check: 'play of nut, bearing and coupling',
          remedy: 'preload or replace the nut'
        },
        parameters: [{name: 'width_um', quantity: 'width', value: 6.02, unit: 'um', u95: 0.08}],
        rms_before: 1.9,
        rms_after: 1.01,
        heldout_rms_before: 1.88,
        heldout_rms_after: 1.03,
        gain: 0.45,
        curve: {
          variable: 'x, mm',
          unit: 'um',
          x: steps,
          before: steps.map((step) => (step % 2 ? 3 : -3) + 0.2 * Math.sin(step)),
          after: steps.map((step) => 0.2 * Math.sin(step))
        }
      },
      {
        cause: 'probe-gain',
        object: 'probe_b',
        probability: 0.62,
        log_evidence: 31.2,
        parameters: [{name: 'delta', quantity: 'delta', value: 0.0312, unit: '', u95: 0.004}],
        rms_before: 0.975,
        rms_after: 0.974,
        heldout_rms_before: 0.971,
        heldout_rms_after: 0.97
      }
    ],
    rivals: [{
      causes: ['probe-gain:probe_b', 'probe-crosstalk:probe_b+probe_c'],
      odds: [0.62, 0.37],
      next_run: 'move the gap of probe b alone',
      expected_odds: 0.999
    }],
    unexplained: [{
      variable: 'time',
      object: 'probe_d',
      amplitude: 0.224,
      unit: 'um',
      p_value: 2e-44,
      from: 481.1,
      to: 500.8,
      variable_unit: 's'
    }],
    heldout: {rows: 1240, rms_before: 1.88, rms_after: 1.03},
    chi2_per_row_before: 3.61,
    chi2_per_row_after: 1.02,
    noise_floor: 1,
    map_change_um: null,
    evidence: steps.slice(0, 12).map((step) => ({
                                       cause: 'servo-lag',
                                       object: 'XYZ'[step % 3],
                                       log_evidence: 10 - step,
                                       visible_sd: 4 + step
                                     }))
  };
}

// The first cause of the above beside something that no known cause makes: without advice.
export function diagnosisInPart() {
  const result = diagnosisResult();
  const [{words: {what, shows}, ...finding}] = result.findings;
  const run = (variable, index) => ({
    variable,
    object: `${String(index).padStart(2, '0')}_run_of_day_${index}`,
    amplitude: 0.5 + index / 10,
    unit: 'times the noise',
    p_value: 10 ** -index
  });
  const unexplained = [
    ...result.unexplained, ...[3, 4, 5, 6, 7, 8, 9, 10, 11, 12].map((index) => run('scatter', index)),
    ...[3, 4].map((index) => run('memory', index)),
    {variable: 'scatter at rest', object: 'probe_c', amplitude: 5.1, unit: 'times the noise', p_value: 1e-30}
  ];
  return {
    ...result, verdict: 'unexplained', rivals: [], unexplained, findings: [{...finding, words: {what, shows}}]
  };
}

// Two causes that a set of runs shows and confuses, and one that it does not.
export function planResult() {
  const cause = (name, object, visible_sd, sizes) =>
      ({cause: name, object, visible_sd, seen: visible_sd > 6, sizes});
  return {
    abbe: '0.1.0',
    command: 'diagnose-plan',
    machine: 'demo-mill',
    runs: ['01_sweep_X.h5', '04_circle_XY.h5'],
    causes: [
      cause('servo-lag', 'X', 40.2, [{name: 'delay_ms', quantity: 'delay', unit: 'ms', seen_from: 0.075, plausible: 0.5}]),
      cause('clock-skew', 'linkage', 38, [{name: 'delay_ms', quantity: 'delay', unit: 'ms', seen_from: 0.08, plausible: 0.5}]),
      cause('channel-sign', 'probe_a', 900, []),
      cause('probe-gain', 'probe_b', 1.25, [{name: 'delta', quantity: 'delta', unit: '', seen_from: 0.048, plausible: 0.01}])
    ],
    cannot_show: ['probe-gain:probe_b'],
    confused: [{causes: ['servo-lag:X', 'clock-skew:linkage'], cosine: 0.9712}]
  };
}

// Two runs, after the second of which the verdict is certain; one name tries to leave its element.
export function investigationResult() {
  const weighed = (text, minutes, bits) => ({text, minutes, bits, bits_per_minute: bits / minutes});
  const step = (number, text, [set_up, run], bits, entropy_bits, next, after) => ({
    number,
    text,
    minutes: {set_up, waiting: 0, run, total: set_up + run},
    bits,
    before: {entropy_bits, nothing: 0.85, worlds: [{name: 'nothing', probability: 0.85}],
             weighed: [weighed(text, set_up + run, bits), weighed(next, 20, bits / 2)], never_shown: []},
    path: `0${number}_path.csv`,
    file: `0${number}_run.h5`,
    after
  });
  return {
    command: 'investigate',
    machine: 'demo-mill',
    recorder: 'devices',
    started: '2026-11-21T08:00:00Z',
    steps: [
      step(1, 'record a circle in XY', [10, 3], 0.317, 1.45, '<img src=x onerror="window.escaped = true">',
           {verdict: 'clean', findings: [], left: [], certain: false}),
      step(2, 'sweep X over its travel', [15, 2], 0.273, 1.22, 'sweep Y over its travel',
           {verdict: 'explained', findings: [{name: 'backlash:X', probability: 0.9996}], left: [], certain: true})
    ],
    ended: {why: 'the verdict is certain', minutes: 30, verdict: 'explained', certain: true}
  };
}

// Limits that are kept, not kept, undecided and without a figure; one name tries to leave its element.
export function checkResult() {
  const check = (name, verdict, value, U95, limit, unit = 'um', conditions = '') =>
      ({name, verdict, value, U95, limit, unit, conditions, U95_from: 'result'});
  return {
    abbe: '0.1.0',
    command: 'history',
    kind: 'check',
    machine: 'demo-mill',
    of: '<img src=x onerror="window.escaped = true">',
    rule: 'pass: |value| + U95 <= limit; fail: |value| - U95 > limit (ISO 14253-1)',
    counts: {pass: 1, fail: 1, undecided: 1, 'not measured': 1},
    checks: [
      check('EYX straightness', 'pass', 2.34, 0.12, 3),
      check('XY circularity', 'fail', 6.1, 0.4, 5, 'um', 'linkage, R 20 mm, F 300'),
      check('X positioning A', 'undecided', 7.9, null, 8), check('volumetric', 'not measured', null, null, 25)
    ],
  };
}

// 0.05 um a day from 3 um on, which meets 6 um on day 60; and a squareness that does not drift, with a
// campaign of a clock that was wrong.
const DAY = 86400e3;
const trendInstant = (day) => new Date(Date.UTC(2026, 9, 1) + day * DAY).toISOString().replace('.000', '');
export function trendResult() {
  const days = [0, 10, 20, 30, 40];
  const series = (object, name, unit, value, U95, more) => ({
    object,
    name,
    unit,
    conditions: '',
    points: days.map((day, index) => ({
                       campaign: index + 1,
                       measured: trendInstant(day),
                       value: value(day),
                       U95,
                       used: true
                     })),
    notes: [],
    ...more
  });
  const line = (last, value) => {
    const at = Array.from({length: 11}, (_, index) => last * index / 10);
    return {measured: at.map(trendInstant), value: at.map(value), U95: at.map(() => 0.2)};
  };
  const straightness = series('EYX', 'EYX straightness', 'um', (day) => 3 + 0.05 * day, 0.2, {
    signed: false,
    limit: 6,
    fit: {rate_per_day: 0.05, U95_rate_per_day: 0.01, excess_scatter: 0, drifts: true},
    line: line(60, (day) => 3 + 0.05 * day),
    limit_reached: {
      already: false,
      expected: trendInstant(60),
      earliest: trendInstant(53),
      latest: trendInstant(71)
    },
    words: 'it changes by 1.50 +- 0.30 um a month',
  });
  const squareness = series('C0Y', 'C0Y squareness', 'urad', () => -12, 4, {
    signed: true,
    limit: 30,
    fit: {rate_per_day: 0, U95_rate_per_day: 0.1, excess_scatter: 0.5, drifts: false},
    line: line(40, () => -12),
    limit_reached: {already: false, expected: null, earliest: null, latest: null},
    words: 'no drift is seen: 0.0 +- 3.0 urad a month',
    notes: ['1 of its campaigns is dated in the future (campaign 6, 2036-01-01T00:00:00Z)'],
  });
  squareness.points.push(
      {campaign: 6, measured: '2026-12-24T00:00:00Z', value: -11, U95: 4, used: false});
  return {
    abbe: '0.1.0',
    command: 'history',
    kind: 'trend',
    machine: 'demo-mill',
    series: [straightness, squareness],
    notes: ['campaign 5 was added after campaign 4 but is dated before it'],
  };
}

// A curve and a figure of which one changed significantly.
export function comparisonResult() {
  const campaign = (number, day, note) =>
      ({campaign: number, machine: 'demo-mill', measured: trendInstant(day), note});
  const positions_mm = [0, 15, 30, 45, 60];
  return {
    abbe: '0.1.0',
    command: 'history',
    kind: 'comparison',
    machine: 'demo-mill',
    before: campaign(1, 0, 'before <b>service</b>'),
    after: campaign(5, 40, ''),
    family_level: 0.05,
    differences: [
      {
        name: 'EYX curve',
        object: 'EYX',
        unit: 'um',
        conditions: 'sweep',
        before: 0.2,
        after: 2.2,
        change: 2,
        U95: 0.3,
        p: 2e-9,
        significant: true,
        shared: ['head'],
        words: 'EYX at 30 mm changed by 2.00 +- 0.30 um',
        at_mm: 30,
        curve: {positions_mm, change: [0, 1, 2, 1, 0], U95: [0.3, 0.3, 0.3, 0.3, 0.3]}
      },
      {
        name: 'XY circularity',
        object: 'XY',
        unit: 'um',
        conditions: 'F 300',
        before: 4,
        after: 4.1,
        change: 0.1,
        U95: 0.4,
        p: 0.62,
        significant: false,
        shared: [],
        words: 'XY circularity grew by 0.10 +- 0.40 um'
      }
    ],
    only_before: [],
    only_after: ['C0Y.urad'],
    new_findings: [{cause: 'servo-lag', object: 'X', probability: 0.98}],
    gone_findings: [],
  };
}

export function writeSamples(folder) {
  mkdirSync(folder, {recursive: true});
  const write = (name, content) => writeFileSync(join(folder, name), content);
  const results = {
    'sweep_X.json': sweepResult('X', 'target', 11),
    'sweep_Y.json': sweepResult('Y', 'target', 42),
    'sweep_Z.json': sweepResult('Z', 'head', 73),
    'positioning_X.json': referenceResult('X'),
    'circle.json': circleResult(),
    'square.json': squareResult(),
    'linkage.json': calibrationResult(),
    'fuse.json': fuseResult(),
    'simulate.json': simulateResult(),
    'correct.json': correctResult(),
    'export.json': exportResult(),
    'diagnosis.json': diagnosisResult(),
    'diagnosis_in_part.json': diagnosisInPart(),
    'plan.json': planResult(),
    'investigation.json': investigationResult(),
    'history_check.json': checkResult(),
    'history_trend.json': trendResult(),
    'history_compare.json': comparisonResult(),
    // A result of a later version: no section of its own, and text that tries to leave its element.
    'compare_X.json': {
      abbe: '0.1.0',
      command: 'rig-compare',
      axis: 'X',
      pulls: {EAX: [0.3, -1.2]},
      remark: '</script><script>window.escaped = true</script><!--'
    },
    // What an early or a partial reduction may leave out.
    'early.json': {
      command: 'reduce',
      kind: 'sweep',
      axis: 'X',
      stations: [0, 0.01, 0.02],
      errors: {EAX: {unit: 'rad', kind: 'roll', value: [0, null, 2e-6], u: 1e-7}}
    },
  };
  for (const [name, result] of Object.entries(results)) write(name, JSON.stringify(result));
  write('cut_short.json', '{"command": "reduce", "kind"');
  write('package.json', '{"name": "foreign"}');
  return Object.keys(results);
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) writeSamples(process.argv[2]);
