"""Where a program built from `no-panic` with `--features count` may still panic: each call of a panic, and the branches to it.

    .ci/no_panic.py PROGRAM

Needs llvm-objdump and llvm-symbolizer. Ends with 1 if a call is left.
"""

import re
import subprocess
import sys

# Bytes before a call in which its arguments are loaded; a branch to there is one that leads to it.
ARGUMENTS = 24
DEEPEST = 9
PANICS = re.compile(r"panicking|slice_index_fail|unwrap_failed|expect_failed|rust_begin_unwind")


def said(*command: str) -> list[str]:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def where(program: str, address: int) -> str:
    """Source lines of an instruction, the innermost first, through what was inlined."""
    lines = said("llvm-symbolizer", f"--obj={program}", "--inlines", hex(address))[1::2]
    return " <- ".join(re.sub(r".*/(itpms-core/src|registry/src/[^/]*|library)/", "", line) for line in lines[:DEEPEST])


def main() -> int:
    program = sys.argv[1]
    listing = said("llvm-objdump", "-d", "--no-show-raw-insn", program)
    inside, calls, branches = "", [], []
    for line in listing:
        if name := re.match(r"^[0-9a-f]+ <(.+)>:", line):
            inside = name.group(1)
        elif step := re.match(r"^\s*([0-9a-f]+):\s+(\S+)\s.*?0x([0-9a-f]+) <([^>+]*)", line):
            address, operation, target, name = step.groups()
            if operation in ("b", "b.w", "bl") and PANICS.search(name) and not PANICS.search(inside):
                calls.append(int(address, 16))
            elif operation != "bl":
                branches.append((int(address, 16), int(target, 16)))
    for call in calls:
        print(where(program, call))
        for line in sorted({where(program, at) for at, to in branches if call - ARGUMENTS <= to <= call}):
            print("    from", line)
    print(f"{len(calls)} calls of panics")
    return bool(calls)


sys.exit(main())
