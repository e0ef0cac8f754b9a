"""What is in a package of the workspace, as CycloneDX in JSON: by cargo-cyclonedx, without a path of this machine in it.

    sbom.py TRIPLE PACKAGE OUT.cdx.json
"""

import os
import subprocess
import sys
from pathlib import Path

NAME = "itpms-sbom"
ROOT = Path(__file__).resolve().parent.parent


def main():
    triple, package, out = sys.argv[1:]
    folder = ROOT / "crates" / package
    command = ["cargo", "cyclonedx", "--quiet", "--manifest-path", folder / "Cargo.toml", "--format", "json", "--spec-version", "1.5"]
    try:
        subprocess.run([*command, "--target", triple, "--override-filename", NAME], check=True, cwd=ROOT)
        text = (folder / f"{NAME}.json").read_text(encoding="utf-8")
    finally:
        # It writes one beside every crate of the workspace.
        for file in ROOT.glob(f"*/*/{NAME}.json"):
            file.unlink()
    text = text.replace(ROOT.as_uri(), "file:///itpms").replace(ROOT.as_posix(), "/itpms")
    if os.fspath(ROOT) in text:
        sys.exit(f"{out}: holds a path of this machine, expected /itpms in its place")
    Path(out).write_text(text, encoding="utf-8")


main()
