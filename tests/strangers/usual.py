"""What machines usually do, by its own equations: effects that abbe has a name for, in the world of strangers.

Effects as in effects.py; `same_as` names the cause, `truth` its sizes. They show whether the name, the size and
its U95 are right, and whether a map is better for having them taken out, where neither machine nor instruments are
those that the causes were written with.
"""
import numpy as np

from effects import AXES, Effect, size, span


def known(cause, thing, hooks, says, *more, **truth):
    """`more`: further causes that are the same thing."""
    return Effect(hooks, says, same_as=((cause, thing, {}), *((other, thing, {}) for other in more)), truth=truth)


def along(k, value):
    return np.eye(3)[k] * value[:, None]


def place_before(run, late):
    """Where the axes of a circle were `late` seconds ago, (n, 3): turned back about its centre."""
    if not run.speed.any():
        return run.q
    centre = 0.03
    radius = np.linalg.norm(run.q - centre, axis=1)[:, None]
    angle = run.feed[:, None] * late / radius
    ahead = run.speed / run.feed[:, None] * radius
    return centre + (run.q - centre) * np.cos(angle) - ahead * np.sin(angle)


def play(draw, runs):
    k, h = draw.integers(3), abs(size(draw, 3e-7, 6e-6))
    lag = lambda r: r.sense[:, k] * (h / 2 - np.minimum(r.since[:, k], h))  # taken up on the way
    return known("backlash", AXES[k], {"travel": lambda r: along(k, lag(r))},
                 f"{AXES[k]} has {h * 1e6:.2f} um of play", "standing-position", width_um=h * 1e6)


def late_axis(draw, runs):
    k, late = draw.integers(3), abs(size(draw, 5e-5, 2e-3))
    behind = lambda r: (place_before(r, late) - r.q)[:, k]
    return known("servo-lag", AXES[k], {"travel": lambda r: along(k, behind(r))},
                 f"{AXES[k]} is {late * 1e3:.3f} ms behind its command", delay_ms=late * 1e3)


def screw(draw, runs):
    k, h, pitch, phase = draw.integers(3), abs(size(draw, 3e-7, 3e-6)), draw.uniform(0.0025, 0.01), draw.uniform(0, 6.28)
    wave = lambda r: h * np.sin(2 * np.pi * r.q[:, k] / pitch + phase)
    return known("leadscrew-cyclic", AXES[k], {"travel": lambda r: along(k, wave(r))},
                 f"the screw of {AXES[k]} errs by {h * 1e6:.2f} um each {pitch * 1e3:.2f} mm",
                 pitch_mm=pitch * 1e3, amplitude_um=h * 1e6)


def sticky_reversal(draw, runs):
    k, h, decay = draw.integers(3), abs(size(draw, 5e-7, 5e-6)), draw.uniform(3e-4, 3e-3)
    back = lambda r: -h * r.sense[:, k] * np.exp(-r.since[:, k] / decay)
    return known("reversal-spike", AXES[k], {"travel": lambda r: along(k, back(r))},
                 f"{AXES[k]} hangs back by {h * 1e6:.2f} um at reversal, for {decay * 1e3:.2f} mm",
                 height_um=h * 1e6, decay_mm=decay * 1e3)


def late_linkage(draw, runs):
    late = abs(size(draw, 1e-4, 5e-3))
    return known("clock-skew", "linkage",
                 {"travel": lambda r: place_before(r, late) - r.q if r.kind == "linkage" else 0.0},
                 f"the linkage is stamped {late * 1e3:.3f} ms late", delay_ms=late * 1e3)


def swapped_probes(draw, runs):
    p, q = sorted(draw.permutation(5)[:2])

    def exchanged(run, gaps):
        value = np.zeros_like(gaps)
        value[:, p], value[:, q] = gaps[:, q] - gaps[:, p], gaps[:, p] - gaps[:, q]
        return value
    names = [f"probe_{'abcde'[i]}" for i in (p, q)]
    return known("channel-swap", "+".join(names), {"gaps": exchanged}, f"{' and '.join(names)} are exchanged")


def mains(draw, runs):
    p, h, rate, phase = draw.integers(5), abs(size(draw, 5e-8, 5e-7)), draw.choice([50.0, 60.0]), draw.uniform(0, 6.28)

    def hum(run, gaps):
        value = np.zeros_like(gaps)
        value[:, p] = h * np.sin(2 * np.pi * rate * run.clock + phase)
        return value
    return known("mains-pickup", f"probe_{'abcde'[p]}", {"gaps": hum},
                 f"probe {'abcde'[p]} hums at {rate:.0f} Hz by {h * 1e9:.0f} nm", frequency_hz=rate,
                 amplitude_um=h * 1e6)


def lost_counts(draw, runs):
    i, h = draw.integers(3), size(draw, 2e-5, 2e-4)
    read = [r for r in runs if r.kind == "linkage"]
    run = read[draw.integers(len(read))]
    instant = run.clock[0] + draw.uniform(0.1, 0.9) * (run.clock[-1] - run.clock[0])
    return known("encoder-count-slip", f"pivot_{i + 1}",
                 {"angles": lambda r, q: np.eye(3)[i] * (h * (r.clock > instant))[:, None]},
                 f"pivot {i + 1} loses {h * 1e6:.0f} urad at {instant:.0f} s")


def warming_axis(draw, runs):
    k, h, lasts = draw.integers(3), size(draw, 5e-7, 5e-6), draw.uniform(0.1, 0.5) * span(runs)
    creep = lambda r: h * (1 - np.exp(-r.clock / lasts))
    return known("warm-up-drift", AXES[k], {"travel": lambda r: along(k, creep(r))},
                 f"{AXES[k]} creeps by {h * 1e6:.2f} um in {lasts:.0f} s")


def uneven_lines(draw, runs):
    i, order, h, phase = draw.integers(3), draw.integers(9, 120), abs(size(draw, 3e-6, 2e-5)), draw.uniform(0, 6.28)
    wave = lambda run, q: np.eye(3)[i] * (h * np.sin(order * q[:, i] + phase))[:, None]
    return known("encoder-subdivision", f"pivot_{i + 1}", {"angles": wave},
                 f"pivot {i + 1} errs by {h * 1e6:.1f} urad {order} times a turn", order=float(order))


USUAL = {f.__name__: f for f in (
    play, late_axis, screw, sticky_reversal, late_linkage, swapped_probes, mains, lost_counts, warming_axis,
    uneven_lines)}
