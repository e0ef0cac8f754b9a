// What has been, as columns for the charts: the last quarter of an hour once a second, the last minute ten times a second.
// Thinned and bounded in the way the server's own history is, so that a page may be open for days.

import { CORNERS } from "./words.js";

const FIELDS = ["state", "pressure_kpa", "pressure_sd_kpa", "gate", "iri_m_per_km", "road_m"];

// More than a time of the past, in whole milliseconds, may be ahead of the one that was rounded.
const ROUNDED_S = 1e-3;

class Stretch {
  constructor(step_s, span_s) {
    this.step_s = step_s;
    this.span_s = span_s;
    this.clear();
  }
  clear() {
    this.time_s = [];
    this.unix_s = [];
    this.wheels = Object.fromEntries(CORNERS.map((c) => [c, Object.fromEntries(FIELDS.map((f) => [f, []]))]));
  }
  get last() {
    return this.time_s.at(-1);
  }
  // Columns as the server sends them: all of it, or what came after what is here.
  load(columns, resumed) {
    if (!resumed) this.clear();
    for (let i = 0; i < columns.time_s.length; i++) {
      const of = (corner) => {
        const wheel = columns.wheels.find((w) => w.corner === corner);
        return wheel && Object.fromEntries(FIELDS.map((f) => [f, wheel[f][i]]));
      };
      this.add(columns.time_s[i], columns.unix_s[i], of);
    }
  }
  add(time_s, unix_s, of) {
    if (time_s == null) return;
    const step = time_s - (this.last ?? -Infinity);
    // The source began again; what the server sends of the past is rounded.
    if (step < -ROUNDED_S) this.clear();
    else if (!(step >= this.step_s * (1 - 1e-6))) return;
    this.time_s.push(time_s);
    this.unix_s.push(unix_s);
    for (const corner of CORNERS) {
      const wheel = of(corner);
      for (const f of FIELDS) this.wheels[corner][f].push(wheel ? wheel[f] ?? null : null);
    }
    // In lumps: cutting off the front of an array costs its length.
    const old = this.time_s.findIndex((t) => time_s - t <= this.span_s);
    if (old > 50) {
      this.time_s.splice(0, old);
      this.unix_s.splice(0, old);
      for (const corner of CORNERS) for (const f of FIELDS) this.wheels[corner][f].splice(0, old);
    }
  }
}

export class Past {
  constructor() {
    this.coarse = new Stretch(1, 900);
    this.fine = new Stretch(0.1, 60);
  }
  load(history) {
    this.coarse.load(history.coarse, history.resumed);
    this.fine.load(history.fine, history.resumed);
  }
  add(snapshot) {
    const of = (corner) => {
      const wheel = snapshot.wheels.find((w) => w.corner === corner);
      return wheel && (wheel.valid ? wheel : { ...wheel, pressure_kpa: null, pressure_sd_kpa: null });
    };
    this.coarse.add(snapshot.time_s, snapshot.unix_s, of);
    this.fine.add(snapshot.time_s, snapshot.unix_s, of);
  }
}
