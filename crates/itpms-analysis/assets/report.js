// What the report draws, panel by panel. Everything else on the page is there without it.
"use strict";
(({ data, panel, strip, flag, VALIDITY, WARNING, STATE, element, level, word, ink, has, digits, short, clock, timeLabel, seconds }) => {
  // Curves come in kPa and are drawn in the page's unit.
  const unit = data.unit, inUnit = (v) => (v == null ? null : v / unit.kpa);
  for (const corner of data.corners) {
    corner.placard = inUnit(corner.placard);
    for (const curve of ["p", "notValid", "lo", "hi", "truth", "sd", "error", "bound", "boundLo", "boundHi"]) corner.time[curve] = corner.time[curve].map(inUnit);
  }
  const number = (v, places) => digits(v, places + unit.more_places), pressureText = (v) => `${number(v, 1)} ${unit.symbol}`;
  const timed = (spec) => ({ x: data.t, group: "time", xLabel: timeLabel, at: (t) => "at " + clock(t, 0.01) + (seconds ? " s" : ""), ...spec });
  // Room for all finite values and some air, never below `least` wide.
  const around = (least, floor) => (u, lo, hi) => {
    if (lo == null) return [0, 1];
    const air = Math.max(0.06 * (hi - lo), 0.5 * (least - (hi - lo)), 0);
    return [floor == null ? lo - air : Math.max(floor, lo - air), hi + air];
  };
  const quantile = (list, q, none = 1) => {
    const sorted = list.filter((v) => v != null).sort((a, b) => a - b);
    return sorted.length ? sorted[Math.floor(q * (sorted.length - 1))] : none;
  };

  // Before anything is known an estimate may be anywhere: axes go by what was valid.
  function span(corner) {
    if (corner.span) return corner.span;
    const c = corner.time, runs = c.validity.filter((run) => run[2] === 0);
    let k = 0;
    const valid = data.t.map((t) => {
      while (k < runs.length && runs[k][1] < t) k++;
      return k < runs.length && runs[k][0] <= t;
    });
    const of = (list) => list.filter((v, i) => v != null && valid[i]);
    const p = of(c.p), lo = of(c.lo), hi = of(c.hi), sd = of(c.sd);
    const known = [...p, ...c.truth.filter((v) => v != null), corner.placard];
    if (!p.length) known.push(quantile(c.notValid, 0.02, corner.placard), quantile(c.notValid, 0.98, corner.placard));
    if (p.length) known.push(quantile(lo, 0.02), quantile(hi, 0.98));
    const bound = c.bound.filter((v) => v != null);
    corner.span = { low: Math.max(0, Math.min(...known)), high: Math.max(...known), sd: Math.max(inUnit(5), quantile(sd, 0.98, 0), quantile(bound, 0.98, 0)) };
    return corner.span;
  }

  // Where something was said about a corner.
  const inkOf = { "over-inflated": "extra", malfunction: "warn", "no-information": "quiet" };
  const said = (u, ctx, corner) => data.alerts.filter((alert) => alert.wheels.includes(corner.id))
    .forEach((alert) => flag(u, ctx, alert.reported, inkOf[alert.kind] || "low"));

  function pressure(host, corner) {
    const c = corner.time;
    const known = has(c.truth);
    panel(host, timed({
      title: "Pressure", wide: true, height: 320, yLabel: `Pressure (${unit.symbol})`,
      range: (u, lo, hi) => around(inUnit(60), 0)(u, lo == null ? lo : Math.max(lo, span(corner).low), hi == null ? hi : Math.min(hi, span(corner).high)),
      note: "The estimate with its 95 % band" + (known ? ", the truth, and around it" : ", and around it")
        + " the band that no estimator of one corner alone can beat; four wheels or a calibration can.",
      items: [
        { label: "95 % band", lo: c.lo, hi: c.hi, band: "band", text: (i) => number(c.lo[i], 0) + " to " + number(c.hi[i], 0) },
        { label: "Cramer-Rao bound, 95 %", lo: c.boundLo, hi: c.boundHi, dash: "dotted",
          ...(known ? { band: "bound-band", edge: "bound", color: "bound" } : { band: "bound-soft" }),
          text: (i) => "± " + number((c.boundHi[i] - c.boundLo[i]) / 2, 0) },
        { label: "Not valid", y: c.notValid, color: "quiet", dash: "dotted", text: (i) => pressureText(c.notValid[i]) },
        { label: "Estimate", y: c.p, color: "estimate", width: 2, text: (i) => pressureText(c.p[i]) },
        { label: "Truth", y: c.truth, color: "truth", dash: "dashed", text: (i) => pressureText(c.truth[i]) },
      ],
      marks: (u, ctx) => (level(u, ctx, corner.placard, "soft", "placard"), said(u, ctx, corner)),
    }));
    const states = has(corner.state) ? [["state", corner.state, STATE]] : [["warning", c.warning, WARNING]];
    if (host.lastChild) strip(host.lastChild, [...states, ["validity", c.validity, VALIDITY]]);
  }

  function inner(host, corner) {
    const c = corner.time;
    panel(host, timed({
      title: "How sure", yLabel: `Std. deviation (${unit.symbol})`, range: (u, lo, hi) => [0, lo == null ? 1 : 1.06 * Math.min(hi, 1.5 * span(corner).sd)],
      note: "Stated standard deviation against the Cramer-Rao bound of one corner alone" + (has(c.error) ? " and the error actually made." : " for a steady pressure."),
      items: [
        { label: "Error", y: c.error, color: "quiet", width: 1, text: (i) => pressureText(c.error[i]) },
        { label: "Bound", y: c.bound, color: "bound", dash: "dashed", text: (i) => pressureText(c.bound[i]) },
        { label: "Stated", y: c.sd, color: "estimate", width: 2, text: (i) => pressureText(c.sd[i]) },
      ],
    }));
    const top = c.nisCheck ? Math.max(2, 1.15 * quantile(c.nis, 0.99), 1.2 * c.nisCheck.upper) : 2;
    panel(host, timed({
      title: "Consistency", yLabel: "NIS / expected", range: [0, top],
      note: c.nisCheck ? "Innovations over " + short(c.nisCheck.window) + " s should stay in the band 95 % of the time; above it the estimate is too sure." : "",
      back: (u, ctx) => {
        if (!c.nisCheck) return;
        const a = u.valToPos(c.nisCheck.upper, "y", true), b = u.valToPos(c.nisCheck.lower, "y", true);
        ctx.fillStyle = ink("fine-soft");
        ctx.fillRect(u.bbox.left, a, u.bbox.width, b - a);
      },
      marks: (u, ctx) => level(u, ctx, 1, "soft", ""),
      items: [
        { label: "Single", y: c.nis, color: "quiet", width: 0.8, text: (i) => digits(c.nis[i], 2) },
        { label: "Averaged", y: c.nisMean, color: "green", width: 2, text: (i) => digits(c.nisMean[i], 2) },
      ],
    }));
    const most = c.forgetting.reduce((m, v) => Math.max(m, v || 0), 1);
    panel(host, timed({
      title: "Memory", yLabel: "Forgetting factor", logY: most > 8,
      range: most > 8 ? [1, 10 ** Math.ceil(Math.log10(most))] : (u, lo, hi) => [Math.min(1, lo == null ? 1 : lo), Math.max(1.05, hi == null ? 1 : hi + 0.05 * (hi - 1))],
      note: "1 keeps everything; peaks are the moments in which old data was let go.",
      items: [{ label: "Forgetting factor", y: c.forgetting, color: "extra", text: (i) => digits(c.forgetting[i], 3) }],
    }));
    panel(host, timed({
      title: "Information", yLabel: "Share, probability", range: [-0.02, 1.04],
      note: "How much of the data was used" + (has(c.change) ? ", and how likely the pressure is changing." : "."),
      items: [
        { label: "Information gate", y: c.gate, color: "estimate", fill: "band", text: (i) => digits(c.gate[i], 2) },
        { label: "Probability of change", y: c.change, color: "bound", dash: "dashed", text: (i) => digits(c.change[i], 2) },
      ],
    }));
  }

  function road(host, corner) {
    const r = corner.road;
    if (!r) return;
    const far = Math.max(r.x[r.x.length - 1] || 0, r.iri.x[r.iri.x.length - 1] || 0) > 5000;
    const along = (list) => (far ? list.map((v) => (v == null ? null : v / 1000)) : list);
    const x = along(r.x), xi = along(r.iri.x), unit = far ? "km" : "m";
    const mm = (list) => list.map((v) => (v == null ? null : v * 1000));
    const z = mm(r.z), truth = mm(r.truth);
    const ends = [x, xi].filter(has).map((list) => [list[0], list[list.length - 1]]);
    const half = r.iri.segment / (far ? 2000 : 2);
    const full = [Math.max(0, Math.min(...ends.map((e) => e[0])) - half), Math.max(...ends.map((e) => e[1])) + half];
    const metres = (d) => "at " + digits(d, far ? 3 : 1) + " " + unit;
    panel(host, {
      title: "Road under this wheel", wide: true, height: 230, x, full, group: "road", xLabel: `Distance (${unit})`, yLabel: "Height (mm)", at: metres, range: around(2),
      note: "Freed of its moving average over 10 m" + (has(truth) ? ", as is the truth" : "")
        + ". Without a band: the standard deviation in a road record (road_sd_m) is mostly that of the slow drift, which is not drawn.",
      items: [
        { label: "Truth", y: truth, color: "truth", dash: "dashed", width: 1, text: (i) => digits(truth[i], 1) + " mm" },
        { label: "Estimate", y: z, color: "estimate", text: (i) => digits(z[i], 1) + " mm" },
      ],
    });
    if (r.psd) spectrum(host, r.psd);
    const seen = r.iri.iri.concat(r.iri.truth).filter((v) => v != null);
    panel(host, {
      title: "Roughness", x: xi, full, group: "road", xLabel: `Distance (${unit})`, yLabel: "IRI (m/km)", at: metres, height: 280,
      range: [0, 1.15 * Math.max(1, ...seen)],
      note: "International Roughness Index of each " + short(r.iri.segment) + " m.",
      items: [
        { label: "Estimate", y: r.iri.iri, color: "estimate", fill: "band", bars: true, text: (i) => digits(r.iri.iri[i], 2) },
        { label: "Truth", y: r.iri.truth, color: "truth", dash: "dashed", text: (i) => digits(r.iri.truth[i], 2) },
      ],
    });
  }

  // Whole powers of ten around some values, nine at most.
  function decadesOf(curve) {
    const top = Math.ceil(Math.log10(Math.max(...curve)));
    const low = Math.floor(Math.log10(quantile(curve, 0.01) || 1e-12));
    return [10 ** Math.max(low, top - 9), 10 ** top];
  }

  function spectrum(host, psd) {
    const fit = psd.fit;
    const line = fit ? psd.n.map((n) => (n >= 0.98 * fit.low && n <= 1.02 * fit.high ? fit.level * (n / 0.1) ** -fit.slope : null)) : [];
    panel(host, {
      title: fit ? `Road spectrum: class ${fit.class}, slope ${fit.slope.toFixed(2)}` : "Road spectrum",
      note: fit ? "The line is fitted where the estimate holds; grey lines divide the ISO 8608 classes." : "Grey lines divide the ISO 8608 classes.",
      x: psd.n, log: true, height: 280, range: decadesOf(psd.density.concat(psd.truth.filter((v) => v > 0))), xLabel: "Spatial frequency (cycles/m)", yLabel: "Density Gd (m³)", at: (n) => "at " + short(n) + " cycles/m",
      items: [
        { label: "Truth", y: psd.truth, color: "truth", dash: "dashed", width: 1, text: (i) => short(psd.truth[i]) },
        { label: "Estimate", y: psd.density, color: "estimate", text: (i) => short(psd.density[i]) },
        { label: "Fitted line", y: line, color: "bound", width: 2.5, dash: "long", text: (i) => short(line[i]) },
      ],
      back: (u, ctx) => classes(u, ctx),
    });
  }

  // The borders between the ISO 8608 classes, Gd(n) = limit (n / 0.1)^-2, and their letters at both edges.
  function classes(u, ctx) {
    const dpr = devicePixelRatio || 1, { min, max } = u.scales.x;
    const at = (limit, n) => u.valToPos(limit * (n / 0.1) ** -2, "y", true);
    const left = u.bbox.left, right = left + u.bbox.width;
    data.classes.forEach(({ label, upper }, k) => {
      if (k < data.classes.length - 1) {
        ctx.strokeStyle = ink("quiet");
        ctx.globalAlpha = 0.55;
        ctx.lineWidth = dpr;
        ctx.beginPath();
        ctx.moveTo(left, at(upper, min));
        ctx.lineTo(right, at(upper, max));
        ctx.stroke();
        ctx.globalAlpha = 1;
      }
      for (const [n, x, align] of [[min, left + 5 * dpr, "left"], [max, right - 5 * dpr, "right"]]) {
        const y = at(upper / 2, n) + 4 * dpr;
        if (y > u.bbox.top + 12 * dpr && y < u.bbox.top + u.bbox.height - 4 * dpr) word(u, ctx, label, x, y, "soft", align);
      }
    });
  }

  // The four pressures as the tires stand, all to the same scale.
  function pressures(host) {
    const spans = data.corners.map(span);
    const low = Math.min(...spans.map((s) => s.low)), high = Math.max(...spans.map((s) => s.high)), air = 0.05 * (high - low);
    host.append(element("h2", "", "Pressures"));
    host.append(element("p", "verdict", "Each estimate with its 95 % band" + (data.corners.some((c) => has(c.time.truth)) ? " and the truth" : "")
      + ", arranged as the tires stand; a flag marks the moment of a warning."));
    const grid = element("div", "panels");
    host.append(grid);
    data.corners.forEach((corner) => {
      const c = corner.time;
      panel(grid, timed({
        title: corner.name, height: 200, yLabel: `Pressure (${unit.symbol})`, range: [Math.max(0, low - air), high + air],
        items: [
          { label: "95 % band", lo: c.lo, hi: c.hi, band: "band", text: (i) => number(c.lo[i], 0) + " to " + number(c.hi[i], 0) },
          { label: "Estimate", y: c.p, color: "estimate", width: 2, text: (i) => pressureText(c.p[i]) },
          { label: "Truth", y: c.truth, color: "truth", dash: "dashed", text: (i) => pressureText(c.truth[i]) },
        ],
        marks: (u, ctx) => (level(u, ctx, corner.placard, "soft", "placard"), said(u, ctx, corner)),
      }));
    });
  }

  function overview(host) {
    const speed = data.speed.map((v) => (v == null ? null : 3.6 * v));
    if (data.corners.length > 1) pressures(host);
    if (has(speed) && Math.max(...speed) - Math.min(...speed) > 0.5) {
      panel(host, timed({
        title: "Speed", height: 150, yLabel: "Speed (km/h)", range: (u, lo, hi) => [0, lo == null ? 1 : 1.08 * hi],
        items: [{ label: "Speed", y: speed, color: "soft", fill: "quiet-soft", text: (i) => digits(speed[i], 0) + " km/h" }],
      }));
    }
  }

  // Every wheel's state over the drive.
  function timeline(host) {
    const rows = data.corners.map((corner) => {
      const name = corner.name.replace("left", "L").replace("right", "R");
      return has(corner.state) ? [name, corner.state, STATE] : [name, corner.time.warning, WARNING];
    });
    if (!rows.length && data.wheels) data.wheels.states.forEach((runs, i) => rows.push([data.wheels.lost[i].name.replace("left", "L").replace("right", "R"), runs, STATE]));
    // A single wheel has its strip under its pressure.
    if (rows.length < 2 || !data.t.length || rows.every((row) => !has(row[1]))) return;
    const figure = element("figure", "panel wide");
    figure.append(element("h3", "", "Each wheel over time"));
    host.append(figure);
    strip(figure, rows, true);
  }

  // The road of each track: front wheel's profile, and the roughness that every wheel of the side has felt.
  function tracks(host) {
    for (const side of ["left", "right"]) {
      const wheels = data.corners.filter((corner) => corner.side === side && corner.road);
      if (!wheels.length) continue;
      const r = wheels[0].road, far = (r.x[r.x.length - 1] || 0) > 5000, unit = far ? "km" : "m", by = far ? 1000 : 1;
      const x = r.x.map((v) => v / by), mm = (list) => list.map((v) => (v == null ? null : v * 1000));
      const z = mm(r.z), truth = mm(r.truth);
      const metres = (d) => "at " + digits(d, far ? 3 : 1) + " " + unit;
      panel(host, {
        title: `Road, ${side} track`, height: 190, x, group: "road", xLabel: `Distance (${unit})`, yLabel: "Height (mm)", at: metres, range: around(2),
        note: `Estimated from the ${wheels[0].name.toLowerCase()} wheel, moving average over 10 m subtracted.`,
        items: [
          { label: "Truth", y: truth, color: "truth", dash: "dashed", width: 1, text: (i) => digits(truth[i], 1) + " mm" },
          { label: "Estimate", y: z, color: "estimate", text: (i) => digits(z[i], 1) + " mm" },
        ],
      });
    }
    for (const side of ["left", "right"]) {
      const wheels = data.corners.filter((corner) => corner.side === side && corner.road && has(corner.road.iri.x));
      if (!wheels.length) continue;
      const first = wheels[0].road.iri, far = first.x[first.x.length - 1] > 5000, unit = far ? "km" : "m", by = far ? 1000 : 1;
      // A wheel's segments at the places of the first wheel's.
      const at = (iri, list) => first.x.map((x) => {
        const k = iri.x.findIndex((other) => Math.abs(other - x) <= 0.5 * first.segment);
        return k < 0 || !has(list) ? null : list[k];
      });
      const look = [["estimate", "solid"], ["extra", "dotted"]];
      const curves = wheels.map((wheel) => at(wheel.road.iri, wheel.road.iri.iri));
      const truth = has(first.truth) ? at(first, first.truth) : [];
      const seen = [...curves.flat(), ...truth].filter((v) => v != null), half = first.segment / 2;
      const x = first.x.map((v) => v / by);
      panel(host, {
        title: `Roughness, ${side} track`, height: 190, x, group: "road", full: [(first.x[0] - half) / by, (first.x[first.x.length - 1] + half) / by],
        xLabel: `Distance (${unit})`, yLabel: "IRI (m/km)", at: (d) => "at " + digits(d, far ? 3 : 0) + " " + unit, range: [0, 1.15 * Math.max(1, ...seen)],
        note: `International Roughness Index of each ${short(first.segment)} m.`,
        items: [
          ...wheels.map((wheel, k) => ({ label: wheel.name, y: curves[k], color: look[k][0], dash: look[k][1], width: 2, steps: true, text: (i) => digits(curves[k][i], 2) })),
          { label: "Truth", y: truth, color: "truth", dash: "dashed", width: 1, steps: true, text: (i) => digits(truth[i], 2) },
        ],
      });
    }
  }

  // Radii since the calibration, and the losses that follow.
  function wheels(host) {
    const w = data.wheels;
    if (!w || ![...w.change, ...w.difference].some((one) => has(one.y))) return;
    const over = (spec) => timed({ x: w.t, ...spec });
    const lost = host.dataset.wheels === "lost";
    const panels = lost ? w.lost.map((one) => [one, one.name, "Lost (%)", "Share of its pressure lost since the calibration, against the other tires, with its 95 % band.", " %", 0, 20, 0]) : [
      ...w.difference.map((one) => [one, one.name, "Radii (‰)", "Change of the ratio since the calibration, measured, with its 95 % band.", " ‰", 2, 1]),
      ...w.change.map((one) => [one, one.name + ", radius", "Radius (‰)", "Change of the rolling radius since the calibration, with its 95 % band.", " ‰", 2, 1]),
    ];
    for (const [one, title, yLabel, note, unit, places, least, floor] of panels) {
      panel(host, over({
        title, height: 190, yLabel, note, range: around(least, floor),
        items: [
          { label: "95 % band", lo: one.lo, hi: one.hi, band: "band", text: (i) => digits(one.lo[i], places) + " to " + digits(one.hi[i], places) + unit },
          { label: "Estimate", y: one.y, color: "estimate", width: 2, text: (i) => digits(one.y[i], places) + unit },
        ],
        marks: (u, ctx) => (level(u, ctx, 0, "soft", ""), data.alerts.filter((alert) => alert.kind === "differs" || alert.kind === "slow-leak").forEach((alert) => flag(u, ctx, alert.reported, "low"))),
      }));
    }
  }

  // ---- what is folded ------------------------------------------------------------------------------------------
  // A link to a folded part opens it, the button opens or closes all, and paper has all.
  const folds = [...document.querySelectorAll("details.fold")], unfold = document.getElementById("unfold");
  const reveal = (hash) => {
    const fold = document.getElementById(hash.slice(1))?.closest("details.fold");
    if (fold) fold.open = true;
    return fold;
  };
  document.querySelectorAll("a[href^='#']").forEach((link) => link.addEventListener("click", () => reveal(link.hash)));
  addEventListener("hashchange", () => reveal(location.hash)?.scrollIntoView());
  const named = () => {
    const open = folds.every((fold) => fold.open);
    unfold.textContent = open ? "Close all" : "Open all";
    unfold.ariaPressed = String(open);
  };
  unfold.hidden = !folds.length;
  unfold.addEventListener("click", () => {
    const open = unfold.ariaPressed !== "true";
    folds.forEach((fold) => (fold.open = open));
    named();
  });
  folds.forEach((fold) => fold.addEventListener("toggle", named));
  let before = [];
  addEventListener("beforeprint", () => {
    before = folds.map((fold) => fold.open);
    folds.forEach((fold) => (fold.open = true));
  });
  addEventListener("afterprint", () => folds.forEach((fold, i) => (fold.open = before[i])));

  timeline(document.getElementById("timeline"));
  document.querySelectorAll("[data-wheels]").forEach(wheels);
  overview(document.getElementById("overview"));
  document.querySelectorAll("[data-roads]").forEach(tracks);
  document.querySelectorAll("[data-corner]").forEach((host) => {
    const corner = data.corners[+host.dataset.corner];
    pressure(host, corner);
    if (data.corners.length < 2) inner(host, corner);
    road(host, corner);
  });
  document.querySelectorAll("[data-inner]").forEach((host) => inner(host, data.corners[+host.dataset.inner]));
  reveal(location.hash)?.scrollIntoView();
})(Chart);
