// The road of each track: its roughness under the front and the rear wheel, its height, and whether both axles agree on it.

import { Curves } from "./charts.js";
import { digits, element, put } from "./words.js";

const SIDES = { left: ["fl", "rl"], right: ["fr", "rr"] };
const MINUTE = (lo, hi) => (hi == null ? [0, 60] : [hi - 60, hi]);

// What an International Roughness Index feels like.
function feels(iri) {
  return iri == null ? "not known yet" : iri < 1.5 ? "very smooth" : iri < 2.7 ? "smooth" : iri < 4.5 ? "fair" : iri < 8 ? "rough" : "very rough";
}

export class Roads {
  constructor(host, windowOf) {
    this.tracks = Object.entries(SIDES).map(([side, wheels]) => {
      const box = element("div", "track");
      box.append(element("h3", "", `${side === "left" ? "Left" : "Right"} track`));
      const facts = element("dl", "facts");
      box.append(facts);
      host.append(box);
      const fact = (name) => {
        const holder = element("div"), value = element("dd", "value", "–");
        holder.append(element("dt", "", name), value);
        facts.append(holder);
        return value;
      };
      const values = { front: fact("IRI, front wheel"), rear: fact("IRI, rear wheel"), rms: fact("Height, rms of the last minute"), shared: fact("Front and rear") };
      const iri = new Curves(box, { title: "Roughness of each 100 m", label: "IRI (m/km)", height: 150, windowOf, wheels: ["front", "rear"], least: 2, unit: "m/km", steps: true });
      const height = new Curves(box, { title: "Height under the front wheel, last minute", label: "Height (mm)", height: 150, windowOf: MINUTE, wheels: ["front"], least: 2, unit: "mm", signed: true });
      return { side, wheels, box, values, iri, height };
    });
  }
  draw(past, stretch, snapshot) {
    for (const { side, wheels, box, values, iri, height } of this.tracks) {
      const of = (corner) => snapshot?.wheels.find((wheel) => wheel.corner === corner);
      box.hidden = !wheels.some(of);
      const track = snapshot?.tracks.find((t) => t.side === side);
      const rough = (wheel) => (wheel?.iri_m_per_km == null ? "not known yet" : `${digits(wheel.iri_m_per_km, 1)} m/km, ${feels(wheel.iri_m_per_km)}`);
      put(values.front, rough(of(wheels[0])));
      put(values.rear, rough(of(wheels[1])));
      const mm = past.fine.wheels[wheels[0]].road_m.map((z) => (z == null ? null : 1000 * z)), seen = mm.filter((z) => z != null);
      put(values.rms, seen.length < 50 ? "–" : `${digits(Math.sqrt(seen.reduce((sum, z) => sum + z * z, 0) / seen.length), 1)} mm`);
      put(values.shared, agreement(track));
      iri.draw(stretch, snapshot, wheels.map((corner) => stretch.wheels[corner].iri_m_per_km));
      height.draw(past.fine, snapshot, [mm]);
    }
  }
}

function agreement(track) {
  if (!track) return "–";
  const share = track.incoherence == null ? "" : `, ${(100 * (1 - track.incoherence)).toFixed(0)} % in common`;
  return (track.shared ? "on the same road" : "not compared now") + share;
}
