"""Counts what the core consists of: `count_core.py [FOLDER] [--modules | --json]`, FOLDER crates/itpms-core/src unless given.

    lines              lines with code on them: not blank, not comment alone, not in tests
    constants          items `const NAME` and `static NAME`, those inside functions and impls among them
    numbers            number literals in them: the fields of a `const DEFAULT: Tuning = Tuning { .. }` are such
    numbers_elsewhere  number literals in other code: the ones without a name

Of number literals whole ones up to 4 (a car has four corners), 0.0, 0.5, 1.0 and 2.0, array lengths and tuple fields (`x.0`) are
not counted. Tests are items behind `#[cfg(test)]` or `#[test]`, and the files of a `#[cfg(test)] mod name;`. It reads tokens, not
Rust: macros count as written."""

import json
import re
import sys
from collections import Counter
from pathlib import Path

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
    |(?P<text>b?r(?P<hashes>\#*)".*?"(?P=hashes)|b?"(?:\\.|[^"\\])*"|b?'(?:\\.[^']*|[^'\\])')
    |(?P<lifetime>'\w+)
    |(?P<number>\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?\w*)
    |(?P<word>[A-Za-z_]\w*)
    |(?P<other>\S)""",
    re.X | re.S,
)
FIGURES = ["lines", "constants", "numbers", "numbers_elsewhere"]
OPEN, CLOSE = "([{", ")]}"


def tokens(text: str) -> list[tuple[str, str, int]]:
    """Kind, text and line of each token, comments left out."""
    found, line, place = [], 1, 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", place, match.start())
        place = match.start()
        if match.lastgroup != "comment":
            kind = "text" if match["text"] is not None else match.lastgroup
            found.append((kind, match.group(), line))
    return found


def closed(found: list, i: int) -> int:
    """The place after the bracket that closes the one at `i`."""
    depth = 0
    while i < len(found):
        depth += (found[i][1] in OPEN) - (found[i][1] in CLOSE)
        i += 1
        if depth == 0:
            break
    return i


def ends(found: list, i: int) -> int:
    """The place after the item that begins at `i`: its `;` or its braces."""
    while i < len(found) and found[i][1] not in ";{":
        i = closed(found, i) if found[i][1] in "([" else i + 1
    return i + 1 if i < len(found) and found[i][1] == ";" else closed(found, i)


def without_tests(found: list) -> tuple[list, set[str]]:
    """The tokens that are no tests, attributes left out, and the names of modules that are tests in files of their own."""
    kept, modules, i = [], set(), 0
    while i < len(found):
        at = [text for _, text, _ in found[i : i + 2]]
        if at not in (["#", "["], ["#", "!"]):
            kept.append(found[i])
            i += 1
            continue
        start = i + (1 if at[1] == "[" else 2)
        end = closed(found, start)
        words = [text for _, text, _ in found[start:end]]
        i = end
        if words[1:2] == ["test"] or (words[1:2] == ["cfg"] and "test" in words and "not" not in words):
            while [text for _, text, _ in found[i : i + 2]] == ["#", "["]:
                i = closed(found, i + 1)
            item = [text for _, text, _ in found[i : i + 6]]  # `pub(crate) mod name`
            if "mod" in item[:5] and found[(end := ends(found, i)) - 1][1] == ";":
                modules.add(item[item.index("mod") + 1])
            i = ends(found, i)
    return kept, modules


def is_counted(found: list, i: int) -> bool:
    kind, text, _ = found[i]
    if kind != "number":
        return False
    before = [token[1] for token in found[max(0, i - 2) : i]]
    if before[-1:] == ["."] and before != [".", "."]:
        return False
    if before[-1:] == [";"] and found[i + 1 : i + 2] and found[i + 1][1] == "]":
        return False
    value = re.sub(r"_|(?:f32|f64|[iu](?:8|16|32|64|128|size))$", "", text)
    try:
        return float(value) not in (0.0, 0.5, 1.0, 2.0) and value not in ("3", "4")
    except ValueError:
        return True


def count(found: list) -> Counter:
    figures, within = Counter(lines=len({line for _, _, line in found})), 0
    for i, (_, text, _) in enumerate(found):
        after = [token[1] for token in found[i + 1 : i + 4]]
        named = after[:1] and re.match(r"[A-Za-z_]", after[0]) and after[0] not in ("fn", "unsafe", "mut")
        generic = i > 0 and found[i - 1][1] in ("<", ",")
        if text in ("const", "static") and named and not generic and ":" in after[1:]:
            figures["constants"] += 1
            depth, end = 0, i
            while end < len(found) and (depth > 0 or found[end][1] != ";"):
                depth += (found[end][1] in OPEN) - (found[end][1] in CLOSE)
                end += 1
            within = max(within, end)
        if is_counted(found, i):
            figures["numbers" if i < within else "numbers_elsewhere"] += 1
    return figures


def count_folder(folder: Path) -> dict[str, Counter]:
    """By module, which is the first part of a file's path."""
    files, tests = {}, set()
    for path in sorted(folder.rglob("*.rs")):
        files[path], modules = without_tests(tokens(path.read_text()))
        home = path.parent if path.name in ("mod.rs", "lib.rs") else path.with_suffix("")
        tests |= {home / name for name in modules}
    counted: dict[str, Counter] = {}
    for path, found in files.items():
        if not any(test == path.with_suffix("") or test in path.parents for test in tests):
            counted.setdefault(path.relative_to(folder).parts[0], Counter()).update(count(found))
    return counted


def main(arguments: list[str]) -> int:
    folders = [a for a in arguments if not a.startswith("--")]
    folder = Path(folders[0]) if folders else Path(__file__).parent.parent / "crates" / "itpms-core" / "src"
    modules = count_folder(folder)
    whole = sum(modules.values(), Counter())
    if "--json" in arguments:
        print(json.dumps({name: whole[name] for name in FIGURES}))
        return 0
    print("module".ljust(24), *(name.rjust(18) for name in FIGURES))
    for name, figures in [*(modules.items() if "--modules" in arguments else []), ("all", whole)]:
        print(name.ljust(24), *(str(figures[figure]).rjust(18) for figure in FIGURES))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
