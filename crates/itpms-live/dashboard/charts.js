// The curves. Times are shown as "before the newest", so that a drive and a replay of last year's log read alike.

import { CORNERS, NAMES, STATES, UNIT, digits, element, exact, inUnit, moment, span } from "./words.js";

const FONT = "12px system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif";
const GUTTER = 44;
const STEPS = [1, 2, 5, 10, 15, 20, 30, 60, 120, 180, 300, 600, 900];

// ---- colors of the page, for the canvas -----------------------------------------------------------------------------
let colors = {};
addEventListener("theme", () => (colors = {}));
const ink = (name) => (colors[name] ??= getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());

function ago(s) {
  if (s <= 0) return "newest";
  return s % 60 === 0 ? `−${s / 60} min` : `−${s} s`;
}

const plots = new Set();
addEventListener("theme", () => plots.forEach((plot) => plot.redraw(false, true)));

// Ticks at whole times before the newest.
const timeAxis = (extra) => ({
  ...look(),
  size: 26,
  space: 64,
  splits: (u, i, min, max) => {
    const room = Math.max(1, Math.floor(u.bbox.width / (devicePixelRatio || 1) / 70));
    const step = STEPS.find((s) => (max - min) / s <= room) ?? 900, all = [];
    for (let s = 0; s <= max - min + 1e-6; s += step) all.unshift(max - s);
    return all;
  },
  values: (u, ticks) => ticks.map((t) => ago(Math.round(u.scales.x.max - t))),
  ...extra,
});
const look = () => ({
  stroke: () => ink("soft"), font: FONT, gap: 5, labelFont: FONT, labelSize: 20, labelGap: 0,
  grid: { stroke: () => ink("grid"), width: 1 }, ticks: { stroke: () => ink("line"), width: 1, size: 5 },
});

// A plot in a box that follows its box's width; `spec`: height, range, label, series, bands, draw, back, cursor(index).
function plot(holder, spec) {
  const u = new uPlot({
    width: Math.max(holder.clientWidth, 200),
    height: spec.height,
    padding: [10, 26, 0, 0],
    legend: { show: false },
    select: { show: false },
    cursor: {
      y: false, x: true, drag: { x: false, y: false },
      points: { show: false },
      sync: { key: "time", scales: ["x", null] },
    },
    scales: { x: { time: false, range: (v, lo, hi) => spec.window(lo, hi) }, y: { range: spec.range } },
    axes: [timeAxis(spec.hideTime ? { show: false } : {}), spec.yAxis ?? { ...look(), size: GUTTER, space: 32, label: spec.label }],
    series: [{}, ...spec.series],
    bands: spec.bands,
    hooks: {
      drawClear: spec.back ? [(v) => clipped(v, spec.back)] : [],
      draw: spec.draw ? [(v) => clipped(v, spec.draw)] : [],
      setCursor: spec.cursor ? [(v) => spec.cursor(v.cursor.left >= 0 ? v.cursor.idx : null)] : [],
    },
  }, spec.empty, holder);
  plots.add(u);
  new ResizeObserver(() => holder.clientWidth > 0 && u.setSize({ width: Math.max(holder.clientWidth, 200), height: spec.height })).observe(holder);
  return u;
}

function clipped(u, draw) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(u, ctx, devicePixelRatio || 1);
  ctx.restore();
}

function word(u, ctx, dpr, text, x, y, color, align) {
  ctx.font = FONT.replace("12px", 12 * dpr + "px");
  ctx.textAlign = align;
  ctx.textBaseline = "alphabetic";
  ctx.strokeStyle = ink("panel");
  ctx.lineWidth = 4 * dpr;
  ctx.lineJoin = "round";
  ctx.strokeText(text, x, y);
  ctx.fillStyle = ink(color);
  ctx.fillText(text, x, y);
}

function figure(host, title, id) {
  const box = element("figure", "panel");
  const heading = element("h3", "", title), at = element("output", "at");
  heading.append(at);
  const holder = element("div", "plot");
  // The table below says the same in words.
  holder.setAttribute("aria-hidden", "true");
  box.append(heading, holder);
  if (id) box.id = id;
  host.append(box);
  return { box, at, holder };
}

// ---- pressures --------------------------------------------------------------------------------------------------------
const hidden = () => ({ stroke: null, width: 0, points: { show: false } });

// The time before the newest and the time of day or of the drive, for the curve's corner.
const placed = (u, i, snapshot) => `${span(u.data[0].at(-1) - u.data[0][i])} before · ${moment(u.data[0][i], snapshot)}`;

export class Pressures {
  constructor(host, windowOf) {
    this.span = [0, 1];
    this.alerts = [];
    this.placards = {};
    this.corners = CORNERS.map((corner) => {
      const { box, at, holder } = figure(host, NAMES[corner], "history-" + corner);
      const cursor = (i) => {
        const u = this.corners.find((c) => c.corner === corner).u, p = i == null ? null : u.data[3][i];
        const value = p == null ? "unknown" : `${exact(p, 1)} ± ${exact((u.data[1][i] - p) / 1.96, 1)} ${UNIT}`;
        at.textContent = i == null ? "" : `${value} · ${placed(u, i, this.newest)}`;
      };
      const u = plot(holder, {
        height: 190, window: windowOf, range: () => this.span, label: `Pressure (${UNIT})`, cursor, empty: [[], [], [], []],
        series: [hidden(), hidden(), { stroke: () => ink("estimate"), width: 2, points: { show: false } }],
        bands: [{ series: [1, 2], fill: () => ink("band") }],
        draw: (v, ctx, dpr) => this.marks(v, ctx, dpr, corner),
      });
      return { corner, box, u };
    });
  }
  draw(stretch, snapshot, alerts) {
    this.newest = snapshot;
    this.alerts = alerts;
    const columns = CORNERS.map((corner) => {
      const wheel = stretch.wheels[corner], p = wheel.pressure_kpa.map(inUnit), sd = wheel.pressure_sd_kpa.map(inUnit);
      const edge = (sign) => p.map((value, i) => (value == null || sd[i] == null ? null : value + sign * 1.96 * sd[i]));
      return [stretch.time_s, edge(1), edge(-1), p];
    });
    for (const wheel of snapshot?.wheels ?? []) this.placards[wheel.corner] = inUnit(wheel.placard_kpa);
    this.span = this.around(columns);
    this.corners.forEach(({ corner, box, u }, k) => {
      box.hidden = !(snapshot?.wheels ?? []).some((wheel) => wheel.corner === corner);
      u.setData(columns[k]);
    });
  }
  // The same scale for all: every estimate, the placards, most of the bands, some air.
  around(columns) {
    let low = Infinity, high = -Infinity;
    const take = (v) => v != null && ((low = Math.min(low, v)), (high = Math.max(high, v)));
    columns.forEach((c) => c[3].forEach(take));
    Object.values(this.placards).forEach(take);
    if (!(high >= low)) return [0, inUnit(300)];
    const air = Math.max(0.08 * (high - low), inUnit(20));
    return [Math.max(0, low - air), high + air];
  }
  marks(u, ctx, dpr, corner) {
    const { left, top, width, height } = u.bbox, placard = this.placards[corner];
    if (placard != null) {
      const y = Math.round(u.valToPos(placard, "y", true));
      line(ctx, dpr, "soft", [2, 3], [left, y], [left + width, y]);
      word(u, ctx, dpr, "placard", left + 4 * dpr, y - 4 * dpr, "soft", "left");
    }
    for (const { alert } of this.alerts) {
      if (!(alert.wheels ?? []).includes(corner)) continue;
      const x = Math.round(u.valToPos(alert.reported_s, "x", true));
      if (x < left || x > left + width) continue;
      const color = { malfunction: "warn", "no-information": "quiet", "over-inflated": "extra" }[alert.kind] ?? "low";
      line(ctx, dpr, color, [4, 3], [x, top], [x, top + height]);
      ctx.fillStyle = ink(color);
      ctx.beginPath();
      ctx.moveTo(x, top + 11 * dpr);
      ctx.lineTo(x - 6 * dpr, top);
      ctx.lineTo(x + 6 * dpr, top);
      ctx.fill();
    }
    if (u.data[0].length && u.data[3].every((v) => v == null)) {
      word(u, ctx, dpr, "unknown", left + width / 2, top + height / 2, "soft", "center");
    }
  }
}

function line(ctx, dpr, color, pattern, from, to) {
  ctx.strokeStyle = ink(color);
  ctx.lineWidth = dpr;
  ctx.setLineDash(pattern.map((d) => d * dpr));
  ctx.beginPath();
  ctx.moveTo(...from);
  ctx.lineTo(...to);
  ctx.stroke();
  ctx.setLineDash([]);
}

// ---- states over time ---------------------------------------------------------------------------------------------------
const LOOKS = { fine: ["fine", "plain"], uncertain: ["quiet", "lines"], unknown: ["quiet", "dots"], over: ["extra", "lines"], malfunction: ["warn", "cross"], low: ["low", "lines"] };

// Stretches of one state: [from, to, state].
function runs(time_s, states) {
  const all = [];
  states.forEach((state, i) => {
    if (state == null) return;
    const last = all.at(-1);
    if (last && last[2] === state && last[3] === i - 1) Object.assign(last, { 1: time_s[i], 3: i });
    else {
      // The new one begins where the old one ends, unless data was missing.
      const from = last && last[3] === i - 1 ? time_s[i - 1] : time_s[i];
      all.push([from, time_s[i], state, i]);
    }
  });
  return all;
}

export class States {
  constructor(host, windowOf) {
    this.rows = [];
    const { box, at, holder } = figure(host, "Each wheel over time");
    this.box = box;
    this.u = plot(holder, {
      height: 28 * 4 + 40, window: windowOf, range: () => [0, 4], empty: [[], []], series: [hidden()],
      yAxis: {
        stroke: () => ink("soft"), font: FONT, size: GUTTER + 20, gap: 4, grid: { show: false }, ticks: { show: false },
        splits: () => [0.5, 1.5, 2.5, 3.5], values: () => CORNERS.map((c) => NAMES[c].replace("left", "L").replace("right", "R")).reverse(),
      },
      cursor: (i) => {
        at.textContent = i == null ? "" : placed(this.u, i, this.newest);
      },
      draw: (u, ctx, dpr) => this.marks(u, ctx, dpr),
    });
  }
  draw(stretch, snapshot) {
    this.newest = snapshot;
    this.rows = CORNERS.map((corner) => runs(stretch.time_s, stretch.wheels[corner].state));
    this.u.setData([stretch.time_s, stretch.time_s.map(() => null)]);
  }
  marks(u, ctx, dpr) {
    const pitch = u.bbox.height / 4, h = pitch - 4 * dpr, right = u.bbox.left + u.bbox.width;
    this.rows.forEach((row, k) => {
      const y = u.bbox.top + k * pitch + 2 * dpr;
      for (const [from, to, state] of row) {
        const a = u.valToPos(from, "x", true), b = u.valToPos(to, "x", true);
        if (b < u.bbox.left) continue;
        const [color, pattern] = LOOKS[state] ?? LOOKS.unknown;
        fillPattern(ctx, dpr, a, y, Math.max(b - a, dpr), h, ink(color), pattern);
        const left = Math.max(a, u.bbox.left), name = STATES[state] ? STATES[state].word.toLowerCase() : "unknown";
        ctx.font = FONT.replace("12px", 12 * dpr + "px");
        const width = ctx.measureText(name).width + 12 * dpr;
        if (Math.min(b, right) - left > width) {
          ctx.fillStyle = ink("panel");
          ctx.globalAlpha = 0.86;
          ctx.fillRect(left + 3 * dpr, y + 2 * dpr, width - 4 * dpr, h - 4 * dpr);
          ctx.globalAlpha = 1;
          ctx.textAlign = "left";
          ctx.textBaseline = "alphabetic";
          ctx.fillStyle = ink("ink");
          ctx.fillText(name, left + 7 * dpr, y + h / 2 + 4.2 * dpr);
        }
      }
    });
  }
}

// ---- one track's road ---------------------------------------------------------------------------------------------------
// Curves of the wheels of a side, the front one solid, the rear one dotted and in another color; as lines or as steps.
export class Curves {
  constructor(host, { title, label, height, windowOf, wheels, least, unit, signed, steps }) {
    const { at, holder } = figure(host, title);
    Object.assign(this, { least, signed, span: [0, 1] });
    const curve = (color, dash) => ({
      stroke: () => ink(color), width: 1.75, dash, points: { show: false }, paths: steps ? uPlot.paths.stepped({ align: -1 }) : undefined,
    });
    this.u = plot(holder, {
      height, window: windowOf, label, range: () => this.span, empty: [[], ...wheels.map(() => [])],
      series: [curve("estimate", []), curve("extra", [3, 3])].slice(0, wheels.length),
      cursor: (i) => {
        const values = wheels.map((name, k) => `${name} ${digits(this.u.data[k + 1][i], 1)}`).join(", ");
        at.textContent = i == null ? "" : `${values} ${unit} · ${placed(this.u, i, this.newest)}`;
      },
    });
  }
  draw(stretch, snapshot, lists) {
    this.newest = snapshot;
    const seen = lists.flat().filter((v) => v != null);
    const high = Math.max(this.least, 1.15 * seen.reduce((m, v) => Math.max(m, Math.abs(v)), 0));
    this.span = [this.signed ? -high : 0, high];
    this.u.setData([stretch.time_s, ...lists]);
  }
}
