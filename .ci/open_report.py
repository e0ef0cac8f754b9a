"""Opens a report from its file in a headless Chromium: it must draw, and the console must stay silent.

Called as `open_report.py BROWSER PAGE`. Exit code 77 says that the browser itself does not run here.
"""

import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77


def run(browser: str, address: str, profile: str) -> subprocess.CompletedProcess[str]:
    options = [
        "--headless",
        "--no-sandbox",  # a container's root may not have one
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--no-first-run",
        f"--user-data-dir={profile}",
        "--window-size=1280,900",
        "--enable-logging=stderr",
        "--virtual-time-budget=10000",
        "--dump-dom",
    ]
    return subprocess.run(
        [browser, *options, address], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=120
    )


def main() -> int:
    browser, page = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        try:
            # Does this browser run at all? Only then does a bad page tell something about the page.
            if "hello" not in run(browser, "data:text/html,<p>hello", profile).stdout:
                print(f"{browser} does not run here")
                return SKIPPED
            shown = run(browser, page.as_uri(), profile)
        except (OSError, subprocess.TimeoutExpired) as trouble:
            print(f"{browser} does not run here: {trouble}")
            return SKIPPED
    complaints = [line for line in shown.stderr.splitlines() if ":CONSOLE" in line]
    canvases = shown.stdout.count("<canvas")
    print("\n".join(complaints) or f"{page.name}: {canvases} charts, silent console")
    if canvases == 0:
        print("expected at least one chart on the page")
    return 1 if complaints or canvases == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
