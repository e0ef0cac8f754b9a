// What is found beside the pressures: each wheel's damper, the force once per turn and the tire's own sensor; what the axles carry.

import { CORNERS, NAMES, UNIT, attribute, digits, element, number, put } from "./words.js";

const section = document.getElementById("beside"), table = document.getElementById("beside-table");
const head = document.getElementById("beside-head"), body = document.getElementById("beside-rows"), load = document.getElementById("load");

const BECAUSE = {
  short: "half a minute of driving is needed",
  smooth: "the road is too smooth",
  rough: "the road is too rough",
  unexplained: "the car moves otherwise than its vehicle file explains",
  "no reference": "there is no stored calibration to compare with",
  adaptive: "adaptive dampers are not judged",
  "level control": "level control hides it",
};
const DAMPER = { fine: ["fine", "Fine"], weak: ["malfunction", "Weak"], worn: ["malfunction", "Worn"], stiff: ["malfunction", "Stiff"], learning: ["unknown", "Learning"] };
const TURN = { found: ["fine", "Known"], rising: ["malfunction", "Rising"], "no-line": ["fine", "None"], slow: ["unknown", "Learning"] };
const SENSOR = { fine: ["fine", "Fine"], leak: ["low", "Leak"], drift: ["malfunction", "Drifts"], stuck: ["malfunction", "Stuck"], learning: ["unknown", "Learning"] };

// On one line.
const within = (value, sd, n, unit) => `${digits(value, n)} ± ${digits(sd, n)}${unit}`.replaceAll(" ", "\u00a0");
const why = (because) => BECAUSE[because] ?? because ?? "";

function damper(it) {
  if (it.over_reference != null) return `${within(it.over_reference, it.over_reference_sd, 2, "")} of the reference`;
  if (it.left_right != null) return `left over right ${within(1 + it.left_right, it.left_right_sd, 2, "")}; ${why(it.because)}`;
  return why(it.because);
}
function turn(it) {
  if (it.force_n == null) return it.state === "slow" ? "two minutes above 40 km/h are needed" : "no force stands out of the road";
  const grams = it.imbalance_g == null ? "" : `, imbalance ${within(it.imbalance_g, it.imbalance_sd_g, 0, " g")}`;
  return `${within(it.force_n, it.force_sd_n, 0, " N")}${grams}${it.rise_n == null ? "" : `; risen by ${within(it.rise_n, it.rise_sd_n, 0, " N")}`}`;
}
function sensor(it, wheel) {
  const kpa = wheel?.tire_sensor_kpa ?? it.pressure_kpa, off = (value, sd) => `${number(value, 0).replace("-", "−")}\u00a0±\u00a0${number(sd, 0)}\u00a0${UNIT}`;
  const more = it.state === "leak" ? `, lost ${off(it.lost_kpa, it.lost_sd_kpa)}` : it.state === "drift" || it.state === "stuck" ? `, off by ${off(it.against_estimate_kpa, it.against_estimate_sd_kpa)}` : "";
  return `${number(kpa, 0)} ${UNIT}${more}`;
}

// Key, heading, words of a state, and the cell's text.
const COLUMNS = [
  ["dampers", "Damper", DAMPER, damper],
  ["once_per_turn", "Force once per turn", TURN, turn],
  ["tire_sensors", "Its own sensor", SENSOR, sensor],
];
const cells = new Map();
let made = "";

function make(columns) {
  cells.clear();
  const th = (text, scope) => Object.assign(element("th", "", text), { scope });
  head.replaceChildren(th("Wheel", "col"), ...columns.map(([, heading]) => th(heading, "col")));
  body.replaceChildren(...CORNERS.map((corner) => {
    const row = element("tr");
    row.append(th(NAMES[corner], "row"), ...columns.map(([key]) => {
      const cell = element("td"), mark = element("span", "badge"), text = element("span");
      cell.append(mark, " ", text);
      cells.set(`${key} ${corner}`, { mark, text });
      return cell;
    }));
    return row;
  }));
}

function loadWords(it) {
  const kg = (value, sd) => `${digits(value, 0)} ± ${digits(sd, 0)} kg`;
  const known = it.total_kg == null ? it.state && `Load ${it.state}${it.because ? `: ${why(it.because)}` : ""}.` : `Front axle ${kg(it.front_axle_kg, it.front_axle_sd_kg)}, rear axle ${kg(it.rear_axle_kg, it.rear_axle_sd_kg)}, total ${kg(it.total_kg, it.total_sd_kg)}, ${it.added_kg < 0 ? "−" : "+"}${kg(Math.abs(it.added_kg), it.added_sd_kg)} since the calibration.`;
  const axle = (name, value) => (value == null ? null : `${name} axle ${digits(value, 0)} kg`);
  const sent = it.sent && [axle("front", it.sent.front_axle_kg), axle("rear", it.sent.rear_axle_kg)].filter(Boolean).join(", ");
  const over = it.state === "overload" || it.sent?.overload ? "Overloaded. " : "";
  return over + [known, sent && `By the car’s own sensors: ${sent}.`].filter(Boolean).join(" ");
}

export function drawBeside(snapshot, state) {
  const columns = COLUMNS.filter(([key]) => snapshot?.[key]), keys = columns.map(([key]) => key).join();
  section.hidden = !columns.length && !snapshot?.load;
  if (section.hidden) return;
  if (keys !== made) make(columns);
  made = keys;
  table.hidden = !columns.length;
  const live = state === "live";
  for (const [key, , words, text] of columns) {
    for (const corner of CORNERS) {
      const it = snapshot[key][corner], cell = cells.get(`${key} ${corner}`);
      const [cls, word] = it ? words[it.state] ?? ["unknown", "Unknown"] : ["unknown", "Unknown"];
      attribute(cell.mark, "class", "badge " + (live ? cls : "unknown"));
      put(cell.mark, live ? word : "last: " + word.toLowerCase());
      put(cell.text, it ? text(it, snapshot.wheels.find((wheel) => wheel.corner === corner)) : "nothing comes");
    }
  }
  load.hidden = !snapshot.load;
  if (snapshot.load) put(load, loadWords(snapshot.load));
}
