"""Checks every dependency against deny.toml: a licence from its list, and crates.io as its source.

A subset of cargo-deny's checks, for machines without it. Needs Python 3.11 and cargo alone.
"""

import json
import re
import subprocess
import sys
import tomllib

CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"


def allowed(expression: str, licences: set[str]) -> bool:
    """Whether an SPDX expression can be met with these licences; AND binds tighter than OR."""
    tokens = re.findall(r"\(|\)|[^\s()]+(?:\s+WITH\s+[^\s()]+)?", expression.replace("/", " OR "))

    def alternatives() -> bool:
        met = terms()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            met = terms() or met
        return met

    def terms() -> bool:
        met = term()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            met = term() and met
        return met

    def term() -> bool:
        token = tokens.pop(0)
        if token != "(":
            return token in licences
        met = alternatives()
        tokens.pop(0)
        return met

    return alternatives()


def main() -> int:
    with open("deny.toml", "rb") as file:
        licences = set(tomllib.load(file)["licenses"]["allow"])
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--all-features"]
    packages = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["packages"]
    complaints = []
    for package in packages:
        name = f"{package['name']} {package['version']}"
        if not package["license"] or not allowed(package["license"], licences):
            complaints.append(f"{name}: licence {package['license']!r} is not among those deny.toml allows")
        if package["source"] not in (None, CRATES_IO):
            complaints.append(f"{name}: comes from {package['source']}, expected crates.io")
    print("\n".join(complaints) or f"{len(packages)} packages: licences and sources as deny.toml wants them")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
