// The machinery behind the report's curves: colors, axes, shared zoom, panels with a legend, the strip of codes.
// What is drawn is `report.js`'s business.
"use strict";
const Chart = (() => {
  const data = JSON.parse(document.getElementById("report-data").textContent);
  const root = document.documentElement;
  const charts = [];

  // ---- theme -------------------------------------------------------------------------------------------------
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const wanted = /theme=(dark|light)/.exec(location.hash);
  let choice = wanted ? wanted[1] : "auto";
  let colors = {};
  const ink = (name) => colors[name] || (colors[name] = getComputedStyle(root).getPropertyValue("--" + name).trim());
  function applyTheme(theme) {
    root.dataset.theme = theme || (choice === "auto" ? (dark.matches ? "dark" : "light") : choice);
    colors = {};
    document.getElementById("theme").textContent = "Theme: " + choice;
    charts.forEach((chart) => chart.paint());
  }
  document.getElementById("theme").addEventListener("click", () => {
    choice = { auto: "light", light: "dark", dark: "auto" }[choice];
    applyTheme();
  });
  dark.addEventListener("change", () => applyTheme());
  applyTheme();

  // ---- words and numbers -------------------------------------------------------------------------------------
  const has = (list) => list && list.length > 0;
  const digits = (v, n) => (v == null ? "–" : v.toFixed(n));
  const short = (v) => (v == null ? "–" : String(+v.toPrecision(3)));
  function clock(t, step) {
    if (longest < 180) return String(+t.toFixed(step < 0.1 ? 2 : step < 1 ? 1 : 0));
    const places = step < 0.1 ? 2 : step < 1 ? 1 : 0, pad = (n, d) => n.toFixed(d).padStart(d ? d + 3 : 2, "0");
    const s = +t.toFixed(places), h = Math.floor(s / 3600), m = Math.floor((s % 3600) / 60);
    return (h ? h + ":" + pad(m, 0) : m) + ":" + pad(s % 60, places);
  }
  // A length of time.
  function lasting(s) {
    if (s < 9.95) return +s.toFixed(1) + " s";
    if (s < 119.5) return Math.round(s) + " s";
    const whole = Math.round(s), h = Math.floor(whole / 3600), m = Math.floor((whole % 3600) / 60), pad = (n) => String(n).padStart(2, "0");
    return h ? h + " h " + pad(m) + " min" : m + " min " + pad(whole % 60) + " s";
  }
  const longest = data.t.length ? data.t[data.t.length - 1] : 0;
  // Round steps in decimals below a minute and in sixties above.
  const steps = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, ...(longest < 180 ? [50, 100] : [30]),
    60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400, 172800, 604800];
  const timeLabel = longest < 180 ? "Time (s)" : longest < 3600 ? "Time (min:s)" : "Time (h:min:s)";
  const powersOfTen = (min, max) => {
    const from = Math.ceil(Math.log10(min) - 1e-9), to = Math.floor(Math.log10(max) + 1e-9);
    const step = Math.max(1, Math.ceil((to - from) / 7)), all = [];
    for (let e = from; e <= to; e += step) all.push(10 ** e);
    // Zoomed in between two powers: the ends will do.
    return all.length > 1 ? all : [min, max];
  };
  const power = (v) => {
    const e = Math.round(Math.log10(v));
    if (Math.abs(Math.log10(v) - e) > 1e-6) return short(v);
    if (e >= -2 && e <= 2) return String(+v.toPrecision(1));
    return "10" + String(e).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] || "⁻");
  };
  const element = (tag, cls, text) => {
    const e = document.createElement(tag);
    if (cls) e.className = cls;
    if (text != null) e.textContent = text;
    return e;
  };

  // ---- zoom shared by all charts of a group ------------------------------------------------------------------
  let zooming = false;
  const reset = document.getElementById("reset");
  function shareZoom(source, group) {
    // While a chart is being set up it has nothing to share yet.
    if (zooming || !charts.some((chart) => chart.plot === source && chart.plot.status)) return;
    zooming = true;
    const { min, max } = source.scales.x;
    charts.forEach((chart) => {
      if (chart.group === group && chart.plot !== source) chart.plot.setScale("x", { min, max });
    });
    zooming = false;
    reset.hidden = !charts.some((chart) => chart.zoomed());
  }
  reset.addEventListener("click", () => charts.forEach((chart) => chart.all()));

  // Two fingers zoom in x, a double tap shows all. uPlot itself knows the mouse only.
  function touch(plot, showAll) {
    const over = plot.over;
    let start = null, tapped = 0;
    const span = (e) => {
      const left = over.getBoundingClientRect().left;
      const a = e.touches[0].clientX - left, b = e.touches[1].clientX - left;
      return [Math.min(a, b), Math.max(a, b)];
    };
    over.addEventListener("touchstart", (e) => {
      if (e.touches.length === 2) {
        start = span(e).map((px) => plot.posToVal(px, "x"));
        e.preventDefault();
      } else if (e.timeStamp - tapped < 300) showAll();
      else tapped = e.timeStamp;
    }, { passive: false });
    over.addEventListener("touchmove", (e) => {
      if (!start || e.touches.length !== 2) return;
      e.preventDefault();
      const [a, b] = span(e), width = over.clientWidth;
      if (b - a < 20) return;
      const scale = (start[1] - start[0]) / (b - a);
      const min = start[0] - a * scale;
      plot.setScale("x", { min, max: min + width * scale });
    }, { passive: false });
    over.addEventListener("touchend", () => (start = null));
  }

  // ---- one panel ---------------------------------------------------------------------------------------------
  // Room left of every chart over time, so that all of them line up; with an axis title it is 20 pixels more.
  const GUTTER = 42;
  const FONT = "12px system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif";
  const dash = { solid: [], dashed: [7, 4], dotted: [2, 3], long: [12, 4] };

  function swatch(item) {
    const ns = "http://www.w3.org/2000/svg";
    const svg = document.createElementNS(ns, "svg");
    svg.setAttribute("width", 26);
    svg.setAttribute("height", 12);
    if (item.band || item.fill) {
      const rect = document.createElementNS(ns, "rect");
      for (const [k, v] of [["x", 0], ["y", 1], ["width", 26], ["height", 10]]) rect.setAttribute(k, v);
      rect.style.fill = `var(--${item.band || item.fill})`;
      svg.append(rect);
    }
    if (item.color) {
      const line = document.createElementNS(ns, "line");
      for (const [k, v] of [["x1", 0], ["x2", 26], ["y1", 6], ["y2", 6]]) line.setAttribute(k, v);
      line.style.stroke = `var(--${item.color})`;
      line.style.strokeWidth = Math.max(item.width || 1.5, 1.5);
      line.style.strokeDasharray = (dash[item.dash] || []).join(" ");
      svg.append(line);
    }
    return svg;
  }

  // spec: title, note, x, group, xLabel, yLabel, range, height, wide, log, marks(u, ctx),
  //       items: [{label, y, lo, hi, color, band, dash, width, text(i), bars}]
  function panel(host, spec) {
    const items = spec.items.filter((item) => has(item.y) || has(item.lo));
    if (!items.length || !has(spec.x)) return;
    const figure = element("figure", "panel" + (spec.wide ? " wide" : ""));
    const heading = element("h3", "", spec.title), at = element("output", "at");
    heading.append(at);
    figure.append(heading);
    if (spec.note) figure.append(element("p", "", spec.note));
    const legend = element("ul", "legend");
    const holder = element("div", "plot");
    figure.append(legend, holder);
    host.append(figure);

    const full = spec.full || [spec.x[0], spec.x[spec.x.length - 1]];
    const columns = [spec.x], series = [{}], bands = [];
    const hidden = (y) => {
      columns.push(y);
      return series.push({ stroke: null, width: 0, points: { show: false } }) - 1;
    };
    for (const item of items) {
      item.index = [];
      if (has(item.lo)) {
        const hi = hidden(item.hi), lo = hidden(item.lo);
        bands.push({ series: [hi, lo], fill: () => ink(item.band) });
        item.index.push(hi, lo);
        if (item.edge) for (const i of [hi, lo]) {
          Object.assign(series[i], { stroke: () => ink(item.edge), width: 1, dash: dash[item.dash] });
        }
      }
    }
    for (const item of items) {
      if (!has(item.y)) continue;
      columns.push(item.y);
      item.index.push(series.push({
        stroke: () => ink(item.color),
        width: item.width || 1.5,
        dash: dash[item.dash],
        fill: item.fill ? () => ink(item.fill) : undefined,
        paths: item.bars ? uPlot.paths.bars({ size: [0.9, 120], gap: 1 }) : item.steps ? uPlot.paths.stepped({ align: 0 }) : undefined,
        points: { show: false },
      }) - 1);
    }
    const outputs = items.map((item) => {
      const li = element("li"), button = element("button"), output = element("output");
      button.append(swatch(item), document.createTextNode(item.label), output);
      button.type = "button";
      button.title = "Show or hide";
      button.ariaPressed = "true";
      li.append(button);
      const flip = () => {
        const show = button.ariaPressed !== "true";
        button.ariaPressed = String(show);
        item.index.forEach((i) => plot.setSeries(i, { show }));
        bands.forEach((band) => (band.show = plot.series[band.series[0]].show));
        plot.redraw();
      };
      button.addEventListener("click", flip);
      legend.append(li);
      return output;
    });

    const axis = (label, size, extra) => ({
      stroke: () => ink("soft"), label, labelSize: 20, labelGap: 0, labelFont: FONT, font: FONT, size, gap: 5,
      grid: { stroke: () => ink("grid"), width: 1 }, ticks: { stroke: () => ink("line"), width: 1, size: 5 },
      ...extra,
    });
    const isTime = spec.group === "time";
    const decades = { splits: (u, i, min, max) => powersOfTen(min, max), filter: (u, ticks) => ticks, values: (u, ticks) => ticks.map(power) };
    const plot = new uPlot({
      width: Math.max(holder.clientWidth, 200),
      height: spec.height || 210,
      padding: [10, 10, 0, 0],
      legend: { show: false },
      cursor: {
        y: false,
        drag: { x: true, y: false, dist: 4 },
        bind: { dblclick: () => () => chart.all() },
        points: { size: 7, fill: (u, i) => (typeof u.series[i].stroke === "function" ? u.series[i].stroke(u, i) : "transparent"), width: 0 },
        sync: spec.group ? { key: spec.group, scales: ["x", null], filters: { sub: (type) => type === "mousemove" || type === "mouseleave" } } : undefined,
      },
      scales: {
        x: { time: false, distr: spec.log ? 3 : 1, min: full[0], max: full[1] },
        y: { distr: spec.log || spec.logY ? 3 : 1, range: spec.range },
      },
      axes: [
        axis(spec.xLabel, 26, spec.log ? decades
          : isTime ? { space: 70, incrs: steps, values: (u, ticks, i, s, step) => ticks.map((t) => clock(t, step)) } : { space: 60 }),
        axis(spec.yLabel, GUTTER, { space: 34, ...(spec.log || spec.logY ? decades : {}) }),
      ],
      series,
      bands,
      hooks: {
        drawClear: spec.back ? [(u) => clipped(u, () => spec.back(u, u.ctx))] : [],
        draw: spec.marks ? [(u) => clipped(u, () => spec.marks(u, u.ctx))] : [],
        setScale: [(u, key) => key === "x" && spec.group && shareZoom(u, spec.group)],
        setCursor: [(u) => {
          const i = u.cursor.idx;
          const on = i != null && u.cursor.left >= 0;
          at.textContent = on ? (spec.at ? spec.at(columns[0][i]) : short(columns[0][i])) : "";
          items.forEach((item, k) => (outputs[k].textContent = on && item.text ? item.text(i) : ""));
        }],
      },
    }, columns, holder);
    register(plot, holder, spec.group, spec.height || 210, full);
    // Room for the longest hover text, so that nothing below moves.
    const places = Array.from({ length: 60 }, (_, k) => Math.round((k * (spec.x.length - 1)) / 59));
    reserve(at, places.map((i) => (spec.at ? spec.at(spec.x[i]) : short(spec.x[i]))));
    items.forEach((item, k) => item.text && reserve(outputs[k], places.map((i) => item.text(i))));
  }

  function reserve(output, texts) {
    output.style.minWidth = Math.max(...texts.map((text) => text.length)) + "ch";
  }

  function clipped(u, draw) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    draw();
    ctx.restore();
  }

  function register(plot, holder, group, height, full) {
    const chart = {
      plot, group,
      paint: () => plot.redraw(false, true),
      all: () => plot.setScale("x", { min: full[0], max: full[1] }),
      zoomed: () => plot.scales.x.max - plot.scales.x.min < 0.9999 * (full[1] - full[0]),
      // Strips keep their height: it is that of their words.
      fit: (width, scale) => plot.setSize({ width: Math.max(width || holder.clientWidth, 200), height: height > 180 ? Math.round(height * (scale || 1)) : height }),
    };
    charts.push(chart);
    touch(plot, chart.all);
    new ResizeObserver(() => printing || chart.fit()).observe(holder);
    return chart;
  }

  // A horizontal line across a panel, with a word at its right end.
  function level(u, ctx, value, color, text, pattern) {
    const y = Math.round(u.valToPos(value, "y", true));
    if (!(y > u.bbox.top && y < u.bbox.top + u.bbox.height)) return;
    const dpr = devicePixelRatio || 1;
    ctx.strokeStyle = ink(color);
    ctx.lineWidth = dpr;
    ctx.setLineDash((pattern || dash.dotted).map((d) => d * dpr));
    ctx.beginPath();
    ctx.moveTo(u.bbox.left, y);
    ctx.lineTo(u.bbox.left + u.bbox.width, y);
    ctx.stroke();
    ctx.setLineDash([]);
    // A halo, so that curves do not strike the word through.
    ctx.strokeStyle = ink("panel");
    ctx.lineWidth = 4 * dpr;
    ctx.lineJoin = "round";
    // Above the line; below it where it would be cut off.
    const off = y - u.bbox.top > 18 * dpr ? -4 : 13;
    word(u, ctx, text, u.bbox.left + u.bbox.width - 4 * dpr, y + off * dpr, color, "right", true);
  }
  function word(u, ctx, text, x, y, color, align, halo) {
    const dpr = devicePixelRatio || 1;
    ctx.font = FONT.replace("12px", 12 * dpr + "px");
    ctx.textAlign = align || "left";
    ctx.textBaseline = "alphabetic";
    ctx.fillStyle = ink(color);
    if (halo) ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
  }

  // ---- validity and warning, by color, pattern and word -------------------------------------------------------
  const VALIDITY = [
    ["valid", "green", "plain"], ["starting", "quiet", "dots"], ["no information", "quiet", "lines"],
    ["bad signal", "warn", "cross"], ["diverged", "low", "cross"], ["car does not fit", "warn", "lines"],
  ];
  const WARNING = [["none", "grid", "plain"], ["malfunction", "warn", "cross"], ["low", "low", "lines"]];
  const STATE = [["fine", "fine", "plain"], ["unknown", "quiet", "dots"], ["uncertain", "quiet", "lines"], ["over-inflated", "extra", "lines"], ["malfunction", "warn", "cross"], ["low", "low", "lines"]];

  // rows: [name, stretches [from, to, code], table of codes], drawn from top to bottom; `axis`: with a time axis.
  function strip(figure, rows, axis) {
    const height = 28 * rows.length + (axis ? 46 : 0);
    const holder = element("div", "plot strip");
    const legend = element("ul", "legend");
    const now = rows.map(([name]) => {
      const li = element("li"), output = element("output");
      li.append(name + ":", output);
      legend.append(li);
      return output;
    });
    // How long each lasted, all its stretches together, in the order in which they first came.
    const durations = (runs, table) => {
      const sums = new Map();
      runs.forEach(([from, to, code]) => sums.set(code, (sums.get(code) || 0) + to - from));
      return [...sums].map(([code, s]) => table[code][0] + " " + lasting(s)).join(", ") || "unknown";
    };
    const rest = () => rows.forEach(([, runs, table], k) => (now[k].textContent = durations(runs, table)));
    rest();
    figure.append(holder, legend);
    const plot = new uPlot({
      width: Math.max(holder.clientWidth, 200),
      height,
      padding: [4, 10, axis ? 0 : 4, 0],
      legend: { show: false },
      cursor: {
        y: false, points: { show: false }, drag: { x: true, y: false, dist: 4 }, bind: { dblclick: () => () => chart.all() },
        sync: { key: "time", scales: ["x", null], filters: { sub: (type) => type === "mousemove" || type === "mouseleave" } },
      },
      scales: { x: { time: false, min: data.t[0], max: longest }, y: { range: [0, rows.length] } },
      axes: [
        axis ? { stroke: () => ink("soft"), label: timeLabel, labelSize: 20, labelGap: 0, labelFont: FONT, font: FONT, size: 26, gap: 5, space: 70,
          incrs: steps, values: (u, ticks, i, s, step) => ticks.map((t) => clock(t, step)),
          grid: { stroke: () => ink("grid"), width: 1 }, ticks: { stroke: () => ink("line"), width: 1, size: 5 } } : { show: false },
        { stroke: () => ink("soft"), font: FONT, size: GUTTER + 20, gap: 4, grid: { show: false }, ticks: { show: false },
          splits: rows.map((row, k) => rows.length - k - 0.5).reverse(), values: () => rows.map((row) => row[0]).reverse() },
      ],
      series: [{}, { stroke: null, points: { show: false } }],
      hooks: {
        draw: [(u) => clipped(u, () => rows.forEach(([, runs, table], k) => {
          const dpr = devicePixelRatio || 1, pitch = u.bbox.height / rows.length, h = pitch - 4 * dpr, y = u.bbox.top + k * pitch + 2 * dpr;
          for (const [from, to, code] of runs) {
            const a = u.valToPos(from, "x", true), b = u.valToPos(to, "x", true);
            const [name, color, pattern] = table[code];
            fillPattern(u.ctx, dpr, a, y, Math.max(b - a, dpr), h, ink(color), pattern);
            const left = Math.max(a, u.bbox.left), room = Math.min(b, u.bbox.left + u.bbox.width) - left;
            u.ctx.font = FONT.replace("12px", 12 * dpr + "px");
            const width = u.ctx.measureText(name).width + 12 * dpr;
            if (room > width) {
              u.ctx.fillStyle = ink("panel");
              u.ctx.globalAlpha = 0.82;
              u.ctx.fillRect(left + 3 * dpr, y + 2 * dpr, width - 4 * dpr, h - 4 * dpr);
              u.ctx.globalAlpha = 1;
              word(u, u.ctx, name, left + 7 * dpr, y + h / 2 + 4.2 * dpr, "ink");
            }
          }
        }))],
        setScale: [(u, key) => key === "x" && shareZoom(u, "time")],
        setCursor: [(u) => {
          if (u.cursor.idx == null || u.cursor.left < 0) return rest();
          const t = u.posToVal(u.cursor.left, "x");
          rows.forEach(([, runs, table], k) => {
            const run = runs.find((r) => t >= r[0] && t <= r[1]);
            now[k].textContent = run ? table[run[2]][0] : "–";
          });
        }],
      },
    }, [data.t, data.t.map(() => null)], holder);
    register(plot, holder, "time", height, [data.t[0], longest]);
  }

  // A mark on the time axis where something was said.
  function flag(u, ctx, t, color) {
    const dpr = devicePixelRatio || 1, x = Math.round(u.valToPos(t, "x", true)), top = u.bbox.top;
    if (!(x >= u.bbox.left && x <= u.bbox.left + u.bbox.width)) return;
    ctx.strokeStyle = ctx.fillStyle = ink(color);
    ctx.lineWidth = 1.5 * dpr;
    ctx.setLineDash([4 * dpr, 3 * dpr]);
    ctx.beginPath();
    ctx.moveTo(x, top);
    ctx.lineTo(x, top + u.bbox.height);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.moveTo(x, top + 11 * dpr);
    ctx.lineTo(x - 6 * dpr, top);
    ctx.lineTo(x + 6 * dpr, top);
    ctx.fill();
  }

  // ---- print: light, as as wide as the paper, and a little lower ------------------------------------------------------------------
  let printing = false;
  addEventListener("beforeprint", () => {
    printing = true;
    applyTheme("light");
    charts.forEach((chart) => chart.fit(chart.plot.root.closest(".wide, #overview > .panel") ? 660 : 310, 0.8));
  });
  addEventListener("afterprint", () => {
    printing = false;
    applyTheme();
    charts.forEach((chart) => chart.fit());
  });

  return { data, panel, strip, flag, VALIDITY, WARNING, STATE, element, level, word, ink, has, digits, short, clock, timeLabel, seconds: longest < 180 };
})();
