// The page: takes what comes over the stream and draws it at a pace the eye and the machine can follow.

import { Alerts } from "./alerts.js";
import { drawBeside } from "./beside.js";
import { drawCar } from "./car.js";
import { Pressures, States } from "./charts.js";
import { Connection } from "./connection.js";
import { drawHealth } from "./health.js";
import { Past } from "./past.js";
import { Roads } from "./roads.js";
import { Status } from "./status.js";
import { drawWheels } from "./wheels.js";
import { CORNERS, NAMES, STATES, UNIT, attribute, digits, element, lower, moment, number, plain, put, rolls, span, speedDoubt, verdict } from "./words.js";

const calm = matchMedia("(prefers-reduced-motion: reduce)");
const by = (id) => document.getElementById(id);

const past = new Past(), status = new Status(), alerts = new Alerts();
let newest = null, run = null, clock_s = -Infinity, span_s = 900;

// The last `span_s`, or less while there is less, but half a minute.
const LEAST_S = 30;
const windowOf = (lo, hi) => {
  if (hi == null) return [0, LEAST_S];
  const first_s = past.coarse.time_s[0] ?? lo;
  return [Math.max(hi - span_s, Math.min(first_s, hi - LEAST_S)), hi];
};
const pressures = new Pressures(by("pressure-charts"), windowOf);
const states = new States(by("state-chart"), windowOf);
const roads = new Roads(by("road-charts"), windowOf);

const take = {
  hello(hello) {
    if (run !== hello.run) {
      if (run !== null) alerts.restart();
      run = hello.run;
      clock_s = -Infinity;
    }
    status.hello(hello);
    put(by("program"), hello.program);
  },
  history(history) {
    past.load(history);
    status.history(history);
    alerts.history(history);
  },
  snapshot(snapshot) {
    // The source began again: a replay from its start, or another bus.
    if (snapshot.time_s != null) {
      if (snapshot.time_s < clock_s) alerts.restart();
      clock_s = snapshot.time_s;
    }
    newest = snapshot;
    past.add(snapshot);
    status.snapshot(snapshot);
    alerts.snapshot(snapshot);
  },
  transition: (transition) => alerts.transition(transition),
  transitions: (transitions) => alerts.history({ transitions }),
  beat: (beat) => status.beat(beat),
};

const connection = new Connection("/api/events", (name, data) => {
  take[name]?.(data);
  if (name === "snapshot" || name === "transition") schedule();
}, () => drawNumbers());
by("retry").addEventListener("click", () => connection.now());

// ---- drawing ------------------------------------------------------------------------------------------------------------
let scheduled = false, numbers_ms = -Infinity, charts_ms = -Infinity;

// As often as there is something new, but numbers at most five times a second and curves twice: nobody reads faster.
function schedule() {
  if (scheduled || document.hidden) return;
  scheduled = true;
  requestAnimationFrame((now_ms) => {
    scheduled = false;
    if (now_ms - numbers_ms >= (calm.matches ? 990 : 190)) {
      numbers_ms = now_ms;
      drawNumbers();
    }
    if (now_ms - charts_ms >= (calm.matches ? 1990 : 490)) {
      charts_ms = now_ms;
      drawCharts();
    }
  });
}

function drawNumbers() {
  const state = status.draw(connection);
  const words = verdict(newest, state !== "live");
  put(by("headline"), state === "live" ? words : status.headline(state));
  put(by("last-known"), state === "live" || !newest?.wheels.length ? "" : `When last seen: ${lower(words).replace(/\bis\b/g, "was").replace(/\bare\b/g, "were")}.`);
  const title = state === "live" ? words : status.headline(state);
  if (document.title !== `${title} · itpms`) document.title = `${title} · itpms`;
  attribute(by("headline"), "class", state === "live" && newest ? worst(newest) : "quiet");
  put(by("subline"), newest ? subline(newest) : "");
  drawCar(newest, state);
  drawWheels(newest, state);
  drawBeside(newest, state);
  drawHealth(newest, state);
  alerts.silence(newest, state);
  alerts.draw(state);
  put(by("tires-title"), state === "live" ? "Tires now" : state === "waiting" || !newest ? "Tires" : "Tires when last seen");
}

const worst = (snapshot) => Object.keys(STATES).find((state) => snapshot.wheels.some((wheel) => wheel.state === state)) ?? "quiet";

function subline(snapshot) {
  const speed = snapshot.speed_m_s == null ? speedDoubt(snapshot) : `${digits(3.6 * snapshot.speed_m_s, 0)} km/h`;
  const far = snapshot.distance_m == null ? null : snapshot.distance_m < 10000 ? `${digits(snapshot.distance_m / 1000, 2)} km` : `${digits(snapshot.distance_m / 1000, 0)} km`;
  const when = snapshot.time_s == null ? null : snapshot.time_s > 1e8 ? moment(snapshot.time_s, snapshot) : `clock ${span(snapshot.time_s)}`;
  return [plain(snapshot.vehicle), plain(snapshot.source.name), speed, far, when].filter(Boolean).join(" · ");
}

function drawCharts() {
  const stretch = span_s > 60 ? past.coarse : past.fine, said = [...alerts.known.values()];
  // Without accelerometers there are no pressures, no road, and nothing to say of sensors that are not there.
  const alone = newest?.wheels.length > 0 && newest.wheels.every(rolls);
  for (const id of ["pressure-charts", "pressure-words", "road", "gates-panel", "sensors-table"]) by(id).hidden = alone;
  put(by("history-title"), alone ? "Wheels over time" : "Pressures over time");
  if (!alone) pressures.draw(stretch, newest, said);
  states.draw(stretch, newest);
  if (!alone) roads.draw(past, stretch, newest);
  if (by("table-box").open) drawTable();
}

// ---- the curves in words ------------------------------------------------------------------------------------------------
let table_ms = 0;
function drawTable() {
  if (Date.now() - table_ms < 5000) return;
  table_ms = Date.now();
  const { time_s, wheels } = past.coarse, rows = [];
  const corners = CORNERS.filter((corner) => wheels[corner].state.some((s) => s != null));
  by("table-head").replaceChildren(...["Before the newest", ...corners.map((corner) => NAMES[corner])].map((text) => Object.assign(element("th", "", text), { scope: "col" })));
  let next = Infinity;
  for (let i = time_s.length - 1; i >= 0; i--) {
    if (time_s[i] > next) continue;
    next = time_s[i] - 30 + 1e-6;
    const row = element("tr"), head = element("th", "", i === time_s.length - 1 ? "newest" : span(time_s.at(-1) - time_s[i]));
    head.scope = "row";
    row.append(head, ...corners.map((corner) => {
      const { pressure_kpa: p, pressure_sd_kpa: sd, state } = wheels[corner], word = (STATES[state[i]]?.word ?? "Unknown").toLowerCase();
      return element("td", "", p[i] == null ? word : `${number(p[i], 0)} ± ${number(sd[i], 0)} ${UNIT}, ${word}`);
    }));
    rows.push(row);
  }
  by("table-body").replaceChildren(...rows);
}
by("table-box").addEventListener("toggle", () => {
  table_ms = 0;
  drawCharts();
});

// ---- everything else ----------------------------------------------------------------------------------------------------
document.querySelectorAll("input[name=span]").forEach((input) => input.addEventListener("change", () => {
  span_s = +input.value;
  drawCharts();
}));
// Time passes without events as well: what was live grows old.
setInterval(() => document.hidden || drawNumbers(), 500);
document.addEventListener("visibilitychange", () => {
  if (document.hidden) return;
  drawNumbers();
  drawCharts();
});
drawNumbers();
drawCharts();
