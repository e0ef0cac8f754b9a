"""Every picture of README, docs and examples that shows the program, made by the program.

    python3 .ci/pictures.py FOLDER_OF_THE_PROGRAMS OUT [NAME ...]

OUT is docs/images; NAME is part of a picture's name, all are made unless given. The drives are those of examples/README.md. Needs
Chromium, and Pillow for smaller files. Look at what it has made before you keep it.
"""

import base64
import contextlib
import io
import json
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
            live(browser)
        notebook()
        session()
        observability()
        os.chdir(ROOT)


main()
