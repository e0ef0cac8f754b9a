"""Every picture of README, docs and examples that shows the program, made by the program.

    python3 .ci/pictures.py FOLDER_OF_THE_PROGRAMS OUT [NAME ...]

OUT is docs/images; NAME is part of a picture's name, all are made unless given. The drives are those of examples/README.md. Needs
Chromium, and Pillow for smaller files. Look at what it has made before you keep it.
"""

import base64
import contextlib
import io
import json
import math
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.request import urlopen

from PIL import Image

PROGRAMS, OUT, WANTED = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), sys.argv[3:]
ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"
LARGEST_BYTES = 150_000
# Of the replayed drive: when the live page is taken, and how fast it is replayed until then.
LIVE_S, LIVE_SPEED = 100.0, 8
COLUMNS, LINE_PX, COLUMN_PX, MARGIN_PX = 112, 18, 7.8, 18
SESSION = ["itpms demo", "itpms signals itpms-demo/drive.csv | head -n 8",
    "itpms vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 -o typical.toml"]
CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def wanted(*names):
    return not WANTED or any(part in name for part in WANTED for name in names)


class Browser:
    """A page of a headless Chromium, by the DevTools protocol through pipes."""

    def __enter__(self):
        program = next(filter(None, map(shutil.which, CHROMIUM)), None) or sys.exit("no Chromium here")
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        (theirs_in, self.to), (self.of, theirs_out) = os.pipe(), os.pipe()
        words = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
            "--force-color-profile=srgb", "--disable-lcd-text", "--remote-debugging-pipe", f"--user-data-dir={self.profile.name}"]
        # The browser reads its commands from 3 and answers on 4.
        self.process = subprocess.Popen(["bash", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "bash", *words], stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, pass_fds=(theirs_in, theirs_out))
        os.close(theirs_in), os.close(theirs_out)
        self.number, self.rest, self.session = 0, b"", {}
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = {"sessionId": self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.profile.cleanup()

    def call(self, method, **parameters):
        self.number += 1
        os.write(self.to, json.dumps({"id": self.number, "method": method, "params": parameters, **self.session}).encode() + b"\0")
        while True:
            while b"\0" not in self.rest:
                more = os.read(self.of, 1 << 20)
                self.rest += more or sys.exit("the browser has ended")
            message, _, self.rest = self.rest.partition(b"\0")
            answer = json.loads(message)
            if answer.get("id") == self.number:
                return answer["result"] if "result" in answer else sys.exit(f"{method}: {answer['error']}")

    def size(self, width, height, scale=1, dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 500)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def open(self, address):
        self.call("Page.navigate", url=address)
        time.sleep(2.0)

    def value(self, script):
        return self.call("Runtime.evaluate", expression=script, returnByValue=True)["result"].get("value")

    def taken(self):
        time.sleep(0.2)
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def page(self, name, path, width, height, from_heading=None):
        """A picture of a page from its top, or from the heading that begins so."""
        self.size(width, height)
        self.open(path.as_uri())
        # Twice: what is above it is laid out only once it has been near.
        for _ in range(2 if from_heading else 0):
            scroll = f"""(() => {{ const h = [...document.querySelectorAll("h2")].find((h) => h.textContent.startsWith({json.dumps(from_heading)}));
                if (h) scrollTo(0, h.getBoundingClientRect().top + scrollY - 24); return !!h; }})()"""
            if not self.value(scroll):
                sys.exit(f"{path.name} has no heading {from_heading}")
            time.sleep(0.5)
        keep(name, self.taken())


def keep(name, png):
    """As a palette of the colors that are most frequent, which flat pages hardly need more of; any other becomes the nearest of them."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    colors = [color for _, color in sorted(picture.getcolors(picture.width * picture.height), reverse=True)]
    kept = colors[:256]
    place = {color: min(range(len(kept)), key=lambda i: sum((a - b) ** 2 for a, b in zip(kept[i], color))) for color in colors}
    data = picture.tobytes()
    small = Image.frombytes("P", picture.size, bytes(place[color] for color in zip(data[::3], data[1::3], data[2::3])))
    small.putpalette([part for color in kept for part in color])
    small.save(OUT / name, optimize=True)
    bytes_ = (OUT / name).stat().st_size
    print(f"{name}: {picture.width} x {picture.height}, {bytes_ / 1000:.0f} kB", flush=True)
    if bytes_ > LARGEST_BYTES:
        sys.exit(f"{name} has more than {LARGEST_BYTES / 1000:.0f} kB")


def itpms(*words):
    """In a folder that holds the examples; what they write goes to `out`."""
    subprocess.run([PROGRAMS / "itpms", "-q", *map(str, words)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def drives():
    os.mkdir("out")
    itpms("lab", "simulate", "drive-puncture", "-o", "out/drive.csv", "--vehicle-out", "out/car.toml")
    for drive in ("first", "later"):
        itpms("lab", "simulate", f"calibration/{drive}.toml", "-o", f"out/{drive}.csv")
    itpms("vehicle", "init", "--mass", 1500, "--front-share", 0.55, "--tire", "205/55R16", "--wheelbase-m", 2.66, "-o", "out/typical.toml")
    itpms("vehicle", "learn", "out/first.csv", "--pressure-kpa", 240, "--from", "out/typical.toml", "-o", "out/own.toml")
    itpms("estimate", "out/first.csv", "--vehicle", "out/own.toml", "-o", "out/est.csv", "--calibrate-s", 600, "--save-reference", "out/own.reference")


def reports(browser):
    if wanted("demo-report.png"):
        itpms("demo", "--out", "out/demo")
        browser.page("demo-report.png", Path("out/demo/report.html").resolve(), 1200, 1870)
    if wanted("example-log.png"):
        itpms("convert", "out/drive.csv", "out/drive.log", "--dbc", "can/car.dbc", "--signals", "can/map.toml")
        itpms("plot", "out/drive.log", "--dbc", "can/car.dbc", "--signals", "can/map.toml", "-o", "out/plot.html")
        browser.page("example-log.png", Path("out/plot.html").resolve(), 1100, 900, from_heading="Front left")
    if wanted("example-calibration.png"):
        itpms("estimate", "out/later.csv", "--vehicle", "out/own.toml", "--reference", "out/own.reference", "-o", "out/est.csv", "--report", "out/later.html")
        browser.page("example-calibration.png", Path("out/later.html").resolve(), 1100, 900)
    if wanted("example-fleet.png"):
        path = {**os.environ, "PATH": f"{PROGRAMS}:{os.environ['PATH']}"}
        subprocess.run([sys.executable, "fleet/make.py", "out"], check=True, env=path, stdout=subprocess.DEVNULL)
        itpms("fleet", "out/logs/**/*.csv", "--vehicle-dir", "out/cars", "--out", "out/fleet")
        browser.page("example-fleet.png", Path("out/fleet/index.html").resolve(), 1100, 820)
    if wanted("example-wheel-speeds.png"):
        itpms("vehicle", "init", "--tire", "205/55R16", "--wheelbase-m", 2.7, "--driven", "front", "-o", "out/wheels.toml")
        itpms("estimate", "wheel-speeds/drive.log", "--dbc", "wheel-speeds/car.dbc", "--vehicle", "out/wheels.toml", "-o", "out/est.csv",
            "--calibrate-s", 50, "--report", "out/wheels.html")
        browser.page("example-wheel-speeds.png", Path("out/wheels.html").resolve(), 1100, 800)


CORNERS = ("fl", "fr", "rl", "rr")


def drive_with(name, head, corners, columns):
    """Simulates a drive of a car, and adds columns to its log: what `columns` makes of the time, once a second."""
    scenario = f'name = "{name}"\nrate_hz = 200.0\nwheelbase_m = 2.7\nconfidence = "measured"\n{head}[car]\n'
    Path(f"out/{name}.toml").write_text(scenario + "".join(f"[corner.{c}]\n{corners(c)}" for c in CORNERS))
    itpms("lab", "simulate", f"out/{name}.toml", "--seed", 5, "--no-truth", "-o", f"out/{name}.csv", "--vehicle-out", f"out/{name}-car.toml")
    head, *lines = Path(f"out/{name}.csv").read_text().splitlines()
    names = columns(0.0)
    rows = (",".join([line, *(str(value) if number % 200 == 0 else "" for value in columns(float(line.split(",")[0])).values())])
        for number, line in enumerate(lines))
    Path(f"out/{name}.csv").write_text("\n".join([",".join([head, *names]), *rows]) + "\n")


def condition(browser):
    """Cold pressures and dampers: a calibration at 20 C, a morning of -10 C with a worn damper. A road with holes and bumps, from above."""
    car = "sprung_mass_kg = {}\nunsprung_mass_kg = 40.0\ndamping_n_s_per_m = 1500.0\nspring_n_per_m = {}\npressure.constant_kpa = {}\n"
    if wanted("example-cold-pressure.png", "example-dampers.png"):
        head = "duration_s = 150.0\n[speed]\npoints_s_km_h = [[0.0, 60.0], [75.0, 90.0], [150.0, 60.0]]\n[road]\ncontact_length_m = 0.1\nsurface.iso8608 = { roughness = \"B\", slope = 2.0 }\n"
        body = lambda c: (330.0, 24000.0) if c[0] == "f" else (270.0, 22000.0)
        drive_with("summer", head, lambda c: car.format(*body(c), 241.3), lambda _: {"ambient_temperature_c": 20})
        drive_with("winter", head, lambda c: car.format(*body(c), 219.0 if c != "fr" else 238.0) + ("truth = { damping_factor = 0.45 }\n" if c == "rl" else ""),
            lambda _: {"ambient_temperature_c": -10, "barometric_kpa": 101.3})
        itpms("estimate", "out/summer.csv", "--vehicle", "out/summer-car.toml", "-o", "out/est.csv", "--calibrate-s", 150, "--save-reference", "out/summer.reference")
        itpms("estimate", "out/winter.csv", "--vehicle", "out/summer-car.toml", "--reference", "out/summer.reference", "-o", "out/est.csv", "--report", "out/winter.html")
        browser.page("example-cold-pressure.png", Path("out/winter.html").resolve(), 1100, 900)
        browser.page("example-dampers.png", Path("out/winter.html").resolve(), 1100, 760, from_heading="Dampers and load")
    if wanted("example-road.png"):
        holes = [(300, 0.03, "left"), (620, -0.025, "right"), (930, 0.04, "right"), (1250, -0.02, "both")]
        head = "duration_s = 80.0\n[speed]\nconstant_km_h = 72.0\n[road]\ncontact_length_m = 0.1\nsurface.segments = { after_last = \"repeat\", list = [" + ", ".join(
            f"{{ length_m = {m}.0, roughness = {gd}, slope = 2.0 }}" for m, gd in ((500, "12e-6"), (300, "40e-6"), (400, "20e-6"), (200, "100e-6"))) + "] }\n" + "".join(
            f"[[road.pothole]]\nat_m = {at}.0\nlength_m = 0.6\ndepth_m = {depth}\nedge_m = 0.15\ntracks = \"{tracks}\"\n" for at, depth, tracks in holes)
        # A bend of 350 m radius, then one of 500 m the other way.
        def place(time_s):
            way, (east, north, heading) = 20.0 * time_s, (0.0, 0.0, 0.3)
            for _ in range(int(way)):
                east, north, heading = east + math.sin(heading), north + math.cos(heading), heading + (1 / 350 if _ < 700 else -1 / 500)
            return {"latitude_deg": 48.0 + north / 111195, "longitude_deg": 11.0 + east / 74400}
        drive_with("road", head, lambda _: "pressure.constant_kpa = 241.3\n", lambda time_s: place(time_s) if time_s % 1 < 0.004 else {"latitude_deg": "", "longitude_deg": ""})
        itpms("roughness", "out/road.csv", "--vehicle", "out/road-car.toml", "--map", "out/road.html")
        browser.page("example-road.png", Path("out/road.html").resolve(), 1100, 900)


def live(browser):
    """The live page late in a replay, three times within moments."""
    if not wanted("dashboard-desktop.png", "dashboard-dark.png", "dashboard-phone.png"):
        return
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
    monitor = subprocess.Popen([PROGRAMS / "itpms", "-q", "monitor", "--replay", "out/later.csv", "--speed", str(LIVE_SPEED), "--vehicle",
        "out/own.toml", "--reference", "out/own.reference", "--http", address], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        for _ in range(100):
            with contextlib.suppress(OSError):
                urlopen(f"http://{address}/api/snapshot").close()
                break
            time.sleep(0.05)
        browser.size(1200, 1500)
        browser.open(f"http://{address}/")
        while json.load(urlopen(f"http://{address}/api/snapshot"))["time_s"] < LIVE_S:
            time.sleep(0.05)
        pictures = {"dashboard-desktop.png": browser.taken()}
        browser.size(1200, 1500, dark=True)
        pictures["dashboard-dark.png"] = browser.taken()
        browser.size(360, 1180, scale=1.5)
        pictures["dashboard-phone.png"] = browser.taken()
        if json.load(urlopen(f"http://{address}/api/snapshot"))["source"]["state"] != "live":
            sys.exit("the replay ended before its pictures were taken")
        for name, png in pictures.items():
            keep(name, png)
    finally:
        monitor.terminate()
        monitor.wait()


def notebook():
    """The first picture of a notebook, as `.ci/notebooks.py --write` has kept it."""
    if wanted("example-notebook.png"):
        cells = json.loads((EXAMPLES / "notebooks" / "own_log.ipynb").read_text(encoding="utf-8"))["cells"]
        outputs = (output.get("data", {}) for cell in cells for output in cell.get("outputs", []))
        keep("example-notebook.png", base64.b64decode(next(data["image/png"] for data in outputs if "image/png" in data)))


def session():
    """What a terminal shows of the first commands, as text that can be selected."""
    if not wanted("session.svg"):
        return
    environment = {"PATH": f"{PROGRAMS}:/usr/bin:/bin", "HOME": os.getcwd(), "LC_ALL": "C.UTF-8"}
    lines = []
    for command in SESSION:
        done = subprocess.run(command, shell=True, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, check=True)
        lines.append(("command", f"$ {command}"))
        for line in done.stdout.splitlines():
            lines += [("out", line[at : at + COLUMNS]) for at in range(0, max(len(line), 1), COLUMNS)]
        lines.append(("out", ""))
    lines.pop()
    width, height = 2 * MARGIN_PX + COLUMNS * COLUMN_PX, 2 * MARGIN_PX + len(lines) * LINE_PX
    text = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height}" width="{width:.0f}" height="{height}" '
        'role="img" font-family="ui-monospace, SFMono-Regular, Menlo, Consolas, monospace" font-size="13">', "<title>A terminal: the first three commands</title>",
        f'<rect width="{width:.0f}" height="{height}" rx="10" fill="#16202c"/>']
    for row, (kind, line) in enumerate(lines):
        if line:
            escaped = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
            look = 'fill="#7fd1ae" font-weight="bold"' if kind == "command" else 'fill="#dbe3ea"'
            # Whatever font there is, columns stand below each other.
            text.append(f'<text x="{MARGIN_PX}" y="{MARGIN_PX + 13 + row * LINE_PX}" xml:space="preserve" {look} '
                f'textLength="{len(line) * COLUMN_PX:.1f}" lengthAdjust="spacingAndGlyphs">{escaped}</text>')
    (OUT / "session.svg").write_text("\n".join([*text, "</svg>", ""]), encoding="utf-8")
    print(f"session.svg: {len(lines)} lines")


def observability():
    if wanted("observability-twins.svg", "observability-time.svg", "observability-sweeps.svg"):
        itpms("lab", "observability", "--vehicle", "out/car.toml", "--out", "out/observability")
        for figure in Path("out/observability").glob("*.svg"):
            shutil.copy(figure, OUT)
            print(figure.name)


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("calibration", "can", "fleet", "wheel-speeds"):
            shutil.copytree(EXAMPLES / name, Path(folder) / name)
        os.chdir(folder)
        drives()
        with Browser() as browser:
            reports(browser)
            condition(browser)
            live(browser)
        notebook()
        session()
        observability()
        os.chdir(ROOT)


main()
