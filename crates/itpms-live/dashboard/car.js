// The car from above: four tires told apart by color, outline, sign and word.

import { CORNERS, NAMES, UNIT, attribute, badge, isShown, kind, number, pressure, put, reading, rolls, short, STATES } from "./words.js";

const tires = Object.fromEntries(CORNERS.map((corner) => {
  const group = document.getElementById("tire-" + corner);
  const part = (cls) => group.querySelector(cls);
  return [corner, { group, sign: part("use"), number: part(".tire-number"), spread: part(".tire-spread"), word: part(".tire-word") }];
}));
const picture = document.getElementById("car");

export function drawCar(snapshot, state) {
  const old = state !== "live";
  for (const corner of CORNERS) {
    const tire = tires[corner], wheel = snapshot?.wheels.find((w) => w.corner === corner);
    const is = wheel ? kind(wheel) : "absent";
    attribute(tire.group, "class", "tire " + is);
    attribute(tire.sign, "href", wheel ? "#sign-" + (is === "uncertain" ? "unknown" : is) : "#sign-none");
    // There is room for whole numbers; the cards have the rest.
    put(tire.number, !wheel ? "" : rolls(wheel) ? pressure(wheel) : isShown(wheel) ? number(wheel.pressure_kpa, 0) : "–");
    put(tire.spread, !wheel ? "no data" : rolls(wheel) ? (wheel.lost_share == null ? "" : "lost") : isShown(wheel) ? `± ${number(wheel.pressure_sd_kpa, 0)} ${UNIT}` : UNIT);
    put(tire.word, wheel ? (old ? STATES[is].was : short(wheel)) : "");
  }
  const said = (snapshot?.wheels ?? []).map((wheel) => `${NAMES[wheel.corner]}: ${badge(wheel)}, ${reading(wheel)}`);
  attribute(picture, "aria-label", (old ? "The car from above, values not current. " : "The car from above. ") + (said.join(". ") || "No data") + ".");
}
