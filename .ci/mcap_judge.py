"""Foxglove's Python reader reads what we write as MCAP: the index, every schema, every message by its schema, and the values of the CSV.

    python .ci/mcap_judge.py ITPMS_BINARY FOLDER

Needs mcap and jsonschema.
"""

import csv
import json
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from jsonschema import Draft202012Validator
from mcap.reader import make_reader

BINARY, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
CORNERS = ("fl", "fr", "rl", "rr")


def run(*arguments):
    subprocess.run([BINARY, "--quiet", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, cwd=FOLDER)


def read(name):
    """The messages of each topic, by the index and in the order of their times."""
    topics = defaultdict(list)
    with open(FOLDER / name, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary.chunk_indexes and all(chunk.compression == "zstd" for chunk in summary.chunk_indexes)
        validators = {}
        for schema in summary.schemas.values():
            assert schema.encoding == "jsonschema", schema
            # What Foxglove asks for: an object whose properties have one type each.
            content = json.loads(schema.data)
            assert content["type"] == "object" and all(isinstance(p["type"], str) for p in content["properties"].values())
            Draft202012Validator.check_schema(content)
            validators[schema.id] = Draft202012Validator(content | {"additionalProperties": False})
        before_ns = 0
        for schema, channel, message in reader.iter_messages():
            assert channel.message_encoding == "json" and message.log_time >= before_ns
            before_ns = message.log_time
            content = json.loads(message.data)
            # Some thousand of each are enough: a validator in Python takes its time.
            if len(topics[channel.topic]) < 2000:
                validators[schema.id].validate(content)
            assert message.log_time == round(content["time_s"] * 1e9), (channel.topic, message.log_time)
            topics[channel.topic].append(content)
        assert summary.statistics.message_count == sum(map(len, topics.values()))
    return topics


def compare(table, topics, root):
    """Every cell of a table against the messages; gives the number of values."""
    compared = 0
    with open(FOLDER / table, newline="") as file:
        for k, row in enumerate(csv.DictReader(file)):
            for column, cell in row.items():
                corner, _, field = column.partition("_")
                topic, field = (f"{root}/{corner}", field) if corner in CORNERS else (root, column)
                if column == "time_s":
                    topic = f"{root}/fl"
                found = topics[topic][k].get(field)
                told = {None: "", True: "true", False: "false"}.get(found, found) if not isinstance(found, float) else found
                assert (float(cell) if isinstance(told, float) else cell) == told, (topic, field, k, found, cell)
                compared += 1
    return compared


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for old in FOLDER.glob("*.mcap"):
        old.unlink()
    run("simulate", "drive-puncture", "--seed", 1, "-o", "drive.csv", "--vehicle-out", "car.toml")
    run("convert", "drive.csv", "drive.mcap")
    print(f"convert: {compare('drive.csv', read('drive.mcap'), '/signals')} values as in the CSV")
    files = ("-o", "est.csv", "--road-out", "road.csv", "--events", "events.jsonl")
    run("estimate", "drive.csv", "--vehicle", "car.toml", *files, "--mcap", "all.mcap")
    topics = read("all.mcap")
    compared = sum(compare(table, topics, root) for table, root in [("est.csv", "/estimate"), ("road.csv", "/road")])
    events = [json.loads(line) for line in (FOLDER / "events.jsonl").read_text().splitlines()]
    events = [{key: value for key, value in event.items() if value is not None} for event in events]
    assert events and topics["/alerts"] == events, events
    print(f"estimate --mcap: {compared} values of estimates and roads as in the CSV, {len(events)} alerts")
    run("monitor", "--replay", "drive.csv", "--speed", "max", "--vehicle", "car.toml", "--mcap", "live.mcap")
    live = read("live.mcap")
    assert {"/estimate", "/alerts", *(f"/estimate/{corner}" for corner in CORNERS)} == live.keys(), live.keys()
    print(f"monitor --mcap: {len(live['/estimate'])} estimates, {len(live['/alerts'])} alerts")


main()
