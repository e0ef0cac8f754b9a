"""Every Parquet file that pyarrow, polars and DuckDB can write of a drive is read as the numbers that went in.

    python .ci/parquet_judge.py ITPMS_BINARY FOLDER

Each column type, codec, encoding and page version in turn holds the clock, the speed or the accelerations of a short drive; `itpms
convert` makes a CSV of it, whose cells have to be the values as the type rounds them. Types that hold no number have to be refused in one
sentence without a word of this program's insides. Needs numpy, pyarrow, polars and duckdb.
"""

import csv
import datetime
import decimal
import subprocess
import sys
from pathlib import Path

import duckdb
import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

BINARY, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
ROWS = 5000
EPOCH = 1_772_352_000  # 2026-03-01 08:00 UTC
TIME, SPEED, BODY, WHEEL = "time_s", "speed_m_s", "fl_body_accel_m_s2", "fl_wheel_accel_m_s2"
# Words of a program's insides, that a person who has a file needs no more than a Rust compiler's.
INSIDES = ["feature", "panicked", "Some(", "IntType", "TimeType", "DecimalType", "Error", "compile"]

rng = np.random.default_rng(5)
steps = np.arange(ROWS, dtype=np.int64)
# Whole numbers, so that every type has the same ones; small enough for eight bits.
body, wheel = rng.integers(-20, 21, ROWS), rng.integers(-99, 100, ROWS)
speed = rng.integers(15, 31, ROWS)
milliseconds = steps * 2
counts = {"good": 0, "refused": 0}
faults = []


def read(path, *options):
    """What `itpms` reads: its rows, or the sentence with which it refuses."""
    out = FOLDER / "read.csv"
    out.unlink(missing_ok=True)
    done = subprocess.run(
        [BINARY, "--quiet", "convert", path, out, "--trust-units", *map(str, options)], capture_output=True, text=True
    )
    if done.returncode != 0:
        return None, done.stderr.strip()
    with open(out, newline="") as file:
        rows = list(csv.reader(file))
    columns = {name: [] for name in rows[0]}
    for row in rows[1:]:
        for name, cell in zip(rows[0], row, strict=True):
            columns[name].append(float(cell) if cell else np.nan)
    return {name: np.array(values) for name, values in columns.items()}, ""


def check(name, path, expected, tolerance=0.0):
    found, why = read(path)
    if found is None:
        faults.append(f"{name}: refused: {why}")
        return
    for column, values in expected.items():
        here = found.get(column)
        if here is None or here.shape != np.shape(values):
            faults.append(f"{name}: {column} has {None if here is None else len(here)} rows of {len(values)}")
            return
        values = np.asarray(values, dtype=float)
        same = (np.abs(here - values) <= tolerance) | (np.isnan(here) & np.isnan(values))
        if not same.all():
            row = int(np.argmin(same))
            faults.append(f"{name}: {column} in row {row} is {here[row]!r}, expected {values[row]!r}")
            return
    counts["good"] += 1


def refused(name, path):
    found, why = read(path)
    counts["refused"] += 1
    if found is not None:
        faults.append(f"{name}: read, though it holds no numbers")
    elif any(word in why for word in INSIDES) or len(why) > 400 or "\n" in why:
        faults.append(f"{name}: refused in other words than a user's: {why}")


def base(**columns):
    table = {TIME: milliseconds / 1000, SPEED: speed * 1.0, BODY: body * 1.0, WHEEL: wheel * 1.0}
    return table | columns


expected = base()


def arrow(name, table, **options):
    path = FOLDER / "drive.parquet"
    pq.write_table(pa.table(table), path, **options)
    return name, path


def decimals(values, scale):
    return [None if v is None else decimal.Decimal(int(v)).scaleb(-scale) for v in values]


def pyarrow_types():
    numbers = [pa.int8(), pa.int16(), pa.int32(), pa.int64(), pa.float16(), pa.float32(), pa.float64()]
    for kind in numbers:
        for version in ["1.0", "2.4", "2.6"]:
            array = pa.array(body.astype(np.float16) if kind == pa.float16() else body.tolist(), type=kind)
            check(*arrow(f"pyarrow {kind}, format {version}", base(**{BODY: array}), version=version), expected)
    for kind in [pa.uint8(), pa.uint16(), pa.uint32(), pa.uint64()]:
        for version in ["1.0", "2.6"]:
            array = pa.array(speed.tolist(), type=kind)
            check(*arrow(f"pyarrow {kind}, format {version}", base(**{SPEED: array}), version=version), expected)
    # Past the sign bit of what is stored.
    for kind, offset in [(pa.uint32(), 2**31 - 1000), (pa.uint64(), 2**63 - 2000)]:
        stamps = [int(offset) + int(step) for step in steps * (1 if kind == pa.uint32() else 2048)]
        table = base(**{SPEED: pa.array(stamps, type=kind)})
        check(*arrow(f"pyarrow {kind} past its sign bit", table), base(**{SPEED: np.array(stamps, dtype=float)}))
    for kind in [pa.decimal32(7, 2), pa.decimal64(12, 3), pa.decimal128(9, 2), pa.decimal128(38, 9), pa.decimal256(60, 20)]:
        array = pa.array(decimals([int(v) * 10**kind.scale for v in body], kind.scale), type=kind)
        for small in [False, True]:
            name, path = arrow(f"pyarrow {kind}, small as integer: {small}", base(**{BODY: array}), store_decimal_as_integer=small)
            check(name, path, expected)
    check(*arrow("pyarrow null", base(**{SPEED: pa.nulls(ROWS)})), base(**{SPEED: np.full(ROWS, np.nan)}))
    check(*arrow("pyarrow bool", base(**{SPEED: pa.array((speed > 20).tolist())})), base(**{SPEED: (speed > 20) * 1.0}))
    encoded = pa.array(body.astype(float)).dictionary_encode()
    check(*arrow("pyarrow dictionary", base(**{BODY: encoded})), expected)
    holes = [None if i % 5 == 0 else float(v) for i, v in enumerate(body)]
    check(*arrow("pyarrow nulls", base(**{BODY: pa.array(holes)})), base(**{BODY: np.array(holes, dtype=float)}))
    inside = pa.StructArray.from_arrays([pa.array(body * 1.0)], names=["x"])
    check(*arrow("pyarrow struct beside", base(inside=inside)), expected)
    for kind, array in [
        ("text", pa.array([str(v) for v in body])),
        ("large text", pa.array([str(v) for v in body], type=pa.large_string())),
        ("bytes", pa.array([b"1"] * ROWS)),
        ("fixed bytes", pa.array([b"123"] * ROWS, type=pa.binary(3))),
        ("list", pa.array([[1.0]] * ROWS)),
        ("map", pa.array([[("a", 1.0)]] * ROWS, type=pa.map_(pa.string(), pa.float64()))),
        ("timestamp", pa.array(milliseconds, type=pa.timestamp("ms"))),
        ("duration", pa.array(milliseconds, type=pa.duration("ms"))),
        ("date", pa.array(steps.astype(np.int32), type=pa.date32())),
        ("time", pa.array(milliseconds.astype(np.int32), type=pa.time32("ms"))),
    ]:
        refused(f"pyarrow {kind} as acceleration", arrow("", base(**{BODY: array}))[1])


def pyarrow_clocks():
    per_s = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
    for unit, units in per_s.items():
        # A clock of whole seconds holds no drive; its type is tried at a rate that it can have with another one's numbers.
        if unit == "s":
            continue
        stamps = milliseconds * (units // 1000)
        for zone in [None, "UTC", "Europe/Berlin"]:
            array = pa.array(EPOCH * units + stamps, type=pa.timestamp(unit, tz=zone))
            want = base(**{TIME: EPOCH + milliseconds / 1000})
            # 1.8e9 s have steps of 0.24 us in 64 bits.
            check(*arrow(f"pyarrow timestamp[{unit}, {zone}]", base(**{TIME: array})), want, 3e-7)
            for flavor in [{"use_deprecated_int96_timestamps": True}, {"version": "1.0"}, {"coerce_timestamps": "ms"}]:
                options = flavor | ({"allow_truncated_timestamps": True} if "coerce_timestamps" in flavor else {})
                check(*arrow(f"pyarrow timestamp[{unit}, {zone}], {flavor}", base(**{TIME: array}), **options), want, 3e-7)
        array = pa.array(stamps, type=pa.duration(unit))
        check(*arrow(f"pyarrow duration[{unit}]", base(**{TIME: array})), expected)
        kind = pa.time32(unit) if unit == "ms" else pa.time64(unit)
        array = pa.array(stamps.astype(np.int32 if unit == "ms" else np.int64), type=kind)
        check(*arrow(f"pyarrow {kind}", base(**{TIME: array})), expected)
    array = pa.array(decimals(milliseconds.tolist(), 3), type=pa.decimal128(18, 3))
    check(*arrow("pyarrow decimal clock", base(**{TIME: array})), expected)


def pyarrow_packings():
    codecs = [("none", None), ("snappy", None), ("gzip", 6), ("brotli", 4), ("lz4", None), ("zstd", 3)]
    for codec, level in codecs:
        for pages in ["1.0", "2.0"]:
            options = {"compression": codec, "compression_level": level, "data_page_version": pages}
            for dictionary in [True, False]:
                name = f"pyarrow {codec}, pages {pages}, dictionary {dictionary}"
                check(*arrow(name, base(), use_dictionary=dictionary, row_group_size=1700, **options), expected)
    integers = base(**{BODY: pa.array(body.astype(np.int32)), WHEEL: pa.array(wheel.astype(np.int64))})
    for encoding, table, columns in [
        ("PLAIN", base(), [BODY, WHEEL]),
        ("BYTE_STREAM_SPLIT", base(), [BODY, WHEEL]),
        ("BYTE_STREAM_SPLIT", integers, [BODY, WHEEL]),
        ("BYTE_STREAM_SPLIT", base(**{BODY: pa.array(body.astype(np.float16))}), [BODY]),
        ("DELTA_BINARY_PACKED", integers, [BODY, WHEEL]),
    ]:
        options = {"column_encoding": {column: encoding for column in columns}, "use_dictionary": False}
        check(*arrow(f"pyarrow {encoding} {pa.table(table).schema.field(BODY).type}", table, **options), expected)
    check(*arrow("pyarrow checksums", base(), write_page_checksum=True, write_page_index=True), expected)


def polars_files():
    path = FOLDER / "drive.parquet"
    frame = pl.DataFrame(base())
    for codec in ["uncompressed", "snappy", "gzip", "brotli", "lz4", "zstd"]:
        frame.write_parquet(path, compression=codec, row_group_size=1700)
        check(f"polars {codec}", path, expected)
    kinds = [pl.Int8, pl.Int16, pl.Int32, pl.Int64, pl.Float32, pl.Float64, pl.Decimal(18, 2)]
    for kind in kinds + [getattr(pl, name) for name in ["Float16", "Int128"] if hasattr(pl, name)]:
        try:
            frame.with_columns(pl.col(BODY).cast(kind)).write_parquet(path)
        except Exception as error:  # what polars does not write
            print(f"polars {kind}: not written: {error}")
            continue
        if kind == getattr(pl, "Int128", None):
            refused(f"polars {kind}", path) if read(path)[0] is None else check(f"polars {kind}", path, expected)
        else:
            check(f"polars {kind}", path, expected)
    for kind in [pl.UInt8, pl.UInt16, pl.UInt32, pl.UInt64]:
        frame.with_columns(pl.col(SPEED).cast(kind)).write_parquet(path)
        check(f"polars {kind}", path, expected)
    for unit, units in [("ms", 10**3), ("us", 10**6), ("ns", 10**9)]:
        stamps = pl.Series(TIME, milliseconds * (units // 1000))
        frame.with_columns(stamps.cast(pl.Duration(unit))).write_parquet(path)
        check(f"polars duration {unit}", path, expected)
        frame.with_columns((stamps + EPOCH * units).cast(pl.Datetime(unit))).write_parquet(path)
        check(f"polars datetime {unit}", path, base(**{TIME: EPOCH + milliseconds / 1000}), 3e-7)
    frame.with_columns(pl.Series(TIME, milliseconds * 10**6).cast(pl.Time)).write_parquet(path)
    check("polars time", path, expected)


def duckdb_files():
    path = FOLDER / "drive.parquet"
    connection = duckdb.connect()
    connection.register("drive", pa.table(base(n=pa.array(milliseconds))))

    def copy(select, options=""):
        connection.execute(f"copy ({select}) to '{path}' (format parquet{options})")

    for codec in ["uncompressed", "snappy", "gzip", "zstd", "brotli", "lz4", "lz4_raw"]:
        for version in ["v1", "v2"]:
            copy("select * from drive", f", compression {codec}, parquet_version {version}, row_group_size 2048")
            check(f"DuckDB {codec} {version}", path, expected)
    signed = ["tinyint", "smallint", "integer", "bigint", "hugeint", "float", "double", "decimal(4,1)", "decimal(18,3)", "decimal(38,9)"]
    for kind in signed:
        copy(f"select * replace ({BODY}::{kind} as {BODY}) from drive")
        check(f"DuckDB {kind}", path, expected)
    for kind in ["utinyint", "usmallint", "uinteger", "ubigint", "uhugeint"]:
        copy(f"select * replace ({SPEED}::{kind} as {SPEED}) from drive")
        check(f"DuckDB {kind}", path, expected)
    for kind in ["make_timestamp_ms(n)", "make_timestamp(n * 1000)", "make_timestamp_ns(n * 1000000)", "to_milliseconds(n)"]:
        copy(f"select * replace ({kind} as {TIME}) from drive")
        check(f"DuckDB {kind}", path, expected)
    copy(f"select * replace (make_timestamp(n * 1000)::time as {TIME}) from drive")
    check("DuckDB time", path, expected)


def folders():
    """Part files, as Spark, Dask and DuckDB leave them."""

    def parts(name, tables, inner=""):
        folder = FOLDER / name
        for number, table in enumerate(tables):
            place = folder / inner.format(number)
            place.mkdir(parents=True, exist_ok=True)
            pq.write_table(table, place / f"part-{number:05}-c0ffee.c000.snappy.parquet", use_deprecated_int96_timestamps=True)
        (folder / "_SUCCESS").touch()
        (folder / ".part-00000.crc").write_bytes(b"crc")
        return folder

    whole = pa.table(base())
    # One after the other, in another order than that of their names, one of them empty.
    sliced = [whole.slice(begin, 1250) for begin in [2500, 0, 3750, 1250]] + [whole.slice(0, 0)]
    check("folder, in a row", parts("in-a-row.parquet", sliced), expected)
    check("folder without an extension", parts("in-a-row", sliced), expected)
    shuffled = [whole.filter(pa.array(steps % 3 == part)) for part in range(3)]
    check("folder, dealt out", parts("dealt-out", shuffled), expected)
    check("folder, partitioned", parts("partitioned", sliced, "minute={}"), expected)
    stamps = pa.array(EPOCH * 10**9 + milliseconds * 10**6, type=pa.timestamp("ns"))
    spark = pa.table(base(**{TIME: stamps}))
    halves = [spark.slice(0, 2500), spark.slice(2500)]
    check("folder, INT96", parts("int96", halves), base(**{TIME: EPOCH + milliseconds / 1000}), 3e-7)
    # A column that a later part has not is missing there.
    renamed = whole.slice(2500).rename_columns([TIME, SPEED, BODY, "x"])
    half = base(**{WHEEL: np.where(steps < 2500, wheel * 1.0, np.nan)})
    check("folder, another column", parts("another", [whole.slice(0, 2500), renamed]), half)


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for part in [pyarrow_types, pyarrow_clocks, pyarrow_packings, polars_files, duckdb_files, folders]:
        before = dict(counts)
        part()
        print(f"{part.__name__}: {counts['good'] - before['good']} read, {counts['refused'] - before['refused']} refused")
    for fault in faults:
        print(f"WRONG  {fault}")
    sys.exit(f"{len(faults)} files of Parquet are not read as they were written" if faults else 0)


main()
