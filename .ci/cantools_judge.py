#!/usr/bin/env python3
"""Random DBC files and frames, decoded and encoded by cantools and by us: the same values, the same bytes.

    cantools_judge.py DBC_LINES [MESSAGES]

DBC_LINES is the built example `dbc_lines` of itpms-can-log. Prints every difference and ends with 1 if there is one."""

import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import cantools

CLASSIC = range(1, 9)
FD = (12, 16, 20, 24, 32, 48, 64)
SCALES = ((1, 0), (0.5, 0), (0.1, -40), (0.01, 0), (-0.25, 10), (3, -7), (1e-3, 0.5))
FRAMES = 40
dice = random.Random(20260)


def bits_of(start, length, intel):
    """Numbers of all bits of a signal, or None where it leaves the frame."""
    bits, at = [], start
    for _ in range(length):
        bits.append(at)
        if intel:
            at += 1
        else:
            at = at + 15 if at % 8 == 0 else at - 1
    return bits


def place(free, size):
    """A random place among the free bits; takes them."""
    for _ in range(60):
        start, intel = dice.randrange(8 * size), dice.random() < 0.5
        length = dice.choice((1, 2, 3, 5, 8, 10, 12, 16, 16, 20, 24, 31, 32, 32, 33, 48, 63, 64, 64))
        bits = bits_of(start, length, intel)
        if set(bits) <= free:
            free -= set(bits)
            return start, length, intel
    return None


class Signal:
    def __init__(self, name, where, multiplexing="", plain=False):
        self.name, (self.start, self.length, self.intel), self.multiplexing = name, where, multiplexing
        self.signed = not plain and dice.random() < 0.5
        self.factor, self.offset = (1, 0) if plain else dice.choice(SCALES)
        self.float = not plain and self.length in (32, 64) and dice.random() < 0.5
        if self.float:
            self.signed, (self.factor, self.offset) = True, dice.choice(((1, 0), (2, 1)))

    def line(self):
        return (f" SG_ {self.name} {self.multiplexing}: {self.start}|{self.length}@{int(self.intel)}{'-' if self.signed else '+'} "
                f"({self.factor},{self.offset}) [0|0] \"\" Vector__XXX")

    def random_value(self):
        """A physical value that a raw one stands for."""
        if self.float:
            return dice.choice((0.0, 1.5, -0.375, 2.0**20, -3.0)) * self.factor + self.offset
        # 48 bits leave room for the roundings of either side.
        wide = min(self.length, 48)
        raw = dice.randrange(-(1 << (wide - 1)), 1 << (wide - 1)) if self.signed else dice.randrange(1 << wide)
        return raw * self.factor + self.offset


class Message:
    def __init__(self, number):
        self.name = f"Message{number}"
        self.extended = dice.random() < 0.4
        self.id = 0x100 + number + (dice.randrange(1 << 17) << 11 if self.extended else 0)
        self.size = dice.choice(FD if dice.random() < 0.3 else CLASSIC)
        free, self.signals, self.extra = set(range(8 * self.size)), [], []
        if dice.random() < 0.4 and self.size > 1:
            self.multiplex(free)
        while (where := place(free, self.size)) and len(self.signals) < 30:
            self.signals.append(Signal(f"Signal{len(self.signals)}", where))
        if not self.signals:
            self.signals.append(Signal("Signal0", (0, 8, True)))

    def multiplex(self, free):
        """Four pages under a multiplexer of two bits; the last of them may have pages of its own."""
        self.switch(free, "Page", "M")
        common = set(dice.sample(sorted(free), len(free) // 2))
        nested = dice.random() < 0.5
        for page in range(4):
            own = set(common)
            if nested and page == 3:
                switch = self.switch(own, "SubPage", "m3M")
                if switch is None:
                    continue
                self.extra.append(f"SG_MUL_VAL_ {self.number()} SubPage Page 3-3;")
                half = set(own)
                if where := place(half, self.size):
                    self.signals.append(Signal("Deep01", where, "m0 "))
                    self.extra.append(f"SG_MUL_VAL_ {self.number()} Deep01 SubPage 0-1;")
                if where := place(own, self.size):
                    self.signals.append(Signal("Deep23", where, "m2 "))
                    self.extra.append(f"SG_MUL_VAL_ {self.number()} Deep23 SubPage 2-2, 3-3;")
                continue
            for i in range(dice.randrange(1, 4)):
                if where := place(own, self.size):
                    self.signals.append(Signal(f"P{page}N{i}", where, f"m{page} "))
                    if nested:
                        self.extra.append(f"SG_MUL_VAL_ {self.number()} P{page}N{i} Page {page}-{page};")
        free -= common

    def switch(self, free, name, multiplexing):
        pairs = [bit for bit in free if bit % 8 < 7 and bit + 1 in free]
        if not pairs:
            return None
        start = dice.choice(sorted(pairs))
        free -= {start, start + 1}
        self.signals.append(Signal(name, (start, 2, True), multiplexing + " ", plain=True))
        return start

    def number(self):
        return self.id | (1 << 31 if self.extended else 0)

    def text(self):
        return "\n".join([f"BO_ {self.number()} {self.name}: {self.size} Vector__XXX"] + [s.line() for s in self.signals]) + "\n"

    def key(self):
        return f"{self.id:08X}" if self.extended else f"{self.id:03X}"


def same(ours, theirs):
    theirs = float(theirs)
    if math.isnan(ours) or math.isnan(theirs):
        return math.isnan(ours) and math.isnan(theirs)
    # Both round a product and a sum; one of them may do so in another order.
    return ours == theirs or abs(ours - theirs) <= 1e-12 * max(1.0, abs(theirs))


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 400
    messages = [Message(number) for number in range(count)]
    text = 'VERSION ""\n\nBS_:\n\nBU_: Vector__XXX\n\n' + "\n".join(m.text() for m in messages) + "\n"
    text += "".join(f"SIG_VALTYPE_ {m.number()} {s.name} : {1 if s.length == 32 else 2};\n" for m in messages for s in m.signals if s.float)
    text += "".join(line + "\n" for m in messages for line in m.extra)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "random.dbc"
        path.write_text(text, encoding="cp1252")
        database = cantools.database.load_file(path, strict=True)
        questions, answers = [], []
        for message in messages:
            theirs = database.get_message_by_frame_id(message.id) if not message.extended else \
                next(m for m in database.messages if m.frame_id == message.id and m.is_extended_frame)
            for _ in range(FRAMES):
                data = dice.randbytes(message.size)
                if dice.random() < 0.2:
                    data = data[:dice.randrange(message.size + 1)]
                try:
                    expected = theirs.decode(data, decode_choices=False, allow_truncated=True)
                except cantools.database.DecodeError:
                    # A multiplexer's value that no signal belongs to is an error there, and no signals here.
                    continue
                questions.append(f"d {message.key()} {data.hex()}")
                answers.append(expected)
                values = {s.name: s.random_value() for s in message.signals}
                try:
                    encoded = theirs.encode(values, strict=False)
                except cantools.database.EncodeError:
                    continue
                questions.append(f"e {message.key()} " + " ".join(repr(float(values[s.name])) for s in message.signals))
                answers.append(encoded)
        result = subprocess.run([program, path], input="\n".join(questions) + "\n", capture_output=True, text=True, check=True)
    faults = result.stderr.splitlines()
    lines = result.stdout.splitlines()
    assert len(lines) == len(questions), f"{len(lines)} answers to {len(questions)} questions"
    values = 0
    for question, line, expected in zip(questions, lines, answers):
        if isinstance(expected, dict):
            ours = dict(word.split("=") for word in line.split()) if not line.startswith("error") else {"error": "nan"}
            values += len(expected)
            if ours.keys() != expected.keys() or not all(same(float(ours[name]), expected[name]) for name in expected):
                faults.append(f"{question}\n  ours   {line}\n  theirs {expected}")
        elif line != expected.hex().upper():
            faults.append(f"{question}\n  ours   {line}\n  theirs {expected.hex().upper()}")
    for fault in faults[:20]:
        print(fault)
    decoded = sum(isinstance(answer, dict) for answer in answers)
    print(f"{count} messages, {decoded} frames with {values} values decoded, {len(answers) - decoded} encoded: {len(faults)} differences")
    return 1 if faults else 0


sys.exit(main())
