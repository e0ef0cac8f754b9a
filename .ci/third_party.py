"""The licences of the linked dependencies, as the program's packages must carry them.

    third_party.py TRIPLE PACKAGE... > THIRD-PARTY.txt

Each crate that one of the packages links on that target, but for the project's own, with its licence and copyright files; the same text once. What only
builds or tests is not among them. Needs Python 3.11 and cargo alone.
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

FILES = re.compile(r"(licen[cs]e|copying|notice|copyright|unlicense)([-._].*)?", re.I)


def linked(metadata, names):
    """The packages that these link, by way of normal dependencies; a macro's own are the compiler's."""
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    is_macro = {i: any("proc-macro" in target["kind"] for target in packages[i]["targets"]) for i in packages}
    found, ahead = set(), [i for i, package in packages.items() if package["name"] in names and package["source"] is None]
    while ahead:
        package = ahead.pop()
        if package in found or is_macro[package]:
            continue
        found.add(package)
        ahead += [d["pkg"] for d in nodes[package]["deps"] if any(kind["kind"] is None for kind in d["dep_kinds"])]
    return sorted((packages[i] for i in found if packages[i]["source"]), key=lambda package: (package["name"], package["version"]))


def main():
    triple, *names = sys.argv[1:]
    sys.stdout.reconfigure(encoding="utf-8")
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", triple]
    crates = linked(json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout), names)
    if not crates:
        sys.exit(f"{' '.join(names)}: no crates are linked, expected packages of this workspace")
    print("itpms contains these works of others: the Rust standard library (MIT OR Apache-2.0, https://www.rust-lang.org),")
    if "musl" in triple:
        print("musl (MIT, copyright 2005-2020 Rich Felker and others, https://musl.libc.org),")
    print("and from https://crates.io:\n")
    texts, owners = {}, defaultdict(list)
    for crate in crates:
        label = f"{crate['name']} {crate['version']}"
        print(f"  {label}: {crate['license']}, {crate['repository'] or 'https://crates.io/crates/' + crate['name']}")
        for file in sorted(Path(crate["manifest_path"]).parent.iterdir()):
            if FILES.fullmatch(file.name) and file.is_file():
                text = file.read_text(encoding="utf-8", errors="replace").strip("\n")
                # The same words, however they are broken into lines.
                words = " ".join(text.split())
                texts.setdefault(words, text)
                owners[words].append(label)
    for words, text in texts.items():
        print(f"\n{'-' * 80}\n{', '.join(dict.fromkeys(owners[words]))}:\n\n{text}")


main()
