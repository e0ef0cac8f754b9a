// A card per wheel: state, pressure with its standard deviation, what it should be, and how much is being learned.

import { NAMES, UNIT, attribute, badge, cold, element, isShown, kind, number, pressure, put, rolls, shows, span, spread, why, LEVELS, STATES } from "./words.js";

const host = document.getElementById("cards");
const cards = new Map();

function card(corner) {
  const article = element("article", "card at-" + corner);
  article.setAttribute("aria-labelledby", "card-" + corner);
  const name = element("h3", "card-name", NAMES[corner]);
  name.id = "card-" + corner;
  const mark = element("span", "badge"), number = element("p", "card-number"), gauge = element("div", "gauge"), foot = element("p", "card-foot");
  const value = element("span", "value", "–"), sd = element("small");
  number.append(value, sd);
  const fill = element("i", "gauge-fill"), band = element("i", "gauge-band"), aim = element("i", "gauge-mark");
  gauge.setAttribute("aria-hidden", "true");
  gauge.append(fill, band, aim);
  const doubt = element("span"), should = element("span"), learned = element("span"), rests = element("span");
  foot.append(doubt, should, learned, rests);
  const chilled = element("p", "card-foot chilled");
  article.append(name, mark, number, gauge, chilled, foot);
  host.append(article);
  return { article, mark, value, sd, gauge, fill, band, chilled, doubt, should, learned, rests };
}

const percent = (share) => (100 * Math.min(1, Math.max(0, share))).toFixed(1) + "%";

export function drawWheels(snapshot, state) {
  const wheels = snapshot?.wheels ?? [];
  host.classList.toggle("alone", wheels.length === 1);
  for (const wheel of wheels) {
    if (!cards.has(wheel.corner)) cards.set(wheel.corner, card(wheel.corner));
    const c = cards.get(wheel.corner), is = kind(wheel), shown = isShown(wheel), old = state !== "live";
    attribute(c.article, "class", `card at-${wheel.corner} ${is}`);
    attribute(c.mark, "class", "badge " + is);
    put(c.mark, old && is !== "unknown" ? STATES[is].was : badge(wheel));
    put(c.value, pressure(wheel));
    put(c.sd, spread(wheel));
    put(c.doubt, old ? "" : why(wheel));
    // The mark for what it should be stands at four fifths.
    const full = (wheel.reference_kpa ?? wheel.placard_kpa) / 0.8;
    c.fill.style.width = shown ? percent(wheel.pressure_kpa / full) : "0";
    c.band.style.left = shown ? percent((wheel.pressure_kpa - 2 * wheel.pressure_sd_kpa) / full) : "0";
    c.band.style.width = shown ? percent((4 * wheel.pressure_sd_kpa) / full) : "0";
    const same = Math.abs(wheel.reference_kpa - wheel.placard_kpa) < 0.5;
    c.gauge.hidden = rolls(wheel);
    put(c.should, rolls(wheel) ? shows(wheel) : same || wheel.reference_kpa == null ? `placard ${number(wheel.placard_kpa, 0)} ${UNIT}` : `reference ${number(wheel.reference_kpa, 0)} ${UNIT}`);
    put(c.chilled, old ? "" : cold(wheel));
    c.chilled.hidden = old || !cold(wheel);
    c.chilled.classList.toggle("add", wheel.cold_add_kpa != null);
    put(c.learned, old ? "" : wheel.informed_age_s == null ? "no estimate yet" : wheel.informed_age_s < 5 ? "updating" : `updated ${span(wheel.informed_age_s)} ago`);
    // The level may be no better than the vehicle file while a change is known well.
    put(c.rests, rolls(wheel) ? LEVELS[wheel.level] : shown && LEVELS[wheel.level] ? `${LEVELS[wheel.level]}; changes ± ${number(wheel.change_sd_kpa, 1)} ${UNIT}` : "");
  }
}
