"""MDF4 both ways, judged by asammdf: what we write it reads, and what it writes we read, to the last bit.

    python mdf4_judge.py EXAMPLES      the folder with the built examples mdf4_make and mdf4_digest

Also writes the files of crates/itpms-mdf4/tests/data again, which checks their formulas. Needs asammdf and numpy.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "crates/itpms-mdf4/tests/data"


def digest(values, missing):
    """As mdf4_digest says it: the bits of each value times 2n+1, added up modulo 2^64."""
    numbers = np.arange(len(values), dtype="u8") * np.uint64(2) + np.uint64(1)
    bits = (np.asarray(values, dtype="<f8") + 0.0).view("<u8")
    with np.errstate(over="ignore"):
        return int((bits * numbers)[~missing].sum(dtype="u8"))


def ours(examples, path):
    """What mdf4_digest reads: (group, channel) -> (unit, comment, samples, missing, digest)."""
    out = subprocess.run([examples / "mdf4_digest", path], check=True, capture_output=True, text=True)
    words = [line for line in out.stderr.splitlines() if not line.endswith("MB/s")]
    assert not words, f"{path.name}: repaired what is not broken: {words}"
    lines = [line.split("\t") for line in out.stdout.splitlines()]
    return {(group, name): (unit, comment, *map(int, rest)) for group, name, unit, comment, *rest in lines}


# --- written by us, read by asammdf -----------------------------------------------------------------------------------


def accel(i, k):  # examples/mdf4_make.rs
    mixed = (i * np.uint64(2_654_435_761) + np.uint64(k * 40_503)) & np.uint64(0xFFFFFFFF)
    return (mixed >> np.uint64(16)).astype("f8") / 4096.0 - 8.0


def check_written(examples, directory):
    checked = 0
    for compression in ("none", "deflate", "transposed"):
        for megabytes in ("0.05", "5", "20"):  # in one block, in a list of them, and in two lists
            path = directory / f"ours-{compression}-{megabytes}.mf4"
            subprocess.run([examples / "mdf4_make", path, megabytes, compression], check=True)
            samples = int(float(megabytes) * 1e6 / 43.0)
            i = np.arange(samples, dtype="u8")
            j = np.arange((samples + 99) // 100)
            with MDF(path) as mdf:
                assert mdf.version == "4.10"
                names = [group.channel_group.acq_name for group in mdf.groups]
                assert names == ["fast", "slow"], names
                assert mdf.groups[0].channel_group.comment == "1 kHz"
                corners = [f"{c}_{part}_accel_m_s2" for c in ("fl", "fr", "rl", "rr") for part in ("body", "wheel")]
                for k, name in enumerate(corners):
                    signal = mdf.get(name)
                    assert signal.unit == "m/s²" and signal.comment == f"acceleration, {name}", signal
                    assert signal.samples.dtype == np.dtype("<f4")
                    assert np.array_equal(signal.samples, accel(i, k).astype("f4")), (path.name, name)
                    assert np.array_equal(signal.timestamps, i / 1000.0)
                    checked += 1
                kept = i % 100 != 99
                counter = mdf.get("counter")
                assert np.array_equal(counter.samples, (i[kept] % 60_000).astype("i8") - 30_000)
                assert np.array_equal(counter.timestamps, i[kept] / 1000.0)
                speed = mdf.get("speed_m_s")
                assert speed.unit == "m/s" and np.array_equal(speed.samples, j % 400 / 10.0)
                assert np.array_equal(speed.timestamps, j * 100 / 1000.0)
                assert np.array_equal(mdf.get("gear").samples, j % 6)
                checked += 3
    print(f"written by us, read by asammdf: {checked} channels with names, units, comments, times and values")


# --- written by asammdf, read by us -----------------------------------------------------------------------------------

TYPES = ["<f8", "<f4", "<f2", ">f8", ">f4", "u1", "i1", "<u2", ">u2", "<i2", ">i2", "<u4", ">i4", "<i8", ">u8"]


def random_signals(dice, times):
    signals = []
    for n, kind in enumerate(dice.choice(TYPES, size=8)):
        kind = np.dtype(kind)
        if kind.kind == "f":
            values = dice.normal(0.0, 100.0, len(times)).astype(kind)
        else:
            info = np.iinfo(kind)
            least, most = max(info.min, -(2**53)), min(info.max, 2**53)
            values = dice.integers(least, most, len(times), endpoint=True).astype(kind)
        bits = dice.random(len(times)) < 0.1 if n % 3 == 0 else None
        conversion = {"a": 0.125, "b": -7.0} if kind.kind != "f" and n % 2 == 0 else None
        texts = dict(name=f"channel {n}", unit=["m/s²", "kPa", ""][n % 3], comment=f"{kind.str}, number {n}")
        signals.append(Signal(values, times, invalidation_bits=bits, conversion=conversion, **texts))
    return signals


def check_read(examples, directory):
    dice = np.random.default_rng(20261120)
    checked = 0
    for n in range(42):
        version = ["4.00", "4.10", "4.11", "4.20", "4.30"][n % 5] if n < 30 else "4.30"
        # From 4.3 on zstd and lz4 as well, each also transposed; asammdf 8.8 fails to write 4.30 without compression.
        compression = {"4.00": 0, "4.30": n % 6 + 1}.get(version, n // 5 % 3)
        mdf = MDF(version=version)
        mdf.configure(write_fragment_size=[4_000_000, 20_000][n % 2])
        expected = {}
        for group in range(dice.integers(1, 4)):
            times = np.cumsum(dice.uniform(0.001, 0.01, dice.integers(1, 3000)))
            signals = random_signals(dice, times)
            mdf.append(signals, acq_name=f"group {group}", comment="random")
            for signal in signals:
                bits = signal.invalidation_bits
                missing = np.zeros(len(times), bool) if bits is None else np.asarray(bits)
                values = signal.samples.astype("f8")
                if signal.conversion is not None:
                    values = -7.0 + 0.125 * values
                key = (f"group {group}", signal.name)
                row = (signal.unit, signal.comment, len(times), int(missing.sum()), digest(values, missing))
                expected[key] = row
            expected[f"group {group}", "time"] = (len(times), 0, digest(times, np.zeros(len(times), bool)))
        path = directory / f"theirs-{n}.mf4"
        mdf.save(path, overwrite=True, compression=compression)
        found = ours(examples, path)
        assert found.keys() == expected.keys(), (path.name, found.keys() ^ expected.keys())
        for key, row in expected.items():
            assert found[key][-len(row) :] == row, (path.name, version, compression, key, found[key], row)
            checked += 1
    print(f"written by asammdf, read by us: {checked} channels in 42 files")


def main():
    examples = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as directory:
        check_written(examples, Path(directory))
        check_read(examples, Path(directory))
        again = Path(directory) / "again"
        again.mkdir()
        made = subprocess.run([sys.executable, DATA / "make.py", again], check=True, capture_output=True, text=True)
        print(f"files of the tests, made again: {len(made.stdout.splitlines())}")


if __name__ == "__main__":
    main()
