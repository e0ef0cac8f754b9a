"""Writes the small MDF4 files of this folder: with asammdf where it can write them, and else block by block.

    python make.py [DIRECTORY]

Every file is read back with asammdf and held against the formulas below, which tests/foreign.rs has as well. Needs
asammdf, numpy and python-can.
"""

import struct
import sys
import zlib
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "itpms-can-log" / "tests" / "data"))
import generate  # the frames of the CAN logs

HERE = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent

# --- what is in the files: sample i of a group ----------------------------------------------------------------------

FAST, SLOW = 240, 24


def fast_time(i):
    return i * 0.002


def accel(i):  # exact in f32
    return (i * i % 97) * 0.25 - 10.0


def slow_time(i):
    return i * 0.02 + 0.001


def count(i):  # signed, both signs
    return (i * 37 % 200) - 100


# --- asammdf --------------------------------------------------------------------------------------------------------


def groups():
    i = np.arange(FAST)
    j = np.arange(SLOW)
    t, u = fast_time(i), slow_time(j)
    fast = [
        Signal(accel(i).astype("<f8"), t, name="accel_f64", unit="m/s^2", comment="body, front left"),
        Signal(accel(i).astype("<f4"), t, name="accel_f32", unit="m/s^2"),
        Signal(accel(i).astype("<f2"), t, name="accel_f16", unit="m/s^2"),
        Signal(count(i).astype("<i2"), t, name="scaled", unit="kPa", conversion={"a": 0.5, "b": -3.0}),
    ]
    slow = [
        Signal((j % 256).astype("u1"), u, name="byte", unit=""),
        Signal((j * 1000003).astype("<u8"), u, name="wide", unit="µm"),
        Signal(np.array([b"gear %d" % (k % 5) for k in range(SLOW)]), u, name="words", encoding="utf-8"),
    ]
    return fast, slow


def new(version="4.10"):
    mdf = MDF(version=version)
    mdf.header.start_time = datetime(2026, 11, 20, tzinfo=timezone.utc)
    return mdf


def save(mdf, name, compression=0):
    mdf.save(HERE / name, overwrite=True, compression=compression)


def native_rates(name, version, compression, fragment=None):
    mdf = new(version)
    if fragment:
        mdf.configure(write_fragment_size=fragment)
    fast, slow = groups()
    mdf.append(fast, acq_name="fast", comment="500 Hz")
    mdf.append(slow, acq_name="slow", comment="50 Hz")
    save(mdf, name, compression)
    check_native(name)


def check_native(name):
    with MDF(HERE / name) as mdf:
        i, j = np.arange(FAST), np.arange(SLOW)
        for channel in ("accel_f64", "accel_f32", "accel_f16"):
            signal = mdf.get(channel)
            assert np.array_equal(signal.samples.astype(float), accel(i)), (name, channel)
            assert np.array_equal(signal.timestamps, fast_time(i)) and signal.unit == "m/s^2"
        assert np.array_equal(mdf.get("scaled").samples, 0.5 * count(i) - 3.0)
        assert np.array_equal(mdf.get("wide").samples, j * 1000003) and mdf.get("wide").unit == "µm"


def invalidation(name):
    mdf = new()
    i = np.arange(FAST)
    signals = [
        Signal(accel(i), fast_time(i), name="thirds", invalidation_bits=i % 3 == 0),
        Signal(accel(i), fast_time(i), name="all_valid"),
        Signal(count(i).astype("<i4"), fast_time(i), name="fifths", invalidation_bits=i % 5 == 4),
    ]
    mdf.append(signals, acq_name="some invalid")
    save(mdf, name, 2)
    with MDF(HERE / name) as mdf:
        assert np.array_equal(mdf.get("thirds", ignore_invalidation_bits=True).samples, accel(i))
        assert np.array_equal(mdf.get("thirds").timestamps, fast_time(i)[i % 3 != 0])


def big_endian(name):
    mdf = new()
    i = np.arange(FAST)
    signals = [
        Signal(accel(i).astype(">f8"), fast_time(i), name="f64"),
        Signal(accel(i).astype(">f4"), fast_time(i), name="f32"),
        Signal(count(i).astype(">i2"), fast_time(i), name="i16"),
        Signal((i * 70000).astype(">u4"), fast_time(i), name="u32"),
    ]
    mdf.append(signals, acq_name="motorola")
    save(mdf, name)
    with MDF(HERE / name) as mdf:
        assert np.array_equal(mdf.get("i16").samples, count(i)) and np.array_equal(mdf.get("u32").samples, i * 70000)


def conversions(name):
    mdf = new()
    i = np.arange(FAST)
    t, raw = fast_time(i), (i % 12).astype("u1")
    rising = {f"raw_{k}": 4.0 * k for k in range(4)} | {f"phys_{k}": float(10 * k * k) for k in range(4)}
    ranges = {"default": -1.0}
    for k in range(3):
        ranges |= {f"lower_{k}": 3.0 * k, f"upper_{k}": 3.0 * k + 1, f"phys_{k}": 100.0 * k}
    words = {f"val_{k}": float(k) for k in range(3)} | {f"text_{k}": f"word {k}".encode() for k in range(3)}
    rational = {"P1": 0.0, "P2": 0.0, "P3": 6.0, "P4": 0.0, "P5": 1.0, "P6": 1.0}
    signals = [
        Signal(raw, t, name="interpolated", conversion=rising | {"interpolation": True}),
        Signal(raw, t, name="nearest", conversion=rising | {"interpolation": False}),
        Signal(raw.astype("<f4"), t, name="ranges", conversion=ranges),  # (of integers it loses the upper ends)
        Signal(raw, t, name="rational", conversion=rational),
        Signal(raw, t, name="words", conversion=words | {"default_addr": b"other"}),
        Signal(raw, t, name="formula", conversion={"formula": "X*2"}),
    ]
    mdf.append(signals, acq_name="converted")
    save(mdf, name)
    with MDF(HERE / name) as mdf:
        assert np.allclose(mdf.get("rational").samples, 6.0 / (raw + 1.0), rtol=1e-15)
        expected = [float(np.interp(x, [0, 4, 8, 12], [0, 10, 40, 90])) for x in raw]
        assert np.array_equal(mdf.get("interpolated").samples, expected)
        expected = [100.0 * (x // 3) if x % 3 == 0 and x < 9 else -1.0 for x in raw.astype(int)]
        assert np.array_equal(mdf.get("ranges").samples, expected)
        steps = [[0, 10, 40, 90][0 if x <= 2 else 1 if x <= 6 else 2 if x <= 10 else 3] for x in raw]
        assert np.array_equal(mdf.get("nearest").samples, steps)


# --- block by block: what asammdf reads but does not write ------------------------------------------------------------


class Blocks:
    """A file in the making; links are patched once their targets have a place."""

    def __init__(self, magic=b"MDF     ", unfinished=0):
        self.bytes = bytearray(
            struct.pack("<8s8s8s4sH30s2H", magic, b"4.10    ", b"by hand ", b"", 410, b"", unfinished, 0)
        )
        self.add(b"##HD", [0] * 6, struct.pack("<Q2h4B2d", 1_795_132_800_000_000_000, 0, 0, 0, 0, 0, 0, 0.0, 0.0))

    def add(self, name, links, data):
        self.bytes += bytes(-len(self.bytes) % 8)
        at = len(self.bytes)
        self.bytes += struct.pack("<4sIQQ", name, 0, 24 + 8 * len(links) + len(data), len(links))
        self.bytes += struct.pack(f"<{len(links)}Q", *links) + data
        return at

    def link(self, at, n, target):
        struct.pack_into("<Q", self.bytes, at + 24 + 8 * n, target)

    def text(self, words):
        return self.add(b"##TX", [], words.encode() + b"\0")

    def linear(self, factor, offset):
        return self.add(b"##CC", [0] * 4, struct.pack("<2B3H2d2d", 1, 0, 0, 0, 2, 0, 0, offset, factor))

    def channel(self, name, unit="", kind=0, sync=0, data_type=0, byte=0, bit=0, bits=8, conversion=0, data=0):
        links = [0, 0, self.text(name), 0, conversion, data, self.text(unit) if unit else 0, 0]
        body = struct.pack("<4B4I2BH6d", kind, sync, data_type, bit, byte, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
        return self.add(b"##CN", links, body)

    def group(self, channels, cycles, length, record_id=0, flags=0, name="", invalid=0, master=0):
        for this, following in zip(channels, channels[1:]):
            self.link(this, 0, following)
        links = [0, channels[0], self.text(name) if name else 0, 0, 0, 0] + ([master] if master else [])
        return self.add(b"##CG", links, struct.pack("<2Q2H3I", record_id, cycles, flags, 0, 0, length, invalid))

    def data_group(self, groups, data, id_bytes=0):
        for this, following in zip(groups, groups[1:]):
            self.link(this, 0, following)
        at = self.add(b"##DG", [0, groups[0], data, 0], struct.pack("<B7x", id_bytes))
        self.link(64, 0, at)
        return at

    def save(self, name):
        (HERE / name).write_bytes(self.bytes)


def sub_byte(name):
    """Bits anywhere, in both byte orders, and a clock that is computed from the number of the sample."""
    blocks = Blocks()
    channels = [
        blocks.channel("t", "s", kind=3, sync=1, bits=0, conversion=blocks.linear(0.01, 1.0)),
        blocks.channel("three_bits", data_type=0, byte=0, bit=2, bits=3),
        blocks.channel("signed_12", data_type=2, byte=1, bit=3, bits=12),
        blocks.channel("motorola_12", data_type=3, byte=3, bit=2, bits=12),
        blocks.channel("one_bit", data_type=0, byte=5, bit=7, bits=1),
    ]
    records = bytearray()
    for i in range(SLOW):
        little = (count(i) & 0xFFF) << 3 | 0x8000 | 5  # noise around the field
        big = (count(i) & 0xFFF) << 2 | 0x8001
        records += bytes([(i % 8) << 2 | 0xC3]) + struct.pack("<H", little) + struct.pack(">H", big)
        records += bytes([(i % 2) << 7 | 0x55, 255 - 5 * i])
    # 255 is a text, 200 to 220 are halved, everything else is doubled and one more.
    halved, doubled = blocks.linear(0.5, 0.0), blocks.linear(2.0, 1.0)
    ends = [255.0, 255.0, 200.0, 220.0]
    scales = blocks.add(
        b"##CC",
        [0, 0, 0, 0, blocks.text("not available"), halved, doubled],
        struct.pack("<2B3H2d4d", 8, 0, 0, 3, 4, 0, 0, *ends),
    )
    channels.append(blocks.channel("partly", byte=6, conversion=scales))
    data = blocks.add(b"##DT", [], bytes(records))
    blocks.data_group([blocks.group(channels, SLOW, 7, name="bits")], data)
    blocks.save(name)
    with MDF(HERE / name) as mdf:
        i = np.arange(SLOW)
        assert np.array_equal(mdf.get("three_bits").samples, i % 8)
        assert np.array_equal(mdf.get("signed_12").samples, count(i))
        assert np.array_equal(mdf.get("motorola_12").samples, count(i))
        assert np.array_equal(mdf.get("one_bit").samples, i % 2)
        expected = [np.nan if x == 255 else 0.5 * x if 200 <= x <= 220 else 2.0 * x + 1.0 for x in 255 - 5 * i]
        assert np.array_equal(mdf.get("partly").samples, expected, equal_nan=True)
        assert np.allclose(mdf.get("one_bit").timestamps, 0.01 * i + 1.0)


def zipped(original, data, columns):
    rows = len(data) // columns
    turned = np.frombuffer(data[: rows * columns], "u1").reshape(rows, columns).T.tobytes() + data[rows * columns :]
    packed = zlib.compress(turned)
    return b"##DZ", [], struct.pack("<2s2BI2Q", original, 1, 0, columns, len(data), len(packed)) + packed


def columns(name, lists):
    """The time in one group, two channels in groups of their own that refer to it (MDF 4.2)."""
    blocks = Blocks()
    struct.pack_into("<8s", blocks.bytes, 8, b"4.20    ")
    struct.pack_into("<H", blocks.bytes, 28, 420)
    clock = blocks.channel("t", "s", kind=2, sync=1, data_type=4, byte=0, bits=64)
    plain = blocks.channel("plain", data_type=4, byte=0, bits=64)
    sevenths = blocks.channel("sevenths", data_type=2, byte=0, bits=16)
    struct.pack_into("<I", blocks.bytes, sevenths + 24 + 64 + 12, 2 if lists else 0)  # has an invalidation bit
    master = blocks.group([clock], FAST, 8, name="time")
    remote = dict(flags=1 << 3, master=master)
    others = [
        blocks.group([plain], FAST, 8, **remote),
        blocks.group([sevenths], FAST, 2, invalid=1 if lists else 0, **remote),
    ]
    data = [
        b"".join(struct.pack("<d", fast_time(i)) for i in range(FAST)),
        b"".join(struct.pack("<d", accel(i)) for i in range(FAST)),
        b"".join(struct.pack("<h", count(i)) for i in range(FAST)),
    ]
    places = [blocks.add(b"##DV", [], values) for values in data[:2]]
    if lists:
        # Two lists: two plain blocks, then a transposed one; a record is never whole in one block alone.
        valid = bytes(int(i % 7 == 0) for i in range(FAST))
        parts = [blocks.add(b"##DV", [], data[2][:101]), blocks.add(b"##DV", [], data[2][101:200])]
        checks = [blocks.add(b"##DI", [], valid[:51]), blocks.add(b"##DI", [], valid[51:100])]
        last = [blocks.add(*zipped(b"DV", data[2][200:], 2)), blocks.add(*zipped(b"DI", valid[100:], 3))]
        flags = struct.pack("<4BI", 0, 0, 0, 0x80, 1) + struct.pack("<Q", 200)
        second = blocks.add(b"##LD", [0, *last], flags)
        flags = struct.pack("<4BI", 0, 0, 0, 0x80, 2) + struct.pack("<2Q", 0, 101)
        places.append(blocks.add(b"##LD", [second, *parts, *checks], flags))
    else:
        places.append(blocks.add(b"##DV", [], data[2]))
    chain = [blocks.data_group([group], place) for group, place in zip([master, *others], places)]
    for this, following in zip(chain, chain[1:]):
        blocks.link(this, 0, following)
    blocks.link(64, 0, chain[0])
    blocks.save(name)
    if not lists:  # asammdf 8.8 cannot read LD
        with MDF(HERE / name) as mdf:
            assert np.array_equal(mdf.get("plain").samples, accel(np.arange(FAST)))
            assert np.array_equal(mdf.get("plain").timestamps, fast_time(np.arange(FAST)))
            assert np.array_equal(mdf.get("sevenths").samples, count(np.arange(FAST)))


def mixed_records():
    """Ten fast samples, then a slow one and a text, by record ids of two bytes; times in 10 µs."""
    records = bytearray()
    for i in range(FAST):
        records += struct.pack("<HIf", 1, i * 200, accel(i))
        if i % 10 == 9:
            j = i // 10
            words = b"sample %d" % j
            records += struct.pack("<HIhQ", 2, j * 2000 + 100, count(j), 0)
            records += struct.pack("<HI", 3, len(words)) + words
    return bytes(records)


def mixed(name, magic=b"MDF     ", unfinished=0, fast=FAST, slow=SLOW, length=None, extra=b""):
    blocks = Blocks(magic, unfinished)
    clock = dict(kind=2, sync=1, data_type=0, byte=0, bits=32)
    ticks = blocks.linear(1e-5, 0.0)
    first = [
        blocks.channel("t", "s", conversion=ticks, **clock),
        blocks.channel("accel", "m/s^2", data_type=4, byte=4, bits=32),
    ]
    second = [
        blocks.channel("t", "s", conversion=ticks, **clock),
        blocks.channel("count", "1", data_type=2, byte=4, bits=16),
        blocks.channel("words", kind=1, data_type=7, byte=6, bits=64),
    ]
    groups = [
        blocks.group(first, fast, 8, record_id=1, name="fast"),
        blocks.group(second, slow, 14, record_id=2, name="slow"),
        # Of texts the group says how many bytes they take, each with its length in front.
        blocks.group([0], slow, sum(4 + len(b"sample %d" % j) for j in range(slow)), record_id=3, flags=1),
    ]
    blocks.link(second[2], 5, groups[2])
    group = blocks.data_group(groups, 0, id_bytes=2)
    data = blocks.add(b"##DT", [], mixed_records() + extra)
    if length is not None:
        struct.pack_into("<Q", blocks.bytes, data + 8, length)
    blocks.link(group, 2, data)
    blocks.save(name)
    return blocks


def check_mixed(name):
    with MDF(HERE / name) as mdf:
        i, j = np.arange(FAST), np.arange(SLOW)
        assert np.array_equal(mdf.get("accel").samples, accel(i)), name
        assert np.allclose(mdf.get("accel").timestamps, fast_time(i), rtol=1e-12)
        assert np.array_equal(mdf.get("count").samples, count(j)), name
        assert np.allclose(mdf.get("count").timestamps, slow_time(j), rtol=1e-12)


def unfinished_sorted(name):
    """As a logger that lost its power leaves it: no count, no length, half a record at the end."""
    blocks = Blocks(b"UnFinMF ", 1 | 4)
    channels = [
        blocks.channel("t", "s", kind=2, sync=1, data_type=4, byte=0, bits=64),
        blocks.channel("accel", "m/s^2", data_type=4, byte=8, bits=32),
    ]
    group = blocks.data_group([blocks.group(channels, 0, 12, name="fast")], 0)
    records = b"".join(struct.pack("<df", fast_time(i), accel(i)) for i in range(FAST))
    data = blocks.add(b"##DT", [], records)
    struct.pack_into("<Q", blocks.bytes, data + 8, 24)
    blocks.link(group, 2, data)
    blocks.save(name)
    with MDF(HERE / name) as mdf:
        assert np.array_equal(mdf.get("accel").samples, accel(np.arange(FAST)))
    with open(HERE / name, "ab") as file:
        file.write(b"\x01\x02\x03\x04\x05")


def frame_channels(blocks, name, data, length):
    """The channels of a group of frames, `name` with the others inside it; `data` is how the data's channel is made."""
    bits = dict(data_type=0, bit=0)
    inside = [
        blocks.channel(f"{name}.{field}", **(bits | place))
        for field, place in [
            ("ID", dict(byte=8, bits=29)),
            ("IDE", dict(byte=11, bit=5, bits=1)),
            ("BusChannel", dict(byte=12, bits=4)),
            ("Dir", dict(byte=12, bit=4, bits=1)),
            ("EDL", dict(byte=12, bit=5, bits=1)),
            ("BRS", dict(byte=12, bit=6, bits=1)),
            ("ESI", dict(byte=12, bit=7, bits=1)),
            ("DLC", dict(byte=13, bits=4)),
            ("DataLength", dict(byte=14, bits=7)),
        ]
    ]
    if data:
        inside.append(blocks.channel(f"{name}.DataBytes", data_type=10, byte=15, **data))
        if data["kind"] == 5:
            blocks.link(inside[-1], 5, inside[-2])
    for this, following in zip(inside, inside[1:]):
        blocks.link(this, 0, following)
    whole = blocks.channel(name, data_type=10, byte=8, bits=8 * (length - 8))
    blocks.link(whole, 1, inside[0])
    return [blocks.channel("t", "s", kind=2, sync=1, data_type=4, byte=0, bits=64), whole], inside[-1]


def frame_record(message, data):
    """Time, identifier and flags, lengths, then what stands for the data."""
    flags = (not message.is_rx) << 4 | message.is_fd << 5 | message.bitrate_switch << 6 | message.error_state_indicator << 7
    return struct.pack(
        "<dI3B",
        message.timestamp - 1_795_132_800.0,
        message.arbitration_id | message.is_extended_id << 29,
        message.channel | flags,
        generate.can.util.len2dlc(message.dlc),
        len(message.data),
    ) + data


def bus(name, apart):
    """A bus logging: bits side by side. `apart`: sorted, the data of frames in blocks of their own; else all records in one stream, a frame's data before
    or after it, those of errors in a place of fixed length that is seldom full."""
    blocks = Blocks()
    messages = [generate.frame(i) for i in range(generate.FRAMES)]
    kinds = {
        "CAN_DataFrame": [m for m in messages if not (m.is_remote_frame or m.is_error_frame)],
        "CAN_RemoteFrame": [m for m in messages if m.is_remote_frame],
        "CAN_ErrorFrame": [m for m in messages if m.is_error_frame],
    }
    stored = {
        "CAN_DataFrame": dict(kind=1, bits=64),
        "CAN_RemoteFrame": None,
        "CAN_ErrorFrame": dict(kind=5, bits=64),
    }
    groups, streams, last = [], [], {}
    for number, (kind, own) in enumerate(kinds.items()):
        length = 23 if stored[kind] else 15
        channels, last[kind] = frame_channels(blocks, kind, stored[kind], length)
        groups.append(blocks.group(channels, len(own), length, record_id=number + 1, flags=6, name="CAN"))
    place, records, samples = 0, {}, {}
    for index, m in enumerate(messages):
        kind = next(kind for kind, own in kinds.items() if m in own)
        data = b""
        if kind == "CAN_DataFrame":
            samples[index] = struct.pack("<I", len(m.data)) + bytes(m.data)
            data, place = struct.pack("<Q", place), place + len(samples[index])
        elif kind == "CAN_ErrorFrame":
            data = bytes(m.data).ljust(8, b"\xee")
        records[index] = (list(kinds).index(kind) + 1, frame_record(m, data))
    if apart:
        values = b"".join(samples.values())
        parts = [blocks.add(b"##SD", [], values[:301]), blocks.add(b"##SD", [], values[301:])]
        listed = blocks.add(b"##DL", [0, *parts], struct.pack("<4BI2Q", 0, 0, 0, 0, 2, 0, 301))
        blocks.link(last["CAN_DataFrame"], 5, listed)
        chain = []
        for number, group in enumerate(groups, 1):
            data = blocks.add(b"##DT", [], b"".join(record for id, record in records.values() if id == number))
            chain.append(blocks.data_group([group], data))
        for this, following in zip(chain, chain[1:]):
            blocks.link(this, 0, following)
        blocks.link(64, 0, chain[0])
    else:
        varying = blocks.group([0], len(samples), place, record_id=9, flags=1)
        blocks.link(last["CAN_DataFrame"], 5, varying)
        stream = bytearray()
        for index, (id, record) in records.items():
            parts = [struct.pack("<B", id) + record]
            if index in samples:
                parts.insert(index % 3 == 0, struct.pack("<B", 9) + samples[index])
            stream += b"".join(parts)
        blocks.data_group([*groups, varying], blocks.add(b"##DT", [], bytes(stream)), id_bytes=1)
    blocks.save(name)
    with MDF(HERE / name) as mdf:
        for kind, own in kinds.items():
            found = mdf.get(kind).samples
            assert list(found[f"{kind}.ID"]) == [m.arbitration_id for m in own], (name, kind)
            if kind == "CAN_DataFrame":
                data = mdf.get(f"{kind}.DataBytes").samples
                assert [bytes(row)[: len(m.data)] for row, m in zip(data, own)] == [bytes(m.data) for m in own], name


def version_3(name, version):
    """Every conversion that is computed, by asammdf."""
    mdf = MDF(version=version)
    i = np.arange(SLOW)
    table = {"raw_0": -100.0, "phys_0": 0.0, "raw_1": 0.0, "phys_1": 10.0, "raw_2": 100.0, "phys_2": 40.0}
    conversions = {
        "linear": {"a": 0.125, "b": -7.0},
        "rational": dict(P1=0.0, P2=2.0, P3=6.0, P4=0.0, P5=0.0, P6=4.0),
        # asammdf writes X1 for X.
        "formula": {"formula": "X * 0.5 + 3"},
        "interpolated": table | {"interpolation": True},
        "nothing": None,
    }
    signals = [
        Signal(count(i).astype("<i2"), slow_time(i), name=key, unit="kPa", comment="number of a sample", conversion=conversion)
        for key, conversion in conversions.items()
    ]
    signals.append(Signal(accel(i).astype("<f4"), slow_time(i), name="a_name_that_is_longer_than_32_letters_in_all", unit="m/s^2"))
    mdf.append(signals, comment="slow")
    i = np.arange(FAST)
    mdf.append([Signal(accel(i).astype("<f8"), fast_time(i), name="accel", unit="m/s^2")], comment="fast")
    mdf.save(HERE / name, overwrite=True)
    # asammdf calls every file of this version .mdf.
    (HERE / name).with_suffix(".mdf").rename(HERE / name)
    mdf.close()


def version_3_mixed(name):
    """Two kinds of records mixed behind ids of a byte, numbers in the order of Motorola; block by block."""
    text = bytearray(struct.pack("<8s8s8s4H32x", b"MDF     ", b"3.00    ", b"by hand ", 1, 0, 300, 0))
    text += b"HD" + struct.pack("<H3IH10s8s32s32s32s32s", 164, 0, 0, 0, 1, b"24:03:2003", b"12:52:32", *[b""] * 4)

    def add(block):
        at = len(text)
        text.extend(block)
        return at

    def channel(following, name, kind, offset, bits, data_type, conversion):
        block = struct.pack(
            "<5IH32s128s4H3d", following, conversion, 0, 0, 0, kind, name, b"", offset, bits, data_type, 0, 0.0, 0.0, 0.0
        )
        return add(b"CN" + struct.pack("<H", 4 + len(block)) + block)

    def linear(unit, factor):
        block = struct.pack("<H2d20s2H2d", 0, 0.0, 0.0, unit, 0, 2, 0.0, factor)
        return add(b"CC" + struct.pack("<H", 4 + len(block)) + block)

    def group(following, first, record_id, channels, length, records):
        block = struct.pack("<3I3HI", following, first, 0, record_id, channels, length, records)
        return add(b"CG" + struct.pack("<H", 4 + len(block)) + block)

    ticks = linear(b"s", 1e-5)
    slow = channel(channel(0, b"count", 0, 32, 16, 1, 0), b"t", 1, 0, 32, 0, ticks)
    fast = channel(channel(0, b"accel", 0, 32, 32, 2, 0), b"t", 1, 0, 32, 0, ticks)
    groups = group(group(0, slow, 2, 2, 6, SLOW), fast, 1, 2, 8, FAST)
    records = bytearray()
    for i in range(FAST):
        records += struct.pack(">BIf", 1, i * 200, accel(i))
        if i % 10 == 9:
            records += struct.pack(">BIh", 2, i // 10 * 2000 + 100, count(i // 10))
    data = add(bytes(records))
    block = struct.pack("<4I2HI", 0, groups, 0, data, 2, 1, 0)
    text[68:72] = struct.pack("<I", add(b"DG" + struct.pack("<H", 4 + len(block)) + block))
    (HERE / name).write_bytes(text)
    with MDF(HERE / name) as mdf:
        assert np.array_equal(mdf.get("accel").samples, accel(np.arange(FAST)))
        assert np.allclose(mdf.get("accel").timestamps, fast_time(np.arange(FAST)))
        assert np.array_equal(mdf.get("count").samples, count(np.arange(SLOW)))


def main():
    native_rates("plain.mf4", "4.00", 0)
    native_rates("deflate.mf4", "4.10", 1)
    native_rates("transposed.mf4", "4.11", 2)
    native_rates("lists-plain.mf4", "4.10", 0, fragment=1000)
    native_rates("lists-transposed.mf4", "4.20", 2, fragment=1000)
    invalidation("invalidation.mf4")
    big_endian("big-endian.mf4")
    conversions("conversions.mf4")
    columns("columns.mf4", lists=False)
    columns("columns-lists.mf4", lists=True)
    sub_byte("sub-byte.mf4")
    mixed("unsorted.mf4")
    check_mixed("unsorted.mf4")
    mixed("unfinalised-unsorted.mf4", b"UnFinMF ", 1 | 4, fast=0, slow=0, length=24)
    check_mixed("unfinalised-unsorted.mf4")
    unfinished_sorted("unfinalised.mf4")
    version_3("v330.dat", "3.30")
    version_3("v214.dat", "2.14")
    version_3_mixed("v300-mixed.dat")
    bus("bus-apart.mf4", apart=True)
    bus("bus-mixed.mf4", apart=False)
    for path in sorted([*HERE.glob("*.mf4"), *HERE.glob("*.dat")]):
        print(f"{path.name:28} {path.stat().st_size:6} bytes")


if __name__ == "__main__":
    main()
