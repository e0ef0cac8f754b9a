// A rectangle of a color and a pattern, for the strips of states of the report and of the live page: told apart without the color, too.
"use strict";
function fillPattern(ctx, dpr, x, y, w, h, color, pattern) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(x, y, w, h);
  ctx.clip();
  ctx.fillStyle = ctx.strokeStyle = color;
  ctx.globalAlpha = pattern === "plain" ? 0.55 : 0.3;
  ctx.fillRect(x, y, w, h);
  ctx.globalAlpha = 0.9;
  ctx.lineWidth = 1.2 * dpr;
  const step = 7 * dpr;
  ctx.beginPath();
  if (pattern === "lines" || pattern === "cross") {
    // From a fixed origin, so that neighbors match.
    for (let d = Math.floor((x - h) / step) * step; d < x + w; d += step) {
      ctx.moveTo(d, y + h);
      ctx.lineTo(d + h, y);
      if (pattern === "cross") {
        ctx.moveTo(d, y);
        ctx.lineTo(d + h, y + h);
      }
    }
    ctx.stroke();
  } else if (pattern === "dots") {
    for (let px = Math.floor(x / step) * step; px < x + w; px += step) {
      for (let py = y + step / 2; py < y + h; py += step) ctx.rect(px, py, 1.6 * dpr, 1.6 * dpr);
    }
    ctx.fill();
  }
  ctx.restore();
}
