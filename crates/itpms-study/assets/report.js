// What the report draws, panel by panel. Everything else on the page is there without it.
"use strict";
(({ data, panel, strip, level, word, ink, has, digits, short, clock, timeLabel, seconds }) => {
  const kpa = (v) => digits(v, 1) + " kPa";
  const timed = (spec) => ({ x: data.t, group: "time", xLabel: timeLabel, at: (t) => "at " + clock(t, 0.01) + (seconds ? " s" : ""), ...spec });
  // Room for all finite values and some air, never below `least` wide.
  const around = (least, floor) => (u, lo, hi) => {
    if (lo == null) return [0, 1];
    const air = Math.max(0.06 * (hi - lo), 0.5 * (least - (hi - lo)), 0);
    return [floor == null ? lo - air : Math.max(floor, lo - air), hi + air];
  };
  const quantile = (list, q) => {
    const sorted = list.filter((v) => v != null).sort((a, b) => a - b);
    return sorted.length ? sorted[Math.floor(q * (sorted.length - 1))] : 1;
  };

  function pressure(host, corner) {
    const c = corner.time;
    const known = has(c.truth);
    panel(host, timed({
      title: "Pressure", wide: true, height: 320, yLabel: "Pressure (kPa)", range: around(60, 0),
      note: known ? "The estimate with its 95 % band, the truth, and the band no single-corner estimator can beat around it."
        : "The estimate with its 95 % band, and the band no single-corner estimator can beat around it.",
      items: [
        { label: "95 % band", lo: c.lo, hi: c.hi, band: "band", text: (i) => digits(c.lo[i], 0) + " to " + digits(c.hi[i], 0) },
        { label: "Cramer-Rao bound, 95 %", lo: c.boundLo, hi: c.boundHi, dash: "dotted",
          ...(known ? { band: "bound-band", edge: "bound", color: "bound" } : { band: "bound-soft" }),
          text: (i) => "± " + digits((c.boundHi[i] - c.boundLo[i]) / 2, 0) },
        { label: "Estimate", y: c.p, color: "estimate", width: 2, text: (i) => kpa(c.p[i]) },
        { label: "Truth", y: c.truth, color: "truth", dash: "dashed", text: (i) => kpa(c.truth[i]) },
      ],
      marks: (u, ctx) => level(u, ctx, corner.placard, "soft", "placard"),
    }));
    if (host.lastChild) strip(host.lastChild, corner);
  }

  function inner(host, corner) {
    const c = corner.time;
    panel(host, timed({
      title: "How sure", yLabel: "Std. deviation (kPa)", range: (u, lo, hi) => [0, lo == null ? 1 : 1.06 * hi],
      note: "Stated standard deviation against the Cramer-Rao bound" + (has(c.error) ? " and the error actually made." : " for a steady pressure."),
      items: [
        { label: "Error", y: c.error, color: "quiet", width: 1, text: (i) => kpa(c.error[i]) },
        { label: "Bound", y: c.bound, color: "bound", dash: "dashed", text: (i) => kpa(c.bound[i]) },
        { label: "Stated", y: c.sd, color: "estimate", width: 2, text: (i) => kpa(c.sd[i]) },
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
    const z = mm(r.z), lo = mm(r.lo), hi = mm(r.hi), truth = mm(r.truth);
    const ends = [x, xi].filter(has).map((list) => [list[0], list[list.length - 1]]);
    const half = r.iri.segment / (far ? 2000 : 2);
    const full = [Math.max(0, Math.min(...ends.map((e) => e[0])) - half), Math.max(...ends.map((e) => e[1])) + half];
    const metres = (d) => "at " + digits(d, far ? 3 : 1) + " " + unit;
    panel(host, {
      title: "Road under this wheel", wide: true, height: 230, x, full, group: "road", xLabel: `Distance (${unit})`, yLabel: "Height (mm)", at: metres, range: around(2),
      note: "Height with its 95 % band, freed of its moving average over 10 m" + (has(truth) ? ", as is the truth." : "."),
      items: [
        { label: "95 % band", lo, hi, band: "band" },
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

  function overview(host) {
    const speed = data.speed.map((v) => (v == null ? null : 3.6 * v));
    if (data.corners.length > 1) {
      const look = [["estimate", "solid"], ["bound", "dashed"], ["green", "long"], ["extra", "dotted"]];
      panel(host, timed({
        title: "All pressures", height: 260, yLabel: "Pressure (kPa)", range: around(60, 0),
        items: data.corners.map((corner, k) => ({
          label: corner.name, y: corner.time.p, color: look[k][0], dash: look[k][1], width: 2, text: (i) => kpa(corner.time.p[i]),
        })),
      }));
    }
    if (has(speed) && Math.max(...speed) - Math.min(...speed) > 0.5) {
      panel(host, timed({
        title: "Speed", height: 150, yLabel: "Speed (km/h)", range: (u, lo, hi) => [0, lo == null ? 1 : 1.08 * hi],
        items: [{ label: "Speed", y: speed, color: "soft", fill: "quiet-soft", text: (i) => digits(speed[i], 0) + " km/h" }],
      }));
    }
  }

  overview(document.getElementById("overview"));
  document.querySelectorAll(".panels").forEach((host) => {
    const corner = data.corners[+host.dataset.corner];
    pressure(host, corner);
    inner(host, corner);
    road(host, corner);
  });
})(Chart);
