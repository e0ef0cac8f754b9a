// Words and numbers: the same ones as in the report.

export const CORNERS = ["fl", "fr", "rl", "rr"];
export const NAMES = { fl: "Front left", fr: "Front right", rl: "Rear left", rr: "Rear right" };

// Most urgent first.
export const STATES = {
  low: { word: "Low", short: "LOW", was: "was low" },
  malfunction: { word: "Malfunction", short: "FAULT", was: "was faulty" },
  over: { word: "Over-inflated", short: "OVER", was: "was over-inflated" },
  uncertain: { word: "Uncertain", short: "uncertain", was: "was uncertain" },
  unknown: { word: "Unknown", short: "unknown", was: "unknown" },
  fine: { word: "Fine", short: "fine", was: "was fine" },
};

// What the level of a pressure rests on.
export const LEVELS = {
  file: "level from the vehicle file",
  calibration: "level from a calibration",
  reference: "level from a stored calibration",
  "other-tires": "known against the other tires only",
};

// Why a state is unknown or uncertain.
const DOUBTS = {
  starting: "still learning",
  "no-information": "nothing to learn from",
  uncertain: "it could be low as well as not",
  misfit: "the car does not fit its vehicle file",
  suspicion: "a sensor is suspected",
  standing: "the car stands",
};
export const why = (wheel) => DOUBTS[wheel.doubt] ?? "";

// Why the speed is not known.
export const speedDoubt = (snapshot) => (snapshot.speed_doubt === "contradicted" ? "speed not known: the signal is zero while the wheels roll" : "speed not known");

// A wheel's state in one word for a badge, and in a shorter one for beside a tire.
export const badge = (wheel) => STATES[wheel.state]?.word || wheel.state;
export const short = (wheel) => STATES[wheel.state]?.short || wheel.state;
// A state that this page does not know is unknown.
export const kind = (wheel) => (wheel && STATES[wheel.state] ? wheel.state : "unknown");

// The unit in which pressures are shown; they come in kPa.
const { unit, unitKpa, unitPlaces } = document.documentElement.dataset;
export const UNIT = unit;
export const inUnit = (kpa) => (kpa == null ? null : kpa / unitKpa);
// A number in that unit, as exact as with `n` places in kPa; the same of a pressure in kPa.
export const exact = (value, n) => digits(value, n + Number(unitPlaces));
export const number = (kpa, n) => exact(inUnit(kpa), n);

// What may be shown of a wheel's pressure.
export const isShown = (wheel) => wheel && wheel.valid && wheel.pressure_kpa != null && wheel.pressure_sd_kpa != null;
// A car of which the wheel speeds alone are known: no pressure, but what each tire has lost against the others.
export const rolls = (wheel) => wheel?.level === "other-tires";
const percent = (share) => `${(100 * share).toFixed(0)} %`;
export const shows = (wheel) => (wheel.detectable_loss == null || wheel.detectable_loss > 0.9 ? "no loss would show yet" : `a loss of ${percent(wheel.detectable_loss)} would show`);
const places = (sd) => (sd < 1.95 ? 1 : 0);
export const pressure = (wheel) => (rolls(wheel) ? (wheel.lost_share == null ? "–" : percent(wheel.lost_share)) : isShown(wheel) ? number(wheel.pressure_kpa, places(wheel.pressure_sd_kpa)) : "–");
export const spread = (wheel) => (rolls(wheel) ? (wheel.lost_share == null ? "not compared yet" : `± ${percent(wheel.lost_share_sd)} lost`) : isShown(wheel) ? `± ${number(wheel.pressure_sd_kpa, places(wheel.pressure_sd_kpa))} ${UNIT}` : UNIT);
// What the tire would have cold, and what is to be done about it: "218 cold at -10 C: add 22".
const add = (wheel) => (wheel.cold_add_kpa == null ? "" : `: add ${number(wheel.cold_add_kpa, 0)}`);
export const cold = (wheel) =>
  isShown(wheel) && wheel.cold_pressure_kpa != null && wheel.ambient_temperature_c != null
    ? `${number(wheel.cold_pressure_kpa, 0)} cold at ${Math.round(wheel.ambient_temperature_c) + 0} C${add(wheel)}`
    : "";
export const reading = (wheel) => `${pressure(wheel)} ${spread(wheel)}`;
export const digits = (value, n) => (value == null || Number.isNaN(value) ? "–" : value.toFixed(n));
export const count = (value) => (value == null ? "–" : value.toLocaleString("en-US").replaceAll(",", "\u202f"));

// A name that somebody else chose, without what would turn the line around or is no letter.
export const plain = (name) => String(name ?? "").replace(/[\u0000-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g, "\ufffd");

const two = (n) => String(n).padStart(2, "0");

// Time of day of some milliseconds since 1970, here.
export function timeOfDay(ms) {
  if (!Number.isFinite(ms)) return "an unknown time";
  const d = new Date(ms);
  if (Number.isNaN(d.getTime())) return "an unknown time";
  return `${two(d.getHours())}:${two(d.getMinutes())}:${two(d.getSeconds())}`;
}

// A length of time for people.
export function span(s) {
  if (s == null || !Number.isFinite(s)) return "never";
  const sign = s < 0 ? "−" : "";
  s = Math.abs(s);
  if (s < 9.95) return `${sign}${s.toFixed(1)} s`;
  if (s < 119.5) return `${sign}${Math.round(s)} s`;
  const whole = Math.round(s), h = Math.floor(whole / 3600), m = Math.floor((whole % 3600) / 60);
  return h ? `${sign}${h} h ${two(m)} min` : `${sign}${m} min ${two(whole % 60)} s`;
}

// A moment on the source's clock: the time of day where it has one, else the time since its start. A replay keeps the clock of
// its log, whatever the time is now.
export function moment(time_s, snapshot) {
  if (time_s == null) return "–";
  if (time_s > 1e8) return timeOfDay(time_s * 1000);
  if (snapshot && snapshot.source.kind !== "replay" && snapshot.time_s != null) {
    return timeOfDay((snapshot.unix_s - (snapshot.time_s - time_s)) * 1000);
  }
  if (time_s < 120) return `${time_s.toFixed(1)} s`;
  return span(time_s);
}

// Words joined as in a sentence.
export const list = (words) => (words.length < 2 ? words.join("") : words.slice(0, -1).join(", ") + " and " + words.at(-1));
export const lower = (text) => text[0].toLowerCase() + text.slice(1);

// One sentence about the car, without a full stop: the most urgent first; "fine" only where everything is known. `old`: of
// how it was, in the words of how it is.
export function verdict(snapshot, old) {
  const wheels = snapshot?.wheels ?? [];
  if (!wheels.length) return "No tire is being watched yet";
  const of = (state) => wheels.filter((wheel) => kind(wheel) === state);
  const names = (some) => list(some.map((wheel, i) => (i ? lower(NAMES[wheel.corner]) : NAMES[wheel.corner])));
  const are = (some) => (some.length > 1 ? "are" : "is");
  const low = of("low"), over = of("over"), broken = of("malfunction"), unknown = of("unknown"), uncertain = of("uncertain"), fine = of("fine");
  if (low.length === 1) return `${names(low)} is low` + (isShown(low[0]) || rolls(low[0]) ? `: ${reading(low[0])}` : "");
  if (low.length && low.length === wheels.length) return `All ${low.length} tires are low`;
  if (low.length) return `${names(low)} are low`;
  if (broken.length) return `${names(broken)}: the sensors allow no statement`;
  if (over.length) return `${names(over)} ${are(over)} over-inflated` + (over.length === 1 && isShown(over[0]) ? `: ${reading(over[0])}` : "");
  if (unknown.length === wheels.length) return "Nothing is known of the tires yet";
  const unsure = [[uncertain, "uncertain"], [unknown, "unknown"]].filter(([some]) => some.length).map(([some, word]) => `${names(some)} ${are(some)} ${word}`);
  if (unsure.length) return unsure.join("; ") + (fine.length ? `, ${fine.length === 1 ? "one is" : fine.length + " are"} fine` : "");
  if (snapshot.all_fine || old) return wheels.length > 1 ? `All ${wheels.length} tires are fine` : `${names(fine)} is fine`;
  return `${wheels.length} tires were fine when last seen`;
}

export function element(tag, cls, text) {
  const e = document.createElement(tag);
  if (cls) e.className = cls;
  if (text != null) e.textContent = text;
  return e;
}
// Written only if it changes: no needless work for the browser and for those who listen to it.
export function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
export function attribute(node, name, value) {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}
