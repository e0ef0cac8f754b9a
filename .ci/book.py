#!/usr/bin/env python3
"""The book holds together: links lead somewhere, equations are numbered once, references to them and citations from the
code resolve, every symbol of a formula is in symbols.md or in its page's own table, every page is in the table of contents. Needs nothing but
Python; prints every fault and ends with 1 if there is one."""

import re
import sys
import unicodedata
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MATH = ROOT / "docs" / "math"
# Pages that carry the paper's equation numbers, which they do not print: up to the last one.
PAPERS_OWN = {"ekf-ui.md": 38, "forgetting.md": 38}
NUMBER = re.compile(r"\s\((\d+[a-z]?)\)(?:-\((\d+)\))?\s*$")
# Longer words in formulas are words; shorter ones are symbols, except these.
NO_SYMBOLS = set("exp sin cos tan tanh sqrt max min tr det Re Im Cov var sd sum of to at and by not the or is in over Hz kPa d "
                 "ln pi up put tire per all m/s".split())
GREEK = set("alpha beta gamma delta eps epsilon eta theta kappa lambda rho sigma tau phi psi omega Phi Psi Lambda Gamma pi".split())
faults = []


def prose_and_formulas(text):
    """Lines outside code, and indented blocks as lists of lines."""
    prose, blocks, block, fenced, before_blank = [], [], [], False, True
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            line = ""
        indented = line.startswith("    ") and (before_blank or block)
        if indented and not fenced:
            block.append(line)
        else:
            if block:
                blocks.append(block)
                block = []
            if not fenced:
                prose.append(line)
        before_blank = not line.strip()
    return prose, blocks + ([block] if block else [])


def numbers(blocks):
    """Every equation number of a page, in order; a range counts with all its numbers."""
    found = []
    for line in (line for block in blocks for line in block):
        if match := NUMBER.search(line):
            first, last = match[1], match[2]
            found += [str(n) for n in range(int(first), int(last) + 1)] if last else [first]
    return found


def slug(heading):
    """The anchor that GitHub and mdBook make of a heading."""
    kept = "".join(c for c in heading.strip().lower() if c.isalnum() or c in "-_ ")
    return kept.replace(" ", "-")


def anchors(path):
    prose, _ = prose_and_formulas(path.read_text(encoding="utf-8"))
    return {slug(re.sub(r"[`*]|\]\([^)]*\)|\[", "", line.lstrip("#"))) for line in prose if line.startswith("#")}


def links(path, prose):
    """Every file this page links to; what leads nowhere is a fault."""
    targets = set()
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", "\n".join(prose))):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        there = (path.parent / file).resolve() if file else path
        if not there.exists():
            faults.append(f"{path.relative_to(ROOT)}: no file {target}")
        elif anchor and there.suffix == ".md" and anchor not in anchors(there):
            faults.append(f"{path.relative_to(ROOT)}: no heading {target}")
        else:
            targets.add(there)
    # Named without a link, which is enough for an equation of it.
    return targets | {path.parent / name for name in re.findall(r"`([\w-]+\.md)`", "\n".join(prose))}


def symbols(text):
    """Symbols in a piece of a formula, without dots, primes and indices: `ẋ_{k-1}` is `x`."""
    plain = "".join(c for c in unicodedata.normalize("NFD", text) if not unicodedata.combining(c))
    plain = plain.translate({ord(c): None for c in "*²³⁴¹⁻⁺"} | {ord(c): " " for c in "πᵀᴴ"})
    found = set()
    for name, index in re.findall(r"([^\W\d_]+)(?:_(\{[^}]*\}|\([^)]*\)|\w+))?", plain):
        if name not in GREEK | NO_SYMBOLS:
            name = re.sub(r"^[∂δΔΣd](?=.)", "", name)
        index = re.sub(r"(?<=[a-z])\d+$", "", index)
        if name in NO_SYMBOLS or (name.isascii() and len(name) > 2 and not index and name not in GREEK):
            continue
        found.add((name, index))
    return found


def known(symbol, table):
    """In the table as it stands, or without an index that only counts."""
    name, index = symbol
    counts = re.fullmatch(r"[\dijkmnp+-]*|\{.*\}|\(.*\)", index)
    return symbol in table or (counts and (name, "") in table)


def table_of(page):
    """Symbols that the first columns of a page's tables explain."""
    table = set()
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("|"):
            for code in re.findall(r"`([^`]*)`", line.split("|")[1].replace("\\|", "")):
                table |= symbols(code)
    return table


def main():
    pages = sorted(MATH.glob("*.md"))
    table = table_of(MATH / "symbols.md")
    equations = {}
    for page in pages:
        prose, blocks = prose_and_formulas(page.read_text(encoding="utf-8"))
        # A statement in words may carry a number at the end of its line, too.
        own = numbers(blocks + [[line for line in prose if re.search(r"\s{4}\(\d+\)$", line)]])
        equations[page] = set(own) | {str(n) for n in range(1, PAPERS_OWN.get(page.name, 0) + 1)}
        for number in sorted({n for n in own if own.count(n) > 1}):
            faults.append(f"{page.name}: equation ({number}) twice")
        if page.name in ("README.md", "symbols.md"):
            continue
        explained = table | table_of(page)
        for block in blocks:
            if not any(NUMBER.search(line) for line in block):
                faults.append(f"{page.name}: no number at {block[0].strip()}")
            for line in block:
                for symbol in sorted(symbols(NUMBER.sub("", line))):
                    if not known(symbol, explained):
                        faults.append(f"{page.name}: {'_'.join(filter(None, symbol))} is neither in symbols.md nor in its own table: {line.strip()}")

    documents = pages + [page for folder in ("docs", ".", "examples", "examples/*") for page in sorted(ROOT.glob(f"{folder}/*.md"))]
    for page in documents:
        prose, _ = prose_and_formulas(page.read_text(encoding="utf-8"))
        targets = links(page, prose)
        if page in equations and equations[page]:
            reachable = equations[page].union(*(equations.get(target, set()) for target in targets))
            for number in re.findall(r"(?<![\w.])\((\d+[a-z]?)\)", re.sub(r"`[^`]*`", "", "\n".join(prose))):
                if number not in reachable:
                    faults.append(f"{page.name}: no equation ({number}) here or on a page linked from here")

    contents = (ROOT / "docs" / "SUMMARY.md").read_text(encoding="utf-8")
    for page in pages:
        if contents.count(f"(math/{page.name})") != 1:
            faults.append(f"SUMMARY.md: not just once: math/{page.name}")

    for source in sorted((ROOT / "crates").rglob("*.rs")):
        text = re.sub(r"\n\s*//[/!]?\s*", " ", source.read_text(encoding="utf-8"))
        for name, first, last in re.findall(r"`(?:docs/math/)?([\w-]+\.md)`,?\s*\(?eq\. (\d+)(?:-(\d+))?", text):
            for number in {first, last or first}:
                if number not in equations.get(MATH / name, set()):
                    faults.append(f"{source.relative_to(ROOT)}: no equation ({number}) in {name}")

    for fault in faults:
        print(fault)
    count = sum(len(found) for found in equations.values())
    print(f"{len(pages)} pages, {count} equations, {len(table)} symbols: {len(faults)} faults")
    return 1 if faults else 0


sys.exit(main())
