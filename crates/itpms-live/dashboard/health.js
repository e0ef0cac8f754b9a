// What the estimates rest on: how much is being learned, the accelerometers, the source, and how late all of it is.

import { NAMES, attribute, count, digits, element, plain, put, span } from "./words.js";

const gates = document.getElementById("gates");
const sensors = document.getElementById("sensors");
const facts = document.getElementById("source-facts");
const made = { gates: new Map(), sensors: new Map(), rows: new Map(), facts: new Map() };

function gate(corner) {
  const row = element("div", "gate"), name = element("span", "gate-name", NAMES[corner]), bar = element("span", "bar"), fill = element("i");
  const share = element("span", "value", "–"), age = element("span", "gate-age");
  bar.append(fill);
  bar.setAttribute("aria-hidden", "true");
  row.append(name, bar, share, age);
  gates.append(row);
  return { fill, share, age };
}

// A row per corner; body and wheel beside each other.
function sensor(column) {
  const [corner, place] = column.split("_"), mark = element("span", "badge"), reason = element("small");
  const cells = made_of("rows", NAMES[corner] ? corner : column, (key) => {
    const row = element("tr"), name = element("th", "", NAMES[key] ?? key), body = element("td"), wheel = element("td");
    name.scope = "row";
    row.append(name, body, wheel);
    sensors.append(row);
    return { body, wheel };
  });
  (place === "wheel" ? cells.wheel : cells.body).append(mark, " ", reason);
  return { mark, reason };
}

function fact(name) {
  const holder = element("div"), value = element("dd", "value");
  holder.append(element("dt", "", name), value);
  facts.append(holder);
  return value;
}

const made_of = (kind, key, make) => {
  if (!made[kind].has(key)) made[kind].set(key, make(key));
  return made[kind].get(key);
};

const SENSOR = { fine: ["fine", "Fine"], suspect: ["unknown", "Suspect"], malfunction: ["malfunction", "Malfunction"] };
const KIND = { socketcan: "CAN interface", stdin: "standard input", replay: "replay of a log", mqtt: "MQTT" };

export function drawHealth(snapshot, state) {
  if (!snapshot) return;
  const live = state === "live";
  for (const wheel of snapshot.wheels) {
    const g = made_of("gates", wheel.corner, gate);
    g.fill.style.width = `${live ? 100 * Math.min(1, Math.max(0, wheel.gate ?? 0)) : 0}%`;
    put(g.share, live && wheel.gate != null ? `${(100 * wheel.gate).toFixed(0)} %` : "–");
    put(g.age, wheel.informed_age_s == null ? "no estimate yet" : live ? `updated ${span(wheel.informed_age_s)} ago` : "not current");
  }
  for (const { column, state: is, reason } of snapshot.sensors) {
    const s = made_of("sensors", column, sensor), [cls, text] = SENSOR[is] ?? ["unknown", is];
    attribute(s.mark, "class", "badge " + (live ? cls : "unknown"));
    put(s.mark, live ? text : "last: " + text.toLowerCase());
    put(s.reason, reason ?? "");
  }
  const { source, latency_ms: late } = snapshot;
  const set = (name, text) => put(made_of("facts", name, fact), text);
  set("Source", `${plain(source.name)} (${KIND[source.kind] ?? source.kind})`);
  set("Rows estimated", count(source.rows));
  set("Frames received", count(source.frames));
  set("Frames lost", count(source.dropped));
  set("Unknown ids", count(source.unknown_ids));
  set("Not readable", count(source.malformed));
  set("Connected again", `${count(source.reconnects)} times`);
  set("Rate", source.rate_hz == null ? "not known yet" : `${digits(source.rate_hz, 0)} rows/s`);
  const ms = (value) => (value == null ? "–" : `${digits(value, 1)} ms`);
  set("Delay, median", ms(late.p50));
  set("Delay, 99 of 100", ms(late.p99));
  set("Delay, worst", ms(late.max));
}
