"""What must have come of the scenario in the virtual machine: reads the directory that `scenario` left and says, line by
line, what was seen and whether that is right.

    judge.py DIR

Called by `run`. Knows nothing of how the machine is made. The frames that the monitor sent are decoded here once more,
from the DBC that it printed, without the project's own decoder.
"""

import itertools
import json
import re
import sys
from pathlib import Path

CORNERS = ["fl", "fr", "rl", "rr"]
HZ = 10.0
# What drive.toml says.
TRUTH_KPA = {"fl": 137.9, "fr": 241.3, "rl": 241.3, "rr": 241.3}
COMPLETE_LOSS_S = 12.5
SPEED_M_S = 80.0 / 3.6

failures = []


def check(holds, what):
    print(f"{'ok    ' if holds else 'FAILED'}  {what}")
    if not holds:
        failures.append(what)


class Marks:
    """What the scenario wrote down: a time since the start, a word and more words."""

    def __init__(self, out):
        self.lines = [line.split() for line in (out / "marks").read_text().splitlines()]
        first_frame_s = float((out / "hello.log").read_text().split()[0].strip("()"))
        self.start_unix_s = 0.0
        self.start_unix_s = first_frame_s - self.time_s("hello")

    def time_s(self, *words):
        """In seconds since 1970, as the estimates have it, to some 20 ms."""
        return next(self.start_unix_s + float(line[0]) for line in self.lines if line[1 : 1 + len(words)] == list(words))

    def rest(self, *words):
        return next(line[1 + len(words) :] for line in self.lines if line[1 : 1 + len(words)] == list(words))


class Run:
    """One start of the monitor: its lines of JSON and the bounds of its life."""

    def __init__(self, out, name, marks):
        lines = [json.loads(line) for line in (out / f"{name}.jsonl").read_text().splitlines()]
        self.estimates = [line for line in lines if line["type"] == "estimate"]
        self.warnings = [line for line in lines if line["type"] == "warning"]
        self.said = (out / f"{name}.txt").read_text()
        self.exit_code = int(marks.rest("ended", name)[0])
        self.stopping_s = marks.time_s("ended", name) - marks.time_s("stop", name)
        ticks = marks.rest("used", name)
        self.load = (int(ticks[0]) + int(ticks[1])) / 100 / (marks.time_s("stop", name) - marks.time_s("start", name))
        self.memory_mb = int(ticks[2]) / 1000

    def between(self, from_s, to_s):
        return [line for line in self.estimates if from_s <= line["unix_s"] < to_s]

    def begun(self, kind):
        return [line for line in self.warnings if line["event"] == "begun" and line["kind"] == kind]


def states(estimate):
    return {wheel["corner"]: wheel["state"] for wheel in estimate["wheels"]}


def hello(out):
    """Three frames sent by hand: a standard one, an extended one, one of CAN FD."""
    seen = [line.split(" ", 2)[2] for line in (out / "hello.log").read_text().splitlines()]
    # Behind `##` are the flags of an FD frame: the bit-rate switch, and on newer kernels the bit that says "FD".
    expected = re.compile(r"123#DEADBEEF 1ABCDEF0#01 7FF##[15]000102030405060708090A0B")
    check(expected.fullmatch(" ".join(seen)), f"candump saw the frames of cansend: {' '.join(seen)}")


def puncture(first, marks):
    """The tire that goes down is named, once, in time; no other is."""
    start_s = marks.time_s("play", "puncture")
    rows = first.between(start_s, marks.time_s("played", "puncture"))
    # Of the drive's time: before the first row the monitor says once a second that it hears nothing, and the rows of the
    # first two seconds, in which it learns how often each signal comes, are told of all at once.
    live = [line["time_s"] for line in rows if line["source"]["state"] == "live"]
    span_s = marks.time_s("played", "puncture") - start_s
    rate_hz = (len(live) - 1) / (live[-1] - live[0])
    check(abs(rate_hz - HZ) < 0.02 * HZ, f"{len(live)} estimates, {rate_hz:.2f} per second")
    check(abs(live[-1] - live[0] - span_s) < 0.5, f"they tell of {live[-1] - live[0]:.1f} of {span_s:.1f} s")
    said = first.begun("under-inflated")
    check([alert["wheels"] for alert in said] == [["fl"]], f"warned of: {[alert['text'] for alert in said]}")
    after_s = said[0]["unix_s"] - start_s - COMPLETE_LOSS_S if said else float("nan")
    check(abs(after_s) <= 3.0, f"warned {after_s:+.1f} s from the complete loss")
    others = [alert["text"] for alert in first.warnings if alert["wheels"] != ["fl"]]
    check(not others, f"nothing else was reported, but {others}")
    last = first.estimates[-1]
    for wheel in last["wheels"]:
        # Five standard deviations: this asks whether the wheels were mixed up, not how good the estimator is.
        error, sd = wheel["pressure_kpa"] - TRUTH_KPA[wheel["corner"]], wheel["pressure_sd_kpa"]
        expected = "low" if wheel["corner"] == "fl" else "fine"
        check(wheel["state"] == expected and abs(error) < 5.0 * sd < 60.0,
              f"{wheel['corner']} {wheel['state']}: {wheel['pressure_kpa']:.1f} kPa, sd {sd:.1f}, error {error:+.1f}")


def outage(run, marks, gone, back, part):
    """While the interface is away what is said is old, and says so; then estimates go on."""
    gone_s, back_s, play_s = marks.time_s(gone), marks.time_s(back), marks.time_s("play", part)
    # Stale after a second without a row; told again every second, each time with the date of the last row.
    newest = max(i for i, line in enumerate(run.estimates) if line["source"]["state"] == "live" and line["unix_s"] < gone_s + 0.5)
    away = list(itertools.takewhile(lambda line: line["source"]["state"] != "live", run.estimates[newest + 1 :]))
    told = [line["source"]["state"] for line in away]
    check(len(told) >= back_s - gone_s - 2.0 and set(told) == {"stale"}, f"{gone}: the source is {told}")
    late_s = [round(line["unix_s"] - gone_s, 2) for line in away]
    # Rows that waited for their like are estimated a second after the last one, when nothing more comes.
    check(all(-0.5 < late < 1.5 for late in late_s), f"{gone}: what is said while it is away has the date of the last row: {late_s}")
    check(not any(line["all_fine"] for line in away), f"{gone}: it was not reported that all is fine")
    live = [line["unix_s"] for line in run.between(play_s, play_s + 30.0) if line["source"]["state"] == "live"]
    wait_s = live[0] - play_s if live else float("nan")
    check(wait_s < 5.0, f"{back}: estimates {wait_s:.2f} s after the first frame")


def counters(first, marks):
    source = first.estimates[-1]["source"]
    print("        counted:", json.dumps(source))
    played = sum(int(marks.rest("played", part)[0]) for part in ["puncture", "after-down", "after-unplugged"])
    # While the interface is opened again, some tenths of a second, nothing is heard.
    check(source["dropped"] == 0 and source["frames"] > 0.97 * played, f"{source['frames']} of {played} frames received, none dropped")
    check(source["reconnects"] == 3, f"{source['reconnects']} reconnects")
    check(source["unknown_ids"] == 1 and source["malformed"] == 0, f"{source['unknown_ids']} frame with an unknown identifier")
    check("bus-off" in first.said, f"reported: {first.said.splitlines()}")


def layouts(dbc):
    """Per identifier, name and place of its signals: first bit, bits, factor. Ours are all unsigned and little-endian."""
    signal = re.compile(r" SG_ (\w+) : (\d+)\|(\d+)@1\+ \(([^,]+),")
    messages = {}
    for line in dbc.read_text().splitlines():
        if line.startswith("BO_ "):
            current = messages.setdefault(int(line.split()[1]), {})
        elif found := signal.match(line):
            current[found[1]] = (int(found[2]), int(found[3]), float(found[4]))
    return messages


def sets_of_frames(log, messages):
    """What the frames say, from one status frame to the next, as raw values."""
    sets = []
    for line in log.read_text().splitlines():
        identifier, data = line.split()[2].split("#")
        bits = int.from_bytes(bytes.fromhex(data), "little")
        places = messages[int(identifier, 16)]
        if "ITPMS_Counter" in places:
            sets.append({})
        if sets:
            sets[-1] |= {name: bits >> start & (1 << length) - 1 for name, (start, length, _) in places.items()}
    return sets


def sent(out, log, run):
    """The frames of our own DBC say what the lines of JSON say, within their quantisation."""
    messages = layouts(out / "itpms.dbc")
    places = {name: place for layout in messages.values() for name, place in layout.items()}
    # Before the first row there are no wheels, and none are sent; what else is found is sent as soon as it is.
    wheels = {f"ITPMS_{signal}_{corner}" for signal in ("Pressure", "PressureSd", "Valid") for corner in ("FL", "FR", "RL", "RR")}
    sets = [values for values in sets_of_frames(out / log, messages) if wheels <= values.keys()]
    estimates = [estimate for estimate in run.estimates if estimate["wheels"]]

    def same(values, name, value):
        _, length, factor = places[name]
        if value is None:  # all bits set: not available
            return values[name] == (1 << length) - 1
        return abs(values[name] * factor - value) <= 0.5 * factor + 1e-9

    def fits(values, estimate):
        return values["ITPMS_Counter"] == estimate["seq"] % 256 and all(
            same(values, f"ITPMS_{signal}_{wheel['corner'].upper()}", wheel[field])
            for wheel in estimate["wheels"]
            for signal, field in [("Pressure", "pressure_kpa"), ("PressureSd", "pressure_sd_kpa"), ("Valid", "valid")])

    alike = sum(fits(values, estimate) for values, estimate in zip(sets, estimates))
    check(alike == len(estimates) == len(sets), f"{log}: {len(sets)} sets of frames for {len(estimates)} estimates, {alike} alike")


def restart(first, second, marks):
    """SIGTERM ends the monitor well, and the next start goes on where it stopped."""
    for name, run in (("first", first), ("second", second)):
        check(run.exit_code == 0, f"SIGTERM: the {name} ended with code {run.exit_code} within {run.stopping_s:.2f} s")
    rows = second.between(marks.time_s("play", "after-restart"), marks.time_s("stop", "second"))
    rows = [line for line in rows if line["source"]["state"] == "live"]
    before, after = first.estimates[-1], rows[0]
    check(states(after) == states(before), f"the first estimate after the restart: {states(after)}")
    # The pause between the starts is shorter than ten seconds, so its way counts, too.
    told = [before, after, second.estimates[-1]]
    driven_m = [line["distance_m"] - before["distance_m"] for line in told[1:]]
    passed_s = [line["time_s"] - before["time_s"] for line in told[1:]]
    check(passed_s[0] < 10.0 and passed_s[1] - passed_s[0] > 5.0
          and all(abs(distance_m - SPEED_M_S * time_s) < 0.02 * SPEED_M_S * time_s for distance_m, time_s in zip(driven_m, passed_s)),
          "driven since the last start: "
          + ", then ".join(f"{distance_m:.1f} m in {time_s:.2f} s" for distance_m, time_s in zip(driven_m, passed_s)))
    check(not second.begun("under-inflated"), "what was reported before the restart is not reported again")


def figures(runs):
    for name, run in runs:
        latest = [line["latency_ms"] for line in run.estimates if line["source"]["state"] == "live"][-1]
        print(f"        {name}: frame to estimate {latest['p50']:.2f} ms (median), {latest['p99']:.2f} ms (99 %),"
              f" {latest['max']:.2f} ms (worst of the last 10 s); processor {100 * run.load:.0f} %,"
              f" memory {run.memory_mb:.1f} MB")


def main():
    out = Path(sys.argv[1])
    marks = Marks(out)
    hello(out)
    if none := [" ".join(line) for line in marks.lines if line[1] == "no"]:
        sys.exit(f"the scenario came to an early end: {none}")
    first, second = Run(out, "first", marks), Run(out, "second", marks)
    puncture(first, marks)
    outage(first, marks, "down", "up", "after-down")
    outage(first, marks, "unplugged", "plugged", "after-unplugged")
    counters(first, marks)
    sent(out, "sent.log", first)
    restart(first, second, marks)
    sent(out, "sent-same-bus.log", second)
    figures([("first start", first), ("second start", second)])
    if failures:
        sys.exit(f"{len(failures)} of the checks failed")


main()
