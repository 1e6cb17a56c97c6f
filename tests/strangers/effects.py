"""Hidden effects that no catalogue was asked about: one small function each, with random size and place.

A function takes a random generator and the runs of the campaign and returns an Effect. Its hooks change the
world where the effect acts:

  carriage(run)        more error motions of an axis: {axis: (n, 6)} in m and rad
  travel(run)          where the axes truly stand less what is recorded, (n, 3) in m
  gaps(run, gaps)      more gap, (n, 5) in m         angles(run, angles)  more angle, (n, 3) in rad
  columns(run)         columns of the user's own, {name: (n,)}
  ball(run)            how far the ball stands off in its cap, (n, 3) in m
  probe_noise, encoder_noise (draw, run, columns)    noise in units of the stated one, in its place
  machine              arguments of machine.Machine   form  factor of the target's form
"""
import dataclasses

import numpy as np

from machine import TRAVEL

AXES = "XYZ"


@dataclasses.dataclass
class Effect:
    hooks: dict
    says: str  # where it is and how large, for the reader
    named_by: tuple = ()  # a leftover in one of these variables, or of one of these objects, has found the place
    # Findings that are honestly the same thing: (cause, object or None, {parameter: (lowest, highest)}).
    same_as: tuple = ()
    truth: dict = dataclasses.field(default_factory=dict)  # its sizes, where a cause has them: {parameter: value}


def size(draw, low, high):
    """Log-uniform, of either sign."""
    return draw.choice([-1, 1]) * np.exp(draw.uniform(np.log(low), np.log(high)))


def motion(axis, component, values):
    more = np.zeros((len(values), 6))
    more[:, component] = values
    return {AXES[axis]: more}


def span(runs):
    return runs[-1].clock[-1]


def warmth(runs, sensor):
    """Mean and standard deviation of a temperature over the campaign."""
    all_of_it = np.concatenate([r.temps[:, sensor] for r in runs])
    return all_of_it.mean(), all_of_it.std()


def play_of(k):
    """What play along an axis honestly is: how wide, that the width varies, and where the axis stands after it."""
    return tuple((cause, AXES[k], {}) for cause in ("backlash", "varying-backlash", "standing-position"))


# ---- the machine

def angular_play(draw, runs):
    k, c, h = draw.integers(3), draw.integers(3, 6), size(draw, 2e-6, 2e-5)
    return Effect({"carriage": lambda r: motion(k, c, h / 2 * r.sense[:, k])},
                  f"E{'ABC'[c - 3]}{AXES[k]} jumps by {h * 1e6:.1f} urad at reversal", ("direction", "reversal"))


def growing_bow(draw, runs):
    k, h = draw.integers(3), size(draw, 2e-7, 2e-6)
    c = draw.choice([m for m in range(3) if m != k])
    bow = lambda r: h * 4 * r.q[:, k] / TRAVEL * (1 - r.q[:, k] / TRAVEL) * r.clock / span(runs)
    return Effect({"carriage": lambda r: motion(k, c, bow(r))},
                  f"{AXES[k]} bows by {h * 1e6:.2f} um towards {AXES[c]} until the end", ("time", "pass"))


def varying_play(draw, runs):
    k, h, place = draw.integers(3), size(draw, 5e-7, 5e-6), draw.uniform(0.015, 0.045)
    width = lambda q: h * np.exp(-(((q - place) / 0.012) ** 2))
    return Effect({"travel": lambda r: np.eye(3)[k] * (width(r.q[:, k]) * r.sense[:, k] / 2)[:, None]},
                  f"{AXES[k]} has {h * 1e6:.2f} um of play about {place * 1e3:.0f} mm only",
                  ("direction", "xyz"[k]), play_of(k))


def product_of_positions(draw, runs):
    i, j = draw.permutation(3)[:2]
    c, h = draw.integers(3), size(draw, 1e-6, 1e-5)
    # The third axis moved alike, were it that: X and Y carry the workpiece, Z the tool.
    k = h if (i == 2) != (c == 2) else -h
    found = tuple(sorted((0.8 * k * 1e9 / 3600, 1.2 * k * 1e9 / 3600)))  # nm over the travels of 60 mm by 60 mm
    same = tuple(("load-coupling", AXES[a] + AXES[b], {"coefficient_nm_per_mm2": found})
                 for a, b in ((i, j), (j, i)) if c not in (i, j))
    return Effect({"carriage": lambda r: motion(i, c, h * (r.q[:, i] / TRAVEL) * (r.q[:, j] / TRAVEL))},
                  f"{AXES[i]} moves along {AXES[c]} by {h * 1e6:.1f} um times both positions, {AXES[i]} and {AXES[j]}",
                  ("xyz"[i], "xyz"[j]), same)


def bend_with_temperature(draw, runs):
    k, s, h = draw.integers(3), draw.integers(2), size(draw, 1e-7, 1e-6)
    c = draw.choice([m for m in range(3) if m != k])
    mean, spread = warmth(runs, s)
    bow = lambda r: h * (r.temps[:, s] - mean) / spread * 4 * r.q[:, k] / TRAVEL * (1 - r.q[:, k] / TRAVEL)
    return Effect({"carriage": lambda r: motion(k, c, bow(r))},
                  f"{AXES[k]} bows by {h * 1e6:.2f} um a usual change of temp_{('column', 'table')[s]}_c",
                  (("temp_column_c", "temp_table_c")[s], "time", "pass"))


def bend_with_rate(draw, runs):
    k, s, h = draw.integers(3), draw.integers(2), size(draw, 1e-6, 1e-5)
    every = np.concatenate([np.gradient(r.temps[:, s], r.clock) for r in runs if len(r.t) > 2])
    rate = lambda r: np.gradient(r.temps[:, s], r.clock) / every.std() if len(r.t) > 2 else np.zeros(len(r.t))
    c = draw.integers(3, 6)
    return Effect({"carriage": lambda r: motion(k, c, h * rate(r))},
                  f"E{'ABC'[c - 3]}{AXES[k]} by {h * 1e6:.1f} urad with the rate of temp_{('column', 'table')[s]}_c",
                  (("temp_column_c", "temp_table_c")[s], "time", "pass"))


def beyond_threshold(draw, runs):
    i, j = draw.permutation(3)[:2]
    c, place, h = draw.integers(3, 6), draw.uniform(0.02, 0.045), size(draw, 1e-5, 1e-4)
    return Effect({"carriage": lambda r: motion(i, c, h * np.maximum(r.q[:, j] - place, 0) / 0.03)},
                  f"E{'ABC'[c - 3]}{AXES[i]} leans once {AXES[j]} is beyond {place * 1e3:.0f} mm",
                  ("xyz"[i], "xyz"[j]))


def late_threshold(draw, runs):
    k, c, h = draw.integers(3), draw.integers(3, 6), size(draw, 2e-6, 2e-5)
    begin = next(r for r in runs if r.axis == AXES[k]).clock
    begin = begin[0] + draw.uniform(0.2, 0.8) * (begin[-1] - begin[0])  # while that axis is swept
    ramp = lambda r: h * r.q[:, k] / TRAVEL * (r.clock > begin)
    return Effect({"carriage": lambda r: motion(k, c, ramp(r))},
                  f"{AXES[k]} turns by {h * 1e6:.1f} urad over its travel from {begin:.0f} s on", ("time", "pass"))


def stick_slip(draw, runs):
    k, h, period = draw.integers(3), size(draw, 5e-7, 5e-6), draw.uniform(0.0015, 0.006)
    saw = lambda r: h * r.sense[:, k] * ((r.since[:, k] / period) % 1 - 0.5)
    turned = draw.uniform(0, 5e-6)
    both = lambda r: np.stack([saw(r), 0 * r.t, 0 * r.t, 0 * r.t, 0 * r.t, saw(r) / abs(h) * turned], axis=1)
    return Effect({"carriage": lambda r: {AXES[k]: np.roll(both(r), k, axis=1) if k else both(r)}},
                  f"{AXES[k]} sticks and slips by {h * 1e6:.2f} um every {period * 1e3:.1f} mm since it turned",
                  ("direction", "reversal", "xyz"[k]))


def two_scales(draw, runs):
    k, place, h = draw.integers(3), draw.uniform(0.02, 0.04), size(draw, 2e-5, 2e-4)
    joint = lambda r: h * np.maximum(r.q[:, k] - place, 0)
    return Effect({"travel": lambda r: np.eye(3)[k] * joint(r)[:, None]},
                  f"the scale of {AXES[k]} is {h * 1e6:.0f} ppm longer beyond {place * 1e3:.0f} mm",
                  ("xyz"[k],), (("scale-error", AXES[k], {}),))


def quantised_positions(draw, runs):
    k, step = draw.integers(3), abs(size(draw, 2e-6, 1e-5))
    return Effect({"travel": lambda r: np.eye(3)[k] * (r.q[:, k] - step * np.round(r.q[:, k] / step))[:, None]},
                  f"{AXES[k]} stands on the nearest {step * 1e6:.1f} um, not where it is recorded", ("xyz"[k],))


def gears(draw, runs):
    """Two wheels that never come round together, each with harmonics of its own."""
    k, h = draw.integers(3), abs(size(draw, 3e-7, 3e-6))
    periods = np.exp(draw.uniform(np.log(0.002), np.log(0.012))) * np.array([1.0, draw.uniform(1.3, 1.9)])
    phase, share = draw.uniform(0, 6.28, (2, 3)), np.abs(draw.normal(size=(2, 3))) * [1.0, 0.5, 0.4]
    order = np.arange(1, 4)
    wave = lambda q: sum((share[i] * np.sin(2 * np.pi * q[:, None] * order / periods[i] + phase[i])).sum(axis=1)
                         for i in range(2))
    pitches = [p / n for p in periods for n in order]
    same = tuple(("leadscrew-cyclic", AXES[k], {"pitch_mm": (p * 980, p * 1020)}) for p in pitches)
    return Effect({"travel": lambda r: np.eye(3)[k] * (h * wave(r.q[:, k]))[:, None]},
                  f"{AXES[k]} runs on wheels of {periods[0] * 1e3:.2f} and {periods[1] * 1e3:.2f} mm, "
                  f"{h * 1e6:.2f} um", ("xyz"[k],), same)


def belt(draw, runs):
    """The teeth of a belt: a wave that grows from one end, and slips by a part of a tooth with the direction."""
    k, h, pitch = draw.integers(3), abs(size(draw, 5e-7, 5e-6)), draw.choice([0.002, 0.003, 0.005])
    phase, slip = draw.uniform(0, 6.28), draw.uniform(0.2, 1.5)
    angle = lambda r: 2 * np.pi * r.q[:, k] / pitch + phase + slip * r.sense[:, k]
    wave = lambda r: h * (0.3 + r.q[:, k] / TRAVEL) * np.sin(angle(r))
    same = (("leadscrew-cyclic", AXES[k], {"pitch_mm": (pitch * 980, pitch * 1020)}),)
    return Effect({"travel": lambda r: np.eye(3)[k] * wave(r)[:, None]},
                  f"{AXES[k]} hangs on a belt with teeth of {pitch * 1e3:.0f} mm, {h * 1e6:.2f} um",
                  ("direction", "xyz"[k]), same)


def damp_scale(draw, runs):
    """A scale that swells with a moisture that the user has recorded."""
    k, h, period, phase = draw.integers(3), size(draw, 1e-6, 1e-5), draw.uniform(600, 4000), draw.uniform(0, 6.28)
    moisture = lambda r: 45 + 5 * np.sin(2 * np.pi * r.clock / period + phase)
    swollen = lambda r: h * (moisture(r) - 45) / 5 * r.q[:, k] / TRAVEL
    return Effect({"travel": lambda r: np.eye(3)[k] * swollen(r)[:, None],
                   "columns": lambda r: {"moisture_pct": moisture(r)}},
                  f"the scale of {AXES[k]} swells by {h * 1e6:.1f} um with moisture_pct",
                  ("column moisture_pct", "time", "run"))


def heavy_workpiece(draw, runs):
    """The table leans under a load that changes from run to run and is written down."""
    k, c, h = draw.integers(2), draw.integers(3, 6), size(draw, 2e-6, 2e-5)
    load = draw.uniform(0, 100, len(runs)).round()
    lean = lambda r: motion(k, c, np.full(len(r.t), h * load[r.number] / 50))
    return Effect({"carriage": lean, "columns": lambda r: {"load_n": np.full(len(r.t), load[r.number])}},
                  f"E{'ABC'[c - 3]}{AXES[k]} by {h * 1e6:.1f} urad for each 50 N of load_n",
                  ("column load_n", "time", "run"))


def tall_play(draw, runs):
    """Play that grows evenly along the axis."""
    k, h = draw.integers(3), abs(size(draw, 5e-7, 5e-6))
    wide = lambda r: h * r.q[:, k] / TRAVEL * r.sense[:, k] / 2
    return Effect({"travel": lambda r: np.eye(3)[k] * wide(r)[:, None]},
                  f"{AXES[k]} has play from nothing to {h * 1e6:.2f} um at its end", ("direction", "xyz"[k]),
                  play_of(k))


def speed_squared(draw, runs):
    k, c, h = draw.integers(3), draw.integers(3), size(draw, 3e-7, 3e-6)
    return Effect({"carriage": lambda r: motion(k, c, h * (r.speed[:, k] / 0.01) ** 2)},
                  f"{AXES[k]} lifts along {AXES[c]} by {h * 1e6:.2f} um with the square of its speed",
                  ("speed", "feed", "xyz"[k]))


def floor_vibration(draw, runs):
    c, h, rate = draw.integers(3), abs(size(draw, 1e-7, 1e-6)), draw.uniform(3, 40)
    period, phase = draw.uniform(20, 120), draw.uniform(0, 6.28, 2)
    shake = lambda r: h * np.maximum(np.sin(2 * np.pi * r.clock / period + phase[0]), 0) * \
        np.sin(2 * np.pi * rate * r.clock + phase[1])
    return Effect({"carriage": lambda r: motion(2, c, shake(r))},
                  f"the column shakes along {AXES[c]} by {h * 1e6:.2f} um at {rate:.2f} Hz, on and off",
                  ("time", "scatter", "memory"),
                  (("vibration", None, {"frequency_hz": (rate - 0.05, rate + 0.05)}),))


def rougher_machine(draw, runs):
    factor = draw.uniform(2, 3)
    return Effect({"machine": {"roughness": factor}}, f"errors {factor:.1f} times as rough", tuple("xyz"))


def kinked_machine(draw, runs):
    return Effect({"machine": {"sharp": True}}, "every error function has a sharp bend", tuple("xyz"))


def heavy_tails(draw, runs):
    return Effect({"machine": {"tails": True}}, "sizes of the error functions of Student's t, 3 degrees")


def larger_errors(draw, runs):
    factor = draw.uniform(2, 3)
    return Effect({"machine": {"size": factor}}, f"errors {factor:.1f} times as large")


# ---- the head

def probe_hysteresis(draw, runs):
    p, h = draw.integers(5), size(draw, 3e-8, 3e-7)

    def lag(run, gaps):
        k = "XYZ".index(run.axis)
        value = np.zeros_like(gaps)
        value[:, p] = h / 2 * run.sense[:, k] * np.minimum(run.since[:, k] / 0.003, 1.0)
        return value
    return Effect({"gaps": lag}, f"probe {'abcde'[p]} lags by {h * 1e9:.0f} nm",
                  ("direction", "reversal", f"probe_{'abcde'[p]}"))


def form_four_times(draw, runs):
    return Effect({"form": 4.0}, "the target is four times less flat than stated",
                  same_as=(("target-form", None, {"rms_um": (0.02, 0.08)}),))


def wandering_target(draw, runs):
    """A random walk of the target's place: each minute moves on from the last."""
    h, c = abs(size(draw, 3e-8, 3e-7)), draw.integers(5)
    grid = np.arange(0, span(runs) + 10, 5.0)
    way = np.cumsum(draw.normal(size=(len(grid), 2)), axis=0) * np.sqrt(5 / 60)
    tops = [0, 1, 2]

    def move(run, gaps):
        value = np.zeros_like(gaps)
        value[:, tops] = h * np.interp(run.clock, grid, way[:, 0])[:, None]
        value[:, 3:] = h * np.interp(run.clock, grid, way[:, 1])[:, None]
        return value
    return Effect({"gaps": move}, f"the target wanders by {h * 1e9:.0f} nm a root minute", ("time", "pass", "memory"))


def tailed_probe_noise(draw, runs):
    noise = lambda g, run, n: g.standard_t(3, size=(len(run.t), n)) / np.sqrt(3)
    return Effect({"probe_noise": noise}, "probe noise of Student's t, 3 degrees", ("scatter",),
                  (("outliers", None, {}),))


def remembering(rho):
    def noise(draw, run, columns):
        step = draw.normal(size=(len(run.t), columns))
        value = step.copy()
        for i in range(1, len(step)):
            value[i] = rho * value[i - 1] + np.sqrt(1 - rho**2) * step[i]
        return value
    return noise


def probe_noise_with_memory(draw, runs):
    rho = draw.uniform(0.5, 0.95)
    return Effect({"probe_noise": remembering(rho)}, f"probe noise of memory {rho:.2f}", ("memory", "scatter"))


def unequal_probes(draw, runs):
    sizes = draw.permutation(np.linspace(5, 20, 5)) / 20
    return Effect({"probe_noise": lambda g, run, n: g.normal(size=(len(run.t), n)) * sizes},
                  f"probes of {', '.join(f'{20 * s:.0f}' for s in sizes)} nm")


# ---- the linkage

def encoder_noise_with_memory(draw, runs):
    rho = draw.uniform(0.5, 0.95)
    return Effect({"encoder_noise": remembering(rho)}, f"encoder noise of memory {rho:.2f}", ("memory", "scatter"))


def tailed_encoder_noise(draw, runs):
    noise = lambda g, run, n: g.standard_t(3, size=(len(run.t), n)) / np.sqrt(3)
    return Effect({"encoder_noise": noise}, "encoder noise of Student's t, 3 degrees", ("scatter",),
                  (("outliers", None, {}),))


def fine_subdivision(draw, runs):
    i, lines, h = draw.integers(3), draw.integers(1000, 5000), abs(size(draw, 3e-6, 2e-5))
    phase = draw.uniform(0, 6.28)
    wave = lambda run, q: np.eye(3)[i] * (h * np.sin(lines * q[:, i] + phase))[:, None]
    return Effect({"angles": wave}, f"pivot {i + 1}: {h * 1e6:.1f} urad {lines} times a turn",
                  (f"pivot_{i + 1}", "scatter"))


def late_encoder(draw, runs):
    i, late = draw.integers(3), abs(size(draw, 1e-4, 2e-3))

    def lag(run, q):
        if not run.speed.any():
            return 0.0
        part = np.r_[0, np.cumsum(np.diff(run.t) > 1.0)]  # the two senses of a circle
        rate = np.concatenate([np.gradient(q[part == n, i], run.t[part == n]) for n in np.unique(part)])
        return -late * np.eye(3)[i] * rate[:, None]
    return Effect({"angles": lag}, f"the encoder of pivot {i + 1} is {late * 1e3:.2f} ms late",
                  ("speed", "feed", f"pivot_{i + 1}"))


def dragging_encoder(draw, runs):
    """The encoder follows its pivot through a soft coupling: full wind-up only some way after each reversal."""
    i, h = draw.integers(3), abs(size(draw, 1e-5, 1e-4))

    def drag(run, q):
        value = np.zeros_like(q)
        wound = 0.0
        for n in range(1, len(q)):
            step = q[n, i] - q[n - 1, i]
            wound += (np.sign(step) - wound) * (1 - np.exp(-abs(step) / (3 * h)))
            value[n, i] = -h / 2 * wound
        return value
    return Effect({"angles": drag}, f"the encoder of pivot {i + 1} drags by {h * 1e6:.0f} urad",
                  ("direction", f"pivot_{i + 1}"), (("joint-hysteresis", f"pivot_{i + 1}", {}),))


def reseated_ball(draw, runs):
    h = abs(size(draw, 3e-7, 3e-6))
    seat = h * draw.normal(size=(len(runs), 3))
    return Effect({"ball": lambda r: seat[r.number] + 0 * r.q},
                  f"the ball seats anew each run, {h * 1e6:.2f} um", ("run", "time"))


EFFECTS = {f.__name__: f for f in (
    angular_play, growing_bow, varying_play, product_of_positions, bend_with_temperature, bend_with_rate,
    beyond_threshold, late_threshold, stick_slip, two_scales, quantised_positions, gears, belt, damp_scale,
    heavy_workpiece, tall_play, speed_squared, floor_vibration, rougher_machine, kinked_machine, heavy_tails,
    larger_errors, probe_hysteresis, form_four_times, wandering_target, tailed_probe_noise, probe_noise_with_memory,
    unequal_probes, encoder_noise_with_memory, tailed_encoder_noise, fine_subdivision, late_encoder, dragging_encoder,
    reseated_ball)}
