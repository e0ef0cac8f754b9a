// What was warned of: what stands on top, what is over below; each new warning is spoken once.

import { CORNERS, NAMES, UNIT, badge, element, kind, list, lower, moment, number, put, why } from "./words.js";

const MOST = 50;
const KINDS = {
  "under-inflated": ["low", "Low"],
  "fast-leak": ["low", "Fast leak"],
  "all-low": ["low", "All low"],
  "common-shift": ["unknown", "Shifted together"],
  "over-inflated": ["over", "Over-inflated"],
  flat: ["low", "Flat, on its rim"],
  differs: ["low", "Differs from the others"],
  "slow-leak": ["low", "Slow leak"],
  "tire-sensor-leak": ["low", "Leak by its own sensor"],
  "tire-sensor-drift": ["malfunction", "Own sensor drifts"],
  "tire-sensor-stuck": ["malfunction", "Own sensor is stuck"],
  "unbalance-rising": ["malfunction", "Imbalance rises"],
  malfunction: ["malfunction", "Malfunction"],
  "no-information": ["unknown", "No information"],
};

const section = document.getElementById("warnings");
const rows = document.getElementById("alert-rows");
const table = document.getElementById("alert-table");
const none = document.getElementById("no-alerts");
const spoken = document.getElementById("spoken-alerts");

// What makes two reports the same warning, over a new connection and over a restart of the monitor as well.
const key = (alert) => `${alert.kind} ${(alert.wheels ?? []).join()} ${alert.reported_s?.toFixed(2)}`;

export function wheelsOf(alert) {
  const wheels = alert.wheels ?? [];
  return wheels.length === CORNERS.length ? "All four" : list(wheels.map((corner, i) => (i ? lower(NAMES[corner] ?? corner) : NAMES[corner] ?? corner)));
}

// The numbers that decided, in words.
function reason(alert) {
  const n = (value) => (value == null ? "–" : value.toFixed(0));
  const [said, should] = [`${number(alert.pressure_kpa, 0)} ± ${number(alert.sd_kpa, 0)} ${UNIT} when reported`, `should be ${number(alert.reference_kpa, 0)}`];
  const at = `${said}, limit ${number(alert.limit_kpa, 0)} (${n(100 * alert.limit_kpa / alert.reference_kpa)} % of ${number(alert.reference_kpa, 0)})`;
  switch (alert.kind) {
    case "under-inflated":
    case "over-inflated":
      return at;
    case "flat":
      return `as hard as ${at}`;
    case "fast-leak":
      // No more than it lacks.
      return `lost up to ${number(Math.min(0.5 * alert.rate_kpa_per_min, Math.max(0, alert.reference_kpa - alert.pressure_kpa)), 0)} ${UNIT} within half a minute; ${said}, ${should}`;
    case "all-low":
      return `at ${n(100 * alert.mean_share)} ± ${n(100 * alert.sd_share)} % of their reference on average`;
    case "common-shift":
      return `at ${n(100 * alert.mean_share)} ± ${n(100 * alert.sd_share)} % of what the stored calibration expects: tires, wheels or dampers were changed, or all of them were filled otherwise`;
    case "no-information":
      return `no information in ${n(alert.driven_s / 60)} min of driving`;
    default:
      return (alert.text ?? "").replace(/; since .*$/, "").replace(/^(malfunction: |\w+ slow leak: |(fl|fr|rl|rr): )/, "").replace(/\b(fl|fr|rl|rr)\b/g, (corner) => lower(NAMES[corner]));
  }
}

export class Alerts {
  constructor() {
    // By key: { alert, ended_s }, in the order in which they were reported.
    this.known = new Map();
    this.spoken = new Set();
    this.waiting = [];
  }
  transition(transition) {
    const { event, time_s, seq, unix_s, ...alert } = transition, k = key(alert);
    const before = this.known.get(k);
    if (event === "ended") this.known.set(k, { alert: before?.alert ?? alert, ended_s: time_s });
    else if (!before) this.known.set(k, { alert, ended_s: null });
    if (event === "begun") this.say(alert);
    this.changed = true;
  }
  history(history) {
    history.transitions.forEach((transition) => this.transition(transition));
  }
  // The newest snapshot has the last word on what stands.
  snapshot(snapshot) {
    const standing = new Set();
    for (const alert of snapshot.alerts) {
      const k = key(alert), before = this.known.get(k);
      standing.add(k);
      if (!before || before.ended_s != null) {
        this.known.set(k, { alert: before?.alert ?? alert, ended_s: null });
        this.say(alert);
        this.changed = true;
      }
    }
    for (const [k, item] of this.known) {
      if (item.ended_s == null && !standing.has(k) && snapshot.time_s >= item.alert.reported_s) {
        item.ended_s = snapshot.time_s;
        this.changed = true;
      }
    }
    while (this.known.size > MOST) this.known.delete(this.known.keys().next().value);
    this.newest = snapshot;
  }
  // The next run of the monitor has a clock of its own; what was spoken stays spoken.
  restart() {
    this.known.clear();
    this.changed = true;
  }
  say(alert) {
    const k = key(alert);
    if (this.spoken.has(k)) return;
    this.spoken.add(k);
    if (this.spoken.size > 4 * MOST) this.spoken.delete(this.spoken.values().next().value);
    const [, what] = KINDS[alert.kind] ?? ["unknown", alert.kind];
    this.waiting.push(`${wheelsOf(alert)}: ${what}. ${reason(alert)}.`);
  }
  draw(state) {
    const old = state !== "live";
    if (old !== this.old) this.changed = true;
    this.old = old;
    // One at a time is read out; several at once are read out together.
    if (this.waiting.length) spoken.replaceChildren(...this.waiting.splice(0).map((text) => element("p", "", text)));
    if (!this.changed) return;
    this.changed = false;
    const all = [...this.known.values()].sort((a, b) => (a.ended_s != null) - (b.ended_s != null) || b.alert.reported_s - a.alert.reported_s);
    rows.replaceChildren(...all.map((item) => this.row(item)));
    table.hidden = !all.length;
    none.hidden = all.length > 0;
    section.classList.toggle("standing", all.some((item) => item.ended_s == null));
  }
  // Without any warning it says how much that is worth.
  silence(snapshot, state) {
    const wheels = snapshot?.wheels ?? [], unknown = wheels.filter((wheel) => ["unknown", "uncertain"].includes(kind(wheel)));
    const said = (wheel) => `${lower(NAMES[wheel.corner])} is ${lower(badge(wheel))}${why(wheel) ? ` (${why(wheel)})` : ""}`;
    const caveat = unknown.length ? ` That is no all-clear: ${list(unknown.map(said))}.` : "";
    const text = state !== "live" ? "No warning was active when the last data came. The present state is unknown." : `No active warning.${caveat}`;
    put(none, wheels.length ? text : "No data yet: no warning is possible.");
  }
  row({ alert, ended_s }) {
    const [cls, what] = KINDS[alert.kind] ?? ["unknown", alert.kind];
    // Roles are spelled out: on a phone the rows are laid out as blocks, which would cost the table its meaning.
    const row = element("tr", ended_s == null ? "stands" : "over");
    row.setAttribute("role", "row");
    row.dataset.kind = alert.kind;
    row.dataset.wheels = (alert.wheels ?? []).join();
    const wheel = element("th", "", wheelsOf(alert));
    wheel.scope = "row";
    wheel.setAttribute("role", "rowheader");
    const warning = element("td");
    warning.setAttribute("role", "cell");
    warning.append(element("span", "badge " + cls, what), " ", element("span", "", reason(alert)));
    const cell = (label, text) => {
      const td = element("td", "", text);
      td.dataset.label = label;
      td.setAttribute("role", "cell");
      return td;
    };
    const at = (time_s) => moment(time_s, this.newest);
    row.append(wheel, warning, cell("reported", at(alert.reported_s)), cell("since", at(alert.since_s)), cell("until", ended_s != null ? at(ended_s) : this.old ? "active when last seen" : "active"));
    return row;
  }
}
